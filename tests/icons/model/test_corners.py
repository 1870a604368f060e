"""Corner points against numbers worked out by hand."""

import math
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from thermicon.icons import CueErrors, Icon, parse
from thermicon.icons.model.corners import Corners
from thermicon.icons.model.statements import Ramp


def icon(body: str, settings: str = "") -> Icon:
    return parse(f"cue 1; set {{ {settings} }}; icon x {{ {body} }}").icons[0]


STEP = "cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s"


def test_the_cooling_step() -> None:
    corners = icon(STEP).corners()
    assert corners == Corners((0.0, 2.0, 6.0, 8.0), (32.0, 26.0, 26.0, 32.0), "temperature_C")
    assert (len(corners), corners.duration_s, corners.lowest, corners.highest) == (4, 8.0, 26.0, 32.0)
    assert corners.steepest_per_s == 3.0
    assert repr(corners) == "Corners(4 corners, 8 s, 26 to 32 °C, at most 3 °C/s)"


def test_times_add_up_exactly() -> None:
    tenths = icon("repeat 30 { hold for 0.1 s }").corners()
    assert tenths == Corners((0.0, 3.0), (32.0, 32.0), "temperature_C")
    stairs = icon("repeat 30 { warm by 0.1 °C over 50 ms; hold for 50 ms }").corners()
    assert (stairs.duration_s, stairs.value[-1], len(stairs)) == (3.0, 35.0, 61)
    minutes = icon("repeat 3 { cool by 1 °C at 1 °C/min; hold for 1 s }").corners()
    assert minutes.time_s == (0.0, 60.0, 61.0, 121.0, 122.0, 182.0, 183.0)


def test_a_staircase_and_absolute_targets() -> None:
    corners = icon(
        "repeat 2 { warm by 1 °C over 1 s; hold for 1 s }; cool to 31 °C at 3 K/s", "baseline 32 °C"
    ).corners()
    assert corners.time_s == (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)
    assert corners.value == (32.0, 33.0, 33.0, 34.0, 34.0, 31.0)


def test_only_straight_neighbours_are_merged() -> None:
    corners = icon(
        "hold for 1 s; hold for 2 s; warm by 1 °C over 1 s; warm by 2 °C over 2 s; warm by 1 °C over 2 s"
    ).corners()
    assert corners.time_s == (0.0, 3.0, 6.0, 8.0)
    assert corners.value == (32.0, 32.0, 35.0, 36.0)


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
    made = icon(
        "to 0.5 A at 1 A/s; hold for 1 s; to -500 mA over 1 s; return at 500 mA/s; rest for 1 s", "control current"
    )
    corners = made.corners()
    assert corners.time_s == (0.0, 0.5, 1.5, 2.5, 3.5, 4.5)
    assert corners.value == (0.0, 0.5, 0.5, -0.5, 0.0, 0.0)
    assert corners.quantity == "current_A"
    assert made.corners(0.1).value == (0.1, 0.5, 0.5, -0.5, 0.1, 0.1)
    with pytest.raises(ValueError, match="start: 30 A is outside the ±20 A"):
        made.corners(30.0)


def test_levels_between_corners() -> None:
    corners = icon(STEP).corners()
    assert [corners.at(t) for t in (-1, 0, 0.5, 2, 7, 8, 9)] == [32.0, 32.0, 30.5, 26.0, 29.0, 32.0, 32.0]
    many = corners.at(np.array([0.5, 7.0]))
    assert many.dtype == np.float64
    assert many.tolist() == [30.5, 29.0]
    with pytest.raises(ValueError, match="not NaN"):
        corners.at(math.nan)


@pytest.mark.parametrize(
    ("times", "values", "quantity", "message"),
    [
        ((0, 1), (1,), "temperature_C", "2 times and 1 values"),
        ((0,), (1,), "temperature_C", "2 or more"),
        ((1, 2), (1, 2), "temperature_C", "begin at 0 s"),
        ((0, 1, 1), (1, 2, 3), "temperature_C", "rise strictly"),
        ((0, 1), (1, math.nan), "temperature_C", "finite"),
        ((0, 1), (1, 2), "warmth", "quantity must be"),
        ((1, 0), (1, 2), "temperature_C", "begin at 0 s and rise"),
    ],
)
def test_corners_prove_themselves(
    times: tuple[float, ...], values: tuple[float, ...], quantity: str, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        Corners(times, values, quantity)  # type: ignore[arg-type]


@pytest.mark.parametrize("steps", [(1,), (-1,), (0, 2)])
def test_a_step_has_a_corner_behind_it(steps: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="must each be a corner that another one follows"):
        Corners((0, 1), (1, 2), "temperature_C", steps)


def test_everything_is_frozen() -> None:
    with pytest.raises(FrozenInstanceError, match="cannot assign"):
        icon(STEP).corners().quantity = "current_A"  # type: ignore[misc]
    with pytest.raises(FrozenInstanceError, match="cannot assign"):
        Ramp("cool", by_K=1, duration_s=1).by_K = 2.0  # type: ignore[misc]
