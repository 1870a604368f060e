"""Many rigs under a current that does not change: exact temperatures at any later time, by modes.

With a constant current the circuit is linear: C·dx/dt = −K·x + b. K is symmetric, since the Peltier heat of a plate
depends on that plate alone, so C^(−1/2)·K·C^(−1/2) has real modes. A heat sink must be ideal: one with a controller of
its own saturates, and is stepped by the kernel instead. A negative rate is a rig that heats without end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Index
from ..rig.module import ZERO_C_IN_K
from .network import COLD, HOT, RECORDED, SKIN, Network

READ = RECORDED[:5]
"""What can be read: the temperatures of RECORDED."""

FARTHEST = 60.0
"""Exponents are cut here: e^60 times a millikelvin is hotter than anything."""


@dataclass(frozen=True, slots=True, eq=False)
class ConstantCurrent:
    """Modes of r rigs with n skin lumps each, under a constant current each.

    `rate_per_s` (r, n + 2), `to_modes` and `from_modes` (r, n + 2, n + 2), `rest_C` (r, n + 2): where all rates are
    positive, the steady state. `reading` (r, probes, n + 2) reads RECORDED[:5] off the modes, `level_C` (r, probes) is
    what they read at rest.
    """

    rate_per_s: Array
    to_modes: Array
    from_modes: Array
    rest_C: Array
    reading: Array
    level_C: Array

    @staticmethod
    def of(networks: Sequence[Network], mean_A: Array, square_A2: Array) -> ConstantCurrent:
        """Modes of networks with equally many lumps; mean current and mean square of it (r,).

        A bridge that switches heats with the mean square, which is larger than the square of the mean.
        """
        plates = np.array([network.plates for network in networks])
        alpha, ohm, leak, hot_J, cold_J, sink, out, deep = plates[:, :8].T
        capacity = np.column_stack([hot_J, cold_J, [network.capacity_J_per_K for network in networks]])
        g = np.array([network.conductance_W_per_K for network in networks])
        perfusion = np.array([network.perfusion_W_per_K for network in networks])
        rigs, count = capacity.shape
        pump, joule = alpha * mean_A, 0.5 * ohm * square_A2
        matrix = np.zeros((rigs, count, count))
        matrix[:, HOT, HOT] = leak + out - pump
        matrix[:, COLD, COLD] = leak + pump + g[:, 0]
        matrix[:, HOT, COLD] = matrix[:, COLD, HOT] = -leak
        lumps = np.arange(SKIN, count)
        matrix[:, lumps, lumps] = g[:, :-1] + g[:, 1:] + perfusion
        above = np.arange(COLD, count - 1)
        matrix[:, above, above + 1] = matrix[:, above + 1, above] = -g[:, :-1]
        source = np.zeros((rigs, count))
        source[:, HOT] = out * sink + pump * ZERO_C_IN_K + joule
        source[:, COLD] = -pump * ZERO_C_IN_K + joule
        source[:, SKIN:] = perfusion * deep[:, np.newaxis]
        source[:, -1] += g[:, -1] * deep
        root = np.sqrt(capacity)
        rates, vectors = np.linalg.eigh(matrix / (root[:, :, np.newaxis] * root[:, np.newaxis, :]))
        from_modes = vectors / root[:, :, np.newaxis]
        to_modes = np.swapaxes(vectors, 1, 2) * root[:, np.newaxis, :]
        forcing = np.einsum("rkm,rk->rm", vectors, source / root)
        safe = np.where(np.abs(rates) < 1e-12, 1e-12, rates)
        rest = np.einsum("rkm,rm->rk", from_modes, forcing / safe)
        weights = np.zeros((rigs, len(READ), count + 1))
        for rig, network in enumerate(networks):
            for row, start in enumerate(network.probe_start[: len(READ)].tolist()):
                weights[rig, row, start : start + 3] += network.probe_weight[row][: count + 1 - start]
        level = np.einsum("rpk,rk->rp", weights[:, :, :-1], rest) + weights[:, :, -1] * deep[:, np.newaxis]
        return ConstantCurrent(rates, to_modes, from_modes, rest, weights[:, :, :-1] @ from_modes, level)

    def only(self, rigs: Sequence[int]) -> ConstantCurrent:
        """The modes of some rigs, in that order."""
        which = list(rigs)
        return ConstantCurrent(
            self.rate_per_s[which], self.to_modes[which], self.from_modes[which], self.rest_C[which],
            self.reading[which], self.level_C[which],
        )  # fmt: skip

    def run(self, rigs: Index, nodes_C: Array, times_s: Array, probes: Sequence[str]) -> Array:
        """Return probes (probes, lanes, times) at times from now of lanes on `rigs` (lanes,); nodes (lanes, n + 3)."""
        from . import kernel_modes

        rest = self.rest_C[rigs]
        modes = np.einsum("lmk,lk->lm", self.to_modes[rigs], nodes_C[:, :-1] - rest)
        rows = [READ.index(probe) for probe in probes]
        values = np.empty((len(probes), len(rigs), len(times_s)))
        reading, level = np.ascontiguousarray(self.reading[:, rows]), np.ascontiguousarray(self.level_C[:, rows])
        kernel_modes.relax(rigs, times_s, self.rate_per_s, modes, reading, level, values)
        return values

    def after(self, rigs: Index, nodes_C: Array, time_s: float) -> Array:
        """Nodes (lanes, n + 3) a time later."""
        rest = self.rest_C[rigs]
        modes = np.einsum("lmk,lk->lm", self.to_modes[rigs], nodes_C[:, :-1] - rest)
        modes = modes * np.exp(np.clip(-self.rate_per_s[rigs] * time_s, None, FARTHEST))
        moved = rest + np.einsum("lkm,lm->lk", self.from_modes[rigs], modes)
        return np.concatenate([moved, nodes_C[:, -1:]], axis=1)

    def passage(self, time_s: float) -> tuple[Array, Array]:
        """What a time in s does to the nodes above the deep one: matrix (r, m, m) and constant (r, m)."""
        decay = np.exp(np.clip(-self.rate_per_s * time_s, None, FARTHEST))
        matrix = (self.from_modes * decay[:, np.newaxis, :]) @ self.to_modes
        return matrix, self.rest_C - np.einsum("rkm,rm->rk", matrix, self.rest_C)
