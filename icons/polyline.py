"""Few corner points for a recording: straight pieces that stay within a tolerance of every reading."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from thermicon.icons.links import fewest_links
from thermicon.icons.rounding import rounded
from thermicon.icons.settle import Path, Tube, settle

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

MOST_CORNERS = 500
# Readings at one time are told apart by this much while fitting; a step has this length there, and none outside.
_INSTANT_S = 1e-9
# The fit keeps a thousandth of the tolerance for its last digits.
_SPARE = 1e-3
_SHARES, _MORE = (0.8, 0.9), 1.15
_MOST_TRIES = 20


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

    Raises ValueError for arrays of other shapes, numbers that are not finite, times that fall, a tolerance that is not
    positive, a ``start`` further than the tolerance from the first reading, or when 500 corners are not enough.

    >>> fit_corners([0, 1, 2, 3, 4, 5], [32.01, 31.99, 29, 26, 26.01, 25.99], tolerance=0.05)
    ((0.0, 1.0, 3.0, 5.0), (32.0, 32.0, 26.0, 26.0))
    """
    time, reading = _proved(time_s, value, tolerance, start)
    # All readings apart in time: a step becomes a piece as short as an instant, which the fit need not know about.
    apart = time + _INSTANT_S * np.concatenate(([0.0], np.cumsum(np.diff(time) == 0)))
    tube = _tube(apart, reading, tolerance, start)
    twice = (np.diff(time) == 0) & (np.abs(np.diff(reading)) > 2 * tolerance * (1 - _SPARE))
    path = _first_path(tube, apart[:-1][twice], start)
    if path is None:
        raise ValueError(_too_many(reading, tolerance))
    settled = settle(path, tube)
    path = settled if tube.holds(settled) else path
    path = _joined(path, tube, _holds(path, tube.tolerance))
    path = _joined(path, tube, _recurring(path, tube.tolerance))
    return rounded(path, tube, time, apart)


def noise(value: Array) -> float:
    """Return the standard deviation of readings about a smooth course, from their second differences.

    >>> noise(np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    0.0
    """
    bends = np.abs(np.diff(value, 2))
    return float(np.median(bends)) / (0.6745 * math.sqrt(6)) if bends.size else 0.0


def _proved(
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
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise ValueError(f"tolerance must be positive, not {tolerance!r}")
    if start is not None and not abs(start - reading[0]) <= tolerance:
        raise ValueError(
            f"start {start:g} is further than the tolerance {tolerance:g} from the first value {reading[0]:g}"
        )
    return time, reading


def _tube(time: Array, reading: Array, tolerance: float, start: float | None) -> Tube:
    """Return the readings with points between them wherever the recording bends, where it counts as straight.

    A corner may lie off that straight line where three readings on each side lie on the two lines that meet in it.
    """
    gap = np.diff(time)
    slope = np.diff(reading) / gap
    turn = np.concatenate(([0.0], np.diff(slope), [0.0]))
    before, after = turn[:-1], turn[1:]
    straight = np.abs(turn[1:-1]) * np.minimum(gap[1:], gap[:-1]) <= 4 * tolerance
    left = np.concatenate(([False, False], straight[:-1])) if len(gap) > 1 else np.array([False])
    right = np.concatenate((straight[1:], [False, False])) if len(gap) > 1 else np.array([False])
    known = left & right & (before * after > 0)
    depth = np.zeros_like(gap)
    depth[known] = 2 * gap[known] / (1 / np.abs(before[known]) + 1 / np.abs(after[known]))
    bent = np.flatnonzero((np.maximum(np.abs(before), np.abs(after)) * gap > tolerance / 2) & (gap > 2 * _INSTANT_S))
    share = np.arange(1, (many := min(max(2000 // len(time), 1), 8)) + 1) / (many + 1)
    between = (time[bent, None] + gap[bent, None] * share).ravel()
    order = np.argsort(np.concatenate((time, between)), kind="stable")

    def with_those(own: Array, others: Array) -> Array:
        return np.asarray(np.concatenate((own, others))[order])

    level = (reading[bent, None] + slope[bent, None] * gap[bent, None] * share).ravel()
    wide = np.repeat(tolerance + depth[bent], many)
    weight = np.repeat(np.where(depth[bent] > 0, 0.0, 1.0), many)
    return Tube(
        with_those(time, between),
        with_those(reading, level),
        with_those(np.full_like(time, tolerance), wide),
        with_those(np.ones_like(time), weight),
        tolerance,
    )


def _first_path(tube: Tube, steps: Array, start: float | None) -> Path | None:
    """Return a path of few corners, or None; `steps` are the times, apart, before which the recording steps."""
    found = _fewest(tube, 1 - _SPARE, start, MOST_CORNERS - 1)
    if found is None:
        return None
    # A path that hugs the tube leaves no room for holds and short decimals: a few corners more are well spent.
    for share in _SHARES:
        roomy = _fewest(tube, share, start, int(_MORE * len(found[0])) - 1)
        if roomy is not None:
            found = roomy
            break
    times, values = np.array(found[0]), np.array(found[1])
    apart = np.append(np.diff(times) > 0, True)
    times, values = times[apart], values[apart]
    pinned = np.zeros(len(times), dtype=bool)
    before = np.searchsorted(times, steps + _INSTANT_S / 2) - 1
    times[before], times[before + 1] = steps, steps + _INSTANT_S
    pinned[before] = pinned[before + 1] = True
    return Path(times, values, np.arange(len(times)), pinned, start is not None)


def _fewest(tube: Tube, share: float, start: float | None, most: int) -> tuple[list[float], list[float]] | None:
    room = tube.room * share
    low, high = tube.reading - room, tube.reading + room
    if start is not None:
        low[0] = high[0] = start
    return fewest_links(tube.time.tolist(), low.tolist(), high.tolist(), most)


def _joined(path: Path, tube: Tube, pairs: list[tuple[int, int]]) -> Path:
    """Return the path with as many pairs of corners on one level as the tube allows; earlier pairs are preferred."""
    wanted, left_over = pairs, []
    while wanted:
        trial = settle(path.joined(wanted), tube)
        if tube.holds(trial):
            path = trial
            break
        worst = set(tube.at_fault(trial).tolist())
        kept = [pair for pair in wanted if not worst.intersection(pair)]
        kept = kept if len(kept) < len(wanted) else wanted[: len(wanted) // 2]
        left_over += [pair for pair in wanted if pair not in kept]
        wanted = kept
    for pair in sorted(left_over, key=pairs.index)[:_MOST_TRIES]:
        trial = settle(path.joined([pair]), tube)
        path = trial if tube.holds(trial) else path
    same = np.diff(path.which) == 0
    return path.without(np.flatnonzero(same[1:] & same[:-1]) + 1)


def _holds(path: Path, tolerance: float) -> list[tuple[int, int]]:
    """Return the ends of pieces that rise or fall by so little that they may be holds, the flattest first."""
    change = np.abs(np.diff(path.value))
    pieces = [j for j in np.argsort(change, kind="stable").tolist() if change[j] <= 2 * tolerance]
    return [(j, j + 1) for j in pieces if not (path.pinned[j] and path.pinned[j + 1])]


def _recurring(path: Path, tolerance: float) -> list[tuple[int, int]]:
    """Return pairs of corners that may share a level: the two ends, any corner and the first, holds at nearly one level."""
    value, last = path.value, len(path.time) - 1
    pairs = [(0, last)] if abs(value[last] - value[0]) <= tolerance else []
    pairs += [(0, j) for j in range(1, last) if abs(value[j] - value[0]) <= tolerance / 2]
    flat = [j for j in range(last) if path.which[j] == path.which[j + 1]]
    flat.sort(key=lambda j: value[j])
    for one, other in pairwise(flat):
        if value[other] - value[one] <= tolerance / 2:
            pairs.append((one, other))
    return [pair for pair in pairs if path.which[pair[0]] != path.which[pair[1]]]


def _too_many(reading: Array, tolerance: float) -> str:
    scatter = noise(reading)
    said = f"{MOST_CORNERS} corners are not enough to stay within {tolerance:g} of every reading"
    if 3 * scatter > tolerance:
        better = float(f"{6 * scatter:.1g}")
        said += f"; the readings scatter by about {scatter:.2g} (standard deviation), so try a tolerance of {better:g}"
    return said
