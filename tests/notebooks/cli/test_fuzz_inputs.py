"""Tens of thousands of damaged files of every kind, and settings: each is read or refused in words, soon.

``pytest -m slow tests/notebooks/cli/test_fuzz_inputs.py`` examines 50,000 of them in some minutes on two cores;
THERMICON_FUZZ=2000 fewer. Mutations are seeded, so that a failure comes again.
"""

from __future__ import annotations

import multiprocessing
import os
import random
import re
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType

import pytest

from thermicon.circuit import Device, Rig, read_drive, simulate_current
from thermicon.circuit.delivery.samples import rate_of
from thermicon.circuit.fitting.log import read_log
from thermicon.circuit.safety.session import read_order
from thermicon.icons import load_library, parse
from thermicon.icons.recordings.recorded import read_readings
from thermicon.notebooks.cli.compare import _shifted
from thermicon.notebooks.files.trace_files import align, read_curves
from thermicon.notebooks.messages import is_ours
from thermicon.notebooks.report.run_report import Comparison, compare_report
from thermicon.notebooks.study.study_file import parse_study, study_text
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.pilot.measurements_file import read_measurements
from thermicon.perception.pilot.trials_file import read_trials

COUNT, CHUNKS = int(os.environ.get("THERMICON_FUZZ", "50000")), 50
SLOWEST_S = 5.0

NUMBERS = [
    "0", "-0.0", "1", "-1", "1e308", "-1e308", "5e-324", "1e-300", "nan", "inf", "-inf", "9" * 30, "9" * 4400,
    "2147483648", "4294967296", "1e7", "1e9", "1024", "0x7fffffff", "1_000", "²", "٣", "true", '"x"', "[]", "{}",
    "[1, 2]", "1979-05-27",
]  # fmt: skip
PIECES = [
    "\x1b[2J", "\u202e", "\0", "\ufeff", "\r", "\r\n", "\n", "\u2028", "*/", "../", '"', "'", "[", "]", "{", "}", "=",
    ",", ".", "#", "é", "a" * 300, "[" * 200, "a." * 200, "[[skin.layer]]\n", "[skin]\n", "\ud800",
]  # fmt: skip
KEYS = ["contact.area_cm2", "skin.layer.0.thickness_mm", "skin.layer.dermis.perfusion_per_s", "driver.update_Hz"]


def texts(folder: str) -> list[str]:
    entries = sorted((files("thermicon.circuit") / folder).iterdir(), key=lambda entry: entry.name)
    return [entry.read_text(encoding="utf-8") for entry in entries if entry.name.endswith(".toml")]


RIGS, DEVICES = texts("rigs"), texts("devices")
CUES = [
    entry.read_text(encoding="utf-8")
    for entry in sorted((files("thermicon.icons") / "library").iterdir(), key=lambda entry: entry.name)
]
DRIVES = [
    "time_s,current_A\n0,0.1\n1,0.2\n2.5,-0.3\n",
    "time_s,current_A,code\r\n0,0.1,5\r\n0.01,0.2,6\r\n",
    '"time_s" , "current_A"\n\n0,0\n1e-3,1\n',
]
LOG = "time_s,current_A,voltage_V,display_C,skin_C\n" + "".join(
    f"{k / 10},{0.1 * (k % 7)},{1 + 0.2 * (k % 7)},{32 - 0.1 * k},{32 - 0.05 * k}\n" for k in range(25)
)
LOGS = [LOG, LOG.replace(",", ";"), LOG.replace("\n", "\r")]
TRIALS = [
    "participant,trial,presented,responded,time_s\n" + "".join(
        f"P{k % 3},{k},{'dip' if k % 2 else 'glow'},dip,{1 + 0.1 * k}\n" for k in range(12)
    ),
]  # fmt: skip
VALUES = [
    "participant,kind,method,channel,value,unit\nP1,threshold,limits,cold,1.1,K\nP2,threshold,limits,warm,0.9,K\n"
]
ORDERS = ["# 4 plays\ncooling-step\nwarming-step, double-dip\ncooling-step\n"]
OBSERVERS = [(files("thermicon.perception") / "data" / "observer.toml").read_text(encoding="utf-8")]
POSTERIOR = (files("thermicon.perception") / "data" / "posterior.csv").read_text(encoding="utf-8").splitlines(True)
DRAWS = ["".join(line for line in POSTERIOR[:24] if "sha256" not in line)]
STUDIES = [(files("thermicon.notebooks") / "data" / "example-study.toml").read_text(encoding="utf-8")]
SETTINGS = [
    *(f"{key}=1" for key in KEYS),
    "probe.0.name=x",
    "module.datasheet=[{}]",
    "skin.layer=[]",
    "safety.reason=x",
]


def mutate(text: str, rng: random.Random) -> str:
    """Change a number, a character, a word or a line."""
    change = rng.randrange(6)
    if change < 2 and (spots := list(re.finditer(r"-?\d[\d.e+-]*", text))):
        spot = rng.choice(spots)
        return text[: spot.start()] + rng.choice(NUMBERS) + text[spot.end() :]
    at = rng.randrange(len(text) + 1)
    if change == 2:
        return text[:at] + rng.choice(PIECES) + text[at:]
    if change == 3:
        return text[:at] + text[at + rng.randint(1, 12) :]
    if change == 4:
        lines = text.split("\n")
        lines[rng.randrange(len(lines))] = rng.choice(lines)
        return "\n".join(lines)
    words = re.split(r"(\W)", text)
    words[rng.randrange(len(words))] = rng.choice(words)
    return "".join(words)


def use_rig(path: Path) -> None:
    rig = Rig.load(path)
    str(rig), rig.warnings, rig.about()


def use_device(path: Path) -> None:
    device = Device.load(path)
    if device.driven_by != "set-points":
        device.scale(1.0)
        rate_of(device, 100.0, 8.0)


def use_curves(path: Path) -> None:
    other = path.with_name("sound.csv")
    other.write_text(LOG)
    first, second = read_curves(str(other)), read_curves(str(path))
    compare_report(Comparison("", align(first, _shifted(first, second)[0])))


@dataclass(frozen=True)
class Kind:
    """Sound texts of a kind of input, how often one is damaged, and what reads its file."""

    texts: list[str]
    weight: int
    file: str
    read: Callable[[Path], object]


def use_drive(path: Path) -> None:
    simulate_current(read_drive(path), Rig.load("thenar"), rate_Hz=10.0)


def use_settings(path: Path) -> None:
    Rig.load("thenar").with_set([path.read_bytes().decode("utf-8", "replace")])


KINDS = [
    Kind(CUES, 3, "a.cue", lambda path: parse(path.read_bytes(), "a.cue")),
    Kind(RIGS, 3, "a.toml", use_rig),
    Kind(DEVICES, 3, "a.toml", use_device),
    Kind(DRIVES, 2, "a.csv", use_drive),
    Kind(SETTINGS, 2, "a.txt", use_settings),
    Kind(LOGS, 2, "a.csv", read_log),
    Kind(LOGS, 2, "a.csv", use_curves),
    Kind(LOGS, 1, "a.csv", lambda path: read_readings(path, "skin_C")),
    Kind(TRIALS, 1, "a.csv", lambda path: read_trials(path, ["dip", "glow"])),
    Kind(VALUES, 1, "a.csv", lambda path: read_measurements(path, Rig.load("thenar"))),
    Kind(ORDERS, 1, "a.csv", lambda path: read_order(path, load_library("six-icons"))),
    Kind(OBSERVERS, 1, "a.toml", ObserverModel.load),
    Kind(DRAWS, 1, "a.csv", ObserverModel.load),
    Kind(STUDIES, 1, "a.toml", lambda path: parse_study(study_text(path), "study.toml")),
]


def mutated(rng: random.Random) -> tuple[bytes, Kind]:
    """A damaged input, and its kind."""
    (kind,) = rng.choices(KINDS, [kind.weight for kind in KINDS])
    text = rng.choice(kind.texts)
    for _ in range(rng.choice([1, 1, 1, 2, 3, 6])):
        text = mutate(text, rng)
    data = text.encode("utf-8", "surrogatepass")
    if rng.random() < 0.1:
        spoilt = bytearray(data or b"x")
        spoilt[rng.randrange(len(spoilt))] = rng.randrange(256)
        data = bytes(spoilt)
    return data, kind


def read(data: bytes, kind: Kind, folder: Path) -> None:
    (folder / kind.file).write_bytes(data)
    kind.read(folder / kind.file)


class TooSlow(Exception):
    """An input was not read in time."""


@contextmanager
def limited() -> Iterator[None]:
    def stop(number: int, frame: FrameType | None) -> None:
        raise TooSlow

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, 4 * SLOWEST_S)  # of a machine that does other things too
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def examine(chunk: int) -> tuple[float, str, list[str]]:
    """Slowest input of a chunk with its time, and what went wrong."""
    rng = random.Random(f"inputs {chunk}")
    slowest: tuple[float, str] = (0.0, "")
    wrong: list[str] = []
    with TemporaryDirectory() as folder:
        read(DRIVES[0].encode(), KINDS[3], Path(folder))  # compiled before it is timed
        for number in range(COUNT // CHUNKS):
            data, kind = mutated(rng)
            shown = f"{kind.file}: {data[:3000]!r}"
            begin = time.process_time()
            try:
                with limited():
                    read(data, kind, Path(folder))
            except Exception as error:
                if not is_ours(error) or any(ord(char) < 32 and char not in "\n\t" for char in str(error)):
                    wrong.append(f"{number} of chunk {chunk}: {error!r} from {shown}")
            slowest = max(slowest, (time.process_time() - begin, shown))
    return *slowest, wrong


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no alarm clock here")
def test_damaged_inputs_are_read_or_refused_in_words() -> None:
    with ProcessPoolExecutor(2, multiprocessing.get_context("fork")) as pool:
        found = list(pool.map(examine, range(CHUNKS)))
    wrong = [line for each in found for line in each[2]]
    assert not wrong, "\n".join(wrong[:10])
    assert max(found)[0] < SLOWEST_S, max(found)[1]


def test_a_handful_of_damaged_inputs(tmp_path: Path) -> None:
    rng = random.Random("a handful")
    refused = 0
    for _ in range(60):
        data, kind = mutated(rng)
        try:
            read(data, kind, tmp_path)
        except Exception as error:
            assert is_ours(error), (kind.file, data, error)
            refused += 1
    assert refused > 20
