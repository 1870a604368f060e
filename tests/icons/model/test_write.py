"""Statements built in Python are those that the text gives, and mistakes are told in the caller's own words."""

from collections.abc import Callable

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
    ],
    ids=repr,
)
def test_a_builder_gives_what_the_text_gives(made: Statement, line: str) -> None:
    assert made == read(line)


@pytest.mark.parametrize(
    ("made", "line"),
    [
        (current(to=0.5, at=1), "to 0.5 A at 1 A/s"),
        (current(to=-0.5, over=2), "to -500 mA over 2 s"),
        (step(by_A=-0.5), "step by -0.5 A"),
        (step(to_A=0.5), "step to 0.5 A"),
        (pulse(by_A=0.5, duration=2), "pulse by 0.5 A for 2 s"),
        (wave("sine", by_A=0.5, every=1, duration=3, starting="down"), "sine by 0.5 A every 1 s for 3 s starting down"),
    ],
    ids=repr,
)
def test_amperes(made: Statement, line: str) -> None:
    assert made == read(line, "control current")


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


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cool(at=3), r"cool\(\) needs either by or to$"),
        (lambda: cool(by=6, to=26, at=3), r"cool\(\) takes only one of by and to$"),
        (lambda: warm(by=6), r"warm\(\) needs either at or over$"),
        (lambda: ramp(by=6, at=1, over=2), r"ramp\(\) takes only one of at and over$"),
        (lambda: cool(by=-6, at=3), r"cool\(by=-6\): a change has a positive size; its direction is in the word"),
        (lambda: ramp(by=0, at=3), r"ramp\(by=0\): a change must not be zero"),
        (lambda: warm(to=70, at=3), r"warm\(to=70\): 70 °C is outside the −10 to 60 °C"),
        (lambda: warm(by=1, at=0), r"warm\(at=0\): a rate is positive"),
        (lambda: current(to=30, at=1), r"current\(to=30\): 30 A is outside the ±20 A"),
        (lambda: current(to=None, at=1), r"current\(\) needs to$"),
        (lambda: current(to=1), r"current\(\) needs either at or over"),
        (lambda: hold("4 s"), r"hold\(duration='4 s'\): a number is needed, in s$"),
        (lambda: hold(True), r"hold\(duration=True\): a number is needed, in s$"),
        (lambda: hold(None), r"hold\(\) needs duration$"),
        (lambda: rest(4000), r"rest\(duration=4000\): 4000 s is more than the hour"),
        (lambda: back(), r"back\(\) needs either at or over"),
        (lambda: back(over=-1), r"back\(over=-1\): a time is positive"),
        (lambda: step(), r"step\(\) needs either by, to, by_A or to_A$"),
        (lambda: step(by=1, to=2, by_A=3), r"step\(\) takes only one of by, to and by_A$"),
        (lambda: step(by_A=0), r"step\(by_A=0\): a change must not be zero"),
        (lambda: pulse(by=1, by_A=1, duration=1), r"pulse\(\) takes only one of by and by_A"),
        (lambda: pulse(by=1, duration=0), r"pulse\(duration=0\): a time is positive"),
        (lambda: wave("sine", by=-3, every=4, duration=4), r"wave\(by=-3\): a change has a positive size"),
        (
            lambda: wave("sine", by_A=-3, every=4, duration=4),
            r'by_A=-3\): an amplitude is positive; .*starting="down"',
        ),
        (
            lambda: wave("square", by=3, every=4, duration=4, starting="up"),
            r"starting='up'\): \"warm\" or \"cool\"",
        ),
        (
            lambda: wave("sawtooth", by_A=3, every=4, duration=4, starting="cool"),
            r"='cool'\): \"up\" or \"down\"",
        ),
        (lambda: wave("triangle", by=3, every=4, duration=4, cut=1), r"wave\(cut=1\): True or False is needed"),
        (lambda: wave("triangle", by=3, every=0, duration=4), r"wave\(every=0\): a time is positive"),
        (lambda: wave("saw", by=3, every=4, duration=4), r"wave\('saw'\): \"sine\", \"square\""),  # type: ignore[arg-type]
        (lambda: repeat(3), r"repeat\(\) needs statements after the count"),
        (lambda: repeat(2.5, hold(1)), r"repeat\(count=2.5\): 2.5 is not a positive whole number"),
        (lambda: repeat("3", hold(1)), r"repeat\(count='3'\): a number is needed$"),
        (lambda: repeat(3, [hold(1)]), r"repeat\(\): \[Hold.* is not a statement"),
        (lambda: repeat(3, total(1)), r"repeat\(\): total\(\) concerns the whole icon"),
        (lambda: play("dip"), r"play\(\) needs an Icon, not 'dip'"),
        (lambda: total(10, "about"), r"total\(bound='about'\): \"exactly\", \"at most\" or \"at least\""),
    ],
)
def test_mistakes_are_told_in_the_words_of_the_call(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()
