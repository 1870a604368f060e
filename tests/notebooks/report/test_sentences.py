"""Sentences of reports: counts in the singular, goals, choices, and how far few participants reach."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from thermicon.notebooks.report.choices import choice_lines, goal_lines
from thermicon.notebooks.report.pilot_report import USEFUL_PEOPLE, observed_sentences
from thermicon.perception import Goal
from thermicon.perception.pilot.trials import Trials, score
from thermicon.perception.selection.goal_result import GoalPartResult, GoalResult

FEW = "Two participants allow hardly any interval of all"
UNEVEN = "participants with more trials count more; the mean of the participants is"


def said(*people: tuple[int, int]) -> str:
    """The sentences on participants with so many right and wrong answers."""
    counts = np.array([[[right, wrong], [0, right]] for right, wrong in people], dtype=float)
    trials = Trials(("a", "b"), tuple(f"P{k}" for k in range(len(people))), counts)
    each = tuple(score(name, own[None]) for name, own in zip(trials.participants, counts, strict=True))
    found: Any = SimpleNamespace(trials=trials, pooled=score("all", counts), each=each)
    return " ".join(observed_sentences(found))


@pytest.mark.parametrize(("count", "named"), [(1, False), (2, True), (3, False)])
def test_two_participants_are_said_to_allow_hardly_any_interval(count: int, named: bool) -> None:
    assert (FEW in said(*[(6, k) for k in range(count)])) == named


def test_from_when_on_an_interval_is_useful_is_what_student_says() -> None:
    from scipy.stats import t

    assert "(with one degree of freedom, 12.7 standard errors to either side)" in said((6, 1), (6, 3))
    assert round(float(t.ppf(0.975, 1)), 1) == 12.7
    assert t.ppf(0.975, USEFUL_PEOPLE - 1) < 3.0 < t.ppf(0.975, USEFUL_PEOPLE - 2)


def test_pooled_answers_beside_the_mean_of_participants_are_explained_where_they_differ() -> None:
    assert f"{UNEVEN} 83 % correct." in said((20, 0), (1, 1), (5, 2))
    assert UNEVEN not in said((6, 1), (6, 1), (6, 1))


def chosen(objective: str, looked_at: int, people: int) -> dict[str, Any]:
    own = {
        "worst_pair": ["a", "b"],
        "d_prime": 3.0,
        "proportion_correct": 0.9,
        "information_bits": 1.0,
        "bits_per_s": 0.1,
        "proportion_correct_interval_new_laboratory": None,
    }
    return {
        "icons": ["a", "b"],
        "pool": 2,
        "objective": objective,
        "value": 3.0,
        "worst_pair": ["a", "b"],
        "optimal": True,
        "looked_at": looked_at,
        "people": people,
        "at_own_range": own,
        "total_J": None,
        "total_s": 9.0,
        "excluded": [],
    }


def test_a_choice_of_one_person_is_said_in_the_singular() -> None:
    worst = "\n".join(choice_lines(chosen("worst", 1, 1)))
    assert "(1 threshold)" in worst
    correct = "\n".join(choice_lines(chosen("correct", 1, 1)))
    assert "no other choice is better: it is the only one, evaluated with 1 person" in correct
    many = "\n".join(choice_lines(chosen("correct", 3, 24)))
    assert "all 3 choices were evaluated, with 24 people" in many


def test_an_icon_that_is_not_reached_is_said_apart_from_safety() -> None:
    goal = Goal.parse("safety green")
    result = GoalResult(goal, (GoalPartResult(goal.parts[0], 0.0, met=True, binding=""),), unreached=("wave", "dip"))
    assert list(goal_lines(result.to_dict())) == [
        "Goal: met",
        "  ✓ safety green: green in this simulation; export judges the worst case",
        "  Not reached, and judged as the rig would play them: wave, dip; export refuses them",
    ]


def test_what_a_share_of_people_means_is_said_once_and_in_a_short_line() -> None:
    goal = Goal.parse("correct >= 80 % for 95 % of people, bits >= 2 for 90 % of people, time <= 9 s")
    parts = tuple(GoalPartResult(part, part.limit, met=True, binding="") for part in goal.parts)
    lines = list(goal_lines(GoalResult(goal, parts).to_dict()))
    assert lines[-1] == "  For a share of people: what at least so many reach, with the uncertainty of the model."
    assert sum("For a share" in line for line in lines) == 1
    assert max(map(len, lines)) <= 100
    mean = GoalResult(Goal((goal.parts[2],)), parts[2:])
    assert not any("share" in line for line in goal_lines(mean.to_dict()))
    assert not any("For a share" in line for line in goal_lines(GoalResult(goal, parts).to_dict(), "met by the best 4"))
