"""A play as a linear map: with a given current the circuit is linear, so a few runs tell what any start leads to.

One lane a node starts 1 K warmer there, and one starts as it is: the differences at the end are the columns of Φ in
x → Φ·x + g. Then repetition costs products of small matrices instead of runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from thermicon.circuit.rig.skin import Array
from thermicon.circuit.solver.batch_inputs import State
from thermicon.circuit.solver.drive import Drive

if TYPE_CHECKING:
    from thermicon.circuit.safety.ensemble import Ensemble

MOST_STEPS = 20_000
"""A drive of more steps is run again and again instead: a map takes some 50 runs, a search for a cycle about ten."""

POWERS = 40
"""Products by which the largest eigenvalue of a map with no negative entry is found to within a per mille."""


@dataclass(frozen=True, slots=True, eq=False)
class PlayMap:
    """Nodes above the deep one (rigs, m) at the end of something, from those before: `matrix @ nodes + constant`."""

    matrix: Array
    constant: Array

    @staticmethod
    def of(ensemble: Ensemble, drive: Drive, start: State) -> PlayMap:
        """The map of a drive in every corner of an ensemble whose heat sinks are ideal."""
        corners, nodes = start.nodes_C.shape
        free = nodes - 1
        warmer = np.zeros((free + 1, nodes))
        warmer[1:, :free] = np.eye(free)
        begun = (start.nodes_C[:, np.newaxis] + warmer).reshape(-1, nodes)
        rigs = np.repeat(np.arange(corners, dtype=np.int64), free + 1)
        ended = ensemble.end_of(drive, State.settled(begun), rigs).nodes_C.reshape(corners, free + 1, nodes)[
            :, :, :free
        ]
        matrix = np.swapaxes(ended[:, 1:] - ended[:, :1], 1, 2)
        return PlayMap(matrix, ended[:, 0] - np.einsum("cij,cj->ci", matrix, start.nodes_C[:, :free]))

    def after(self, nodes_C: Array) -> Array:
        """Nodes (rigs, m + 1) afterwards; the last, which is deep, stays."""
        moved = np.einsum("cij,cj->ci", self.matrix, nodes_C[:, :-1]) + self.constant
        return np.concatenate([moved, nodes_C[:, -1:]], axis=1)

    def then(self, other: PlayMap) -> PlayMap:
        """First this map, then another."""
        return PlayMap(
            other.matrix @ self.matrix, np.einsum("cij,cj->ci", other.matrix, self.constant) + other.constant
        )

    def only(self, corners: list[int]) -> PlayMap:
        """The map of some rigs."""
        return PlayMap(self.matrix[corners], self.constant[corners])

    def fixed_point(self) -> tuple[Array, npt.NDArray[np.bool_]]:
        """Nodes (rigs, m) that come back to themselves, and whether all others tend to them (rigs,)."""
        count = self.matrix.shape[1]
        grown = np.ones(self.constant.shape)
        for _ in range(POWERS):
            before = np.maximum(np.abs(grown).max(axis=1, keepdims=True), 1e-300)
            grown = np.einsum("cij,cj->ci", self.matrix, grown / before)
        settles: npt.NDArray[np.bool_] = np.abs(grown).max(axis=1) < 1.0 - 1e-9
        point = np.linalg.solve(np.eye(count) - self.matrix, self.constant[:, :, np.newaxis])[:, :, 0]
        return np.asarray(point), settles
