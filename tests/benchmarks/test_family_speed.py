"""Speed of families beside icons built one by one, and of reading and laying out text."""

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
