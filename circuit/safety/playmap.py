"""The steady cycle of a drive and the bounds of repeated plays.

With a given current the circuit is linear in its temperatures, and a node never gets colder because another is warmer:
a play with its pause is a map x → Φ·x + g with Φ ≥ 0. The state before a play therefore tends to a fixed point, the
*steady cycle*. A state u that is warmer than rest, and that no drive of a set makes warmer (Φ·u + g ≤ u for each), is
warmer than the state before any play in any order: the *warm bound*; the *cold bound* is its mirror image.

A few runs determine a map: one lane per node starts 1 K warmer there, and one starts unchanged. Repetition then costs
products of small matrices. The least u with u = max(start, Φ₁·u + g₁, Φ₂·u + g₂ …), node by node, comes from Howard's
iteration: which of them is the largest in each node, solve with those, again until none changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from thermicon.base.files.inputs import InputError
from thermicon.base.numbers.arrays import Array

from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .ensemble import Ensemble, LaneDrives

MOST_ROWS = 20_000
"""A drive of more rows is thinned for the matrix of its map, which takes some 50 runs."""

THIN_S = 0.01
"""Length of the intervals of a thinned drive, as of the longest steps of a simulation."""

MOST_CHOICES = 60
"""Most iterations of Howard's method; a handful is usual."""

POWERS = 40
"""Products that distinguish an eigenvalue below 1 from one above; where they fail, all are computed."""

ROUNDING_K = 1e-11
"""Howard's method has arrived when no node moves by more than this."""

NEAR_K = 1e-6
"""Tolerance for the growth of a bound in one more play: rounding."""

NO_BOUND = (
    "not judged: no bound was found for the temperatures of repeated plays; use a longer pause, fewer icons, or a "
    "smaller or shorter change"
)
"""What is said of plays whose bound an iteration did not reach, in place of any temperature."""


class UnjudgedError(InputError):
    """A drive of which no verdict can be computed: it is refused, though nothing says that it is unsafe."""


@dataclass(frozen=True, slots=True, eq=False)
class PlayMap:
    """Nodes above the deep one (rigs, m) at the end of something, from those before: `matrix @ nodes + constant`."""

    matrix: Array
    constant: Array

    @staticmethod
    def of(ensemble: Ensemble, drive: Drive | LaneDrives, start: State) -> PlayMap:
        """The map of a drive in every corner of an ensemble.

        A long drive is itself played from `start`. Only the differences from there are those of the thinned one: the
        current pumps a few hundredths as much heat of them, so that at most 1e-4 of a difference is wrong.
        """
        corners, nodes = start.nodes_C.shape
        free = nodes - 1
        warmer = np.zeros((free + 1, nodes))
        warmer[1:, :free] = np.eye(free)
        begun = (start.nodes_C[:, np.newaxis] + warmer).reshape(-1, nodes)
        rigs = np.repeat(np.arange(corners, dtype=np.int64), free + 1)
        thin = thinned(drive)
        ended = ensemble.end_of(thin, State(begun), rigs).nodes_C
        ended = ended.reshape(corners, free + 1, nodes)[:, :, :free]
        matrix = np.swapaxes(ended[:, 1:] - ended[:, :1], 1, 2)
        from_start = ended[:, 0]
        if thin is not drive:
            from_start = ensemble.end_of(drive, State(start.nodes_C)).nodes_C[:, :free]
        return PlayMap(matrix, np.zeros_like(from_start)).through(start.nodes_C[:, :free], from_start)

    def through(self, before_C: Array, after_C: Array) -> PlayMap:
        """The map with this matrix that takes nodes (rigs, m) to others."""
        return PlayMap(self.matrix, after_C - np.einsum("cij,cj->ci", self.matrix, before_C))

    def after(self, nodes_C: Array) -> Array:
        """Nodes (rigs, m + 1) afterwards; the last, which is deep, stays."""
        moved = np.einsum("cij,cj->ci", self.matrix, nodes_C[:, :-1]) + self.constant
        return np.concatenate([moved, nodes_C[:, -1:]], axis=1)

    def then(self, other: PlayMap) -> PlayMap:
        """First this map, then another."""
        constant = np.einsum("cij,cj->ci", other.matrix, self.constant) + other.constant
        return PlayMap(other.matrix @ self.matrix, constant)

    def only(self, corners: list[int]) -> PlayMap:
        """The map of some rigs."""
        return PlayMap(self.matrix[corners], self.constant[corners])

    def fixed_point(self) -> tuple[Array, npt.NDArray[np.bool_]]:
        """Nodes (rigs, m) that come back to themselves, and whether all others tend to them (rigs,)."""
        point = _solved(self.matrix, self.constant)
        return point, np.array([_settles(matrix) for matrix in self.matrix]) & np.isfinite(point).all(axis=1)


def thinned(drive: Drive | LaneDrives) -> Drive | LaneDrives:
    """A drive, or of one with too many rows the means of its current in intervals of about THIN_S; longer rows stay."""
    times, currents = drive.time_s, drive.current_A
    if len(times) - 1 <= MOST_ROWS:
        return drive
    lengths = np.diff(times)
    new = np.diff(np.floor(times[:-1] / THIN_S), prepend=-1.0) > 0.0
    begins = np.flatnonzero(new | (lengths >= 0.5 * THIN_S))
    during = currents[..., :-1] if drive.held else 0.5 * (currents[..., :-1] + currents[..., 1:])
    means = np.add.reduceat(during * lengths, begins, axis=-1) / np.add.reduceat(lengths, begins)
    return type(drive)(np.append(times[begins], times[-1]), np.append(means, currents[..., -1:], axis=-1), True)


def _settles(matrix: Array) -> bool:
    """Whether all eigenvalues of a matrix without negative entries lie inside the unit circle.

    For any v > 0 the largest lies between the least and the greatest of (P·v)/v, which powers of P bring together.
    """
    if not np.isfinite(matrix).all():
        return False
    v = np.ones(len(matrix))
    for _ in range(POWERS):
        grown = np.maximum(matrix @ v, 1e-12)
        ratio = grown / v
        if ratio.max() < 1.0 or ratio.min() >= 1.0:
            return bool(ratio.max() < 1.0)
        v = grown / grown.max()
    return bool(np.abs(np.linalg.eigvals(matrix)).max() < 1.0)


def least_bound(maps: Sequence[PlayMap], starts_C: Sequence[Array], side: float) -> Array:
    """Nodes (rigs, m) that starts and plays never exceed, by `side` 1 above or −1 below; checked.

    NaN where some play heats without limit when repeated; raises UnjudgedError where none does and no bound is found.
    """
    most = np.max([side * start for start in starts_C], axis=0)
    matrices = np.stack([np.zeros_like(maps[0].matrix), *(play_map.matrix for play_map in maps)])
    constants = np.stack([most, *(side * play_map.constant for play_map in maps)])
    now, chosen = most, np.full(most.shape, -1)
    rig, node = np.ogrid[: most.shape[0], : most.shape[1]]
    for _ in range(MOST_CHOICES):
        options = np.einsum("kcij,cj->kci", matrices, now) + constants
        best = np.argmax(np.nan_to_num(options, nan=-np.inf), axis=0)
        if (best == chosen).all():
            break
        chosen, before = best, now
        now = _solved(matrices[chosen, rig, node], constants[chosen, rig, node])
        if (np.abs(now - before) <= ROUNDING_K).all():  # two that are equally large may go on changing places
            break
    after = (np.einsum("kcij,cj->kci", matrices, now) + constants).max(axis=0)
    holds = (after <= now + NEAR_K).all(axis=1)
    for corner in np.flatnonzero(~holds).tolist():
        if all(_settles(play_map.matrix[corner]) for play_map in maps):
            raise UnjudgedError(NO_BOUND)
    return side * np.where(holds[:, np.newaxis], now, np.nan)


def _solved(matrix: Array, constant: Array) -> Array:
    """Solutions (rigs, m) of x = matrix·x + constant; NaN where there is none."""
    systems, solution = np.eye(constant.shape[1]) - matrix, np.full_like(constant, np.nan)
    try:
        return np.asarray(np.linalg.solve(systems, constant[..., np.newaxis])[..., 0], dtype=np.float64)
    except np.linalg.LinAlgError:  # of one rig at least: the others have theirs
        for rig, (system, offset) in enumerate(zip(systems, constant, strict=True)):
            with suppress(np.linalg.LinAlgError):
                solution[rig] = np.linalg.solve(system, offset)
    return solution
