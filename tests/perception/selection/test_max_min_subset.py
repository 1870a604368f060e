import math
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp

from thermicon.perception.selection.max_min_subset import (
    LIMIT_REACHED,
    Limits,
    UndecidedError,
    max_min_subset,
    nearest_pair,
)

Array = NDArray[np.float64]
MOST_STEPS = "thermicon.perception.selection.max_min_subset.MOST_STEPS"


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
    assert found.proven


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


@pytest.mark.parametrize("seed", range(4))
def test_the_integer_program_agrees_with_the_exhaustive_search(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    d = points(seed, 12, 3)
    limits = Limits(np.random.default_rng(seed).random((1, 12)), (2.0,))
    searched = max_min_subset(d, 4, (seed,), limits)
    monkeypatch.setattr(MOST_STEPS, 0)
    program = max_min_subset(d, 4, (seed,), limits)
    assert searched is not None
    assert program is not None
    assert (program.chosen, program.value, program.proven) == (searched.chosen, searched.value, searched.proven)


def test_distances_without_geometry_are_decided_without_a_program(monkeypatch: pytest.MonkeyPatch) -> None:
    # Programs for 64 such icons take about a second each.
    d = np.triu(np.random.default_rng(0).lognormal(size=(64, 64)), 1)
    monkeypatch.setattr("scipy.optimize.milp", undecided)
    found = max_min_subset(d + d.T, 6)
    assert found is not None
    assert found.proven


def undecided(*_: object, **__: object) -> SimpleNamespace:
    return SimpleNamespace(x=None, status=LIMIT_REACHED)


def test_a_program_that_reaches_its_limit_leaves_a_bound_above(monkeypatch: pytest.MonkeyPatch) -> None:
    d = points(5, 30, 3)
    proven = max_min_subset(d, 6)
    monkeypatch.setattr(MOST_STEPS, 0)
    monkeypatch.setattr("scipy.optimize.milp", undecided)
    limited = max_min_subset(d, 6)
    assert proven is not None
    assert limited is not None
    assert not limited.proven
    assert limited.value <= proven.value <= limited.bound


def test_an_undecided_program_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    # No four of 0 and 0.3 add up to between 1.0 and 1.05.
    costs = np.array([0.0, 0.3, 0.0, 0.3, 0.3, 0.0, 0.3, 0.0])
    limits = Limits(np.stack([costs, -costs]), (1.05, -1.0))
    assert max_min_subset(points(1, 8), 4, (), limits) is None
    monkeypatch.setattr(MOST_STEPS, 0)
    monkeypatch.setattr("scipy.optimize.milp", undecided)
    with pytest.raises(UndecidedError):
        max_min_subset(points(1, 8), 4, (), limits)


@pytest.mark.parametrize(("count", "must"), [(1, ()), (4, ()), (2, (0, 1, 2))])
def test_what_cannot_be_chosen(count: int, must: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"cannot be chosen|must be among"):
        max_min_subset(points(0, 3), count, must)
