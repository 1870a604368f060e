"""The budget of a release (`budget.toml`), which the ordinary tests let work exceed by 3 %: lines and words of docs."""

import pytest

from tests.count import BUDGET, rooms, words_of_docs

SLACK = 1.03
"""Room for what is not released yet; `python tests/count.py` warns above the number itself."""


def _judge(name: str, number: int, budget: int) -> None:
    most = int(SLACK * budget)
    assert number <= most, f"{name}: {number}, 3 % above the budget are {most}; remove {number - most}"


@pytest.mark.parametrize("part", ["product", "tests"])
def test_what_is_maintained_stays_near_its_lines(part: str) -> None:
    _judge(f"lines of the {part}", sum(map(sum, rooms(part).values())), BUDGET["lines"][part])


def test_the_docs_have_hardly_more_words_than_their_budget() -> None:
    _judge("words of docs", words_of_docs(), BUDGET["docs_words"])
