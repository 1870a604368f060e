"""Speed of families, compared with building their icons one by one, and of reading and laying out text.

Run with `pytest -m benchmark tests/benchmarks/test_family_speed.py -s`.
"""

import time

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from tests.benchmarks.peers import best_of
from thermicon.icons import Icon, back, hold, parse, ramp

pytestmark = pytest.mark.benchmark
FAMILY = (
    "cue 1\nicon ramp(amount in 0.1..10 step 0.1 °C, rate in 0.1..10 step 0.1 °C/s, pause in 1..10 step 1 s)\n"
    '  means "{amount} at {rate}"\n{ change by amount at rate; hold for pause; return at rate }'
)


def one_by_one(count: int) -> list[Icon]:
    """The first members of the family, each built and checked by itself."""
    made = []
    for n in range(count):
        amount, rate, pause = (n // 1_000 + 1) / 10, (n // 10 % 100 + 1) / 10, n % 10 + 1
        made.append(Icon(f"ramp-{n}", (ramp(by=amount, at=rate), hold(pause), back(at=rate))))
    return made


def test_members_are_checked_no_slower_than_one_by_one(benchmark: BenchmarkFixture) -> None:
    icons = benchmark.pedantic(lambda: parse(FAMILY), rounds=1)
    assert len(icons) == 100_000
    alone = best_of(lambda: one_by_one(5_000)) * 20
    took = benchmark.stats["min"]
    print(f"\n100,000 members checked and counted in {took:.1f} s; one by one {alone:.1f} s, {alone / took:.1f} times")
    assert took < alone


def test_a_check_follows_every_member_once(benchmark: BenchmarkFixture) -> None:
    """What is said of all members comes from the same pass as their errors: 2 s of processor time for 50,601."""
    text = (
        "cue 1\nicon dip(size in 0.1..10.1 step 0.1 °C, time in 0.1..50.1 step 0.1 s)\n"
        "{ cool by size at 3 K/s; hold for time; return at 2 K/s; total at most 100 s }"
    )

    def check() -> float:
        start = time.process_time()
        icons = parse(text)
        summary = icons.summary(32.0)
        assert (len(icons), summary.shortest_s) == (50_601, pytest.approx(0.1 + 0.1 / 3 + 0.1 / 2))
        return time.process_time() - start

    took = benchmark.pedantic(check, rounds=1)
    print(f"\n50,601 members checked and summarised in {took:.1f} s of processor time")
    assert took < 4.0
