"""Speed of whole commands, and of many cues streamed through one rig.

Run with `pytest -n 0 -m benchmark tests/benchmarks/test_command_speed.py -s` on a quiet machine. Elapsed time is what a
user waits for; processor time says how much of it other programs took.
"""

import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.benchmark
THERMICON = [sys.executable, "-m", "thermicon.notebooks.cli.main"]
VALIDATED_WITHIN_S = 180.0
STREAM = """
import itertools, resource, sys, time
from thermicon.circuit import Rig, simulate_many
from thermicon.icons import parse
count = int(sys.argv[1])
def icons():
    cues = ((k, 1 + k % 50 / 10, 1 + k // 50 % 20 / 10) for k in range(count))
    while part := list(itertools.islice(cues, 500)):
        text = "cue 1\\nset s { control display }\\n" + "".join(
            f"icon c{k} {{ cool by {size:.1f} °C at {rate:.1f} °C/s; hold for 1 s; return at 3 °C/s }}\\n"
            for k, size, rate in part)
        yield parse(text).icons
rig = Rig.load("thenar")
simulate_many(next(icons()), [rig], nominal=rig, end_s=10.0)
start, coldest, done = time.perf_counter(), 99.0, 0
for part in icons():
    batch = simulate_many(part, [rig], nominal=rig, end_s=10.0)
    coldest, done = min(coldest, float(batch.cold_C.min())), done + len(part)
print(done, coldest, time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6)
"""


def ten_seconds(folder: Path, icons: int = 64) -> Path:
    """A file with so many icons of 10 s that the thenar rig reaches: ramps of other sizes and rates, once or twice."""
    lines = ["cue 1", "set ten { site thenar; control display; baseline 32 °C }"]
    for k in range(icons):
        size, rate, rounds = (1.0, 2.0, 3.0, 4.0)[k // 2 % 4], (1.5, 2.0, 2.5, 3.0)[k // 8 % 4], 1 + k // 32
        hold = 10.0 / rounds - size / rate - size / 2.0
        body = (
            f"{('cool', 'warm')[k % 2]} by {size} °C at {rate} °C/s; hold for {max(hold, 0.2):.4f} s; return at 2 °C/s"
        )
        lines.append(f"icon i{k} {{ repeat {rounds} {{ {body} }} }}" if rounds > 1 else f"icon i{k} {{ {body} }}")
    file = folder / "ten.cue"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def took(*words: str | Path) -> tuple[float, str]:
    """Run a command of thermicon; its elapsed time, and that in words with processor time and the most memory."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([*THERMICON, *map(str, words)], check=True, capture_output=True)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return wall, f"{wall:.1f} s elapsed, {cpu:.1f} s of processor time, at most {after.ru_maxrss / 1024:.0f} MB"


@pytest.mark.parametrize("what", ["python", "check"])
def test_check_answers_at_once(benchmark: Any, what: str) -> None:
    command = [*THERMICON, "check", "six-icons"] if what == "check" else [sys.executable, "-c", "pass"]
    assert benchmark(subprocess.run, command, check=True, capture_output=True).returncode == 0


def test_the_commands_that_are_asked_for_most(tmp_path: Path) -> None:
    file = ten_seconds(tmp_path)
    took("rank", "six-icons", "--people", "2")
    print(f"\nsix icons, 200 people: {took('rank', 'six-icons')[1]}")
    print(f"best 6 of 64 by the worst pair, 200 people: {took('improve', file, '--choose', '6')[1]}")
    print(f"64 icons, 1,000 people: {took('rank', file, '--people', '1000')[1]}")
    validated_s, said = took("validate")
    print(f"validate: {said}")
    assert validated_s < VALIDATED_WITHIN_S


@pytest.mark.parametrize("count", [1_000, 10_000, 100_000])
def test_memory_does_not_grow_with_the_number_of_cues(count: int) -> None:
    run = subprocess.run([sys.executable, "-c", STREAM, str(count)], capture_output=True, text=True, check=True)
    done, coldest, seconds, gigabytes = run.stdout.split()
    print(f"\n{done} cues of 10 s: {float(seconds) / count * 1e3:.3f} ms each, at most {float(gigabytes):.2f} GB")
    assert int(done) == count
    assert 20 < float(coldest) < 32
    assert float(gigabytes) < 2
