"""Few corner points for a recording: a polyline in the tunnel that the tolerance makes around its readings.

Lines that reach as far through the tunnel as they can give the places of corners, at the least tolerance that needs no
more of them. Regression lines of the pieces meet near those places, and cones keep every piece in the tunnel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Places = NDArray[np.intp]
Path = tuple[Array, Array]
"""Times and values of corners, each (corners,)."""

SPARE = 1e-9
"""Share of a tolerance that rounding errors may take."""

INSTANT_S = 1e-9
"""How far two readings at one time are held apart while fitting, so that a step is a piece like others."""

GAP_STEPS = 3
"""A gap is longer than so many usual steps between readings."""

_HALVINGS, _SETTLING = 6, 3
"""Halvings by which the least tolerance is sought, and rounds in which corner times settle."""

MOST_CORNERS = 500
"""Corners of an icon that is made of a recording: more than anybody edits."""
_MOST_DECIMALS = 9


@dataclass(frozen=True, slots=True)
class Tunnel:
    """Readings (readings,) with the lowest and highest value that a path may have there, and ``fixed`` corners.

    Of two readings at one time the second is ``time`` a little later; ``recorded`` is the time of both.
    """

    recorded: Array
    time: Array
    value: Array
    low: Array
    high: Array
    fixed: NDArray[np.bool_]

    def cuts(self, share: float, most: int) -> list[int]:
        """Return readings between which one line keeps to this share of the tunnel, each as late as it can be."""
        low = self.value + share * (self.low - self.value)
        high = self.value + share * (self.high - self.value)
        cuts = [0]
        for last in np.flatnonzero(self.fixed)[1:].tolist():
            while cuts[-1] < last and len(cuts) <= most:
                cuts.append(_farthest(self.time, low, high, cuts[-1], last))
        return cuts

    def fit(self, times: Array) -> Path:
        """Return corners near these times, where the regression lines of the pieces beside them meet."""
        for _ in range(_SETTLING):
            slope, level = self._lines(times)
            turn, length = np.diff(slope), np.diff(times)
            begins, ends = np.searchsorted(self.time, times, side="right"), np.searchsorted(self.time, times)
            several = ends[1:] - begins[:-1] > 1
            movable = several[1:] & several[:-1] & (turn != 0) & ~np.isin(times[1:-1], self.time[self.fixed])
            shift = np.divide(-np.diff(level), turn, out=times[1:-1].copy(), where=movable) - times[1:-1]
            shift[(shift <= -0.5 * length[:-1]) | (shift >= 0.5 * length[1:])] = 0.0
            times = times + np.concatenate(([0.0], shift, [0.0]))
        slope, level = self._lines(times)
        beside = np.full((2, len(times)), np.nan)
        beside[0, 1:] = level + slope * times[1:]
        beside[1, :-1] = level + slope * times[:-1]
        known = np.isfinite(beside)
        mean = np.where(known, beside, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        return times, np.where(known.any(axis=0), mean, np.interp(times, self.time, self.value))

    def _lines(self, times: Array) -> Array:
        """Return slope and level at time 0 (2, pieces) of the regression line of each piece, NaN where none is."""
        lines = np.full((2, len(times) - 1), np.nan)
        begins, ends = np.searchsorted(self.time, times, side="right"), np.searchsorted(self.time, times)
        for piece, (begin, end) in enumerate(zip(begins[:-1].tolist(), ends[1:].tolist(), strict=True)):
            if end - begin == 1:  # a single reading inside: with those at the corners
                begin = max(begin - 1, 0)
                end += 1
            if end - begin > 1:
                lines[:, piece] = np.polyfit(self.time[begin:end], self.value[begin:end], 1)
        return lines

    def inside(self, path: Path) -> Path:
        """Return the path moved into the tunnel, with more corners where a piece would leave it."""
        grid = np.union1d(self.time, path[0])
        low = np.interp(grid, self.time, np.maximum(self.low, self.value.min()))
        high = np.interp(grid, self.time, np.minimum(self.high, self.value.max()))
        ends = np.searchsorted(grid, path[0])
        wanted = np.clip(np.interp(grid, *path), low, high)
        corner, level = [0], [float(wanted[0])]
        for end in ends[1:].tolist():
            while corner[-1] < end:
                ahead = slice(corner[-1] + 1, end + 1)
                run = grid[ahead] - grid[corner[-1]]
                least = np.maximum.accumulate((low[ahead] - level[-1]) / run)
                most = np.minimum.accumulate((high[ahead] - level[-1]) / run)
                slope = (wanted[ahead] - level[-1]) / run
                reached = np.flatnonzero((least <= slope) & (slope <= most))
                # Back to the path as soon as it cannot be followed, or else as far as a line keeps to the tunnel.
                last = reached[-1] if reached.size else int((least <= most).sum()) - 1
                corner.append(corner[-1] + int(last) + 1)
                level.append(level[-1] + float(np.clip(slope, least, most)[last] * run[last]))
        return grid[corner], np.array(level)


def tunnel_of(time: Array, reading: Array, tolerance: float, start: float | None = None) -> Tunnel:
    """The tunnel around readings, of which `start` may prescribe the first, and nowhere beyond the farthest of them.

    Two readings at one time are a step where no value lies within the tolerance of both, and otherwise one.
    """
    apart, twice = np.abs(np.diff(reading)), np.diff(time) == 0
    step = twice & (apart > 1.99 * tolerance)
    value, room = reading.copy(), np.full_like(time, tolerance * (1 - SPARE))
    if start is not None:
        step[0] |= twice[0] and abs(reading[1] - start) > tolerance
    same = np.flatnonzero(twice & ~step)
    value[same] = (reading[same] + reading[same + 1]) / 2
    room[same] -= apart[same] / 2
    low, high = value - room, value + room
    if start is not None:
        value[0] = low[0] = high[0] = start
    ends = step | gaps(time)
    fixed = np.append(True, ends) | np.append(ends, True)
    fixed[same] |= fixed[same + 1]
    late = INSTANT_S * np.append(0.0, np.cumsum(step))
    once = np.delete(np.arange(len(time)), same + 1)
    return Tunnel(time[once], (time + late)[once], value[once], low[once], high[once], fixed[once])


def gaps(time: Array) -> NDArray[np.bool_]:
    """Return which intervals (readings − 1,) are gaps: longer than three usual steps, of the median length."""
    steps = np.diff(time)
    return np.asarray(steps > GAP_STEPS * (1 + 1e-6) * np.median(steps[steps > 0]))


def fit_corners(
    time_s: Sequence[float] | Array,
    value: Sequence[float] | Array,
    tolerance: float,
    start: float | None = None,
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return times (s) and values of corners whose polyline lies within ``tolerance`` of readings (readings,).

    It does so at every reading and, of the straight line between two readings, everywhere. A time that stands twice
    with values further apart than the tolerance bridges is a step, and two corners have that time; a gap has a corner
    at each end. Exact holds, levels that return and short decimals are preferred, as far as the tolerance allows.
    ``start`` prescribes the first value. Raises ValueError when 500 corners are not enough.

    >>> fit_corners([0, 1, 2, 3, 4, 5], [32.01, 31.99, 29, 26, 26.01, 25.99], tolerance=0.05)
    ((0.0, 1.0, 3.0, 5.0), (32.0, 32.0, 26.0, 26.0))
    """
    time, reading = np.array(time_s, dtype=np.float64), np.array(value, dtype=np.float64)
    tunnel = tunnel_of(time, reading, tolerance, start)
    cuts = tunnel.cuts(1.0, MOST_CORNERS)
    less, share = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (less + share) / 2
        narrower = tunnel.cuts(middle, len(cuts))
        if len(narrower) == len(cuts):
            share, cuts = middle, narrower
        else:
            less = middle
    path = tunnel.inside(tunnel.fit(tunnel.time[cuts]))
    if len(path[0]) > MOST_CORNERS:
        message = f"{MOST_CORNERS} corners are not enough to stay within {tolerance:g} of every reading"
        if 3 * (scatter := noise(reading)) > tolerance:
            try_K = f"so try a tolerance of {float(f'{6 * scatter:.1g}'):g}"
            message += f"; the readings scatter by about {scatter:.2g} (standard deviation), {try_K}"
        raise ValueError(message)
    times, values = _short(tunnel, path, tolerance)
    flat = np.diff(values) == 0
    corner = np.concatenate(([True], ~(flat[1:] & flat[:-1]), [True])) | np.isin(times, tunnel.time[tunnel.fixed])
    row = np.searchsorted(tunnel.time, times)
    times = np.where(tunnel.time[row] == times, tunnel.recorded[row], times)
    return tuple(times[corner].tolist()), tuple((values[corner] + 0.0).tolist())


def noise(value: Array) -> float:
    """Return the standard deviation of readings about a smooth course, from their second differences."""
    bends = np.abs(np.diff(value, 2))
    return float(np.median(bends)) / (0.6745 * math.sqrt(6)) if bends.size else 0.0


def _farthest(time: Array, low: Array, high: Array, first: int, last: int) -> int:
    """Return the last reading, up to `last`, to which one line from the first keeps between low and high."""

    def straight(end: int) -> bool:
        return _straight(time[first : end + 1], low[first : end + 1], high[first : end + 1])

    reached, size = first + 1, 1
    while reached < last and straight(min(reached + size, last)):
        reached = min(reached + size, last)
        size *= 2
    while size > 1:
        size //= 2
        if reached + size <= last and straight(reached + size):
            reached += size
    return reached


def _straight(time: Array, low: Array, high: Array) -> bool:
    """Return whether one line keeps between low and high, by halving the slopes that no pair of readings excludes."""
    least, most = ((side[-1] - other[0]) / (time[-1] - time[0]) for side, other in ((low, high), (high, low)))
    for _ in range(60):
        slope = (least + most) / 2
        floor, ceiling = low - slope * (time - time[0]), high - slope * (time - time[0])
        under, over = int(floor.argmax()), int(ceiling.argmin())
        if least > most or floor[under] <= ceiling[over]:
            break
        bound = (low[under] - high[over]) / (time[under] - time[over])
        if under > over:
            least = bound
        else:
            most = bound
    return bool(floor[under] <= ceiling[over])


def _short(tunnel: Tunnel, path: Path, tolerance: float) -> Path:
    """Return the path on fewer levels and in fewer decimals, as far as no more corners are needed for it."""
    read = np.isin(path[0], tunnel.time)
    coarse = max(0, -math.floor(math.log10(tolerance / 2)))
    for spread in tolerance * np.array([1, 0.5, 0.25, 0.125, 0.0]):
        levels = _levels(path[1], spread)
        if tunnel.low[0] == tunnel.high[0]:
            levels[levels == levels[0]] = path[1][0]
        scatter = float(np.abs(np.interp(tunnel.time, path[0], levels) - tunnel.value).max())
        cost = min(max(scatter / 2, tolerance / 100), tolerance / 5)
        for decimals in range(coarse, _MOST_DECIMALS):
            shorter = np.where(read, path[0], path[0].round(decimals)), levels.round(decimals)
            if np.abs(shorter[1] - levels).max() <= cost and (np.diff(shorter[0]) > 0).all():
                shorter = tunnel.inside(shorter)
                if len(shorter[0]) <= len(path[0]):
                    return shorter
    return path


def _levels(values: Array, spread: float) -> Array:
    """Return values with the mean of their level in place of each; a level is wide as `spread`."""
    order = np.sort(values)
    lowest = [float(order[0])]
    for value in order.tolist():
        if value - lowest[-1] > spread:
            lowest.append(value)
    level = np.searchsorted(lowest, values, side="right") - 1
    return np.asarray((np.bincount(level, values) / np.bincount(level))[level])
