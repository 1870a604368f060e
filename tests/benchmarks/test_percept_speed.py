"""The speed of percepts.

Run with `pytest -m benchmark tests/benchmarks -s`. What is asked for is under 5 s on two cores.
"""

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture

from thermicon.perception import Observer
from thermicon.perception.sensation.percept import perceive_many

pytestmark = pytest.mark.benchmark
TRACES, ROWS, STEP_S = 10_000, 3001, 0.01
LIMIT_S = 5.0
Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def courses() -> tuple[Array, Array]:
    """Random walks of steps and ramps about 32 °C, cold and warm depth."""
    rng = np.random.default_rng(0)
    corners = 32.0 + np.cumsum(rng.normal(0.0, 1.0, (TRACES, 16)), axis=1)
    place = np.linspace(0.0, 15.0, ROWS)
    left = np.minimum(place.astype(int), 14)
    share = place - left
    cold = (1.0 - share) * corners[:, left] + share * corners[:, left + 1]
    return cold, 32.0 + 0.9 * (cold - 32.0)


@pytest.mark.parametrize("variable", ["temperature", "heat flow"])
def test_ten_thousand_percepts(benchmark: BenchmarkFixture, courses: tuple[Array, Array], variable: str) -> None:
    person = Observer.load(variable=variable)  # type: ignore[arg-type]
    perceive_many(courses[0][:4], courses[1][:4], STEP_S, person)
    cold, warm = benchmark.pedantic(
        perceive_many, args=(courses[0], courses[1], STEP_S, person), rounds=3, iterations=1
    )
    assert cold.shape == warm.shape == (TRACES, ROWS)
    assert np.isfinite(cold).all()
    least = benchmark.stats.stats.min
    print(f"\n{TRACES} percepts of 30 s from {variable}: {least:.2f} s, {least / TRACES * 1e6:.0f} µs each")
    assert least < LIMIT_S
