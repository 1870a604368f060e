"""Subsets of icons: the best by the nearest pair or by identification."""

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp

from thermicon.perception.identification.confusion import confuse
from thermicon.perception.identification.measures import information_bits, proportion_correct
from thermicon.perception.selection import max_min_subset as max_min
from thermicon.perception.selection.max_min_subset import Totals, max_min_subset, nearest_pair
from thermicon.perception.selection.request import Objective, UndecidedError
from thermicon.perception.selection.subset_identification import SubsetIdentification, ceiling, pick, replaced, right

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
    limits = Totals(costs, tuple(float(share * row.mean() * count) for row in costs))
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
    tight = Totals(costs[None], (float(np.sort(costs)[:5].sum()),))
    found = max_min_subset(points(2, 60), 5, (), tight)
    assert found is not None and found.chosen == tuple(sorted(np.argsort(costs)[:5].tolist()))
    assert tight.kept(found.chosen) and not Totals(costs[None], (tight.most[0] - 1e-6,)).kept(found.chosen)
    # No four of 0 and 0.3 add up to between 1.0 and 1.05.
    few = np.array([0.0, 0.3, 0.0, 0.3, 0.3, 0.0, 0.3, 0.0])
    limits = Totals(np.stack([few, -few]), (1.05, -1.0))
    assert max_min_subset(points(1, 8), 4, (), limits) is None
    monkeypatch.setattr(max_min, "MOST_STEPS", 0)
    with pytest.raises(UndecidedError, match="it could not be decided whether any choice keeps the totals: relax one"):
        max_min_subset(points(1, 8), 4, (), limits)


OBJECTIVES: tuple[Objective, ...] = ("felt-and-named", "named", "bits", "bits-per-s")


def pool(seed: int, n: int, people: int = 3, size: float = 1.5) -> SubsetIdentification:
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(n, 2)) * size
    d = np.linalg.norm(x[:, None] - x[None], axis=-1)
    each = d[None] * rng.uniform(0.7, 1.3, size=(people, 1, 1))
    durations_s, reports = rng.uniform(2.0, 8.0, size=n), rng.uniform(0.3, 1.0, size=(people, n))
    return SubsetIdentification.of(each, np.full(people, 0.03), reports, durations_s, seed)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize(("n", "count", "must"), [(6, 2, ()), (7, 3, (4,)), (6, 6, ()), (7, 4, (2, 6))])
def test_enumeration_is_brute_force(objective: Objective, n: int, count: int, must: tuple[int, ...]) -> None:
    held = pool(n, n)
    found = held.enumerated(count, objective, must, Totals.none(n))
    assert found is not None
    allowed = [c for c in combinations(range(n), count) if set(must) <= set(c)]
    scores = [held.score(c, objective) for c in allowed]
    assert found.chosen == allowed[int(np.argmax(scores))]
    assert found.value == found.bound == max(scores)
    assert found.seen == len(allowed)


@pytest.mark.parametrize("place", range(3))
def test_what_is_named_right_is_the_same_with_and_without_the_errors(place: int) -> None:
    held = pool(3, 9)
    half = held.half.copy()
    half[:, 0, 4] = half[:, 4, 0] = 0.0  # equally near, where the icon itself is named
    of, trial = (half, held.push, held.lapse), (np.array([1, 4, 6]), place, np.array([0, 2, 3, 5, 7, 8]))
    assert np.array_equal(right(*of, np.ones((3, 9)), *trial), replaced(*of, *trial)[0])


def test_an_icon_that_is_hardly_felt_is_never_chosen_by_what_is_felt_and_named() -> None:
    """Though nobody would confuse it with any other."""
    held = pool(5, 7, size=3.0)
    far = held.half.copy()
    far[:, 3], far[:, :, 3] = 1e3, 1e3
    far[:, 3, 3] = 0.0
    reports = np.ones((3, 7))
    reports[:, 3] = 0.02
    faint = replace(held, half=far, reports=reports)
    found = {objective: faint.enumerated(3, objective, (), Totals.none(7)) for objective in ("named", "felt-and-named")}
    chosen = {objective: one.chosen for objective, one in found.items() if one is not None}
    assert 3 in chosen["named"] and 3 not in chosen["felt-and-named"]


def test_enumeration_keeps_limits() -> None:
    held = pool(2, 7)
    limits = Totals(held.durations_s[None], (float(np.sort(held.durations_s)[:4].sum()) - 1.0,))
    found = held.enumerated(3, "named", (), limits)
    allowed = [c for c in combinations(range(7), 3) if limits.kept(c)]
    assert found is not None
    assert 0 < found.seen == len(allowed) < math.comb(7, 3)
    assert found.value == found.bound == max(held.score(c, "named") for c in allowed)
    assert held.enumerated(3, "named", (), replace(limits, most=(1.0,))) is None


def test_a_score_is_what_the_confusions_of_the_set_give() -> None:
    # In two dimensions nothing is bent, so that the whole pool as a set is the matrix of `confuse`, but for noise.
    rng = np.random.default_rng(4)
    x = rng.normal(size=(5, 2)) * 2.0
    d = np.linalg.norm(x[:, None] - x[None], axis=-1)[None].repeat(24, axis=0)
    reports = rng.uniform(0.2, 1.0, size=(24, 5))
    held = SubsetIdentification.of(d, np.full(24, 0.02), reports, np.full(5, 4.0), 0)
    named = confuse(d, lapse=0.02).probability
    assert held.score(range(5), "named") == pytest.approx(float(proportion_correct(named).mean()), abs=0.01)
    alert = (reports * np.diagonal(named, axis1=1, axis2=2)).mean()  # of each person, before any mean
    assert held.score(range(5), "felt-and-named") == pytest.approx(float(alert), abs=0.01)
    assert held.score(range(5), "bits") == pytest.approx(float(information_bits(named).mean()), abs=0.06)
    assert held.score(range(5), "bits-per-s") == held.score(range(5), "bits") / 4.0


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_a_swap_scores_what_its_set_scores(objective: Objective) -> None:
    held = pool(7, 8, people=5)
    chosen = [5, 0, 3]
    allowed = np.ones((3, 8), dtype=bool)
    allowed[:, chosen], allowed[1, 7] = False, False
    found = held.swapped(chosen, objective, allowed)
    assert np.isneginf(found[~allowed]).all()
    for place, other in zip(*np.nonzero(allowed), strict=True):
        trial = [int(other) if k == place else icon for k, icon in enumerate(chosen)]
        assert found[place, other] == pytest.approx(held.score(trial, objective), rel=1e-12)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_no_choice_exceeds_the_ceiling_and_icons_far_apart_reach_it(objective: Objective) -> None:
    alike = replace(pool(1, 6, size=200.0), durations_s=np.full(6, 4.0))
    bound = ceiling(alike, 3, objective)
    reached = alike.score((0, 2, 4), objective)
    assert reached <= bound + 1e-12
    assert reached == pytest.approx(bound, rel=1e-12 if objective == "named" else 0.3)


@pytest.mark.parametrize(
    "objective", [pytest.param(each, marks=[pytest.mark.slow] * (each != "bits")) for each in OBJECTIVES]
)
def test_many_icons_are_climbed_to_under_a_bound(objective: Objective) -> None:
    held = pool(1, 40)
    middle = np.sqrt(2.0 * np.maximum(held.half, 0.0)).mean(axis=0)
    one, two = (pick(middle, held, 8, objective, (3,), None, seed=5) for _ in range(2))
    assert one == two
    assert one is not None
    assert not one.optimal
    assert 3 in one.chosen
    assert one.value <= one.bound
    # No single swap betters it.
    for place in range(8):
        for other in set(range(40)) - set(one.chosen):
            if one.chosen[place] != 3:
                trial = sorted({*one.chosen} - {one.chosen[place]} | {other})
                assert held.score(trial, objective) <= one.value + 1e-9
