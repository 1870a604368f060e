"""Objects built in Python."""

import copy
import pickle
from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest

from tests.builders import messages
from thermicon.icons import CueErrors, Icon, IconSet, back, cool, current, hold, load_library, parse, play, repeat, rest
from thermicon.icons.model import builders, statements
from thermicon.icons.model.builders import total
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.corners import Corners
from thermicon.icons.model.statements import Hold, Play, Pulse, Ramp, Repeat, Rest, Return, Statement, Step, Total, Wave

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


MESSAGES = messages(__file__)


@pytest.mark.parametrize("made", MESSAGES["refused"])
def test_what_cannot_be_is_refused(made: str) -> None:
    with pytest.raises(ValueError, match=MESSAGES["refused"][made]):
        eval(made, {**vars(statements), **globals(), "Corners": Corners})


def test_statements_know_where_they_stood() -> None:
    read = parse("cue 1\nicon dip {\n  hold for 1 s\n  repeat 2 { rest for 1 s }\n}").icons[0]
    repeat = read.statements[1]
    assert isinstance(repeat, Repeat)
    assert (read.statements[0].span, repeat.span, repeat.body[0].span) == ((3, 3), (4, 3), (4, 14))


def test_a_set_is_looked_up_by_name() -> None:
    icons = load_library("six-icons")
    assert len(icons) == len(list(icons)) == 6
    assert "cooling-step" in icons and icons.icons[0] in icons and "nothing" not in icons
    with pytest.raises(KeyError, match=r"no icon is called 'coolingstep'; did you mean cooling-step\? the set has: c"):
        icons["coolingstep"]
    assert repr(icons["cooling-step"]) == "<Icon cooling-step: 8 s, 26 to 32 °C, at most 3 °C/s, control display>"
    assert repr(Icon("x", HOLD)).endswith("control skin, baseline 32 °C assumed>")


def test_errors_of_an_icon_show_its_canonical_text() -> None:
    told = r"<icon x>:1:1  E205 (?s:.)*1 \| rest for 2 s\n    \| \^{12} the level is 31"
    with pytest.raises(CueErrors, match=told) as caught:
        Icon("x", (Ramp("cool", by_K=1, duration_s=1), Rest(2)))
    assert len(caught.value.errors) == 1


def test_statements_are_frozen_and_travel() -> None:
    icon = Icon("x", EVERYTHING)
    space = load_library("search-space")
    made = IconSet("", "", Context(), Metadata(), (WAIT, icon))
    for part in (*EVERYTHING, icon, made, space, space.families[0], space.families[0][3]):
        for again in (pickle.loads(pickle.dumps(part)), copy.copy(part), copy.deepcopy(part)):
            assert again == part
            assert hash(again) == hash(part)
            assert "\n" not in repr(again)
        name = fields(part)[0].name
        with pytest.raises(FrozenInstanceError, match=f"cannot assign to field '{name}'"):
            setattr(part, name, None)


def read(line: str, settings: str = "") -> Statement:
    """The first statement of an icon that goes on so that it can be run."""
    body = f"{line}; hold for 1 s" if line.startswith("step") else line
    return parse(f"cue 1; set {{ {settings} }}; icon x {{ {body} }}").icons[0].statements[0]


BUILDERS = messages(__file__, "cases.toml")["builders"]


@pytest.mark.parametrize("made", BUILDERS)
def test_a_builder_gives_what_the_text_gives(made: str) -> None:
    line = BUILDERS[made]
    settings = "control current" if " A " in f"{line} " or "mA" in line else ""
    assert eval(made, dict(vars(builders))) == read(line, settings)


def test_an_icon_of_builders_is_the_icon_of_the_text() -> None:
    made = Icon("dip", [cool(by=6, at=3), hold(4), back(at=3)])
    played = Icon("twice", [repeat(2, play(made), rest(1)), total(18), total(20, "at most"), total(1, "at least")])
    text = (
        "cue 1; icon dip { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }\n"
        "icon twice { repeat 2 { play dip; rest for 1 s }; total 18 s; total at most 20 s; total at least 1 s }"
    )
    assert (made, played) == tuple(parse(text).icons)
    assert Icon("a", [current(to=1, over=1), back(over=2)], Context("current")).corners().duration_s == 3.0


def test_numbers_of_any_kind_become_floats_and_equal_icons_are_equal() -> None:
    for value in (np.float32(2), np.int64(2), 2):
        assert hold(value) == hold(2.0)  # type: ignore[arg-type]
        assert type(hold(value).duration_s) is float  # type: ignore[arg-type]
    assert repeat(np.int64(3), hold(1)).count == 3  # type: ignore[arg-type]
    by_hand = Icon("dip", (Ramp("cool", by_K=6, rate_K_per_s=3), Hold(4), Return(3)))
    text = "cue 1\nicon dip {\n cool by 6 K at 3 K/s; hold for 4000 ms\n return at 180 °C/min }"
    assert by_hand == parse(text).icons[0] and hash(by_hand) == hash(parse(text).icons[0])
