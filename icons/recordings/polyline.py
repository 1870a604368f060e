"""Few corner points for a recording: straight pieces that stay within a tolerance of every reading.

Ramer, Douglas and Peucker's cuts come first, at twice the tolerance, since noise may reach the tolerance on both sides.
Then the pieces become lines of least squares, what leaves the tolerance is cut again, and what is not needed goes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Path = tuple[Array, Array]
"""Times and values of corners, each (corners,)."""

SPARE = 1e-9
"""Share of a tolerance that rounding errors may take."""

INSTANT_S = 1e-9
"""How far two readings at one time are held apart while fitting, so that a step is a piece like others."""

_SETTLING, _LEVELLING, _LITTLE = 4, 12, 0.5
"""Rounds in which corner times settle, and then values, where a path leaves the room by less than this share of it."""

_SOFT, _FIRM = 1e-7, 1e9
"""Weights of the reading at a corner, which decides where no other does, and of a prescribed value."""

MOST_CORNERS = 500
"""Corners of an icon that is made of a recording: more than anybody edits."""
_MOST_DECIMALS = 12


@dataclass(frozen=True, slots=True)
class Course:
    """Readings (readings,) that a path may be ``room`` off, with ``fixed`` corners, and how ``late`` steps make it."""

    time: Array
    value: Array
    room: Array
    fixed: NDArray[np.bool_]
    late: Array
    prescribed: bool

    def excess(self, path: Path) -> Array:
        """Return by how much a path leaves the room of each reading, as a share of it; negative inside."""
        return np.asarray(np.abs(np.interp(self.time, *path) - self.value) / self.room - 1 - SPARE)

    def holds(self, path: Path) -> bool:
        """Return whether a path has its corners in order and keeps to the room of every reading."""
        return bool((np.diff(path[0]) > 0).all() and (self.excess(path) <= 0).all())

    def worst(self, path: Path) -> NDArray[np.intp]:
        """Return the worst reading of each piece that leaves the room of a reading."""
        excess = self.excess(path)
        order = np.argsort(-excess, kind="stable")[: int((excess > 0).sum())]
        return order[np.unique(self.piece(path[0])[order], return_index=True)[1]]

    def at_fault(self, path: Path) -> NDArray[np.intp]:
        """Return the corners of pieces that leave the room of a reading, and those that are not in order."""
        piece = self.piece(path[0])[self.excess(path) > 0]
        piece = np.append(piece, np.flatnonzero(np.diff(path[0]) <= 0))
        return np.union1d(piece, piece + 1)

    def piece(self, times: Array) -> NDArray[np.intp]:
        """Return for each reading the piece that it belongs to, between corners at these times."""
        return np.clip(np.searchsorted(times, self.time, side="right") - 1, 0, len(times) - 2)

    def cuts(self, limit: float) -> NDArray[np.intp]:
        """Return the readings between whose chords none is more than `limit` of its room off."""
        return np.array(cuts_of(self.time, self.value, self.room, np.flatnonzero(self.fixed).tolist(), limit))

    def fit(self, times: Array) -> Path:
        """Return the path with corners near these times that fits best by least squares; it may leave the room."""
        for _ in range(_SETTLING):
            times = self._met(times)
        return self.levelled(times, np.arange(len(times)))

    def levelled(self, times: Array, level: NDArray[np.intp]) -> Path:
        """The path with corners at these times that fits best; corners of one number in `level` share a value.

        Just outside of the room, readings weigh the more the farther they are off (Lawson 1961).
        """
        weight = np.ones_like(self.time)
        path = times, self._values(times, level, weight)
        for _ in range(_LEVELLING):
            if not 0 < (excess := self.excess(path)).max() < _LITTLE:
                break
            weight *= 1 + excess
            path = times, self._values(times, level, weight)
        return path

    def _met(self, times: Array) -> Array:
        """Return corner times moved to where the regression lines of the two pieces beside a corner meet."""
        piece, count = self.piece(times), len(times) - 1
        inner = (self.time > times[piece]) & (self.time < times[piece + 1])
        piece, time, value = piece[inner], self.time[inner], self.value[inner]
        number = np.bincount(piece, minlength=count)
        known = number > 1
        mean_t, mean_v = (np.bincount(piece, each, count) / np.maximum(number, 1) for each in (time, value))
        off = time - mean_t[piece]
        slope = np.bincount(piece, off * value, count) / np.where(known, np.bincount(piece, off**2, count), 1.0)
        # At the corner the line before it is `gap` above the line after it, which gains `turn` on it each second.
        gap = (mean_v + slope * (times[1:] - mean_t))[:-1] - (mean_v + slope * (times[:-1] - mean_t))[1:]
        turn, length = np.diff(slope), np.diff(times)
        movable = known[1:] & known[:-1] & (turn != 0) & ~np.isin(times[1:-1], self.time[self.fixed])
        shift = np.divide(gap, turn, out=np.zeros(count - 1), where=movable)
        shift[(shift <= -0.5 * length[:-1]) | (shift >= 0.5 * length[1:])] = 0.0
        return np.asarray(times + np.concatenate(([0.0], shift, [0.0])))

    def _values(self, times: Array, level: NDArray[np.intp], weight: Array) -> Array:
        """Return the values of corners that fit best: a tridiagonal system, in which shared levels are one unknown."""
        from scipy.sparse import csc_array, diags_array
        from scipy.sparse.linalg import spsolve

        piece, count = self.piece(times), len(times)
        right = (self.time - times[piece]) / np.diff(times)[piece]
        left = 1 - right

        def at_corners(on_left: Array, on_right: Array) -> Array:
            sums = np.bincount(piece, weight * on_left, count) + np.bincount(piece + 1, weight * on_right, count)
            return np.asarray(sums)

        beside = np.bincount(piece, weight * left * right, count - 1)
        own, pull = at_corners(left**2, right**2), at_corners(left * self.value, right * self.value)
        hold = np.full(count, _SOFT)
        hold[0] = _FIRM if self.prescribed else _SOFT
        numbers, column = np.unique(level, return_inverse=True)
        shared = csc_array((np.ones(count), (np.arange(count), column)), shape=(count, len(numbers)))
        square = csc_array(diags_array([beside, own + hold, beside], offsets=[-1, 0, 1]))
        vector = shared.T @ (pull + hold * np.interp(times, self.time, self.value))
        return np.asarray(np.atleast_1d(np.asarray(spsolve(csc_array(shared.T @ square @ shared), vector)))[column])


def cuts_of(time: Array, value: Array, room: Array, ends: list[int], limit: float) -> list[int]:
    """Places between whose chords no value is more than `limit` of its room off, from `ends` (Douglas & Peucker 1973).

    Time goes with values times cuts at the worst.
    """
    cuts, pieces = set(ends), list(pairwise(ends))
    while pieces:
        first, last = pieces.pop()
        inner, both = slice(first + 1, last), [first, last]
        off = np.abs(value[inner] - np.interp(time[inner], time[both], value[both])) / room[inner]
        if off.size and off.max() > limit:
            cut = first + 1 + int(off.argmax())
            cuts.add(cut)
            pieces += [(first, cut), (cut, last)]
    return sorted(cuts)


def course_of(time: Array, reading: Array, tolerance: float, start: float | None = None) -> Course:
    """The course of readings, of which `start` may prescribe the first; two at one time are a step where no value lies
    within the tolerance of both, and otherwise one.
    """
    apart, twice = np.abs(np.diff(reading)), np.diff(time) == 0
    step = twice & (apart > 1.99 * tolerance)
    if start is not None:
        step[0] |= twice[0] and abs(reading[1] - start) > tolerance
    same = np.flatnonzero(twice & ~step)
    value, room = reading.copy(), np.full_like(time, tolerance)
    value[same], room[same] = (reading[same] + reading[same + 1]) / 2, tolerance - apart[same] / 2
    if start is not None:
        value[0] = start
    fixed = np.append(True, step) | np.append(step, True)
    fixed[same] |= fixed[same + 1]
    late = INSTANT_S * np.append(0.0, np.cumsum(step))
    once = np.delete(np.arange(len(time)), same + 1)
    return Course((time + late)[once], value[once], room[once], fixed[once], late[once], start is not None)


def fit_corners(
    time_s: Sequence[float] | Array,
    value: Sequence[float] | Array,
    tolerance: float,
    start: float | None = None,
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return times (s) and values of corners whose polyline lies within ``tolerance`` of every reading (readings,).

    A time that stands twice with values further apart than the tolerance bridges is a step, and two corners have that
    time. Exact holds, levels that return and short decimals are preferred, as far as the tolerance allows. ``start``
    prescribes the first value. Raises ValueError when 500 corners are not enough.

    >>> fit_corners([0, 1, 2, 3, 4, 5], [32.01, 31.99, 29, 26, 26.01, 25.99], tolerance=0.05)
    ((0.0, 1.0, 3.0, 5.0), (32.0, 32.0, 26.0, 26.0))
    """
    time, reading = np.array(time_s, dtype=np.float64), np.array(value, dtype=np.float64)
    course = course_of(time, reading, tolerance, start)
    path = _sparse(course, _inside(course))
    if len(path[0]) > MOST_CORNERS:
        message = f"{MOST_CORNERS} corners are not enough to stay within {tolerance:g} of every reading"
        if 3 * (scatter := noise(reading)) > tolerance:
            try_K = f"so try a tolerance of {float(f'{6 * scatter:.1g}'):g}"
            message += f"; the readings scatter by about {scatter:.2g} (standard deviation), {try_K}"
        raise ValueError(message)
    times, values = _rounded(course, _shared(course, path, tolerance), tolerance)
    flat = np.diff(values) == 0
    corner = np.concatenate(([True], ~(flat[1:] & flat[:-1]), [True]))
    return tuple(times[corner].tolist()), tuple((values[corner] + 0.0).tolist())


def noise(value: Array) -> float:
    """Return the standard deviation of readings about a smooth course, from their second differences."""
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
