"""Speed of a fit of three parameters to a log of 60 s: `pytest -n 0 -m benchmark tests/benchmarks -k fit`."""

from __future__ import annotations

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from thermicon.circuit import Rig, fit
from thermicon.circuit.fitting.laboratory import synthetic_log

TRUTH = {"contact.resistance_m2K_per_W": 7e-4, "module.seebeck_V_per_K": 0.0505, "module.resistance_ohm": 6.6}
MOST_S = 2.0


@pytest.mark.benchmark
def test_a_fit_of_three_parameters_takes_less_than_two_seconds(benchmark: BenchmarkFixture) -> None:
    log, rig = synthetic_log(Rig.load("thenar").with_(**TRUTH), seed=1), Rig.load("thenar")
    found = benchmark.pedantic(lambda: fit(log, rig, free=list(TRUTH)), rounds=3, warmup_rounds=1, iterations=1)
    assert all(abs(found[key].value / value - 1) < 0.02 for key, value in TRUTH.items())
    assert benchmark.stats.stats.min < MOST_S
