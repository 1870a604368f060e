"""Corner times and levels moved to where they fit a recording best: damped least squares inside a tube."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_MOST_STEPS = 40
# Beyond this share of the room a deviation costs more, step by step, until it is inside.
_SHARE = 0.9
_COSTS = (0.0, 1e2, 1e4)


@dataclass(frozen=True, slots=True)
class Tube:
    """What a path must keep to: shapes (points,); ``time`` rises, deviations stay within ``room``.

    ``weight`` says how much a point draws the path, ``tolerance`` is the room that a reading leaves.
    """

    time: Array
    reading: Array
    room: Array
    weight: Array
    tolerance: float

    def excess(self, path: Path) -> Array:
        """Return by how much the path leaves the tube at each point, negative inside."""
        return np.asarray(np.abs(np.interp(self.time, path.time, path.value) - self.reading) - self.room)

    def holds(self, path: Path) -> bool:
        """Tell whether the path stays in the tube."""
        return bool((np.diff(path.time) > 0).all() and (self.excess(path) <= 0).all())

    def at_fault(self, path: Path) -> NDArray[np.intp]:
        """Return the corners of the pieces that leave the tube, rising."""
        piece = np.searchsorted(path.time, self.time[self.excess(path) > 0], side="right") - 1
        piece = np.clip(piece, 0, len(path.time) - 2)
        return np.union1d(piece, piece + 1)


@dataclass(frozen=True, slots=True)
class Path:
    """A polyline: corner times (corners,), rising; levels (levels,); which level each corner has.

    Corners that are ``pinned`` keep their time; with ``given``, the level of the first corner is prescribed.
    """

    time: Array
    level: Array
    which: NDArray[np.intp]
    pinned: NDArray[np.bool_]
    given: bool = False

    @property
    def value(self) -> Array:
        """Value at each corner, shape (corners,)."""
        return np.asarray(self.level[self.which])

    def joined(self, pairs: list[tuple[int, int]]) -> Path:
        """Return the path with the levels of pairs of corners made one, at their mean or at the prescribed level."""
        which = self.which.copy()
        for one, other in pairs:
            which[which == which[other]] = which[one]
        kept, which = np.unique(which, return_inverse=True)
        level = np.bincount(which, self.value) / np.bincount(which)
        if self.given:
            level[which[0]] = self.value[0]
        return replace(self, level=level, which=which)

    def without(self, corners: NDArray[np.intp]) -> Path:
        """Return the path without some of its corners."""
        kept, which = np.unique(np.delete(self.which, corners), return_inverse=True)
        pinned, time = np.delete(self.pinned, corners), np.delete(self.time, corners)
        return Path(time, self.level[kept], which, pinned, self.given)


def settle(path: Path, tube: Tube, levels: bool = True) -> Path:
    """Return the path of the same corners that fits best, by least squares, or that one which keeps to the tube.

    With ``levels`` False only times move. The path returned may leave the tube; ``Tube.holds`` tells.
    """
    for cost in _COSTS:
        path = _least_squares(path, tube, levels, cost)
        if tube.holds(path):
            break
    return path


def _least_squares(path: Path, tube: Tube, levels: bool, cost: float) -> Path:
    """Levenberg and Marquardt's method on all levels and times at once; a piece knows only of its two corners."""
    slot, count = _unknowns(path, levels)
    if count == 0:
        return path
    damping, error, system = 1e-4, *_system(path, tube, slot, count, cost)
    for _ in range(_MOST_STEPS):
        matrix, pull = system
        scale = np.diag(matrix).copy()
        scale[scale <= 0] = 1.0
        step = np.append(np.linalg.solve(matrix + np.diag(damping * scale), pull), 0.0)
        moved = _moved(path, step, slot)
        trial, trial_system = _system(moved, tube, slot, count, cost)
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
    """Return, for each corner's level (row 0) and time (row 1), the place of its unknown; the last place is for none."""
    free = np.full(len(path.level), levels)
    if path.given:
        free[path.which[0]] = False
    moving = ~path.pinned
    moving[[0, -1]] = False
    count = int(free.sum() + moving.sum())
    places = np.where(free, np.cumsum(free) - 1, count)
    return np.stack((places[path.which], np.where(moving, free.sum() + np.cumsum(moving) - 1, count))), count


def _moved(path: Path, step: Array, slot: NDArray[np.intp]) -> Path:
    level = path.level.copy()
    level[path.which] = path.value + step[slot[0]]
    # No corner passes another: each moves by at most two fifths of the shorter piece beside it.
    length = np.diff(path.time)
    most = 0.4 * np.minimum(np.append(length, np.inf), np.append(np.inf, length))
    return replace(path, level=level, time=path.time + np.clip(step[slot[1]], -most, most))


def _system(
    path: Path, tube: Tube, slot: NDArray[np.intp], count: int, cost: float
) -> tuple[float, tuple[Array, Array]]:
    """Return the error of a path, and the matrix and right side whose solution is the best small move."""
    value, length = path.value, np.diff(path.time)
    pieces = len(length)
    slope = np.diff(value) / length
    piece = np.clip(np.searchsorted(path.time, tube.time, side="right") - 1, 0, pieces - 1)
    share = (tube.time - path.time[piece]) / length[piece]
    missing = tube.reading - value[piece] - share * (value[piece + 1] - value[piece])
    beyond = np.abs(missing) - _SHARE * tube.room
    outside = np.where(beyond > 0, cost, 0.0)
    error = float((tube.weight * missing**2).sum() + (outside * beyond**2).sum())
    pull = tube.weight * missing + outside * np.copysign(beyond, missing)
    stiff = tube.weight + outside

    def over(points: Array) -> Array:
        return np.bincount(piece, points, minlength=pieces)

    # Derivatives by level and time at the left corner are (1 - share)(1, -slope), at the right one share (1, -slope).
    left, right = 1 - share, share
    both = np.stack((over(stiff * left * left), over(stiff * left * right), over(stiff * right * right)))
    ends = both[[[0, 1], [1, 2]]]
    turn = np.stack((np.ones(pieces), -slope))
    local = np.einsum("abp,cp,dp->pcadb", ends, turn, turn)
    side = np.einsum("ap,cp->pca", np.stack((over(pull * left), over(pull * right))), turn)
    places = np.stack((slot[:, :-1], slot[:, 1:]), axis=-1).transpose(1, 0, 2)
    matrix, vector = np.zeros((count + 1, count + 1)), np.zeros(count + 1)
    np.add.at(matrix, (places[:, :, :, None, None], places[:, None, None, :, :]), local)
    np.add.at(vector, places, side)
    return error, (matrix[:-1, :-1], vector[:-1])
