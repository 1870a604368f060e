"""Few corner points for a recording: Ramer-Douglas-Peucker, least squares for the levels, then short decimals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

MOST_CORNERS = 500
# Beyond this many corners each is kept: trying to leave one out takes a fit.
_MOST_TRIED = 80
# What floats leave of a distance that equals the tolerance.
_ROUNDING = 1e-9
# Decimals of seconds that are tried, in this order; None is the time of the nearest reading.
_DECIMALS = (1, 2, None, 3, 4, 6, 9)


def fit_corners(
    time_s: Sequence[float] | Array,
    value: Sequence[float] | Array,
    tolerance: float,
    start: float | None = None,
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return times (s) and values of corners whose polyline lies within ``tolerance`` of every reading.

    ``time_s`` and ``value`` have the shape (readings,); a time that stands twice with two values more than twice the
    tolerance apart is a step, and two corners then have that time. Flat holds, levels that return and short decimals
    are preferred as far as the tolerance allows. ``start`` prescribes the first value.

    Raises ValueError for arrays of other shapes, numbers that are not finite, times that fall, a tolerance that is not
    positive, a ``start`` further than the tolerance from the first reading, or when 500 corners are not enough.

    >>> fit_corners([0, 1, 2, 3, 4, 5], [32.01, 31.99, 29, 26, 26.01, 25.99], tolerance=0.05)
    ((0.0, 1.0, 3.0, 5.0), (32.0, 32.0, 26.0, 26.0))
    """
    time, reading = _checked(time_s, value, tolerance, start)
    steps = np.flatnonzero((np.diff(time) == 0) & (np.abs(np.diff(reading)) > 2 * tolerance)) + 1
    part = np.zeros(len(time), dtype=int)
    part[steps] = 1
    path = _first_path(time, reading, np.cumsum(part), tolerance, start)
    path = _without_needless(path)
    path = _with_common_levels(path)
    return _rounded(path)


def noise(value: Array) -> float:
    """Return the standard deviation of readings about a smooth course, from their second differences.

    >>> noise(np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    0.0
    """
    bends = np.abs(np.diff(value, 2))
    return float(np.median(bends)) / (0.6745 * math.sqrt(6)) if bends.size else 0.0


@dataclass(frozen=True)
class _Path:
    """Corners at times in parts (between steps) of a recording; corners of equal ``level`` share one fitted level."""

    time: Array
    reading: Array
    part: NDArray[np.int_]
    tolerance: float
    start: float | None
    corner: Array
    of_part: NDArray[np.int_]
    level: NDArray[np.int_]

    @cached_property
    def weights(self) -> tuple[NDArray[np.int_], Array]:
        """For each reading the corner before it, and how far (0-1) it lies on the way to the next."""
        first = np.searchsorted(self.of_part, self.part)
        last = np.searchsorted(self.of_part, self.part, side="right") - 1
        scale = self.time[-1] - self.time[0] + 1.0  # parts one behind the other, so that one search finds all
        place = np.searchsorted(self.corner + self.of_part * scale, self.time + self.part * scale, side="right") - 1
        place = np.clip(place, first, np.maximum(last - 1, first))
        after = np.minimum(place + 1, last)
        gap = self.corner[after] - self.corner[place]
        share = np.divide(self.time - self.corner[place], gap, out=np.zeros_like(gap), where=gap > 0)
        return place, np.clip(share, 0.0, 1.0)

    @cached_property
    def value(self) -> Array:
        """Values at the corners that fit the readings best in the sense of least squares."""
        place, share = self.weights
        after = np.minimum(place + 1, len(self.corner) - 1)
        count = int(self.level.max()) + 1
        left, right = self.level[place], self.level[after]
        normal, goal = np.zeros((count, count)), np.zeros(count)
        for row, weight in ((left, 1 - share), (right, share)):
            np.add.at(goal, row, weight * self.reading)
            for column, other in ((left, 1 - share), (right, share)):
                np.add.at(normal, (row, column), weight * other)
        if self.start is not None:
            fixed = self.level[0]
            normal[fixed], goal[fixed] = 0.0, self.start
            normal[fixed, fixed] = 1.0
        return np.asarray(np.linalg.lstsq(normal, goal, rcond=None)[0][self.level])

    def off(self, value: Array | None = None) -> Array:
        """Distance of each reading from the polyline."""
        value = self.value if value is None else value
        place, share = self.weights
        after = np.minimum(place + 1, len(self.corner) - 1)
        return np.asarray(np.abs(value[place] * (1 - share) + value[after] * share - self.reading))

    def fits(self, value: Array | None = None) -> bool:
        """Tell whether every reading lies within the tolerance."""
        return bool((self.off(value) <= self.tolerance * (1 + _ROUNDING)).all())

    def inner(self, k: int) -> bool:
        """Tell whether a corner is not at a step: the corners beside it are of the same part."""
        return bool(self.of_part[k - 1] == self.of_part[k] == self.of_part[k + 1])

    def with_corners(self, corner: Array, of_part: NDArray[np.int_]) -> _Path:
        return replace(self, corner=corner, of_part=of_part, level=np.arange(len(corner)))


def _first_path(time: Array, reading: Array, part: NDArray[np.int_], tolerance: float, start: float | None) -> _Path:
    """Corners at readings: those of Ramer-Douglas-Peucker, and more where the best fit leaves the tolerance."""
    kept = np.zeros(len(time), dtype=bool)
    bent = tolerance + 2 * noise(reading)  # chords run between single readings, which may be off themselves
    for number in range(int(part[-1]) + 1):
        inside = np.flatnonzero(part == number)
        kept[[inside[0], inside[-1]]] = True
        pairs = [(int(inside[0]), int(inside[-1]))]
        while pairs:
            a, b = pairs.pop()
            if b - a < 2 or time[a] == time[b]:
                continue
            chord = reading[a] + (reading[b] - reading[a]) * (time[a : b + 1] - time[a]) / (time[b] - time[a])
            worst = a + int(np.argmax(np.abs(chord - reading[a : b + 1])))
            if abs(chord[worst - a] - reading[worst]) > bent:
                kept[worst] = True
                pairs += [(a, worst), (worst, b)]
    while True:
        places = np.flatnonzero(kept)
        doubled = np.flatnonzero((np.diff(time[places]) == 0) & (np.diff(part[places]) == 0)) + 1
        places = np.delete(places, doubled)
        if len(places) > MOST_CORNERS:
            raise ValueError(_too_many(reading, tolerance))
        path = _Path(time, reading, part, tolerance, start, time[places], part[places], np.arange(len(places)))
        if path.fits():
            return path
        off = np.where(kept, 0.0, path.off())
        if not off.max() > tolerance:  # every reading that is too far off is a corner: take the readings themselves
            off = np.where(kept, 0.0, 1.0)
        if not off.max():
            raise ValueError(_too_many(reading, tolerance))
        kept[np.argmax(off)] = True


def _without_needless(path: _Path) -> _Path:
    """Return the path without the corners that the tolerance does not need, the others moved to where lines meet."""
    moved = _moved(path)
    path = moved if moved.fits() else path
    if len(path.corner) > _MOST_TRIED:
        return path
    tried: set[float] = set()
    while True:
        inner = [
            k for k in range(1, len(path.corner) - 1) if path.of_part[k - 1] == path.of_part[k] == path.of_part[k + 1]
        ]
        inner = [k for k in inner if path.corner[k] not in tried]
        if not inner:
            break
        bend = [abs(np.diff(path.value[k - 1 : k + 2]) / np.diff(path.corner[k - 1 : k + 2]) @ [-1, 1]) for k in inner]
        k = inner[int(np.argmin(bend))]
        fewer = path.with_corners(np.delete(path.corner, k), np.delete(path.of_part, k))
        moved = _moved(fewer)
        chosen = next((one for one in (moved, fewer) if one.fits()), None)
        if chosen is None:
            tried.add(float(path.corner[k]))
        else:
            path = chosen
    while (moved := _moved(path)).fits() and moved.off().max() < 0.9 * path.off().max():
        path = moved
    return path


def _moved(path: _Path) -> _Path:
    """Return the path with corners where the lines through the readings before and behind them meet."""
    lines = []
    for k in range(len(path.corner) - 1):
        a, b = path.corner[k], path.corner[k + 1]
        first, last = np.searchsorted(path.time, a, side="right"), np.searchsorted(path.time, b, side="left")
        own = slice(first, last)
        if last - first >= 2:
            lines.append(np.polyfit(path.time[own] - a, path.reading[own], 1) @ [[1, -a], [0, 1]])
        elif b > a:
            slope = (path.value[k + 1] - path.value[k]) / (b - a)
            lines.append(np.array([slope, path.value[k] - slope * a]))
        else:
            lines.append(np.zeros(2))
    corner = path.corner.copy()
    room = path.tolerance + np.ptp(path.reading) / 20  # a spike between two readings is not what was recorded
    for k in range(1, len(corner) - 1):
        bend = lines[k - 1][0] - lines[k][0]
        if not path.inner(k) or not bend:
            continue
        meets = (lines[k][1] - lines[k - 1][1]) / bend
        level = lines[k][0] * meets + lines[k][1]
        if corner[k - 1] < meets < path.corner[k + 1] and path.reading.min() - room < level < path.reading.max() + room:
            corner[k] = meets
    return path.with_corners(corner, path.of_part)


def _with_common_levels(path: _Path) -> _Path:
    """Return the path with one level for the ends of a hold, and for levels that return, as far as it then fits."""
    refused: set[tuple[int, int]] = set()
    for _ in range(2 * _MOST_TRIED):
        value = path.value
        flat = [(k, k + 1) for k in range(len(value) - 1) if path.of_part[k] == path.of_part[k + 1]]
        order = np.argsort(value, kind="stable").tolist()
        pairs = [pair for pair in flat if abs(value[pair[1]] - value[pair[0]]) <= path.tolerance]
        pairs += [(a, b) for a, b in pairwise(order) if value[b] - value[a] <= path.tolerance / 2]
        pairs = [pair for pair in pairs if path.level[pair[0]] != path.level[pair[1]] and pair not in refused]
        if not pairs:
            break
        a, b = min(pairs, key=lambda pair: abs(value[pair[1]] - value[pair[0]]))
        level = np.where(path.level == path.level[b], path.level[a], path.level)
        joined = replace(path, level=np.unique(level, return_inverse=True)[1])
        if joined.fits():
            path = joined
        else:
            refused.add((a, b))
    return path


def _rounded(path: _Path) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return times and values in as few decimals as the noise of the readings hides."""
    cost = min(max(float(path.off().max()) / 2, path.tolerance / 100), path.tolerance / 5)
    slope = np.abs(np.diff(path.value) / np.maximum(np.diff(path.corner), 1e-12))
    slope = np.maximum(np.append(slope, 0.0), np.append(0.0, slope))
    fixed = np.append(True, np.diff(path.of_part) > 0) | np.append(np.diff(path.of_part) > 0, True)
    for shrink in (1.0, 0.5, 0.25, 0.1, 0.01, 0.0):
        value = np.array([_level(one, path.tolerance, cost * shrink) for one in path.value.tolist()])
        if path.start is not None:
            value[path.level == path.level[0]] = path.start
        pairs = zip(path.corner.tolist(), slope.tolist(), fixed.tolist(), strict=True)
        corner = np.array([t if still else _time(t, path.time, s, cost * shrink) for t, s, still in pairs])
        short = replace(path, corner=corner)
        rising = np.diff(corner) > 0
        if (rising | (np.diff(path.of_part) > 0)).all() and short.fits(value):
            break
    else:
        corner, value = path.corner, path.value
    same = (np.diff(value) == 0) & (np.diff(path.of_part) == 0)
    kept = np.concatenate(([True], ~(same[1:] & same[:-1]), [True])) if len(corner) > 2 else np.ones(len(corner), bool)
    return tuple(corner[kept].tolist()), tuple((value[kept] + 0.0).tolist())


def _level(value: float, tolerance: float, cost: float) -> float:
    first = max(0, -math.floor(math.log10(tolerance / 2)))
    return next((round(value, n) for n in range(first, first + 8) if abs(round(value, n) - value) <= cost), value)


def _time(time: float, readings: Array, slope: float, cost: float) -> float:
    after = int(np.clip(np.searchsorted(readings, time), 1, len(readings) - 1))
    before, behind = float(readings[after - 1]), float(readings[after])
    nearest = before if time - before < behind - time else behind
    if abs(time - nearest) <= 0.02 * (behind - before):  # so near to a reading a corner is meant to be at it
        return round(nearest, 9)
    choices = (nearest if n is None else round(time, n) for n in _DECIMALS)
    return next((choice for choice in choices if abs(choice - time) * slope <= cost), time)


def _checked(
    time_s: Sequence[float] | Array, value: Sequence[float] | Array, tolerance: float, start: float | None
) -> tuple[Array, Array]:
    time, reading = np.array(time_s, dtype=np.float64), np.array(value, dtype=np.float64)
    if time.ndim != 1 or time.shape != reading.shape:
        raise ValueError(f"one value is needed for each time; got shapes {time.shape} and {reading.shape}")
    if len(time) < 2:
        raise ValueError(f"{len(time)} readings; at least two are needed")
    if not (np.isfinite(time).all() and np.isfinite(reading).all()):
        raise ValueError("times and values must be finite numbers")
    if (np.diff(time) < 0).any() or time[0] == time[-1]:
        raise ValueError("times must not fall, and must not all be the same")
    if (three := np.flatnonzero(time[2:] == time[:-2])).size:
        raise ValueError(f"the time {time[three[0]]:g} s stands more than twice; two readings at one time are a step")
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise ValueError(f"tolerance must be positive, not {tolerance!r}")
    if start is not None and not abs(start - reading[0]) <= tolerance:
        raise ValueError(
            f"start {start:g} is further than the tolerance {tolerance:g} from the first value {reading[0]:g}"
        )
    return time, reading


def _too_many(reading: Array, tolerance: float) -> str:
    scatter = noise(reading)
    message = f"{MOST_CORNERS} corners are not enough to stay within {tolerance:g} of every reading"
    if 3 * scatter > tolerance:
        better = float(f"{6 * scatter:.1g}")
        message += (
            f"; the readings scatter by about {scatter:.2g} (standard deviation), so try a tolerance of {better:g}"
        )
    return message
