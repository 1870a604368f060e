"""Exports or refusals of everyday cues on all shipped hardware: `everyday.csv`.

``python tests/circuit/delivery/test_everyday_cues.py`` writes the table anew, in half an hour of two cores.
"""

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path

import pytest

from tests.circuit.delivery.one_drive import icon_of, prepare
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.device import device_names
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.formats import FormatError, format_names, load_format
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rigfile import RigError
from thermicon.icons import Icon

TABLE = Path(__file__).with_name("everyday.csv")
COMMENT, HEAD, *ROWS = TABLE.read_text("utf-8").splitlines()
STEPS = tuple(product(("skin", "display"), (-6, -3, 3, 6)))
MARKS = {"unsafe": "not safe", "unreachable": "not reached", "lossy": "loses"}
ORDINARY = (("thenar", "dac-16"), ("thenar", "pwm-h-bridge-10"), ("thenar", "qst-tcs2"), ("shani2021", "dac-16"))
QUICK = tuple(pytest.param(*pair, marks=() if pair[1] == "qst-tcs2" else pytest.mark.slow) for pair in ORDINARY)
"""In the ordinary suite the thermode, whose verdicts are quick; steps by current are exported in `test_export.py`."""


@dataclass(frozen=True, slots=True)
class Case:
    """One cue on one rig and device: its column in the table, `yes` or the first cause, that in words, the forms."""

    column: str
    mark: str
    why: str = ""
    forms: tuple[tuple[str, str], ...] = ()


def step_of(control: str, change: int) -> Icon:
    verb = "cool" if change < 0 else "warm"
    return icon_of(f"{verb} by {abs(change)} °C at 3 °C/s; hold for 4 s; return at 3 °C/s", control, name="step")


def case_of(icon: Icon, rig: Rig, device: Device, column: str, forms: Sequence[str]) -> Case:
    plain = next(name for name in format_names() if device.driven_by in load_format(name).takes)
    try:
        ready = prepare(icon, rig, device, load_format(plain))
    except (DeviceError, RigError) as problem:
        return Case(column, "cannot play", str(problem))
    if ready.refusals:
        first = ready.refusals[0]
        return Case(column, MARKS[first.kind], str(first))
    written = []
    for name in forms:
        form = load_format(name)
        if device.driven_by not in form.takes:
            continue
        try:
            form.write(ready.delivery)
            written.append((name, ""))
        except FormatError as problem:
            written.append((name, str(problem)))
    return Case(column, "yes", forms=tuple(written))


@cache
def steps_on(rig_name: str, device_name: str) -> list[Case]:
    rig, device = Rig.load(rig_name), Device.load(device_name)
    return [case_of(step_of(*step), rig, device, column_of(*step), format_names()) for step in STEPS]


def column_of(control: str, change: int) -> str:
    return f"{control} {change:+d} K".replace("-", "−")


def row_of(rig: str, device: str, cases: Iterable[Case]) -> str:
    return ",".join((rig, device, *(case.mark for case in cases)))


@pytest.mark.parametrize(("rig", "device"), QUICK)
def test_the_table_says_what_becomes_of_everyday_steps(rig: str, device: str) -> None:
    cases = steps_on(rig, device)
    assert row_of(rig, device, cases) in ROWS, "if it is right: python tests/circuit/delivery/test_everyday_cues.py"
    for case in cases:
        assert (case.why == "") == (case.mark == "yes")
        assert {name for name, why in case.forms if why} <= {"wav"}, case.forms


@pytest.mark.parametrize(("rig", "device"), QUICK[:3])
def test_every_everyday_step_is_exported_on_the_default_rig(rig: str, device: str) -> None:
    marks = {case.column: case.mark for case in steps_on(rig, device)}
    if device != "qst-tcs2":  # an open loop may take the display to 45 °C on the way, where a stuck driver may leave it
        assert marks.pop("skin +6 K") == "not safe"
    assert set(marks.values()) == {"yes"}


def test_a_device_that_cannot_play_is_a_cause_like_any_other() -> None:
    warm = icon_of("warm by 1 °C at 1 °C/s", baseline=42)
    case = case_of(warm, Rig.load("thenar"), Device.load("qst-tcs2"), "", ())
    assert (case.mark, case.why[:46]) == ("cannot play", "qst-tcs2: a baseline of 42 °C is beyond 20 … 4")


def test_the_table_has_every_rig_with_every_device() -> None:
    assert ",".join(("rig", "device", *(column_of(*step) for step in STEPS))) == HEAD
    missing = "write the table anew: python tests/circuit/delivery/test_everyday_cues.py"
    assert {tuple(row.split(",")[:2]) for row in ROWS} == set(product(rig_names(), device_names())), missing


def everything() -> list[str]:
    with ProcessPoolExecutor(max_workers=min(4, os.cpu_count() or 1)) as pool:
        pairs = list(product(rig_names(), device_names()))
        return [
            row_of(*pair, cases)
            for pair, cases in zip(pairs, pool.map(steps_on, *zip(*pairs, strict=True)), strict=True)
        ]


if __name__ == "__main__":
    TABLE.write_text("\n".join([COMMENT, HEAD, *everything()]) + "\n", "utf-8")
