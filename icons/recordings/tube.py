"""The tube that a path through a recording must keep to: room about every reading, and between readings that bend."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .settle import Path

    Array = NDArray[np.float64]

SPARE = 1e-3
"""The share of the tolerance that a first path leaves for the last digits."""

INSTANT_S = 1e-9
"""How far (s) two readings at one time are held apart while fitting, so that a step is a piece like others."""


@dataclass(frozen=True, slots=True)
class Tube:
    """What a path must keep to, arrays of shape (points,): ``time`` (s) rises, deviations stay within ``room``.

    ``recorded`` is the time without the instants that steps take in ``time``; ``own`` marks readings, the other points
    lie between two of them; ``weight`` says how much a point draws a path. ``begins`` are the points at which the
    recording begins and where it goes on after a step. ``tolerance`` is the room that one reading leaves.
    """

    time: Array
    recorded: Array
    reading: Array
    room: Array
    weight: Array
    own: NDArray[np.bool_]
    begins: NDArray[np.intp]
    tolerance: float

    def excess(self, path: Path) -> Array:
        """Return by how much the path leaves the tube at each point, negative inside."""
        return np.asarray(np.abs(np.interp(self.time, path.time, path.value) - self.reading) - self.room)

    def deviation(self, path: Path) -> float:
        """Return how far the path lies from the farthest reading."""
        return float(self.excess(path)[self.own].max() + self.tolerance)

    def holds(self, path: Path) -> bool:
        """Tell whether the path stays in the tube."""
        return bool((np.diff(path.time) > 0).all() and (self.excess(path) <= 0).all())

    def at_fault(self, path: Path) -> NDArray[np.intp]:
        """Return the corners of the pieces that leave the tube, and those that are not in order, rising."""
        piece = np.searchsorted(path.time, self.time[self.excess(path) > 0], side="right") - 1
        piece = np.append(np.clip(piece, 0, len(path.time) - 2), np.flatnonzero(np.diff(path.time) <= 0))
        return np.union1d(piece, piece + 1)


def tube_about(time: Array, reading: Array, tolerance: float, start: float | None = None) -> Tube:
    """Return the tube about readings (readings,) at times (s) that rise, or stand twice.

    Two readings at one time are a step when no value lies within the tolerance of both, or not the prescribed `start`;
    otherwise they are one reading.
    """
    apart = np.abs(np.diff(reading))
    twice = np.diff(time) == 0
    step = twice & (apart > 2 * tolerance * (1 - SPARE))
    if start is not None and twice[0] and abs(reading[1] - start) > tolerance:
        step[0] = True
    room, weight = np.full_like(time, tolerance), np.ones_like(time)
    one = np.flatnonzero(twice & ~step)
    reading, kept = reading.copy(), np.ones(len(time), dtype=bool)
    reading[one], room[one], weight[one] = (reading[one] + reading[one + 1]) / 2, tolerance - apart[one] / 2, 2.0
    kept[one + 1] = False
    begins = np.concatenate(([False], step))[kept]
    points = np.stack((time[kept], reading[kept], room[kept], weight[kept], np.ones(kept.sum())))
    many = min(max(2000 // len(time), 1), 8)
    stretches = [_between(each, many, tolerance) for each in np.split(points, np.flatnonzero(begins), axis=1)]
    lengths = [each.shape[1] for each in stretches]
    time, reading, room, weight, own = np.concatenate(stretches, axis=1)
    instants = INSTANT_S * np.repeat(np.arange(len(stretches)), lengths)
    first = np.cumsum([0, *lengths[:-1]])
    return Tube(time + instants, time, reading, room, weight, own > 0, first, tolerance)


def _between(points: Array, many: int, tolerance: float) -> Array:
    """Return points (5, points) with `many` more in each gap beside a bend, where a recording counts as straight.

    A path may be twice the tolerance off that straight line, for a corner there that noise hides, and further off
    where three readings on each side lie on two lines that meet in the gap.
    """
    time, reading = points[:2]
    if len(time) < 3:
        return points
    gap = np.diff(time)
    slope = np.diff(reading) / gap
    bend = np.diff(slope)
    straight = np.abs(bend) / (1 / gap[1:] + 1 / gap[:-1]) <= 2 * tolerance
    before, after = np.concatenate(([0.0], bend)), np.append(bend, 0.0)
    known = np.concatenate(([False, False], straight[:-1])) & np.concatenate((straight[1:], [False, False]))
    near = np.minimum(np.concatenate(([0.0], gap[:-1])), np.append(gap[1:], 0.0))
    known &= (before * after > 0) & (gap <= 8 * near)
    depth = np.zeros_like(gap)
    depth[known] = 1.5 * gap[known] / (1 / np.abs(before[known]) + 1 / np.abs(after[known]))
    bent = np.flatnonzero(np.maximum(np.abs(before), np.abs(after)) * gap > tolerance / 2)
    share, ones = np.arange(1, many + 1) / (many + 1), np.ones(many)
    more = (
        time[bent, None] + gap[bent, None] * share,
        reading[bent, None] + (slope * gap)[bent, None] * share,
        (2 * tolerance + depth[bent, None]) * ones,
        (depth[bent, None] == 0) * ones,
        0 * bent[:, None] * ones,
    )
    found = np.concatenate((points, np.stack([each.ravel() for each in more])), axis=1)
    return found[:, np.argsort(found[0], kind="stable")]
