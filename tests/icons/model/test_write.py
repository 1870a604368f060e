"""Statements built in Python are those that the text gives, in °C and in A."""

import numpy as np
import pytest

from thermicon.icons import (
    Icon,
    back,
    cool,
    current,
    hold,
    parse,
    play,
    pulse,
    ramp,
    repeat,
    rest,
    step,
    total,
    warm,
    wave,
)
from thermicon.icons.model.context import Context
from thermicon.icons.model.statements import Statement


def read(line: str, settings: str = "") -> Statement:
    """The first statement of an icon that goes on so that it can be run."""
    body = f"{line}; hold for 1 s" if line.startswith("step") else line
    return parse(f"cue 1; set {{ {settings} }}; icon x {{ {body} }}").icons[0].statements[0]


@pytest.mark.parametrize(
    ("made", "line"),
    [
        (cool(by=6, at=3), "cool by 6 °C at 3 °C/s"),
        (warm(to=38, over=2), "warm to 38 °C over 2 s"),
        (ramp(by=-6, at=3), "change by -6 °C at 3 °C/s"),
        (ramp(to=26, over=2), "change to 26 °C over 2 s"),
        (hold(4), "hold for 4 s"),
        (rest(0.5), "rest for 500 ms"),
        (step(by=-6), "step by -6 °C"),
        (step(to=26), "step to 26 °C"),
        (pulse(by=-3, duration=0.5), "pulse by -3 °C for 500 ms"),
        (wave("sine", by=3, every=4, duration=12, starting="cool"), "sine by 3 °C every 4 s for 12 s starting cool"),
        (wave("square", by=3, every=4, duration=10, cut=True), "square by 3 °C every 4 s for 10 s cut"),
        (wave("triangle", by=3, every=4, duration=8), "triangle by 3 °C every 4 s for 8 s"),
        (wave("sawtooth", by=3, every=4, duration=8, starting="warm"), "sawtooth by 3 °C every 4 s for 8 s"),
        (repeat(3, hold(1), pulse(by=2, duration=1)), "repeat 3 { hold for 1 s; pulse by 2 °C for 1 s }"),
        (current(to=0.5, at=1), "to 0.5 A at 1 A/s"),
        (current(to=-0.5, over=2), "to -500 mA over 2 s"),
        (step(by_A=-0.5), "step by -0.5 A"),
        (step(to_A=0.5), "step to 0.5 A"),
        (pulse(by_A=0.5, duration=2), "pulse by 0.5 A for 2 s"),
        (wave("sine", by_A=0.5, every=1, duration=3, starting="down"), "sine by 0.5 A every 1 s for 3 s starting down"),
    ],
    ids=repr,
)
def test_a_builder_gives_what_the_text_gives(made: Statement, line: str) -> None:
    assert made == read(line, "control current" if " A " in f"{line} " or "mA" in line else "")


def test_an_icon_of_builders_is_the_icon_of_the_text() -> None:
    made = Icon("dip", [cool(by=6, at=3), hold(4), back(at=3)])
    assert made == parse("cue 1; icon dip { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }").icons[0]
    played = Icon("twice", [repeat(2, play(made), rest(1)), total(18), total(20, "at most"), total(1, "at least")])
    text = (
        "cue 1; icon dip { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }\n"
        "icon twice { repeat 2 { play dip; rest for 1 s }; total 18 s; total at most 20 s; total at least 1 s }"
    )
    assert played == parse(text)["twice"]
    assert Icon("a", [current(to=1, over=1), back(over=2)], Context("current")).corners().duration_s == 3.0


def test_numbers_of_any_kind_become_floats() -> None:
    for value in (np.float32(2), np.int64(2), 2):
        assert hold(value) == hold(2.0)  # type: ignore[arg-type]
        assert type(hold(value).duration_s) is float  # type: ignore[arg-type]
    assert repeat(np.int64(3), hold(1)).count == 3  # type: ignore[arg-type]
