"""Corners dragged: the right numbers change, nothing else in the text, and what cannot be is refused in a sentence."""

from __future__ import annotations

import re

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from thermicon.icons import load_library, parse
from thermicon.notebooks.editing.cue_check import read_text
from thermicon.notebooks.timeline.dragging import Dragged, drag
from thermicon.notebooks.timeline.handles import MOST_HANDLES, handles_of

HEAD = "cue 1\n"


def text_of(body: str, head: str = HEAD) -> str:
    """A text with one icon, one statement per line."""
    return f"{head}icon dip {{\n  {body}\n}}\n"


def line(dragged: Dragged, number: int = 3) -> str:
    """One line of what a drag gave, which must not have been refused."""
    assert dragged.refused is None
    return dragged.text.splitlines()[number - 1].strip()


@pytest.mark.parametrize(
    ("body", "index", "place", "becomes"),
    [
        ("cool by 4 °C at 2 °C/s", 0, (1.0, 28.0), "cool by 4 °C at 4 °C/s"),
        ("cool by 4 °C at 2 °C/s", 0, (2.0, 27.0), "cool by 5 °C at 2.5 °C/s"),
        ("cool by 4 °C over 2 s", 0, (2.0, 27.0), "cool by 5 °C over 2 s"),
        ("cool by 4 °C over 2 s", 0, (2.5, 28.0), "cool by 4 °C over 2.5 s"),
        ("cool by 4 °C over 2 s", 0, (2.5, 27.0), "cool by 5 °C over 2.5 s"),
        ("cool to 28 °C over 2 s", 0, (2.0, 26.9), "cool to 26.9 °C over 2 s"),
        ("cool by 4 °C over 2 s", 0, (2.0, 34.0), "warm by 2 °C over 2 s"),
        ("cool to 28 °C over 2 s", 0, (2.0, 34.0), "warm to 34 °C over 2 s"),
        ("change by -4 °C over 2 s", 0, (2.0, 34.0), "change by 2 °C over 2 s"),
        ("change by −4 °C over 2 s", 0, (2.0, 27.0), "change by −5 °C over 2 s"),
        ("change by +4 °C over 2 s", 0, (2.0, 37.0), "change by +5 °C over 2 s"),
        ("cool by 4K over 2000ms", 0, (2.53, 26.96), "cool by 5K over 2550ms"),
        ("cool by 4 degC at 120 °C/min", 0, (1.0, 28.0), "cool by 4 degC at 240 °C/min"),
        ("cool by 4 °C over 0.5 min", 0, (36.0, 28.0), "cool by 4 °C over 0.6 min"),
        ("step cool by 4 °C; hold for 2 s", 0, (9.0, 27.0), "step cool by 5 °C; hold for 2 s"),
        ("step cool by 4 °C; hold for 2 s", 0, (0.0, 34.0), "step warm by 2 °C; hold for 2 s"),
        ("step to 28 °C; hold for 2 s", 1, (3.0, 20.0), "step to 28 °C; hold for 3 s"),
        ("pulse by -3 °C for 500 ms", 0, (0.0, 30.0), "pulse by -2 °C for 500 ms"),
        ("pulse by -3 °C for 500 ms", 1, (0.8, 29.0), "pulse by -3 °C for 800 ms"),
        ("sine by 3 °C every 4 s for 8 s", 0, (1.0, 34.0), "sine by 2 °C every 4 s for 8 s"),
        ("sine by 3 °C every 4 s for 8 s", 0, (1.5, 35.0), "sine by 3 °C every 6 s for 12 s"),
        ("sine by 3 °C every 4 s for 8 s", 1, (12.7, 32.0), "sine by 3 °C every 4 s for 12 s"),
        ("sine by 3 °C every 4 s for 9 s cut", 1, (10.0, 32.0), "sine by 3 °C every 4 s for 10 s cut"),
        ("square by 3 °C every 4 s for 8 s starting cool", 0, (3.0, 28.0),
         "square by 4 °C every 6 s for 12 s starting cool"),
    ],
)  # fmt: skip
def test_a_drag_changes_the_numbers_that_it_is_about(
    body: str, index: int, place: tuple[float, float], becomes: str
) -> None:
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
    assert drag(text, "dip", 0, 2.02, 27.95) == Dragged(text)


def test_in_a_repeat_all_rounds_follow_and_the_corner_comes_under_the_pointer() -> None:
    text = text_of("repeat 3 { cool by 1 °C at 1 °C/s; hold for 1 s }")
    dragged = drag(text, "dip", 4, 6.5, 26.0)
    assert line(dragged) == "repeat 3 { cool by 2 °C at 1.33 °C/s; hold for 1 s }"
    assert handles_of(parse(dragged.text)["dip"])[4].level == 26.0


@pytest.mark.parametrize(
    ("body", "index", "place", "sentence"),
    [
        ("hold for 1 s; cool by 4 °C over 2 s", 1, (1.0, 28.0), "cannot come before 1 s, where its statement begins"),
        ("cool by 4 °C at 2 °C/s", 0, (-1.0, 28.0), "cannot come before 0 s"),
        ("cool by 4 °C over 2 s", 0, (2.0, 32.0), "that would be no change"),
        ("sine by 3 °C every 4 s for 8 s", 0, (1.0, 30.0), 'write "starting cool": an amplitude is positive'),
        ("cool by 4 °C over 2 s", 0, (2.0, -40.0), "more than the whole −10 to 60 °C that the language allows"),
        ("cool by 4 °C over 2 s; total 2 s", 0, (3.0, 28.0), "total not kept: this icon lasts 3 s, not 2 s"),
        ("cool by 4 °C over 2 s; warm to 30 °C over 1 s", 0, (2.0, 31.0), "target on the wrong side"),
        ("cool by 4 °C over 2 s", 5, (2.0, 31.0), "dip has 1 corners now, so there is none to move at 6"),
        ("cool by 4 °C over 2 s", 0, (float("nan"), 31.0), "the message has no target position"),
    ],
)
def test_a_drag_that_cannot_be_is_refused_in_a_sentence(
    body: str, index: int, place: tuple[float, float], sentence: str
) -> None:
    text = text_of(body)
    dragged = drag(text, "dip", index, *place)
    assert dragged.text == text
    assert sentence in str(dragged.refused)


def test_a_text_with_errors_is_not_dragged() -> None:
    dragged = drag("cue 1; icon dip { cool by 6 at 3 K/s }", "dip", 0, 1.0, 30.0)
    assert dragged.refused == "the corner stays where it is: line 1 has an error"
    assert "no icon is called dop" in str(drag(text_of("rest for 1 s"), "dop", 0, 1.0, 30.0).refused)


def test_what_a_parameter_writes_does_not_move_and_what_stands_beside_it_does() -> None:
    text = "cue 1\nicon dip(size in [3, 6] K) {\n  cool by size over 2 s; return at 3 K/s\n}\n"
    reading = read_text(text)
    icon = reading.icons.icons[1] if reading.icons else None
    assert icon is not None
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
