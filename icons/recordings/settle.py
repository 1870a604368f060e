"""Corner times and levels moved to where they fit a recording best: damped least squares inside a tube."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .tube import Tube

    Array = NDArray[np.float64]

_MOST_STEPS = 30
_SPARSE = 100


@dataclass(frozen=True, slots=True)
class Path:
    """A polyline: corner times (corners,), rising; levels (levels,); which level each corner has.

    Corners that are ``pinned`` keep their time, levels that are ``held`` stay when a path settles, shape (levels,).
    """

    time: Array
    level: Array
    which: NDArray[np.intp]
    pinned: NDArray[np.bool_]
    held: NDArray[np.bool_]

    @property
    def value(self) -> Array:
        """Value at each corner, shape (corners,)."""
        return np.asarray(self.level[self.which])

    def joined(self, pairs: list[tuple[int, int]]) -> Path:
        """Return the path with the levels of pairs of corners made one: the held one, or else the mean."""
        which, held = self.which.copy(), self.held.copy()
        for pair in pairs:
            one, other = (int(which[corner]) for corner in pair)
            if held[one] and held[other]:
                continue
            one, other = (other, one) if held[other] else (one, other)
            which[which == other] = one
        kept, which = np.unique(which, return_inverse=True)
        mean = np.bincount(which, self.value) / np.bincount(which)
        return replace(self, level=np.where(held[kept], self.level[kept], mean), which=which, held=held[kept])

    def without(self, corners: NDArray[np.intp]) -> Path:
        """Return the path without some of its corners."""
        kept, which = np.unique(np.delete(self.which, corners), return_inverse=True)
        pinned, time = np.delete(self.pinned, corners), np.delete(self.time, corners)
        return Path(time, self.level[kept], which, pinned, self.held[kept])


def settle(path: Path, tube: Tube, levels: bool = True) -> Path:
    """Return the path of the same corners that fits best, by least squares; it may leave the tube.

    With ``levels`` False only times move. Levenberg and Marquardt's method: a piece knows only of its two corners.
    """
    slot, count = _unknowns(path, levels)
    if count == 0:
        return path
    damping, error, system = 1e-4, *_system(path, tube, slot, count)
    for _ in range(_MOST_STEPS):
        moved = _moved(path, np.append(_solved(*system, damping), 0.0), slot)
        trial, trial_system = _system(moved, tube, slot, count)
        if trial > error:
            damping *= 10
            if damping > 1e6:
                break
            continue
        slopes = np.abs(np.diff(path.value) / np.diff(path.time))
        steepest = np.maximum(np.append(slopes, 0), np.append(0, slopes))
        shift = max(np.abs(moved.level - path.level).max(), (np.abs(moved.time - path.time) * steepest).max())
        path, error, system = moved, trial, trial_system
        damping = max(damping / 10, 1e-9)
        if shift < 1e-5 * tube.tolerance:
            break
    return path


def _unknowns(path: Path, levels: bool) -> tuple[NDArray[np.intp], int]:
    """Return the place of the unknown of each corner's level (row 0) and time (row 1); the last place is for none."""
    free = ~path.held & levels
    moving = ~path.pinned
    moving[[0, -1]] = False
    count = int(free.sum() + moving.sum())
    places = np.where(free, np.cumsum(free) - 1, count)
    return np.stack((places[path.which], np.where(moving, free.sum() + np.cumsum(moving) - 1, count))), count


def _moved(path: Path, step: Array, slot: NDArray[np.intp]) -> Path:
    level = path.level.copy()
    level[path.which] = path.value + step[slot[0]]
    # No corner passes another: each moves by at most two fifths of the shorter piece beside it, above a microsecond.
    length = np.maximum(np.diff(path.time) - 1e-6, 0.0)
    most = 0.4 * np.minimum(np.append(length, np.inf), np.append(np.inf, length))
    return replace(path, level=level, time=path.time + np.clip(step[slot[1]], -most, most))


def _solved(matrix: Array, pull: Array, damping: float) -> Array:
    scale = np.diag(matrix).copy()
    scale[scale <= 0] = 1.0
    matrix = matrix + np.diag(damping * scale)
    if len(pull) < _SPARSE:
        return np.asarray(np.linalg.solve(matrix, pull), dtype=np.float64)
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import spsolve

    return np.asarray(spsolve(csc_array(matrix), pull))


def _system(path: Path, tube: Tube, slot: NDArray[np.intp], count: int) -> tuple[float, tuple[Array, Array]]:
    """Return the error of a path, and the matrix and right side whose solution is the best small move."""
    value, length = path.value, np.diff(path.time)
    slope = np.diff(value) / length
    begins = np.concatenate(([0], np.searchsorted(tube.time, path.time[1:-1])))
    points = np.diff(begins, append=len(tube.time))
    # Points stand piece by piece, so that sums over pieces are sums over stretches; an empty stretch has no sum.
    share = tube.time * np.repeat(1 / length, points) - np.repeat(path.time[:-1] / length, points)
    missing = tube.reading - np.repeat(value[:-1], points) - share * np.repeat(np.diff(value), points)
    stiff, pull = tube.weight, tube.weight * missing

    def over(terms: Array) -> Array:
        return np.asarray(np.where(points > 0, np.add.reduceat(np.append(terms, 0.0), begins), 0.0))

    # Derivatives by level and time at the left corner are (1 - share)(1, -slope), at the right one share (1, -slope).
    once, twice, whole = over(stiff * share), over(stiff * share * share), over(stiff)
    both = np.stack((whole - 2 * once + twice, once - twice, twice))
    ends = both[[[0, 1], [1, 2]]]
    turn = np.stack((np.ones(len(length)), -slope))
    local = np.einsum("abp,cp,dp->pcadb", ends, turn, turn)
    pulled = over(pull * share)
    side = np.einsum("ap,cp->pca", np.stack((over(pull) - pulled, pulled)), turn)
    places = np.stack((slot[:, :-1], slot[:, 1:]), axis=-1).transpose(1, 0, 2)
    matrix, vector = np.zeros((count + 1, count + 1)), np.zeros(count + 1)
    np.add.at(matrix, (places[:, :, :, None, None], places[:, None, None, :, :]), local)
    np.add.at(vector, places, side)
    return float(pull @ missing), (matrix[:-1, :-1], vector[:-1])
