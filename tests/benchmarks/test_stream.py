"""Many cues streamed through one rig: time for each, and memory that does not grow."""

import resource
import subprocess
import sys

import pytest

pytestmark = pytest.mark.benchmark

PROGRAM = """
import itertools, resource, sys, time
from thermicon.circuit import Rig
from thermicon.circuit.solver.batch import simulate_stream
from thermicon.icons import parse
count = int(sys.argv[1])
def cues():
    for k in range(count):
        size, rate = 1 + k % 50 / 10, 1 + k // 50 % 20 / 10
        yield k, size, rate
def icons():
    many = cues()
    while part := list(itertools.islice(many, 500)):
        text = "cue 1\\nset s { control display }\\n" + "".join(
            f"icon c{k} {{ cool by {size:.1f} °C at {rate:.1f} °C/s; hold for 1 s; return at 3 °C/s }}\\n"
            for k, size, rate in part)
        yield from parse(text)
rig = Rig.load("thenar")
next(simulate_stream(icons(), rig, end_s=10.0))
start, coldest, done = time.perf_counter(), 99.0, 0
for part, batch in simulate_stream(icons(), rig, end_s=10.0):
    coldest, done = min(coldest, float(batch.cold_C.min())), done + len(part)
print(done, coldest, time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6)
"""


@pytest.mark.parametrize("count", [1_000, 10_000, 100_000])
def test_streaming(count: int) -> None:
    if count == 100_000 and resource.getrlimit(resource.RLIMIT_CPU)[0] not in (-1, resource.RLIM_INFINITY):
        pytest.fail("this measurement needs some minutes of processor time")
    run = subprocess.run([sys.executable, "-c", PROGRAM, str(count)], capture_output=True, text=True, check=True)
    done, coldest, seconds, gigabytes = run.stdout.split()
    print(f"\n{done} cues of 10 s: {float(seconds) / count * 1e3:.3f} ms each, at most {float(gigabytes):.2f} GB")
    assert int(done) == count
    assert 20 < float(coldest) < 32
    assert float(gigabytes) < 2
