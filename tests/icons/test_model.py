"""Objects built in Python prove themselves, say who they are, and compare by value."""

import math
from collections.abc import Callable

import pytest

from thermicon.icons import (
    Change,
    CueErrors,
    Drive,
    Frame,
    Hold,
    Icon,
    IconSet,
    Metadata,
    Repeat,
    Rest,
    Return,
    load_library,
    parse,
)
from thermicon.icons.statements import Broken

HOLD = (Hold(1),)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Change("up", by_K=1, duration_s=1), 'direction must be "warm" or "cool"'),
        (lambda: Change("warm", duration_s=1), "either by_K or to_C"),
        (lambda: Change("warm", by_K=1, to_C=40, duration_s=1), "and not both"),
        (lambda: Change("warm", by_K=1), "either rate_K_per_s or duration_s"),
        (lambda: Change("warm", by_K=-1, duration_s=1), r"Change.by_K = -1.0: a change has a positive size"),
        (lambda: Change("warm", by_K=1, rate_K_per_s=0), "a rate is positive"),
        (lambda: Change("warm", to_C=61, duration_s=1), "61 °C is outside the −10 to 60 °C"),
        (lambda: Change("warm", by_K=math.nan, duration_s=1), "nan is not a number that the language takes"),
        (lambda: Change("warm", by_K="1", duration_s=1), "must be a number, not '1'"),
        (lambda: Drive(21, duration_s=1), "21 A is outside the ±20 A"),
        (lambda: Drive(None, duration_s=1), "to_A must be a number"),
        (lambda: Drive(1), "either rate_A_per_s or duration_s"),
        (lambda: Hold(0), "a time is positive"),
        (lambda: Hold(None), "duration_s must be a number, not None"),
        (lambda: Rest(3601), "more than the hour"),
        (lambda: Return(), "either rate_per_s or duration_s"),
        (lambda: Repeat(0, HOLD), "whole number from 1"),
        (lambda: Repeat(True, HOLD), "not True"),
        (lambda: Repeat(2, ()), "at least one statement"),
        (lambda: Repeat(2, ("hold",)), "nothing else"),
        (lambda: Frame("heat"), "control must be one of skin, display, current, not 'heat'"),
        (lambda: Frame(baseline_C=99), "baseline_C: 99 °C is outside"),
        (lambda: Frame(site="left thumb"), "site: 'left thumb' is not a name"),
        (lambda: Metadata(means=" "), "means: the text is empty"),
        (lambda: Metadata(by="a\x00"), r"by: the text holds the control character U\+0000"),
        (lambda: Metadata(tags="a"), "tags must be a tuple"),
        (lambda: Metadata(tags=("a,b",)), "has a comma"),
        (lambda: Icon("my icon", HOLD), "icon: 'my icon' is not a name"),
        (lambda: Icon("x", ()), "at least one statement"),
        (lambda: Icon("x", (Repeat(2, (Broken(),)),)), "nothing but statements"),
        (lambda: Icon("x", (Return(1),)), "E206 already at baseline"),
        (lambda: Icon("x", (Change("warm", to_C=30, duration_s=1),)), "E201 target on the wrong side"),
        (lambda: Icon("x", (Drive(1, duration_s=1),)), "E209 to without warm or cool"),
        (lambda: Icon("x", (Repeat(10**6, HOLD),)), "E220 too many corners"),
        (lambda: IconSet("a", "", Frame(), Metadata(), ()), "at least one icon"),
        (lambda: IconSet("1", "", Frame(), Metadata(), (Icon("x", HOLD),)), "set: '1' is not a name"),
        (lambda: IconSet("a", " ", Frame(), Metadata(), (Icon("x", HOLD),)), "title: the text is empty"),
        (lambda: IconSet("a", "", Frame(), Metadata(), (Icon("x", HOLD),) * 2), "two icons are called x"),
        (lambda: IconSet("a", "", Frame("display"), Metadata(), (Icon("x", HOLD),)), "is not that of the set"),
    ],
)
def test_what_cannot_be_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_numbers_become_floats_and_equal_icons_are_equal() -> None:
    by_hand = Icon("dip", (Change("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3)))
    read = parse("cue 1\nicon dip {\n cool by 6 K at 3 K/s; hold for 4000 ms\n return at 180 °C/min }").icons[0]
    assert by_hand == read
    assert hash(by_hand) == hash(read)
    assert isinstance(by_hand.statements[1], Hold)
    assert isinstance(by_hand.statements[1].duration_s, float)


def test_statements_know_where_they_stood() -> None:
    read = parse("cue 1\nicon dip {\n  hold for 1 s\n  repeat 2 { rest for 1 s }\n}").icons[0]
    repeat = read.statements[1]
    assert isinstance(repeat, Repeat)
    assert (read.statements[0].span, repeat.span, repeat.body[0].span) == ((3, 3), (4, 3), (4, 14))


def test_one_line_reprs_with_units() -> None:
    icons = load_library("six-icons")
    assert repr(icons) == "<IconSet six-icons: 6 icons, 8 s, control display, baseline 32 °C>"
    assert repr(icons["cooling-step"]) == "<Icon cooling-step: 8 s, 26 to 32 °C, at most 3 °C/s, control display>"
    assert repr(Icon("x", HOLD)).endswith("control skin, baseline 32 °C assumed>")
    drive = Icon("x", (Drive(1, duration_s=2),), Frame("current"))
    assert repr(drive) == "<Icon x: 2 s, 0 to 1 A, at most 0.5 A/s, control current>"


def test_a_set_is_looked_up_by_name() -> None:
    icons = load_library("six-icons")
    assert len(icons) == len(list(icons)) == 6
    assert "cooling-step" in icons
    assert icons.icons[0] in icons
    assert "nothing" not in icons
    with pytest.raises(
        KeyError, match=r"no icon is called 'coolingstep'; did you mean cooling-step\? the set has: cool"
    ):
        icons["coolingstep"]


def test_errors_of_an_icon_show_its_canonical_text() -> None:
    with pytest.raises(
        CueErrors, match=r"<icon x>:1:1  E205 (?s:.)*1 \| rest for 2 s\n    \| \^{12} the level is 31"
    ) as caught:
        Icon("x", (Change("cool", by_K=1, duration_s=1), Rest(2)))
    assert len(caught.value.errors) == 1
