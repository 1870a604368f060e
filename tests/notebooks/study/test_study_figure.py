"""The figure of a study: every play once in the orders and once on the clock, in its own colour."""

from __future__ import annotations

import pytest
from matplotlib.colors import to_hex

from tests.circuit.surerig import sure_rig
from thermicon.circuit import Session, SessionPlan, play_session
from thermicon.icons import parse
from thermicon.notebooks.figures.study_figure import COLOURS, MOST_ROWS, study_figure
from thermicon.notebooks.study.schedule import Course, Pace, Trial, planned_plays

from .conftest import CUES

TRIALS = (Trial(1, 0, 0, "glow"), Trial(2, 1, 1, "dip"), Trial(3, 1, 2, "glow"), Trial(4, 2, 3, "dip"))
COURSES = (Course("A", TRIALS), Course("B", TRIALS[::-1]))
PACE = Pace(30.0, 10.0, 40.0)
LASTING = {"dip": 3.0, "glow": 3.0}


@pytest.fixture(scope="module")
def session() -> Session:
    return play_session(parse(CUES, "two"), SessionPlan(COURSES[0].order, 10.0), sure_rig())


def test_planned_times_have_landings_gaps_and_breaks() -> None:
    """Practice goes over into the first block; the second begins with a break and a landing."""
    plays = planned_plays(COURSES[0], LASTING, PACE)
    assert [play.onset_s for play in plays] == [30.0, 43.0, 56.0, 59.0 + 40.0 + 30.0]


def test_every_play_is_drawn_in_its_own_colour(session: Session) -> None:
    plays = planned_plays(COURSES[0], LASTING, PACE)
    figure = study_figure(COURSES, COURSES[0], plays, PACE, session)
    order, clock, skin = figure.axes
    assert [text.get_text() for text in order.texts] == ["2", "1", "2", "1", "1", "2", "1", "2"]
    assert [to_hex(bar.get_facecolor()) for bar in order.patches[1:3]] == [COLOURS[0], COLOURS[1]]
    assert [label.get_text() for label in order.get_xticklabels()] == ["practice", "block 1", "block 2"]
    assert [text.get_text() for text in order.get_legend().get_texts()] == ["1  dip", "2  glow"]
    on_clock = [bar for bar in clock.patches if to_hex(bar.get_facecolor()) in COLOURS]
    assert [60.0 * bar.get_x() for bar in on_clock] == pytest.approx([30.0, 43.0, 56.0, 129.0])
    assert {text.get_text() for text in clock.get_legend().get_texts()} == {"landing of the hand", "break, hand off"}
    lines = [line for line in skin.get_lines() if len(line.get_xdata()) > 10]
    assert [60.0 * line.get_xdata()[0] for line in lines] == pytest.approx([30.0, 43.0, 56.0, 129.0], abs=0.05)
    assert 60.0 * max(line.get_xdata()[-1] for line in lines[:3]) < 60.0, "no line through the break"


def test_of_many_participants_the_first_are_drawn_and_of_a_thermode_no_skin() -> None:
    many = [Course(f"{k}", TRIALS) for k in range(MOST_ROWS + 5)]
    figure = study_figure(many, many[0], planned_plays(many[0], LASTING, PACE), PACE, None)
    assert figure.axes[0].get_title(loc="left") == f"order of play (the first {MOST_ROWS} of {MOST_ROWS + 5})"
    assert "no session is simulated for a thermode" in figure.axes[2].texts[0].get_text()
