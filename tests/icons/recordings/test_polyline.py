"""Corners of recordings at the true places and within the tolerance."""

import warnings
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from tests.properties import for_any
from thermicon.icons import from_samples
from thermicon.icons.recordings.polyline import fit_corners, noise

Array = NDArray[np.float64]
Corners = tuple[tuple[float, ...], tuple[float, ...]]

STEP: Corners = ((0.0, 2.0, 4.0, 8.0, 10.0, 12.0), (32.0, 32.0, 26.0, 26.0, 32.0, 32.0))
ODD: Corners = ((0.0, 1.03, 2.234, 3.4, 4.125, 6.0), (32.0, 32.0, 26.125, 31.4, 32.0, 32.0))
RAMPS: Corners = ((0.0, 1.5, 4.5, 6.0), (33.0, 30.2, 35.4, 33.0))


def sampled(corners: Corners, rate_Hz: float) -> tuple[Array, Array]:
    """A course read so many times a second, the end included."""
    time = np.arange(round(corners[0][-1] * rate_Hz) + 1) / rate_Hz
    return time, np.interp(time, *corners)


def farthest(time: Array, value: Array, corners: Corners) -> float:
    """Largest distance of a reading from the polyline; at a step, from the nearer side of it."""
    times, values = (np.array(each) for each in corners)
    parts = np.split(np.arange(len(times)), np.flatnonzero(np.diff(times) == 0) + 1)
    off = np.full(len(time), np.inf)
    for part in parts:
        inside = (time >= times[part[0]] - 1e-9) & (time <= times[part[-1]] + 1e-9)
        off[inside] = np.minimum(off[inside], np.abs(np.interp(time, times[part], values[part]) - value)[inside])
    return float(off.max())


@pytest.mark.parametrize("rate_Hz", [10, 100, 1000])
@pytest.mark.parametrize("corners", [STEP, ODD, RAMPS])
def test_a_course_without_noise_is_found_exactly(corners: Corners, rate_Hz: float) -> None:
    time, value = sampled(corners, rate_Hz)
    found = fit_corners(time, value, 0.05)
    if set(corners[0]) <= set(time):
        assert found == corners
    # Below the readings beside it a corner would be a temperature that nobody read.
    assert np.interp(time, *found) == pytest.approx(value, abs=0.05)
    assert min(found[1]) >= min(value) and len(found[0]) <= len(corners[0]) + 2


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("corners", [STEP, RAMPS])
@pytest.mark.parametrize("size", [0.02, 0.04])
def test_a_course_is_found_under_noise(corners: Corners, size: float, seed: int) -> None:
    time, value = sampled(corners, 100)
    found = fit_corners(time, value + np.random.default_rng(seed).uniform(-size, size, len(value)), 0.05)
    assert len(found[0]) == len(corners[0])
    assert found[0] == pytest.approx(corners[0], abs=0.02)
    assert found[1] == pytest.approx(corners[1], abs=0.02)
    # Holds are flat and levels that return are one level, to the last digit.
    assert np.array_equal(np.diff(found[1]) == 0, np.diff(corners[1]) == 0)
    assert (found[1][-1] == found[1][0]) == (corners[1][-1] == corners[1][0])


def test_a_smooth_course_takes_few_corners() -> None:
    time = np.arange(6001) / 100
    value = 32 - 6 * (1 - np.exp(-time / 5))
    found = fit_corners(time, value, 0.05)
    assert farthest(time, value, found) <= 0.05
    # Straight pieces within ±e of a curve: the integral of √(|v''| / 16 e), here 5.5, and one more corner than pieces.
    # The fewest are 7; cuts at the farthest reading and least squares come close to that.
    assert len(found[0]) <= 8


@pytest.mark.parametrize(
    ("time", "value", "expected"),
    [
        # A time that stands twice is a step, unless both readings agree.
        ([0, 1, 1, 2, 7, 7, 9], [32, 32, 26, 26, 26, 32, 32], ([0, 1, 1, 2, 7, 7, 9], [32, 32, 26, 26, 26, 32, 32])),
        ([0, 0, 5, 5], [32, 30, 30, 31], ([0, 0, 5, 5], [32, 30, 30, 31])),
        ([0, 1, 1, 2], [32.01, 32.03, 31.97, 31.99], ([0, 2], [32, 32])),
        # With corners anywhere, a spike between the two readings of the hold would need fewer of them.
        ([0, 1, 3, 7, 9, 10], [32, 32, 26, 26, 32, 32], ([0, 1, 3, 7, 9, 10], [32, 32, 26, 26, 32, 32])),
        # A gap is longer than three usual steps, and has a corner at each end.
        ([0, 1, 2, 3, 6, 7, 8], [32, 32, 30, 30, 30, 30, 30], ([0, 1, 2, 8], [32, 32, 30, 30])),
        ([0, 1, 2, 3, 6.01, 7, 8], [32, 32, 30, 30, 30, 30, 30], ([0, 1, 2, 3, 6.01, 8], [32, 32, 30, 30, 30, 30])),
    ],
)
def test_corners_of_few_readings(time: ArrayLike, value: ArrayLike, expected: tuple[list[float], list[float]]) -> None:
    assert fit_corners(time, value, 0.05) == tuple(tuple(map(float, each)) for each in expected)


def test_a_noisy_hold_is_one_flat_piece_and_its_scatter_is_told() -> None:
    time = np.arange(3000) / 100
    readings = 31.7 + np.random.default_rng(1).uniform(-0.049, 0.049, len(time))
    assert fit_corners(time, readings, 0.05) == ((0.0, 29.99), (31.7, 31.7))
    time = np.arange(20_000) / 1000
    readings = 32 + 3 * np.sin(time) + np.random.default_rng(0).normal(0, 0.03, len(time))
    assert noise(readings) == pytest.approx(0.03, rel=0.05)


def test_a_jump_between_two_readings_takes_one_interval() -> None:
    time = np.arange(1001) / 100
    value = np.where((time >= 2) & (time < 8), 26.0, 32.0)
    expected = (0.0, 1.99, 2.0, 7.99, 8.0, 10.0), (32.0, 32.0, 26.0, 26.0, 32.0, 32.0)
    assert fit_corners(time, value, 0.05) == expected
    shaken = value + np.random.default_rng(0).uniform(-0.03, 0.03, len(time))
    assert fit_corners(time, shaken, 0.05) == expected


def test_levels_close_to_one_another_become_one() -> None:
    bumpy: Corners = ((0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10), (32, 29, 29, 32.01, 32.01, 29.01, 29.01, 32, 32.0, 30, 31.96))
    values = fit_corners(*sampled(bumpy, 50), 0.05)[1]
    assert len(set(values)) == 3
    assert values[0] == values[-1] == values[3]


def test_the_first_value_can_be_prescribed() -> None:
    time, value = sampled(STEP, 100)
    found = fit_corners(time, value + 0.03, 0.05, start=32)
    assert found[1][0] == found[1][1] == found[1][-1] == 32
    assert farthest(time, value + 0.03, found) <= 0.05


def test_noise_near_the_tolerance_takes_few_corners_more() -> None:
    lengths = np.cumsum([0, 289, 164, 221, 247, 112, 99, 115, 247]) / 100
    corners: Corners = (tuple(lengths), (27.7, 36.8, 36.8, 31.9, 35.3, 35.3, 35.5, 32.6, 27.5))
    time, value = sampled(corners, 200)
    value = value + np.random.default_rng(6509).uniform(-0.45, 0.45, len(value))
    found = fit_corners(time, value, 0.5)
    assert farthest(time, value, found) <= 0.5 * (1 + 1e-9)
    assert len(found[0]) <= len(corners[0]) + 2


@st.composite
def recordings(draw: st.DrawFn) -> tuple[Corners, Array, Array, float]:
    """A random course of up to eight pieces, read at a steady rate but for gaps, with noise below the tolerance."""
    lengths = draw(st.lists(st.integers(20, 300), min_size=1, max_size=8))
    levels = draw(st.lists(st.integers(220, 400), min_size=len(lengths) + 1, max_size=len(lengths) + 1))
    still = draw(st.lists(st.booleans(), min_size=len(lengths), max_size=len(lengths)))
    for n, stays in enumerate(still):
        levels[n + 1] = levels[n] if stays else levels[n + 1]
    corners: Corners = (tuple(np.cumsum([0, *lengths]) / 100), tuple(level / 10 for level in levels))
    tolerance = draw(st.sampled_from([0.02, 0.05, 0.1, 0.5]))
    time, value = sampled(corners, draw(st.sampled_from([20, 50, 100, 200])))
    size = draw(st.sampled_from([0.0, 0.2, 0.6, 0.9])) * tolerance
    random = np.random.default_rng(draw(st.integers(0, 10_000)))
    value = value + random.uniform(-size, size, len(value))
    kept = np.full(len(time), True)
    for begin in random.uniform(0, 0.8 * time[-1], draw(st.integers(0, 2))):
        kept[1:-1] &= ((time < begin) | (time > begin + random.uniform(0.0, 0.4) * time[-1]))[1:-1]
    return corners, time[kept], value[kept], tolerance


@for_any(recordings(), examples=300)
def test_an_icon_never_leaves_its_readings(recording: tuple[Corners, Array, Array, float]) -> None:
    _, time, value, tolerance = recording
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        course = from_samples(time, value, tolerance_K=tolerance).corners()
    at, level = np.array(course.time_s), np.array(course.value)
    assert value.min() - 1e-9 <= level.min() and level.max() <= value.max() + 1e-9
    every = np.union1d(time, at)
    off = np.interp(every, at, level) - np.interp(every, time, value)
    assert np.abs(off).max() <= tolerance + 1e-6
    assert (at[0], at[-1]) == pytest.approx((time[0], time[-1]), abs=1e-6)
    steps = np.diff(time)
    gaps = np.flatnonzero(steps > 3.01 * np.median(steps))
    assert set(time[gaps]) | set(time[gaps + 1]) <= set(fit_corners(time, value, tolerance)[0])
    notes = [str(note.message) for note in said if "without readings" in str(note.message)]
    assert len(notes) == bool(gaps.size) and all(f"of {steps[gaps].max():.6g} s from" in note for note in notes)


@for_any(recordings(), examples=150)
def test_there_are_few_corners_more_than_the_course_had(recording: tuple[Corners, Array, Array, float]) -> None:
    corners, time, value, tolerance = recording
    gaps = int((np.diff(time) > 3.01 * np.median(np.diff(time))).sum())
    found = fit_corners(time, value, tolerance)
    assert all(a < b for a, b in pairwise(found[0]))
    assert len(found[0]) <= 2 * len(corners[0]) + 2 * gaps


@for_any(
    st.lists(st.tuples(st.integers(0, 50), st.integers(2000, 4000)), min_size=2, max_size=40),
    st.sampled_from([0.01, 0.3, 2.0]),
    examples=150,
)
def test_any_recording_is_followed_within_the_tolerance(rows: list[tuple[int, int]], tolerance: float) -> None:
    rows = sorted(rows, key=lambda row: row[0])
    rows = [row for n, row in enumerate(rows) if n < 2 or rows[n - 2][0] != row[0]]
    time, value = (np.array(column) for column in zip(*rows, strict=True))
    time, value = time / 8, value / 100
    if time[0] == time[-1]:
        return
    found = fit_corners(time, value, tolerance)
    assert farthest(time, value, found) <= tolerance * (1 + 1e-9)
    assert all(a <= b for a, b in pairwise(found[0]))
