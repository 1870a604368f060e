"""The readings of a recording as a course to follow: where to cut it, and the polyline that fits it best."""

from __future__ import annotations

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


@dataclass(frozen=True, slots=True)
class Course:
    """Readings (readings,) at times that rise; a path may be ``room`` off each, and has corners at those ``fixed``.

    ``late`` is how much later than recorded a reading stands, since a step takes an instant.
    """

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
        """Return the readings between whose chords none is more than `limit` of its room off (Douglas & Peucker 1973).

        Time goes with readings times cuts at the worst.
        """
        ends = np.flatnonzero(self.fixed).tolist()
        cuts, pieces = set(ends), list(pairwise(ends))
        while pieces:
            first, last = pieces.pop()
            inner, both = slice(first + 1, last), [first, last]
            off = np.abs(self.value[inner] - np.interp(self.time[inner], self.time[both], self.value[both]))
            off /= self.room[inner]
            if off.size and off.max() > limit:
                cut = first + 1 + int(off.argmax())
                cuts.add(cut)
                pieces += [(first, cut), (cut, last)]
        return np.array(sorted(cuts))

    def fit(self, times: Array) -> Path:
        """Return the path with corners near these times that fits best by least squares; it may leave the room."""
        for _ in range(_SETTLING):
            times = self._met(times)
        return self.levelled(times, np.arange(len(times)))

    def levelled(self, times: Array, level: NDArray[np.intp]) -> Path:
        """Return the path with corners at these times that fits best; corners of one number in `level` share a value.

        Where least squares leave the room by little, readings weigh more the farther they are off (Lawson 1961), which
        takes the largest deviation towards its least.
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


def course_of(time: Array, reading: Array, tolerance: float, start: float | None = None) -> Course:
    """Return the course of readings at times (s) that rise or stand twice; `start` is the first value if prescribed.

    Two readings at one time are a step when no value lies within the tolerance of both, or not the prescribed one;
    otherwise they are one reading.
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
