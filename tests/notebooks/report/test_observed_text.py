"""What is said of answers before any prediction: how far two participants reach, and who counts how much."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from thermicon.notebooks.report.answers_text import USEFUL_PEOPLE, observed_sentences
from thermicon.perception.pilot.trials import Trials, score_person, score_pooled

FEW = "Two participants allow hardly any interval of all"
UNEVEN = "participants with more trials count more; the mean of the participants is"


def said(*people: tuple[int, int]) -> str:
    """The sentences on participants with so many right and wrong answers."""
    counts = np.array([[[right, wrong], [0, right]] for right, wrong in people], dtype=float)
    trials = Trials(("a", "b"), tuple(f"P{k}" for k in range(len(people))), counts)
    each = tuple(score_person(trials, person) for person in range(len(people)))
    found: Any = SimpleNamespace(trials=trials, pooled=score_pooled(trials), each=each)
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
