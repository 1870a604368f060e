"""The nearest cue that a rig reaches."""

import pytest

from tests.circuit.delivery.one_drive import icon_of
from thermicon.circuit import Rig, nearest_reachable, simulate
from thermicon.circuit.delivery.nearest import changed
from thermicon.icons import load_library, parse

THENAR = Rig.load("thenar")
WEAK = THENAR.with_(**{"driver.current_limit_A": 1.0})
STEP = load_library("cooling-step-skin").icons[0]


def test_the_nearest_is_reached_and_a_little_more_is_not() -> None:
    nearest = nearest_reachable(STEP, WEAK)
    assert simulate(nearest.icon, WEAK).reachable
    assert nearest.slower == 1.0
    assert not simulate(changed(STEP, 32.0, smaller=nearest.smaller * 1.03), WEAK).reachable
    said = "it is reached with its changes 0.8 times as large, in the same time: cool by 6 °C at 3 °C/s → "
    assert nearest.sentence == f"{said}cool by 4.8 °C at 2.4 °C/s; return at 3 °C/s → return at 2.4 °C/s"


def test_changes_keep_their_durations_and_levels() -> None:
    icon = icon_of("repeat 2 { cool to 28 °C at 2 °C/s; hold for 1 s; return over 3 s }")
    smaller = changed(icon, 32.0, smaller=0.5).corners(32.0)
    assert smaller.time_s == icon.corners(32.0).time_s
    assert smaller.value == pytest.approx([32, 30, 30, 32, 30, 30, 32])
    slower = changed(icon, 32.0, slower=2.0).corners(32.0)
    assert slower.time_s == pytest.approx([0, 4, 5, 11, 15, 16, 22])
    assert slower.value == icon.corners(32.0).value


def test_an_icon_that_plays_another_plays_it_as_often_as_before() -> None:
    twice = parse(
        "cue 1\nicon a { cool by 4 °C at 2 °C/s; return at 2 °C/s }\nicon b { play a; hold for 1 s; play a }"
    )["b"]
    smaller, known = changed(twice, 32.0, smaller=0.5).corners(32.0), twice.corners(32.0)
    assert (smaller.time_s, min(smaller.value)) == (known.time_s, pytest.approx(30.0))


def test_what_is_reached_has_none_nor_what_cannot_begin_nor_a_current() -> None:
    assert nearest_reachable(STEP, THENAR) is None
    assert nearest_reachable(STEP, THENAR.with_(**{"driver.current_limit_A": 0.01})) is None
    icon = icon_of("to 3 A at 1 A/s; return at 1 A/s", "current")
    assert not simulate(icon, THENAR).reachable
    assert nearest_reachable(icon, THENAR) is None


@pytest.mark.parametrize(
    ("body", "control", "changes"),
    [
        ("warm by 3 °C at 2 °C/s; hold for 2 s", "skin", {"driver.current_min_A": 0.0}),
        ("cool by 6 °C at 3 °C/s; hold for 4 s", "skin", {"driver.current_limit_A": 0.3}),
        ("cool by 5 °C at 50 °C/s; hold for 1 s", "display", {}),
        ("cool by 3 °C at 8 °C/s; hold for 1 s", "skin", {}),  # its ramps slower, all others smaller
    ],
)
def test_the_number_as_printed_is_reached(body: str, control: str, changes: dict[str, float]) -> None:
    rig, icon = THENAR.with_(**changes), icon_of(body, control)
    nearest = nearest_reachable(icon, rig)
    printed = float(f"{nearest.smaller:.3g}")
    assert printed == pytest.approx(nearest.smaller, rel=1e-12)
    assert simulate(changed(icon, 32.0, slower=float(f"{nearest.slower:.3g}"), smaller=printed), rig).reachable
    text = str(icon)
    for old, new in (line.split(" → ") for line in nearest.lines):
        text = text.replace(old, new)
    assert nearest.lines and simulate(parse(text).icons[0], rig).reachable
