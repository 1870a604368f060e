import re
from typing import Any

import pytest

from thermicon.icons import load_library
from thermicon.icons.files.shipped import library_names
from thermicon.notebooks.report.choices import choice_lines


@pytest.mark.parametrize("name", library_names())
def test_what_shipped_icons_mean_reads_well_for_a_single_one(name: str) -> None:
    for icon in load_library(name):
        said = icon.metadata.means or ""
        assert not re.search(r"(?<![\d.])1 [a-z]+s\b", said), said


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
        "best_for_people": 1.0 if objective == "worst" else None,
        "median_loss": 0.0,
        "excluded": [],
    }


def test_a_choice_of_one_person_is_said_in_the_singular() -> None:
    worst = "\n".join(choice_lines(chosen("worst", 1, 1)))
    assert "(1 threshold)" in worst
    assert "100 % of 1 individual person;" in worst
    correct = "\n".join(choice_lines(chosen("correct", 1, 1)))
    assert "no other choice is better: it is the only one, evaluated with 1 person" in correct
    many = "\n".join(choice_lines(chosen("correct", 3, 24)))
    assert "all 3 choices were evaluated, with 24 people" in many
