import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp

from thermicon.perception.selection import max_min_subset as max_min
from thermicon.perception.selection.max_min_subset import Limits, max_min_subset, nearest_pair
from thermicon.perception.selection.request import UndecidedError

Array = NDArray[np.float64]


def points(seed: int, n: int, axes: int = 2) -> Array:
    x = np.random.default_rng(seed).normal(size=(n, axes))
    return np.asarray(np.linalg.norm(x[:, None] - x[None], axis=-1))


def spread(d: Array, chosen: tuple[int, ...]) -> tuple[float, ...]:
    return tuple(sorted(float(d[a, b]) for a, b in combinations(chosen, 2)))


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), n=st.integers(2, 9), data=st.data())
def test_every_choice_is_worse_or_equal(seed: int, n: int, data: st.DataObject) -> None:
    d, count = points(seed, n), data.draw(st.integers(2, n))
    must = tuple(data.draw(st.lists(st.integers(0, n - 1), max_size=count, unique=True)))
    found = max_min_subset(d, count, must)
    assert found is not None
    allowed = [c for c in combinations(range(n), count) if set(must) <= set(c)]
    assert found.chosen == max(allowed, key=lambda c: spread(d, c))
    assert found.value == found.bound == nearest_pair(d, found.chosen)
    assert found.optimal


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), n=st.integers(3, 8), share=st.floats(0.3, 1.2), data=st.data())
def test_limits_are_kept_and_ties_do_no_harm(seed: int, n: int, share: float, data: st.DataObject) -> None:
    d, count = np.round(points(seed, n)), data.draw(st.integers(2, n))
    costs = np.random.default_rng(seed + 1).random((2, n)) - 0.2
    limits = Limits(costs, tuple(float(share * row.mean() * count) for row in costs))
    allowed = [c for c in combinations(range(n), count) if limits.kept(c)]
    found = max_min_subset(d, count, (), limits)
    if not allowed:
        assert found is None
        return
    assert found is not None
    assert found.chosen in allowed
    assert found.value == max(nearest_pair(d, c) for c in allowed)


def test_an_integer_program_finds_the_same_value() -> None:
    # An independent proof: of every pair nearer than t at most one; the largest t with six of them.
    d = points(3, 30, 3)
    found = max_min_subset(d, 6)
    assert found is not None

    def six(threshold: float) -> bool:
        rows = [(a, b) for a, b in combinations(range(30), 2) if d[a, b] < threshold]
        matrix = np.zeros((len(rows) + 1, 30))
        for k, (a, b) in enumerate(rows):
            matrix[k, [a, b]] = 1.0
        matrix[-1] = 1.0
        high = np.array([1.0] * len(rows) + [6.0])
        low = np.array([-np.inf] * len(rows) + [6.0])
        asked = LinearConstraint(matrix, low, high)
        return bool(milp(np.zeros(30), integrality=np.ones(30), bounds=Bounds(0, 1), constraints=asked).success)

    assert six(found.value)
    assert not six(math.nextafter(found.value, math.inf))


def test_a_search_that_stops_early_leaves_a_bound_above(monkeypatch: pytest.MonkeyPatch) -> None:
    d = points(5, 30, 3)
    proven = max_min_subset(d, 6)
    monkeypatch.setattr(max_min, "MOST_STEPS", 3)
    limited = max_min_subset(d, 6)
    assert proven is not None
    assert limited is not None
    assert proven.optimal and not limited.optimal
    assert limited.value <= proven.value <= limited.bound


def test_totals_are_decided_or_said_to_be_open(monkeypatch: pytest.MonkeyPatch) -> None:
    costs = np.random.default_rng(2).random(60)
    tight = Limits(costs[None], (float(np.sort(costs)[:5].sum()),))
    found = max_min_subset(points(2, 60), 5, (), tight)
    assert found is not None and found.chosen == tuple(sorted(np.argsort(costs)[:5].tolist()))
    assert tight.kept(found.chosen) and not Limits(costs[None], (tight.most[0] - 1e-6,)).kept(found.chosen)
    # No four of 0 and 0.3 add up to between 1.0 and 1.05.
    few = np.array([0.0, 0.3, 0.0, 0.3, 0.3, 0.0, 0.3, 0.0])
    limits = Limits(np.stack([few, -few]), (1.05, -1.0))
    assert max_min_subset(points(1, 8), 4, (), limits) is None
    monkeypatch.setattr(max_min, "MOST_STEPS", 0)
    with pytest.raises(UndecidedError, match="it could not be decided whether any choice keeps the totals: relax one"):
        max_min_subset(points(1, 8), 4, (), limits)
