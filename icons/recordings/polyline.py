"""Few corner points for a recording: straight pieces that stay within a tolerance of every reading.

Ramer, Douglas and Peucker's cuts come first, at twice the tolerance, since noise may reach the tolerance on both sides.
Then the pieces become lines of least squares, what leaves the tolerance is cut again, and what is not needed goes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .course import SPARE, Array, Course, Path, course_of

MOST_CORNERS = 500
"""Corners of an icon that is made of a recording: more than anybody edits."""
_MOST_DECIMALS = 12


def fit_corners(
    time_s: Sequence[float] | Array,
    value: Sequence[float] | Array,
    tolerance: float,
    start: float | None = None,
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return times (s) and values of corners whose polyline lies within ``tolerance`` of every reading.

    ``time_s`` and ``value`` have the shape (readings,); a time that stands twice with two values further apart than the
    tolerance bridges is a step, and two corners then have that time. Beside few corners, exact holds, levels that
    return and short decimals are preferred, as far as the tolerance allows. ``start`` prescribes the first value.

    Times rise or stand twice and all numbers are finite, as `read_readings` gives them. Raises ValueError when 500
    corners are not enough.

    >>> fit_corners([0, 1, 2, 3, 4, 5], [32.01, 31.99, 29, 26, 26.01, 25.99], tolerance=0.05)
    ((0.0, 1.0, 3.0, 5.0), (32.0, 32.0, 26.0, 26.0))
    """
    time, reading = np.array(time_s, dtype=np.float64), np.array(value, dtype=np.float64)
    course = course_of(time, reading, tolerance, start)
    path = _sparse(course, _inside(course))
    if len(path[0]) > MOST_CORNERS:
        raise ValueError(_too_many(reading, tolerance))
    times, values = _rounded(course, _shared(course, path, tolerance), tolerance)
    flat = np.diff(values) == 0
    corner = np.concatenate(([True], ~(flat[1:] & flat[:-1]), [True]))
    return tuple(times[corner].tolist()), tuple((values[corner] + 0.0).tolist())


def noise(value: Array) -> float:
    """Return the standard deviation of readings about a smooth course, from their second differences.

    >>> noise(np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    0.0
    """
    bends = np.abs(np.diff(value, 2))
    return float(np.median(bends)) / (0.6745 * math.sqrt(6)) if bends.size else 0.0


def _inside(course: Course) -> Path:
    """Return a path that keeps to the course, or one of more corners than are allowed."""
    cuts = course.cuts(2.0)
    while len(cuts) <= MOST_CORNERS:
        path = course.fit(course.time[cuts])
        if course.holds(path):
            return path
        worst = course.worst(path)
        more = np.union1d(cuts, worst)
        if len(more) == len(cuts):  # the worst readings are corners already: halve the pieces beside them
            at = np.searchsorted(cuts, worst)
            beside = np.stack([cuts[np.maximum(at - 1, 0)], cuts[np.minimum(at + 1, len(cuts) - 1)]])
            more = np.union1d(cuts, (beside + worst) // 2)
        if len(more) == len(cuts):
            break
        cuts = more
    cuts = course.cuts(1.0)
    return course.time[cuts], course.value[cuts]


def _sparse(course: Course, path: Path) -> Path:
    """Return the path without the corners that it can do without."""
    fixed, k = set(course.time[course.fixed].tolist()), 1
    while k < len(path[0]) - 1 <= 4 * MOST_CORNERS:
        shorter = course.fit(np.delete(path[0], k)) if path[0][k] not in fixed else path
        if shorter is not path and course.holds(shorter):
            path, k = shorter, max(k - 1, 1)
        else:
            k += 1
    return path


def _shared(course: Course, path: Path, tolerance: float) -> Path:
    """Return the path with corners on one level that are within the tolerance of one another, as far as it holds."""
    times, values = path
    level = np.arange(len(values))
    order = np.argsort(values, kind="stable").tolist()
    lowest = order[0]
    for corner in order:
        lowest = lowest if values[corner] - values[lowest] <= tolerance * (1 + SPARE) else corner
        level[corner] = lowest
    while True:
        joined = course.levelled(times, level)
        at_fault = course.at_fault(joined)
        shared = at_fault[np.bincount(level)[level[at_fault]] > 1]
        if not shared.size:
            return path if at_fault.size else joined
        level[shared] = len(values) + shared


def _rounded(course: Course, path: Path, tolerance: float) -> Path:
    """Return recorded times and values of corners, in as few decimals as their noise makes sensible."""
    late = np.interp(path[0], course.time, course.late)
    times, values = path[0] - late, path[1]
    cost = min(max(tolerance * (1 + float(course.excess(path).max())) / 2, tolerance / 100), tolerance / 5)
    slope = np.abs(np.diff(values) / np.diff(path[0]))
    steepest = np.maximum(np.append(slope, 0.0), np.append(0.0, slope))
    coarse = max(0, -math.floor(math.log10(tolerance / 2)))
    read, level = np.isin(path[0], course.time), np.unique(values, return_inverse=True)[1]
    finer = np.zeros(len(times), dtype=np.int64)
    while finer.max() < _MOST_DECIMALS:
        short_times = np.array(
            [
                t if at else _short(t, 1, cost / s if s else 1.0, n)
                for t, at, s, n in zip(times.tolist(), read, steepest, finer.tolist(), strict=True)
            ]
        )
        short_values = np.array(
            [_short(v, coarse, cost, n) for v, n in zip(values.tolist(), finer.tolist(), strict=True)]
        )
        if course.prescribed:
            short_values[level == level[0]] = course.value[0]
        at_fault = course.at_fault((short_times + late, short_values))
        if not at_fault.size:
            return short_times, short_values
        finer[np.isin(level, level[at_fault])] += 1
    return times, values


def _short(number: float, coarse: int, cost: float, finer: int) -> float:
    """Return a number in the fewest decimals, `coarse` or more, that change it by at most `cost`, and `finer` more."""
    decimals = next(
        (n for n in range(coarse, _MOST_DECIMALS) if abs(round(number, n) - number) <= cost), _MOST_DECIMALS
    )
    return round(number, decimals + finer)


def _too_many(reading: Array, tolerance: float) -> str:
    scatter = noise(reading)
    message = f"{MOST_CORNERS} corners are not enough to stay within {tolerance:g} of every reading"
    if 3 * scatter > tolerance:
        better = float(f"{6 * scatter:.1g}")
        message += (
            f"; the readings scatter by about {scatter:.2g} (standard deviation), so try a tolerance of {better:g}"
        )
    return message
