import dataclasses

import numpy as np
import pytest

from tests.builders import messages
from thermicon.circuit import Rig
from thermicon.icons import IconSet
from thermicon.perception import Goal, choose, rank
from thermicon.perception.selection.goal import QUANTITIES, GoalError, other_word
from thermicon.perception.selection.goal_result import SetOutcome, judge_goal
from thermicon.perception.selection.request import Selection


def test_a_goal_is_read_and_written_in_one_form() -> None:
    goal = Goal.parse("correct>=90% for 95 % of people,detected ≥ 0.95, safety green, time <= 0.5 min, onset < 800 ms")
    assert goal.text == (
        "named >= 90 % for 95 % of people, detected >= 95 %, safety green, time <= 30 s, onset <= 0.8 s"
    )
    assert Goal.parse(goal.text) == goal
    assert [part.quantity for part in goal.parts] == ["named", "detected", "safety", "time", "onset"]
    assert goal.of("time") == 30.0
    assert goal.of("energy") is None
    assert repr(Goal.parse("count 6")) == "Goal(count >= 6)"


def test_the_strictest_of_several_counts() -> None:
    goal = Goal.parse("named >= 80 % for 95 % of people, named >= 90 %")
    assert goal.of("named") == 0.9


MESSAGES = messages(__file__)


@pytest.mark.parametrize("text", MESSAGES["goal"])
def test_what_cannot_be_read_is_said_with_its_place_and_cure(text: str) -> None:
    with pytest.raises(GoalError) as raised:
        Goal.parse(text)
    assert MESSAGES["goal"][text] in str(raised.value)


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("90 % named for 95 % of people", "named >= 90 % for 95 % of people"),
        ("95 % detected, 10 s time, safety green", "detected >= 95 %, time <= 10 s, safety green"),
        ("energy <= 0.005 kJ", "energy <= 5 J"),
        ("energy <= 5000 mJ", "energy <= 5 J"),
        ("time <= 0.5 min", "time <= 30 s"),
        ("onset <= 1500 ms", "onset <= 1.5 s"),
        ("named >= 0.9", "named >= 90 %"),
        ("bits >= 2 bit", "bits >= 2"),
        ("90 % felt and named for 95 % of people", "felt-and-named >= 90 % for 95 % of people"),
        ("felt and named >= 0.9", "felt_and_named >= 90 %"),
        ("correct >= 90 %", "named >= 90 %"),
    ],
)
def test_a_goal_can_be_said_as_people_say_it(said: str, meant: str) -> None:
    assert Goal.parse(said) == Goal.parse(meant)


def test_correct_is_read_as_named_and_the_other_word_is_offered() -> None:
    assert other_word("95 % detected, correct >= 90 %") == (
        "correct is read as named, for which a play that is not felt is no miss; for that write felt-and-named"
    )
    assert other_word("90 % felt and named, named >= 95 %") is None


def test_a_set_with_a_silent_icon_misses_and_the_reason_is_that_icon() -> None:
    faint = dataclasses.replace(
        OUTCOME, each_felt_and_named=np.array([0.95, 0.0099, 0.9]), detected=np.array([0.99, 0.01, 1.0])
    )
    result = judge_goal(Goal.parse("felt-and-named >= 90 %"), faint)
    assert (result.met, result.binding) == (False, ("glow is felt in 1 % of plays",))
    confused = dataclasses.replace(
        faint, each_felt_and_named=np.array([0.95, 0.9, 0.5]), detected=np.array([0.99, 0.99, 0.99])
    )
    assert judge_goal(Goal.parse("felt-and-named >= 90 %"), confused).binding == ("glow and wave are confused most",)


def test_every_quantity_can_be_asked_for() -> None:
    for name, known in QUANTITIES.items():
        unit = next(iter(known.units))
        goal = Goal.parse(f"{name} {known.comparison} 5 {unit}".rstrip())
        assert goal.parts[0].limit == pytest.approx(5 * known.units[unit])


OUTCOME = SetOutcome(
    names=("dip", "glow", "wave"),
    felt_and_named=0.87,
    named=0.9,
    bits=1.4,
    d_prime=2.4,
    each_felt_and_named=np.array([0.95, 0.9, 0.76]),
    detected=np.array([0.99, 0.93, 1.0]),
    onset_s=np.array([0.9, 1.6, 1.1]),
    durations_s=np.array([3.0, 4.0, 5.0]),
    energies_J=np.array([2.0, 1.0, 4.0]),
    worst_pair=("glow", "wave"),
    nearest_pair=("dip", "wave"),
    amber=(),
    red=(),
    persons={
        "felt_and_named": np.linspace(0.4, 0.9, 101),
        "named": np.linspace(0.5, 1.0, 101),
        "bits": np.full(10, 1.2),
        "detected": np.full(10, 0.9),
    },
)


@pytest.mark.parametrize("text", MESSAGES["judged"])
def test_every_quantity_is_judged(text: str) -> None:
    result, (value, met, binding) = judge_goal(Goal.parse(text), OUTCOME), MESSAGES["judged"][text]
    assert result.parts[0].value == pytest.approx(value)
    assert (result.met, list(result.binding)) == (met, binding)


def test_safety_is_the_worst_of_the_icons() -> None:
    amber = dataclasses.replace(OUTCOME, amber=("dip",))
    red = dataclasses.replace(amber, red=("wave",))
    green, tolerant = Goal.parse("safety green"), Goal.parse("safety amber")
    assert [judge_goal(green, each).met for each in (OUTCOME, amber, red)] == [True, False, False]
    assert [judge_goal(tolerant, each).met for each in (OUTCOME, amber, red)] == [True, True, False]
    assert judge_goal(green, red).binding == ("wave, dip are not green",)
    assert judge_goal(green, amber).to_dict()["parts"][0]["value"] == "amber"
    assert judge_goal(Goal.parse("count 3"), red).binding == ("wave cannot be played",)


def test_an_icon_that_is_not_reached_is_no_matter_of_safety() -> None:
    missed = dataclasses.replace(OUTCOME, unreached=("wave",))
    result = judge_goal(Goal.parse("safety green, count 3"), missed)
    assert [part.met for part in result.parts] == [True, False]
    assert result.binding == ("wave cannot be played",)
    assert result.to_dict()["not_reached"] == ["wave"]


def test_a_weak_rig_makes_icons_unreached_not_red(six: IconSet, rig: Rig) -> None:
    ranking = rank(six, rig.with_(**{"driver.current_limit_A": 0.5}), people=2, parameters=0)
    reached = judge_goal("safety green", ranking)
    assert all(icon.safe for icon in ranking.icons)
    assert reached.met
    assert reached.unreached == tuple(icon.name for icon in ranking.icons if not icon.reachable) != ()


def test_an_icon_that_is_not_felt_has_no_onset() -> None:
    silent = dataclasses.replace(OUTCOME, onset_s=np.array([0.9, np.nan, 1.1]))
    result = judge_goal(Goal.parse("onset <= 5 s"), silent)
    assert (result.met, result.parts[0].value) == (False, None)
    assert result.binding == ("glow is not felt",)


def test_a_share_of_people_needs_draws() -> None:
    with pytest.raises(ValueError, match="needs draws of the posterior"):
        judge_goal(Goal.parse("named >= 50 % for 95 % of people"), dataclasses.replace(OUTCOME, persons={}))


def test_a_ranking_and_a_choice_are_judged_by_their_own_numbers(six: IconSet, rig: Rig) -> None:
    goal = "named >= 99 % for 95 % of people, named >= 30 %, time <= 500 s"
    ranking = rank(six, rig, people=6, parameters=12)
    choice = choose(ranking, Selection(2), parameters=12)
    whole, chosen = judge_goal(goal, ranking), judge_goal(Goal.parse(goal), ranking, choice)
    assert [part.met for part in whole.parts] == [False, True, True]
    assert whole.parts[1].value == ranking.proportion_correct
    assert chosen.parts[0].value > whole.parts[0].value  # type: ignore[operator]
    assert chosen.parts[2].value == pytest.approx(choice.total_s)
    # People and model together: the 5 % quantile lies below the mean over people.
    assert whole.parts[0].value < ranking.proportion_correct  # type: ignore[operator]
    held = whole.to_dict()
    assert (held["text"], held["met"]) == (Goal.parse(goal).text, False)
    assert held["parts"][0]["wanted"] == 0.99
    assert held["binding"]
