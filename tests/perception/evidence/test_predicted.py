"""Observers that the evidence leaves possible, and which predictions no choice of them can mend together."""

import math

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer
from thermicon.perception.evidence.predicted import (
    Answers,
    Asked,
    correlation,
    plausible_observers,
    predict,
    trade_offs,
)
from thermicon.perception.experiments.on_bench import forced_choice
from thermicon.perception.observer.channels import VARIABLES, Variable
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.sensation.bench import Bench


@pytest.mark.parametrize("variable", VARIABLES)
def test_draws_are_those_of_the_posterior_and_fill_it(variable: Variable) -> None:
    drawn = plausible_observers(16, variable=variable)
    assert {o.variable for o in drawn} == {variable}
    known = PosteriorDraws.load(variable=variable).values("noise correlation time")
    noise = np.array([o.noise_correlation_s for o in drawn])
    assert set(noise.tolist()) <= set(known.tolist())
    assert 3 <= (noise < np.median(known)).sum() <= 13
    assert len({o.memory.timing for o in drawn}) == 16


def test_every_draw_keeps_the_thresholds_near_the_shipped_ones() -> None:
    bench = Bench(Rig.load("thenar"))
    shipped = forced_choice(Observer.load(), bench, "cold")
    found = [forced_choice(person, bench, "cold") for person in plausible_observers(8)]
    assert 0.35 * shipped < min(found) < max(found) < 2.5 * shipped


def test_the_seed_decides() -> None:
    assert plausible_observers(4, seed=1) == plausible_observers(4, seed=1)
    assert plausible_observers(4, seed=1) != plausible_observers(4, seed=2)
    with pytest.raises(ValueError, match=r"at least two observers are needed to show an interval, not 1"):
        plausible_observers(1)


def test_what_is_not_felt_is_none() -> None:
    found = predict("x", [Asked("y", "cold", "K", "z", lambda _: float(np.inf))], "temperature", draws=2)
    assert (found[0].value, found[0].low, found[0].high) == (None, None, None)
    assert repr(found[0]).startswith("Predicted(x, y, cold: nothing felt from temperature")


UP = tuple(float(k) for k in range(20))
DOWN = UP[::-1]


def answers(label: str, each: tuple[float, ...], below: float, away: int) -> Answers:
    return Answers(label, each, tuple(value < below for value in each), away)


@pytest.mark.parametrize(
    ("first", "second", "against", "rarer", "both_miss", "both_hold"),
    [
        (answers("a", UP, 10, 1), answers("b", DOWN, 10, 1), True, True, True, 0.0),
        (answers("a", UP, 10, 1), answers("b", UP, 5, 1), False, False, True, 0.25),
        (answers("a", UP, 10, 0), answers("b", UP, 5, 1), None, False, False, 0.25),
        # By chance none holds in C(18, 2) of C(20, 2) cases.
        (answers("a", UP, 2, 1), answers("b", DOWN, 2, 1), True, False, True, 0.0),
        (answers("a", UP, 8, 1), answers("b", DOWN, 8, 1), True, False, True, 0.0),
        (answers("a", UP, 9, 1), answers("b", DOWN, 9, 1), True, True, True, 0.0),
    ],
)
def test_two_rows_are_mended_together_or_against_each_other(
    first: Answers, second: Answers, against: bool | None, rarer: bool, both_miss: bool, both_hold: float
) -> None:
    (found,) = trade_offs([first, second])
    shares = found.share_first_holds, found.share_second_holds
    assert shares == (np.mean(first.holds), np.mean(second.holds))
    assert found.share_both_by_chance == pytest.approx(shares[0] * shares[1])
    assert found.share_both_hold == both_hold
    assert (found.against, found.rarer_than_chance, found.both_miss) == (against, rarer, both_miss)
    assert abs(found.correlation or 0.0) == 1.0


def test_ranks_share_ties_and_few_draws_tell_nothing() -> None:
    assert correlation((1.0, 1.0, 2.0), (3.0, 3.0, math.inf)) == 1.0
    assert correlation((1.0, 1.0), (1.0, 2.0)) is None
    assert correlation((1.0, 2.0, 3.0, 4.0), (1.0, 3.0, 2.0, 4.0)) == pytest.approx(0.8)
    assert trade_offs([answers("a", UP[:7], 3, 1), answers("b", UP[:7], 3, 1)]) == ()
    for correlated, against in ((0.48, None), (0.52, False)):
        # Two numbers in exchange for each other leave the rest in order.
        swapped = min(
            (tuple(UP[:k]) + tuple(DOWN[: 20 - k]) for k in range(20)),
            key=lambda each: abs((correlation(UP, each) or 0.0) - correlated),
        )
        found = trade_offs([answers("a", UP, 3, 1), answers("b", swapped, 3, 1)])[0]
        assert abs((found.correlation or 0.0) - correlated) < 0.2
        assert (found.against is None) == (abs(found.correlation or 0.0) < 0.5) == (against is None)
