"""Tens of thousands of damaged input files or settings, each read or refused in words.

``pytest -m slow tests/notebooks/cli/test_fuzz_inputs.py`` examines 50,000 of them in some minutes on two cores;
THERMICON_FUZZ=2000 fewer. Mutations are seeded, so that a failure comes again.
"""

import multiprocessing
import os
import random
import re
import signal
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType

import pytest

from tests.notebooks.conftest import Cli
from tests.notebooks.readers import DRIVES, KINDS, Kind
from thermicon.notebooks.messages import is_ours

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


def mutated(rng: random.Random) -> tuple[bytes, Kind]:
    """A damaged input, and its kind."""
    (kind,) = rng.choices(list(KINDS.values()), [kind.weight for kind in KINDS.values()])
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
        read(DRIVES[0].encode(), KINDS["drive"], Path(folder))  # compiled before it is timed
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


def test_a_table_of_which_no_row_is_left_is_refused(tmp_path: Path) -> None:
    data = b"time_s,current_A\n0,0.1,\n,02\xef\xbb\xbf\ntime_s,current_A\n0,0.1,"
    for kind in (kind for kind in KINDS.values() if kind.file == "a.csv"):
        with pytest.raises(Exception, match=r"a\.csv") as refusal:
            read(data, kind, tmp_path)
        assert is_ours(refusal.value), (kind, refusal.value)


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.command])
def test_a_damaged_file_ends_its_command_with_one_message(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    kind = KINDS[name]
    monkeypatch.chdir(tmp_path)
    content = kind.texts[0].encode()
    Path(kind.file).write_bytes(content[: len(content) // 2] + b"\xff\0" + content[len(content) // 2 :])
    said = cli(*kind.command.split())
    assert (said.exit_code, said.stdout) == (1, ""), said
    assert kind.file in said.stderr and "Traceback" not in said.stderr
    assert [each.name for each in tmp_path.iterdir()] == [kind.file]
