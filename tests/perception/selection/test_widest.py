import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp

from thermicon.perception.selection.widest import Limits, OutOfBudget, widest, worst

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
    found = widest(d, count, must)
    assert found is not None
    allowed = [c for c in combinations(range(n), count) if set(must) <= set(c)]
    assert found.chosen == max(allowed, key=lambda c: spread(d, c))
    assert found.value == found.bound == worst(d, found.chosen)
    assert found.proven


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), n=st.integers(3, 8), share=st.floats(0.3, 1.2), data=st.data())
def test_limits_are_kept_and_ties_do_no_harm(seed: int, n: int, share: float, data: st.DataObject) -> None:
    d, count = np.round(points(seed, n)), data.draw(st.integers(2, n))
    costs = np.random.default_rng(seed + 1).random((2, n)) - 0.2
    limits = Limits(costs, tuple(float(share * row.mean() * count) for row in costs))
    allowed = [c for c in combinations(range(n), count) if limits.kept(c)]
    found = widest(d, count, (), limits)
    if not allowed:
        assert found is None
        return
    assert found is not None
    assert found.chosen in allowed
    assert found.value == max(worst(d, c) for c in allowed)


def test_an_integer_program_finds_the_same_value() -> None:
    # An independent proof: of every pair nearer than t at most one; the largest t with six of them.
    d = points(3, 30, 3)
    found = widest(d, 6)
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


def test_without_nodes_the_bound_is_honest() -> None:
    d = points(5, 60, 6)
    sure, rash = widest(d, 12), widest(d, 12, most_nodes=3)
    assert sure is not None
    assert rash is not None
    assert not rash.proven
    assert rash.value <= sure.value <= rash.bound
    assert widest(d, 12, most_nodes=3) == rash


def test_an_open_question_is_said_to_be_open() -> None:
    # No four of 0 and 0.3 add up to between 1.0 and 1.05, which neither limit alone can tell.
    costs = np.array([0.0, 0.3, 0.0, 0.3, 0.3, 0.0, 0.3, 0.0])
    limits = Limits(np.stack([costs, -costs]), (1.05, -1.0))
    assert widest(points(1, 8), 4, (), limits) is None
    with pytest.raises(OutOfBudget):
        widest(points(1, 8), 4, (), limits, most_nodes=1)


@pytest.mark.parametrize(("count", "must"), [(1, ()), (4, ()), (2, (0, 1, 2))])
def test_what_cannot_be_chosen(count: int, must: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"cannot be chosen|must be among"):
        widest(points(0, 3), count, must)
