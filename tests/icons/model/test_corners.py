"""Corner points against numbers worked out by hand."""

import math
from itertools import pairwise
from typing import get_args

import numpy as np
import pytest

from tests.builders import messages
from thermicon.icons import CueErrors, Icon, parse, pulse, step, wave
from thermicon.icons.model.corners import STEP_S, Corners
from thermicon.icons.model.statements import Shape, Statement, Wave


def icon(body: str, settings: str = "") -> Icon:
    return parse(f"cue 1; set {{ {settings} }}; icon x {{ {body} }}").icons[-1]


def corners_of(body: str, settings: str = "") -> Corners:
    return icon(body, settings).corners()


def nominal(corners: Corners) -> list[tuple[float, float]]:
    """Times and levels with the two ends of each step at one time again."""
    times = list(corners.time_s)
    for place in corners.steps:
        end = times[-1] - times[place + 1] < STEP_S / 2  # the last step ends on time, all others begin on time
        times[place if end else place + 1] = times[place + 1 if end else place]
    return [(round(time, 9), value) for time, value in zip(times, corners.value, strict=True)]


CASES = messages(__file__, "cases.toml")


@pytest.mark.parametrize("body", CASES["corners"])
def test_corners_by_hand(body: str) -> None:
    assert nominal(corners_of(body)) == [(time, level) for time, level in CASES["corners"][body]]


@pytest.mark.parametrize("shape", get_args(Shape))
def test_of_whole_periods_nothing_is_cut(shape: str) -> None:
    wave = f"{shape} by 3 °C every 0.7 s for 2.1 s"
    assert corners_of(f"{wave} cut") == corners_of(wave)


def test_where_a_cut_sine_stops() -> None:
    for time in (0.1, 1.0, 1.7, 2.0, 3.3, 5.9):
        corners = corners_of(f"sine by 3 °C every 4 s for {time} s cut")
        assert corners.time_s[-1] == time
        assert corners.value[-1] == pytest.approx(32 + 3 * math.sin(2 * math.pi * time / 4), abs=5e-9)


@pytest.mark.parametrize("size", [0.01, 0.5, 3, 10])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-3, 0.02])
def test_a_sine_lies_within_its_tolerance(size: float, tolerance: float) -> None:
    made = Icon("x", [wave("sine", by=size, every=4, duration=8, starting="cool")])
    corners = made.corners(tolerance=tolerance)
    time = np.linspace(0, 8, 200_001)
    error = np.abs(np.interp(time, corners.time_s, corners.value) - (32 - size * np.sin(2 * np.pi * time / 4)))
    assert error.max() <= tolerance * 1.001 + 2e-9 * size
    assert (corners.lowest, corners.highest) == (pytest.approx(32 - size, abs=1e-8), pytest.approx(32 + size, abs=1e-8))
    # The best polyline with ends on the curve has a count that rises with the square root of size over tolerance.
    assert len(corners) <= 2 * 4 * math.ceil(0.75 * math.sqrt(size / tolerance) + 1.5) + 1
    assert (made.corners() == corners) == (tolerance == 1e-3), "the default is a millikelvin"
    with pytest.raises(ValueError, match="tolerance = 0 must lie above 0 and below 10"):
        made.corners(tolerance=0)


def test_steps_are_marked_and_take_a_tenth_of_a_microsecond() -> None:
    corners = corners_of("hold for 1 s; step by 3 °C; hold for 1 s; step by -1 °C")
    assert (STEP_S, corners.steps) == (1e-7, (1, 3))
    assert corners.time_s == (0.0, 1.0, 1.0 + STEP_S, 2.0 - STEP_S, 2.0)
    assert corners.duration_s == 2.0
    assert corners.steepest_per_s == 0.0


@pytest.mark.parametrize(
    "body",
    [
        "square by 3 K every 4 s for 2.00000001 s cut",
        "square by 3 K every 4 s for 2.0000000000000004 s cut",
        "step by 3 K; sine by 3 K every 0.000001 s for 0.000002 s",
        "sine by 3 K every 4 s for 1.00000001 s cut; step to 40 °C",
        "square by 1 K every 0.000001 s for 0.000003 s",
        "hold for 3599 s; square by 1 K every 1 s for 0.5000000000000001 s cut",
    ],
)
def test_pieces_shorter_than_a_step_keep_their_order(body: str) -> None:
    corners = corners_of(body)
    assert all(a < b for a, b in pairwise(corners.time_s))
    assert corners.steps


def test_a_played_icon_stands_for_its_statements() -> None:
    text = "cue 1\nicon a { pulse by 1 K for 1 s; rest for 1 s }\nicon b { repeat 2 { play a }; hold for 1 s }"
    assert parse(text)["b"].corners() == corners_of("repeat 2 { pulse by 1 K for 1 s; rest for 1 s }; hold for 1 s")


STEP = "cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s"


def test_the_cooling_step() -> None:
    corners = icon(STEP).corners()
    assert corners == Corners((0.0, 2.0, 6.0, 8.0), (32.0, 26.0, 26.0, 32.0), "temperature_C")
    assert (len(corners), corners.duration_s, corners.lowest, corners.highest) == (4, 8.0, 26.0, 32.0)
    assert corners.steepest_per_s == 3.0


def test_times_add_up_exactly() -> None:
    tenths = icon("repeat 30 { hold for 0.1 s }").corners()
    assert tenths == Corners((0.0, 3.0), (32.0, 32.0), "temperature_C")
    stairs = icon("repeat 30 { warm by 0.1 °C over 50 ms; hold for 50 ms }").corners()
    assert (stairs.duration_s, stairs.value[-1], len(stairs)) == (3.0, 35.0, 61)
    minutes = icon("repeat 3 { cool by 1 °C at 1 °C/min; hold for 1 s }").corners()
    assert minutes.time_s == (0.0, 60.0, 61.0, 121.0, 122.0, 182.0, 183.0)
    for shape in get_args(Shape):
        short = Wave(shape, by_K=1, period_s=0.1, duration_s=0.7)
        body: list[Statement] = [pulse(by=1, duration=0.1), short, step(by=1)]
        assert Icon("x", [*body * 10, wave("square", by=1, every=0.3, duration=0.9)]).corners().duration_s == 8.9


def test_the_baseline_comes_from_the_frame_then_from_the_caller() -> None:
    assert icon(STEP, "baseline 30 °C").corners(35.0).value[0] == 30.0
    assert icon(STEP).corners(35.0).value == (35.0, 29.0, 29.0, 35.0)
    assert icon(STEP).corners().value[0] == 32.0
    with pytest.raises(ValueError, match="start: 99 °C is outside"):
        icon(STEP).corners(99.0)


def test_a_start_that_turns_a_target_round_is_told() -> None:
    made = icon("cool to 30 °C at 3 °C/s")
    with pytest.raises(CueErrors, match=r"<icon x>:1:.*E201(?s:.)*30 °C is above the 28 °C"):
        made.corners(28.0)
    with pytest.raises(CueErrors, match="this leads to -11 °C"):
        icon("cool by 6 °C at 3 °C/s; cool by 20 °C at 3 °C/s").corners(15.0)


def test_currents() -> None:
    made = icon("to 0.5 A at 1 A/s; hold for 1 s; to -500 mA over 1 s; return at 500 mA/s", "control current")
    assert made.corners() == Corners((0.0, 0.5, 1.5, 2.5, 3.5), (0.0, 0.5, 0.5, -0.5, 0.0), "current_A")
    assert made.corners(0.1).value == (0.1, 0.5, 0.5, -0.5, 0.1)
    with pytest.raises(ValueError, match="start: 30 A is outside the ±20 A"):
        made.corners(30.0)
    shapes = "step to 0.5 A; hold for 1 s; triangle by 0.5 A every 1 s for 1 s; return at 1 A/s"
    expected = [(0, 0), (0, 0.5), (1, 0.5), (1.25, 1), (1.75, 0), (2, 0.5), (2.5, 0)]
    assert nominal(corners_of(shapes, "control current")) == expected
    sine, time = icon("sine by 0.5 A every 1 s for 1 s", "control current").corners(), np.linspace(0, 1, 9999)
    assert np.abs(np.interp(time, sine.time_s, sine.value) - 0.5 * np.sin(2 * np.pi * time)).max() <= 1.001e-3
