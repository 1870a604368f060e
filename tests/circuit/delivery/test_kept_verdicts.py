"""Kept verdicts: nothing is written by one that is not what the gate says of just these drives."""

import json
import os
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.circuit.delivery.one_drive import changed, icon_of
from thermicon.circuit import Device, Rig, export
from thermicon.circuit.delivery import export as exporting
from thermicon.circuit.delivery import kept_verdicts as kept
from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
from thermicon.circuit.delivery.ways import deliver, worst_cases
from thermicon.circuit.safety.gate import Gate

RIG, DAC = Rig.load("thenar"), Device.load("dac-16")
DIP = icon_of("cool by 2 °C at 1 °C/s; return at 1 °C/s", "display", name="dip")
RISE = icon_of("warm by 2 °C at 1 °C/s; return at 1 °C/s", "display", name="rise")
ONE, OTHER = deliver(DIP, RIG, DAC), deliver(RISE, RIG, DAC)
POSIX = sys.platform != "win32"


class Judge:
    """The gate, which counts how often it is asked; it says the same of all drives."""

    def __init__(self) -> None:
        self.asked, self.says = 0, worst_cases([ONE])[0]

    def __call__(self, deliveries: list[DeliveredDrive], pause_s: float | None = None) -> tuple[Gate, ...]:
        self.asked += 1
        return (self.says,) * len(deliveries)


@pytest.fixture
def judge(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Judge:
    judge = Judge()
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(kept, "worst_cases", judge)
    monkeypatch.setattr(exporting, "worst_cases", judge)
    monkeypatch.setattr(exporting, "kept_or_judged", kept.kept_or_judged)
    return judge


def files() -> list[Path]:
    return sorted((kept.cache_folder() / "verdicts").glob("*"))


def test_drives_are_judged_once_for_export_and_study(judge: Judge) -> None:
    first = export(DIP, RIG, DAC)
    again = export(DIP, RIG, DAC)
    assert judge.asked == 1
    assert first.files == again.files
    assert repr(again.prepared[0].verdict.to_dict()) == repr(judge.says.to_dict())


def test_every_kind_of_verdict_comes_back_as_it_was(tmp_path: Path) -> None:
    for rig, device in (("tcs2", "qst-tcs2"), ("thenar", "closed-loop-controller"), ("thenar", "pwm-h-bridge-10")):
        verdicts = worst_cases([deliver(DIP, Rig.load(rig), Device.load(device))])
        kept.write(tmp_path / device, verdicts)
        assert kept.text_of(kept.read(tmp_path / device, 1)) == kept.text_of(verdicts)


def test_any_change_of_what_is_judged_or_of_the_program_is_judged_anew(
    judge: Judge, monkeypatch: pytest.MonkeyPatch
) -> None:
    digit, area = changed(DAC, "update rate", "Hz", high=10_001.0), RIG.with_(**{"contact.area_cm2": 9.000001})
    strict = RIG.with_(**{"safety.skin_highest_C": 41.9})
    asked: list[tuple[list[DeliveredDrive], float | None]] = [([ONE], None), ([ONE], 599.9), ([ONE, OTHER], None)]
    asked += [([OTHER, ONE], None), *(([replace(ONE, rig=rig)], None) for rig in (area, strict))]
    asked += [([replace(ONE, device=digit)], None), ([deliver(DIP, RIG, DAC, tail_s=0.01)], None)]
    for count, (deliveries, pause_s) in enumerate(asked, 1):
        kept.kept_or_judged(deliveries, pause_s)
        assert judge.asked == count
    for count, patch in enumerate(((np, "__version__", "1"), (kept, "code_digest", str)), len(asked) + 1):
        with monkeypatch.context() as other:
            other.setattr(*patch)
            kept.kept_or_judged([ONE], None)
        assert judge.asked == count
    kept.kept_or_judged([ONE], None)
    assert judge.asked == len(asked) + 2, "what was kept is still there"


def resealed(path: Path, content: bytes) -> None:
    kept.write_sealed(path, content)


def turned_red(path: Path) -> None:
    table = json.loads(path.read_bytes()[32:])
    table[1][0][1]["once"][1][0][1] |= {"since_s": 0.0, "severity": "hard"}
    table[1][0][1]["checks"] = table[1][0][1]["once"]
    resealed(path, json.dumps(table).encode())


def linked(path: Path) -> None:
    path.rename(path.with_name("else"))
    path.symlink_to(path.with_name("else"))


ATTACKS: dict[str, Callable[[Path], object]] = {
    "a digit": lambda path: path.write_bytes(path.read_bytes().replace(b"0.1", b"0.2", 1)),
    "half of it": lambda path: os.truncate(path, path.stat().st_size // 2),
    "nothing": lambda path: path.write_bytes(b""),
    "that of other drives": lambda path: path.write_bytes(files()[files()[0] == path].read_bytes()),
    "too deep": lambda path: resealed(path, b"[" * 100_000),
    "a record of none": lambda path: resealed(path, b'["tuple", [["Path", {}]]]'),
    "no verdict": lambda path: resealed(path, b'["tuple", [["Before", {"plays": "any"}]]]'),
    "too few": lambda path: resealed(path, b'["tuple", []]'),
    "red": turned_red,
    "too long": lambda path: os.truncate(path, kept.LARGEST + 1),
    **({"a link": linked, "of anyone": lambda path: path.chmod(0o666)} if POSIX else {}),
}


@pytest.mark.parametrize("attack", ATTACKS)
def test_a_file_that_is_not_as_it_was_written_is_judged_anew(judge: Judge, attack: str) -> None:
    kept.kept_or_judged([OTHER], None)
    others = set(files())
    kept.kept_or_judged([ONE], None)
    for path in set(files()) - others:
        ATTACKS[attack](path)
    kept.kept_or_judged([ONE], None)
    assert judge.asked == 3
    kept.kept_or_judged([ONE], None)
    assert judge.asked == 3, "and kept again"


def test_red_and_forced_verdicts_are_not_kept(judge: Judge, monkeypatch: pytest.MonkeyPatch) -> None:
    green = judge.says
    failed = replace(green.once[0], severity="hard", since_s=0.0)
    judge.says = replace(green, once=(failed,), checks=(failed,))
    export(DIP, RIG, DAC)
    judge.says = green
    export(DIP, RIG, DAC, force=True)
    monkeypatch.setattr(kept, "STARTED_S", 0.0)  # the program was changed while it ran
    export(DIP, RIG, DAC)
    assert (judge.asked, files()) == (3, [])
    monkeypatch.undo()


def test_where_nothing_can_be_kept_drives_are_judged(judge: Judge, monkeypatch: pytest.MonkeyPatch) -> None:
    full = OSError(28, "No space left on device")
    with monkeypatch.context() as disk:
        disk.setattr(Path, "write_bytes", lambda *_: (_ for _ in ()).throw(full))
        assert kept.kept_or_judged([ONE], None) == (judge.says,)
    assert files() == []
    if POSIX:
        (kept.cache_folder() / "verdicts").chmod(0o777)
        assert kept.kept_or_judged([ONE], None) == (judge.says,)
        assert files() == []


def test_writers_at_once_leave_whole_files_and_the_oldest_give_way(
    judge: Judge, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, verdicts = tmp_path / "one", (judge.says,)
    kept.write(path, verdicts)
    with ThreadPoolExecutor(8) as pool:
        written = pool.map(lambda k: kept.write(path, verdicts) if k % 2 else kept.read(path, 1), range(80))
        assert all(one is None or kept.text_of(one) == kept.text_of(verdicts) for one in written)
        assert list(tmp_path.iterdir()) == [path]
    monkeypatch.setattr(kept, "MOST", 2 * path.stat().st_size + 10)
    for age, name in enumerate(("two", "three", "four")):
        os.utime(path, (age, age))
        path = tmp_path / name
        kept.write(path, verdicts)
    assert {each.name for each in tmp_path.iterdir()} == {"three", "four"}
