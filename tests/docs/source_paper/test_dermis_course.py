"""Figure 6b: changes inside the dermis, and the table of claims."""

from __future__ import annotations

import numpy as np
import pytest

from source_paper.dermis_course import dermis_course
from source_paper.paper_differences import paper_differences, paper_table


def test_the_last_depth_changes_as_much_as_the_paper_says() -> None:
    course = dermis_course()
    largest = np.abs(course.change_K).max(axis=1)
    assert largest[-1] == pytest.approx(1.0, rel=0.05) and course.depth_m[-1] == pytest.approx(1.5e-3, rel=0.1)
    assert (np.diff(largest) < 0).all() and np.ptp(course.insulated_K) < largest[-1]
    assert len(course.plot().get_lines()) == 5


def test_the_table_has_every_claim_with_its_verdict() -> None:
    table, points = paper_table(), paper_differences()
    assert list(table["claim"]) == [point.topic for point in points]
    assert list(table["verdict"] == "agrees") == [point.agrees for point in points]
    assert table["ours"].str[0].str.upper().equals(table["ours"].str[0])
