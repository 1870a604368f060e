"""The plan of a session: landings, gaps and breaks on its clock."""

from __future__ import annotations

from thermicon.notebooks.study.schedule import Course, Pace, Trial, planned_plays


def test_planned_times_have_landings_gaps_and_breaks() -> None:
    """Practice goes over into the first block; the second begins with a break and a landing."""
    trials = (Trial(1, 0, 0, "glow"), Trial(2, 1, 1, "dip"), Trial(3, 1, 2, "glow"), Trial(4, 2, 3, "dip"))
    plays = planned_plays(Course("A", trials), {"dip": 3.0, "glow": 3.0}, Pace(30.0, 10.0, 40.0))
    assert [play.onset_s for play in plays] == [30.0, 43.0, 56.0, 59.0 + 40.0 + 30.0]
