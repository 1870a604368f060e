"""Ranking as it is typed, start of the command included: icons of 10 s, each followed for 10 s more.

Run with `pytest -m benchmark tests/benchmarks/test_rank_commands.py -s` on a quiet machine. Elapsed time is what a user
waits for; processor time says how much of it other programs took.
"""

import resource
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.benchmark
HEAD = "cue 1\nset ten { site thenar; control display; baseline 32 °C }\n"


def ten_seconds(folder: Path, icons: int = 64) -> Path:
    """A file with so many icons of 10 s that the thenar rig reaches: ramps of other sizes and rates, once or twice."""
    lines = []
    for k in range(icons):
        size, rate, rounds = (1.0, 2.0, 3.0, 4.0)[k // 2 % 4], (1.5, 2.0, 2.5, 3.0)[k // 8 % 4], 1 + k // 32
        verb, whole = ("cool", "warm")[k % 2], 10.0 / rounds
        hold = whole - size / rate - size / 2.0
        body = f"{verb} by {size} °C at {rate} °C/s; hold for {max(hold, 0.2):.4f} s; return at 2 °C/s"
        lines.append(f"icon i{k} {{ repeat {rounds} {{ {body} }} }}" if rounds > 1 else f"icon i{k} {{ {body} }}")
    file = folder / "ten.cue"
    file.write_text(HEAD + "\n".join(lines) + "\n", encoding="utf-8")
    return file


def took(*words: str | Path) -> str:
    """Run a command of thermicon; its elapsed and processor time, and the most memory that any has had."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-c", "from thermicon.notebooks.cli.main import main; main()", *map(str, words)]
    subprocess.run(command, check=True, capture_output=True)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return f"{wall:.1f} s elapsed, {cpu:.1f} s of processor time, at most {after.ru_maxrss / 1024:.0f} MB"


def test_the_commands_that_are_asked_for_most(tmp_path: Path) -> None:
    file = ten_seconds(tmp_path)
    took("rank", "six-icons", "--people", "2")
    print(f"\nsix icons, 200 people: {took('rank', 'six-icons')}")
    print(f"best 6 of 64 by the worst pair, 200 people: {took('rank', file, '--choose', '6')}")
    print(f"64 icons, 1,000 people: {took('rank', file, '--people', '1000')}")
