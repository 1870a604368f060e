"""Sentences of reports."""

from types import SimpleNamespace as Record
from typing import Any, cast

import numpy as np
import pytest

from thermicon.circuit.fitting.identify import FittedParameter
from thermicon.circuit.fitting.rig_fit import RigFit
from thermicon.notebooks.report.blocks import Text
from thermicon.notebooks.report.choices import choice_lines, goal_lines
from thermicon.notebooks.report.fit_report import parameter_table
from thermicon.notebooks.report.pilot_report import fit_sentences, measured_sentences, pairs
from thermicon.notebooks.report.plan_report import designs_table
from thermicon.perception import Goal
from thermicon.perception.pilot.plan import ExperimentPlan, ExperimentSize
from thermicon.perception.pilot.prediction import Fit, PairFit
from thermicon.perception.selection.appraise import Appraisal
from thermicon.perception.selection.choose import Choice
from thermicon.perception.selection.goal_result import GoalPartResult, GoalResult
from thermicon.perception.selection.request import Objective


def chosen(objective: Objective, seen: int, people: int) -> Choice:
    pair, own = ("a", "b"), Appraisal(("a", "b"), 3.0, 0.88, 0.9, 1.0, 0.1, 0.7, 0.8, np.ones(2), np.ones(2), np.eye(2))
    return Choice(pair, objective, 3.0, True, 3.0, pair, 9.0, 12.0, 2, people, seen, (), own)


def test_a_choice_of_one_person_is_said_in_the_singular() -> None:
    for asked, words in (
        (("worst", 1, 1), "(1 threshold)"),
        (("named", 1, 1), "no other choice is better: it is the only one, evaluated with 1 person"),
        (("named", 3, 24), "all 3 choices were evaluated, with 24 people"),
    ):
        assert words in "\n".join(choice_lines(chosen(*asked)))


def test_an_icon_that_is_not_reached_is_said_apart_from_safety() -> None:
    goal = Goal.parse("safety green")
    result = GoalResult(goal, (GoalPartResult(goal.parts[0], 0.0, met=True, binding=""),), unreached=("wave", "dip"))
    assert list(goal_lines(result)) == [
        "Goal: met",
        "  ✓ safety green: green in this simulation; export judges the worst case",
        "  Not reached, and judged as the rig would play them: wave, dip; export refuses them",
    ]


def test_what_a_share_of_people_means_is_said_once_and_in_a_short_line() -> None:
    goal = Goal.parse("named >= 80 % for 95 % of people, bits >= 2 for 90 % of people, time <= 9 s")
    parts = tuple(GoalPartResult(part, part.limit, met=True, binding="") for part in goal.parts)
    lines = list(goal_lines(GoalResult(goal, parts)))
    assert lines[-1] == "  For a share of people: what at least so many reach, with the uncertainty of the model."
    assert sum("For a share" in line for line in lines) == 1
    assert max(map(len, lines)) <= 100
    assert not any("share" in line for line in goal_lines(GoalResult(Goal((goal.parts[2],)), parts[2:])))
    assert not any("For a share" in line for line in goal_lines(GoalResult(goal, parts), "met by the best 4"))


@pytest.mark.parametrize(("found", "starred"), [((None, None), [False, True]), ((0.7, 0.9), [False, True])])
def test_the_star_of_a_plan_stands_at_sizes_that_are_enough(
    found: tuple[float | None, ...], starred: list[bool]
) -> None:
    """Of one set the width of the interval counts, of two the power."""
    sizes = tuple(
        ExperimentSize(10, trials, width, 1.5, power)
        for trials, width, power in zip((24, 48), (0.12, 0.08), found, strict=True)
    )
    plan = ExperimentPlan(
        (), None, sizes, 0.1 if found[0] is None else 0.8, (), ("a", "b"), "thenar", (), "episodes", 0, 8, "0"
    )
    (row,) = designs_table(plan).rows
    assert ["*" in cell.text for cell in row[1:]] == starred


def test_a_fitted_number_has_the_digits_that_its_interval_takes() -> None:
    for value, low, high, said in (
        (12.3456, 11, 14, "12.35 11.00 to 14.00"),
        (12345.6, 12342, 12349, "12346 12342 to 12349"),
    ):
        item = FittedParameter("a", "a", "", 1.0, value, low, high, True, True)
        (row,) = parameter_table(cast("RigFit", Record(parameters=[item]))).rows
        assert " ".join(cell.text for cell in row[1:3]) == said


@pytest.mark.parametrize(("count", "chance"), [(15, "0.8"), (60, "3.0")])
def test_of_more_pairs_more_lie_outside_their_95_percent_by_chance(count: int, chance: str) -> None:
    fits = tuple(PairFit("a", "b", 20, 0.3, 0.2, (0.1, 0.25), missed=number < 2) for number in range(count))
    head = cast("Text", pairs(Fit(0.4, None, (0.7, 0.6, 0.8), (1.2, 1.0, 1.4), fits))[0])
    assert head.text == f"Pairs outside their predicted 95 % (2 of {count}; about {chance} by chance):"


@pytest.mark.parametrize(
    ("before", "after", "count", "said"),
    [
        (0.0099, 0.4, 20, "p under 0.01 before, p = 0.40 after the answers were used: the prediction missed"),
        (0.01, 0.4, 20, "p = 0.01 before"),
        (0.0499, 0.4, 20, "the prediction missed, but laboratories that the evidence allows explain the answers"),
        (0.05, 0.0499, 20, "the model cannot explain these answers, not even with other constants"),
        (0.05, 0.05, 20, "the answers are near the limit of what the prediction before them allowed"),
        (0.0999, 0.4, 20, "the answers are near the limit of what the prediction before them allowed"),
        (0.1, 0.4, 20, "the answers are what the prediction allows"),
        (0.01, 0.4, 19, "19 answers are too few to judge the model by; 20 or more can"),
    ],
)
def test_answers_are_judged_by_how_many_and_how_likely_they_are(
    before: float, after: float, count: int, said: str
) -> None:
    counts = np.array([[count - 2, 0], [2, 0]])
    data = Record(trials=Record(pooled=counts, counts=counts), pooled=Record(unanswered=0, information_bits_plugin=0.0))
    fits = {
        name: Fit(p, None, (0.7, 0.6, 0.8), (1.2, 1.0, 1.4), ()) for name, p in (("fit", before), ("fit_after", after))
    }
    assert said in fit_sentences(cast("Any", Record(data=data, conditioned=Record(after=[0] * 100), **fits)))[1]


@pytest.mark.parametrize(("total", "said"), [(5, "5 values are too few to judge"), (6, "what the prediction allows")])
def test_six_values_are_enough_to_judge_the_model_by(total: int, said: str) -> None:
    data, fit = Record(measurements=Record(total=total, assumed_errors=0, conditions=())), Record(p=0.4, conditions=())
    found = Record(data=data, fit=fit, fit_after=fit, conditioned=Record(after=[0] * 100))
    assert said in measured_sentences(cast("Any", found))[-1]
