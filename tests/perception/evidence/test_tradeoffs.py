import math

import pytest

from thermicon.perception.evidence.tradeoffs import Answers, chance_of_as_few, correlation, trade_offs

UP = tuple(float(k) for k in range(20))
DOWN = UP[::-1]


def answers(label: str, each: tuple[float, ...], below: float, away: int) -> Answers:
    return Answers(label, each, tuple(value < below for value in each), away)


def test_two_that_both_must_fall_and_move_apart_are_against_each_other_and_rarely_hold_together() -> None:
    (found,) = trade_offs([answers("a", UP, 10, 1), answers("b", DOWN, 10, 1)])
    assert (found.correlation, found.first_holds, found.second_holds, found.both_hold) == (-1.0, 0.5, 0.5, 0.0)
    assert (found.against, found.rarer, found.both_miss) == (True, True, True)
    assert found.by_chance == 0.25


def test_two_that_move_together_are_mended_together() -> None:
    (found,) = trade_offs([answers("a", UP, 10, 1), answers("b", UP, 5, 1)])
    assert (found.against, found.rarer, found.both_hold) == (False, False, 0.25)


def test_what_holds_already_is_not_mended() -> None:
    (found,) = trade_offs([answers("a", UP, 10, 0), answers("b", UP, 5, 1)])
    assert (found.against, found.both_miss) == (None, False)


def test_rarely_both_is_no_exclusion_where_chance_gives_as_few() -> None:
    (found,) = trade_offs([answers("a", UP, 2, 1), answers("b", DOWN, 2, 1)])
    assert found.both_hold == 0.0
    assert not found.rarer
    assert chance_of_as_few(20, 2, 2, 0) == pytest.approx(math.comb(18, 2) / math.comb(20, 2))


def test_few_draws_tell_nothing() -> None:
    assert trade_offs([answers("a", UP[:7], 3, 1), answers("b", UP[:7], 3, 1)]) == ()


def test_ranks_share_ties_and_what_is_not_felt_comes_last() -> None:
    assert correlation((1.0, 1.0, 2.0), (3.0, 3.0, math.inf)) == 1.0
    assert correlation((1.0, 1.0), (1.0, 2.0)) is None
