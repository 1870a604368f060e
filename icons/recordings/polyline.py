"""Few corner points for a recording: straight pieces that stay within a tolerance of every reading."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .fewest import fewest_links
from .rounding import rounded
from .settle import Path, settle
from .tube import SPARE, Tube, tube_about

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

MOST_CORNERS = 500
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
    tube = tube_about(time, reading, tolerance, start)
    path = _first_path(tube, start)
    if path is None:
        raise ValueError(_too_many(reading, tolerance))
    path = _settled_inside(path, tube)
    path = _joined(path, tube, _holds(path, tube.tolerance))
    path = _joined(path, tube, _recurring(path, tube.tolerance))
    return rounded(path, tube, start is not None)


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
    if (three := np.flatnonzero(time[2:] == time[:-2])).size:
        raise ValueError(f"the time {time[three[0]]:g} s stands more than twice; two readings at one time are a step")
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise ValueError(f"tolerance must be positive, not {tolerance!r}")
    if start is not None and not abs(start - reading[0]) <= tolerance:
        raise ValueError(
            f"start {start:g} is further than the tolerance {tolerance:g} from the first value {reading[0]:g}"
        )
    return time, reading


def _first_path(tube: Tube, start: float | None) -> Path | None:
    """Return a path of few corners, or None; at a step of the recording it has a corner on each side."""
    found = _fewest(tube, 1 - SPARE, start, MOST_CORNERS)
    if found is None:
        return None
    for share in _SHARES:
        if (roomy := _fewest(tube, share, start, len(found.time))) is not None:
            return roomy
    if tube.holds(settle(found, tube)):
        return found
    # A path that hugs the tube leaves no room for holds and short decimals: a few corners more are well spent.
    tried = (_fewest(tube, share, start, int(_MORE * len(found.time))) for share in _SHARES)
    return next((roomy for roomy in tried if roomy is not None), found)


def _fewest(tube: Tube, share: float, start: float | None, most: int) -> Path | None:
    room = tube.room * share
    low, high = tube.reading - room, tube.reading + room
    if start is not None:
        low[0] = high[0] = start
    times, values = list[float](), list[float]()
    pinned = list[bool]()
    for first, end in pairwise([*tube.begins.tolist(), len(tube.time)]):
        time, bottom, top = (array[first:end].tolist() for array in (tube.time, low, high))
        if (found := fewest_links(time, bottom, top, most - len(times) - 1)) is None:
            return None
        alone = end - first == 1
        times += found[0][alone:]
        values += found[1][alone:]
        pinned += [True, *[False] * (len(found[0]) - 2), True][alone:]
    held = np.zeros(len(times), dtype=bool)
    if start is not None:
        held[0], values[0] = True, start
    path = Path(np.array(times), np.array(values), np.arange(len(times)), np.array(pinned), held)
    return path.without(np.flatnonzero(np.diff(times) <= 0) + 1)


def _settled_inside(path: Path, tube: Tube) -> Path:
    """Return the path that fits best, where that keeps to the tube; elsewhere the path stays as it is, and is kept."""
    best, stay = settle(path, tube), np.zeros(len(path.time), dtype=bool)
    while True:
        level, time = np.where(stay, path.level, best.level), np.where(stay, path.time, best.time)
        mixed = replace(path, time=time, level=level, pinned=path.pinned | stay, held=path.held | stay)
        fault = tube.at_fault(mixed)
        if stay[fault].all():
            return mixed
        stay[fault] = True


def _joined(path: Path, tube: Tube, pairs: list[tuple[int, int]]) -> Path:
    """Return the path with as many pairs of corners on one level as the tube allows; earlier pairs are preferred."""
    wanted, left_over = pairs, list[tuple[int, int]]()
    while wanted:
        made, fault = _on_one_level(path, tube, wanted)
        if made is not None:
            path = made
            break
        kept = [pair for pair in wanted if not fault.intersection(pair)]
        kept = kept if len(kept) < len(wanted) else wanted[: len(wanted) // 2]
        left_over += [pair for pair in wanted if pair not in kept]
        wanted = kept
    for pair in sorted(left_over, key=pairs.index)[:_MOST_TRIES]:
        path = _on_one_level(path, tube, [pair])[0] or path
    same = np.diff(path.which) == 0
    return path.without(np.flatnonzero(same[1:] & same[:-1]) + 1)


def _on_one_level(path: Path, tube: Tube, pairs: list[tuple[int, int]]) -> tuple[Path | None, set[int]]:
    """Return the path with pairs of corners on one level, or None and the corners that leave the tube then."""
    joined = path.joined(pairs)
    settled = settle(joined, tube)
    if tube.holds(settled):
        return settled, set()
    # What fits best on the whole leaves the tube somewhere: move nothing but the levels that became one.
    members = np.bincount(path.which, minlength=len(path.level))[path.which]
    changed = np.bincount(joined.which)[joined.which] != members
    held = joined.held.copy()
    held[joined.which[~changed]] = True
    settled = settle(replace(joined, pinned=np.ones_like(joined.pinned), held=held), tube)
    settled = replace(settled, pinned=joined.pinned, held=joined.held)
    return (settled, set()) if tube.holds(settled) else (None, set(tube.at_fault(settled).tolist()))


def _holds(path: Path, tolerance: float) -> list[tuple[int, int]]:
    """Return the ends of pieces that rise or fall by so little that they may be holds, the flattest first."""
    change = np.abs(np.diff(path.value))
    pieces = [j for j in np.argsort(change, kind="stable").tolist() if change[j] <= 2 * tolerance]
    return [(j, j + 1) for j in pieces if not (path.pinned[j] and path.pinned[j + 1])]


def _recurring(path: Path, tolerance: float) -> list[tuple[int, int]]:
    """Return pairs of corners that may share a level: the two ends, any corner and the first, holds close together."""
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
