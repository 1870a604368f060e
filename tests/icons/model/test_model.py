"""Objects built in Python prove themselves, say who they are, and compare by value."""

import copy
import math
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, fields

import pytest

from thermicon.icons import CueErrors, Icon, IconSet, load_library, parse
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.statements import (
    Broken,
    Current,
    Hold,
    Play,
    Pulse,
    Ramp,
    Repeat,
    Rest,
    Return,
    Step,
    Total,
    Wave,
)

HOLD = (Hold(1),)
WAIT = Icon("wait", (Rest(1),))
EVERYTHING = (
    Ramp("change", by_K=-1, duration_s=1),
    Return(duration_s=1),
    Step("cool", by_K=1),
    Step(to_C=32),
    Pulse(by_K=1, duration_s=0.5),
    Wave("sawtooth", by_K=1, period_s=1, duration_s=2, start="cool"),
    Repeat(2, (Play(WAIT), Hold(1))),
    Total(20, "at most"),
)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Ramp("up", by_K=1, duration_s=1), 'direction must be "warm", "cool" or "change", not \'up\''),
        (lambda: Ramp("change", by_K=0, duration_s=1), "a change must not be zero"),
        (lambda: Ramp("warm", duration_s=1), "either by_K or to_C"),
        (lambda: Ramp("warm", by_K=1, to_C=40, duration_s=1), "and not both"),
        (lambda: Ramp("warm", by_K=1), "either rate_K_per_s or duration_s"),
        (lambda: Ramp("warm", by_K=-1, duration_s=1), r"Ramp.by_K = -1.0: a change has a positive size"),
        (lambda: Ramp("warm", by_K=1, rate_K_per_s=0), "a rate is positive"),
        (lambda: Ramp("warm", to_C=61, duration_s=1), "61 °C is outside the −10 to 60 °C"),
        (lambda: Ramp("warm", by_K=math.nan, duration_s=1), "nan is not a number that the language takes"),
        (lambda: Ramp("warm", by_K="1", duration_s=1), "must be a number, not '1'"),
        (lambda: Current(21, duration_s=1), "21 A is outside the ±20 A"),
        (lambda: Current(None, duration_s=1), "to_A must be a number"),
        (lambda: Current(1), "either rate_A_per_s or duration_s"),
        (lambda: Hold(0), "a time is positive"),
        (lambda: Hold(None), "duration_s must be a number, not None"),
        (lambda: Rest(3601), "more than the hour"),
        (lambda: Return(), "either rate_per_s or duration_s"),
        (lambda: Repeat(0, HOLD), "whole number from 1"),
        (lambda: Repeat(True, HOLD), "not True"),
        (lambda: Repeat("3", HOLD), "Repeat.count must be a whole number from 1 to .*, not '3'"),
        (lambda: Repeat(3, [list(HOLD)]), "Repeat.body must hold .* nothing else"),
        (lambda: Repeat(2, ()), "at least one statement"),
        (lambda: Repeat(2, ("hold",)), "nothing else"),
        (lambda: Repeat(2, (Total(1),)), "may not hold a Total, which concerns the whole icon"),
        (lambda: Total(1, "about"), 'bound must be "exactly", "at most" or "at least", not \'about\''),
        (lambda: Play("x"), "Play.icon must be an Icon, not 'x'"),
        (lambda: Step(), "Step needs either by_K or to_C or by_A or to_A, and not both"),
        (lambda: Step("up", by_K=1), 'Step.direction must be "warm", "cool" or "change", not \'up\''),
        (lambda: Step("warm", by_K=-1), "a change has a positive size"),
        (lambda: Step("warm", by_A=1), 'Step: a current is changed, not "warm"ed'),
        (lambda: Step(by_A=0), "Step.by_A = 0: a change must not be zero"),
        (lambda: Pulse(by_K=1, by_A=1), "Pulse needs either by_K or by_A, and not both"),
        (lambda: Pulse(by_K=0), "a change must not be zero"),
        (lambda: Wave("saw", by_K=1), "Wave.shape must be one of sine, square, triangle, sawtooth, not 'saw'"),
        (lambda: Wave("sine", by_A=-1), 'Wave.by_A = -1.0: an amplitude is positive; .*start "down"'),
        (lambda: Wave("sine", by_K=1, start="up"), 'Wave.start must be "warm" or "cool" here, not \'up\''),
        (lambda: Wave("sine", by_A=1, start="cool"), 'Wave.start must be "up" or "down" here, not \'cool\''),
        (lambda: Wave("sine", by_K=1, cut=1), "Wave.cut must be True or False, not 1"),
        (lambda: Icon("x", (Wave("sine", by_K=1, period_s=2),)), "E225 not whole periods"),
        (lambda: Icon("x", (Wave("sine", by_A=1),)), "E210 unit does not fit the control"),
        (lambda: Icon("x", (Step(by_K=1),)), "E223 icon without duration"),
        (lambda: Icon("x", (*HOLD, Total(2))), "E222 total not kept"),
        (lambda: Icon("x", (Ramp("warm", by_K=1, duration_s=1), Play(WAIT))), "E224 play away from baseline"),
        (lambda: Icon("x", (Play(WAIT),), Context("display")), "plays wait, whose context differs"),
        (lambda: Icon("wait", (Play(WAIT),)), "plays two different icons that are both called wait"),
        (lambda: Context("heat"), "control must be one of skin, display, current, not 'heat'"),
        (lambda: Context(baseline_C=99), "baseline_C: 99 °C is outside"),
        (lambda: Context(site="left thumb"), "site: 'left thumb' is not a name"),
        (lambda: Metadata(means=" "), "means: the text is empty"),
        (lambda: Metadata(by="a\x00"), r"by: the text holds the control character U\+0000"),
        (lambda: Metadata(tags="a"), "tags must be a tuple"),
        (lambda: Metadata(tags=("a,b",)), "has a comma"),
        (lambda: Icon("my icon", HOLD), "icon: 'my icon' is not a name"),
        (lambda: Icon("x", ()), "at least one statement"),
        (lambda: Icon("x", (Repeat(2, (Broken(),)),)), "nothing but statements"),
        (lambda: Icon("x", (Return(1),)), "E206 already at baseline"),
        (lambda: Icon("x", (Ramp("warm", to_C=30, duration_s=1),)), "E201 target on the wrong side"),
        (lambda: Icon("x", (Current(1, duration_s=1),)), "E209 to without warm or cool"),
        (lambda: Icon("x", (Repeat(10**6, HOLD),)), "E220 too many corners"),
        (lambda: IconSet("a", "", Context(), Metadata(), ()), "at least one icon"),
        (lambda: IconSet("1", "", Context(), Metadata(), (Icon("x", HOLD),)), "set: '1' is not a name"),
        (lambda: IconSet("a", " ", Context(), Metadata(), (Icon("x", HOLD),)), "title: the text is empty"),
        (lambda: IconSet("a", "", Context(), Metadata(), (Icon("x", HOLD),) * 2), "two icons are called x"),
        (lambda: IconSet("a", "", Context("display"), Metadata(), (Icon("x", HOLD),)), "is not that of the set"),
    ],
)
def test_what_cannot_be_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_numbers_become_floats_and_equal_icons_are_equal() -> None:
    by_hand = Icon("dip", (Ramp("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3)))
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
    drive = Icon("x", (Current(1, duration_s=2),), Context("current"))
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
        Icon("x", (Ramp("cool", by_K=1, duration_s=1), Rest(2)))
    assert len(caught.value.errors) == 1


def test_statements_are_frozen_and_travel() -> None:
    icon = Icon("x", EVERYTHING)
    for part in (*EVERYTHING, icon, IconSet("", "", Context(), Metadata(), (WAIT, icon))):
        for again in (pickle.loads(pickle.dumps(part)), copy.copy(part), copy.deepcopy(part)):
            assert again == part
            assert hash(again) == hash(part)
            assert "\n" not in repr(again)
        name = fields(part)[0].name
        with pytest.raises(FrozenInstanceError, match=f"cannot assign to field '{name}'"):
            setattr(part, name, None)


def test_a_wave_says_which_way_it_starts() -> None:
    assert Wave("sine", by_K=1).start == "warm"
    assert Wave("sine", by_A=1).start == "up"
    assert [Wave("sine", by_K=1, start=way).sign for way in ("warm", "cool")] == [1, -1]  # type: ignore[arg-type]
    assert Wave("sine", by_K=1) == Wave("sine", by_K=1, start="warm")


def test_a_statement_that_could_not_be_read_draws_no_words_about_durations() -> None:
    for body in ("cool by 6 at 3 °C/s; return at 3 °C/s", "hold for 1; step by 1 K; return over 1 s; total 6 s"):
        with pytest.raises(CueErrors, match="E102 missing unit") as caught:
            parse(f"cue 1; icon x {{ {body} }}")
        assert [error.code for error in caught.value.errors] == ["E102"]
