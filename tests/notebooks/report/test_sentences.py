"""Sentences of reports: counts in the singular, goals, choices, and how far few participants reach."""

from typing import Any

from thermicon.notebooks.report.choices import choice_lines, goal_lines
from thermicon.perception import Goal
from thermicon.perception.selection.goal_result import GoalPartResult, GoalResult


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
