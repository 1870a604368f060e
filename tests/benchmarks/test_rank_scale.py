"""The growth of the cost of ranking with icons and people.

Run with `pytest -m benchmark tests/benchmarks/test_rank_scale.py -s`; processor time is compared with the line,
since other programs do not change it much.
"""

import resource
import time
from typing import Any

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from thermicon.circuit import Rig
from thermicon.icons import IconSet, load_library, parse
from thermicon.perception import rank

pytestmark = pytest.mark.benchmark
RIG = Rig.load("thenar")
PAIRS = (100, 1_000, 10_000, 100_000)


def pool(icons: int) -> IconSet:
    """So many different icons of at most 6 s, cooling and warming."""
    lines = ["cue 1", "set pool { control display; baseline 32 °C }"]
    for k in range(icons):
        verb, size, rate = ("cool", "warm")[k % 2], 1 + k // 2 % 8 * 0.5, 1 + k // 16 % 4
        lines.append(f"icon i{k} {{ {verb} by {size} °C at {rate} °C/s; hold for {1 + k // 64} s }}")
    return parse("\n".join(lines))


def cost_s(icons: IconSet, people: int) -> float:
    """Processor time of a ranking without what does not depend on the number of people."""
    start = time.process_time()
    rank(icons, RIG, people=people, parameters=0)
    return time.process_time() - start


def test_cost_is_linear_in_icons_times_people() -> None:
    ten = pool(10)
    rank(ten, RIG, people=2, parameters=0)
    costs = [cost_s(ten, pairs // 10) for pairs in PAIRS]
    slope = float(np.polyfit(np.log(PAIRS[1:]), np.log(costs[1:]), 1)[0])
    for pairs, cost in zip(PAIRS, costs, strict=True):
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"\n{pairs:7d} pairs: {cost:7.2f} s of processor time, {1e3 * cost / pairs:.3f} ms a pair", end="")
    print(f"\nexponent {slope:.2f}, at most {peak:.0f} MB")
    assert slope < 1.1


@pytest.mark.parametrize(
    "what",
    [{}, {"parameters": 0}],
    ids=["people and intervals", "people"],
)
def test_six_icons_and_two_hundred_people(benchmark: BenchmarkFixture, what: dict[str, Any]) -> None:
    benchmark.pedantic(rank, args=(load_library("six-icons"), RIG), kwargs=what, rounds=5, warmup_rounds=1)
