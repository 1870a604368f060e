"""Dragged corners: the right numbers change, or a sentence refuses."""

import re

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tests.builders import messages, missing
from thermicon.icons import load_library, parse
from thermicon.notebooks.editing.cue_check import read_text
from thermicon.notebooks.timeline.dragging import DragResult, drag
from thermicon.notebooks.timeline.handles import MOST_HANDLES, handles_of

HEAD = "cue 1\n"
DRAGS = messages(__file__)


def of(asked: str) -> tuple[str, int, tuple[float, float]]:
    """Statement, corner, and the time and level that it is dragged to."""
    body, _, numbers = asked.rpartition(" | ")
    index, _, time_s, level = numbers.split()
    return body, int(index), (float(time_s), float(level))


def text_of(body: str, head: str = HEAD) -> str:
    """A text with one icon, one statement per line."""
    return f"{head}icon dip {{\n  {body}\n}}\n"


def line(dragged: DragResult, number: int = 3) -> str:
    """One line of what a drag gave, which must not have been refused."""
    assert dragged.refused is None
    return dragged.text.splitlines()[number - 1].strip()


@pytest.mark.parametrize(("asked", "becomes"), DRAGS["changed"].items())
def test_a_drag_changes_the_numbers_that_it_is_about(asked: str, becomes: str) -> None:
    body, index, place = of(asked)
    assert line(drag(text_of(body), "dip", index, *place)) == becomes


def test_current_is_dragged_in_amperes() -> None:
    text = text_of("to 0.5 A at 1 A/s; hold for 2 s", "cue 1\nset { control current }\n")
    assert line(drag(text, "dip", 0, 0.5, 1.0, start=0.0), 4) == "to 1 A at 2 A/s; hold for 2 s"


def test_everything_else_stays_byte_for_byte() -> None:
    text = "\ufeffcue 1 # by 6 °C\r\nicon dip { # cool by 6 °C\r\n\tcool  by 6.0 °C at 3 °C/s   # by 6 °C at 3\r\n}\r\n"
    dragged = drag(text, "dip", 0, 3.0, 26.0)
    assert dragged.text == text.replace("at 3 °C/s", "at 2 °C/s")


def test_a_move_of_less_than_half_a_step_changes_nothing() -> None:
    text = text_of("cool by 4.02 °C over 2.01 s")
    assert drag(text, "dip", 0, 2.02, 27.95) == DragResult(text)


def test_in_a_repeat_all_rounds_follow_and_the_corner_comes_under_the_pointer() -> None:
    text = text_of("repeat 3 { cool by 1 °C at 1 °C/s; hold for 1 s }")
    dragged = drag(text, "dip", 4, 6.5, 26.0)
    assert line(dragged) == "repeat 3 { cool by 2 °C at 1.33 °C/s; hold for 1 s }"
    assert handles_of(parse(dragged.text)["dip"])[4].level == 26.0


@pytest.mark.parametrize(("asked", "words"), DRAGS["refused"].items())
def test_a_drag_that_cannot_be_is_refused_in_a_sentence(asked: str, words: str | list[str]) -> None:
    body, index, place = of(asked)
    text = text_of(body)
    dragged = drag(text, "dip", index, *place)
    assert dragged.text == text
    assert missing(words, str(dragged.refused)) == []


def test_a_text_with_errors_is_not_dragged() -> None:
    dragged = drag("cue 1; icon dip { cool by 6 at 3 K/s }", "dip", 0, 1.0, 30.0)
    assert dragged.refused == "the corner stays where it is: line 1 has an error"
    assert "no icon is called dop" in str(drag(text_of("rest for 1 s"), "dop", 0, 1.0, 30.0).refused)


def test_what_a_parameter_writes_does_not_move_and_what_stands_beside_it_does() -> None:
    text = "cue 1\nicon dip(size in [3, 6] K) {\n  cool by size over 2 s; return at 3 K/s\n}\n"
    reading = read_text(text)
    icon = reading.icons.icons[1] if reading.icons else None
    handle = handles_of(icon, reading.family_of(icon.name))[0]
    assert (handle.moves_time, handle.moves_level) == (True, False)
    assert handle.why == "the parameter size of the family writes this amount"
    assert line(drag(text, icon.name, 0, 3.0, 20.0)) == "cool by size over 3 s; return at 3 K/s"


def test_corners_of_a_played_icon_say_where_they_are_moved() -> None:
    text = "cue 1\nicon dip { cool by 3 K over 1 s; return over 1 s }\nicon two { rest for 1 s; play dip; play dip }\n"
    handles = handles_of(parse(text)["two"])
    assert [(handle.line, handle.moves_time) for handle in handles] == [(3, True)] + 4 * [(3, False)]
    refused = drag(text, "two", 1, 3.0, 30.0).refused
    assert refused == "this is played from dip; select that icon to move its corners"


def test_handles_of_a_long_repeat_are_capped() -> None:
    icon = parse("cue 1; icon dip { repeat 2000 { cool by 1 °C over 0.5 s; return over 0.5 s } }")["dip"]
    assert len(handles_of(icon)) == MOST_HANDLES


@pytest.mark.parametrize("name", ["six-icons", "wave-shapes", "wilson-ramps", "pulse-sequences"])
def test_every_corner_of_the_library_moves_or_says_why(name: str) -> None:
    icons = load_library(name)
    text = str(icons)
    for icon in list(icons.icons)[:8]:
        family = read_text(text).family_of(icon.name)
        for place, handle in enumerate(handles_of(icon, family)):
            if handle.moves_time or handle.moves_level:
                dragged = drag(text, icon.name, place, handle.time_s * 1.1 + 0.1, handle.level + 0.3)
                assert dragged.text != text or dragged.refused or "wave" in str(handle.why)
            if not (handle.moves_time and handle.moves_level):
                assert handle.why


SIZE = st.sampled_from(["1", "2.5", "4", "0.75"])
TIME = st.sampled_from(["1 s", "1.5 s", "750 ms", "0.05 min"])
PACE = st.one_of(TIME.map("over {}".format), st.sampled_from(["at 2 °C/s", "at 0.8 K/s", "at 90 °C/min"]))
RAMP = st.builds("{} by {} °C {}".format, st.sampled_from(["cool", "warm", "change"]), SIZE, PACE)
HOLD = TIME.map("hold for {}".format)
PULSE = st.builds("pulse by {}{} °C for {}".format, st.sampled_from(["-", "+", ""]), SIZE, TIME)
WAVE = st.builds("{} by {} K every 2 s for 4 s".format, st.sampled_from(["sine", "triangle", "sawtooth"]), SIZE)
PLAIN = st.one_of(RAMP, HOLD, PULSE, WAVE)
ROUND = st.lists(PLAIN, min_size=1, max_size=3).map(lambda body: f"repeat 2 {{ {'; '.join(body)} }}")
BODY = st.lists(st.one_of(PLAIN, ROUND), min_size=1, max_size=4)


@settings(max_examples=150)
@given(body=BODY, back=st.booleans(), pick=st.integers(0, 40), dt=st.floats(-0.6, 2.0), dy=st.floats(-3.0, 3.0))
def test_after_any_drag_the_corner_is_where_asked_and_one_statement_changed(
    body: list[str], back: bool, pick: int, dt: float, dy: float
) -> None:
    text = "cue 1\nicon dip {\n  " + "\n  ".join([*body, *["return at 2 °C/s"] * back]) + "\n}\n"
    reading = read_text(text)
    assume(reading.icons is not None)
    icon = reading.find("dip")
    assert icon is not None
    before = handles_of(icon)
    index = pick % len(before)
    asked = before[index].time_s + dt, before[index].level + dy
    dragged = drag(text, "dip", index, *asked)
    if dragged.refused is not None:
        assert dragged.text == text
        return
    found = read_text(dragged.text).find("dip")
    assert found is not None
    after = handles_of(found)[index]
    words = re.split(r"[;{}\n]", text), re.split(r"[;{}\n]", dragged.text)
    assert sum(a != b for a, b in zip(*words, strict=True)) <= 1
    whole_periods = "wave ends" in (before[index].why or "")
    if before[index].moves_time and not whole_periods:
        assert after.time_s == pytest.approx(asked[0], abs=0.15)
    if before[index].moves_level:
        assert after.level == pytest.approx(asked[1], abs=0.15)
