"""Many rigs under a current that does not change: exact temperatures at any later time, by modes.

With a constant current the circuit is linear: C·dx/dt = −K·x + b. K is symmetric, since the Peltier heat of a plate
depends on that plate alone, so C^(−1/2)·K·C^(−1/2) has real modes. A heat sink must be ideal or passive: one with a
controller of its own saturates, and is stepped by the kernel instead. A negative rate is a rig that heats without end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..arrays import Array, Index
from ..rig.module import ZERO_C_IN_K
from .network import COLD, HOT, RECORDED, SKIN, Network
from .plate import CONDUCTANCE, LEG_J_PER_K, SINK_AIR_W_PER_K, SINK_C, SINK_J_PER_K, SINK_W_PER_K

READ = RECORDED[:5]
"""What can be read: the temperatures of RECORDED."""

FARTHEST = 60.0
"""Exponents are cut here: e^60 times a millikelvin is hotter than anything."""


@dataclass(frozen=True, slots=True, eq=False)
class ConstantCurrent:
    """Modes of r rigs with m states above the deep node each, under a constant current each.

    `rate_per_s` (r, m), `to_modes` and `from_modes` (r, m, m), `rest_C` (r, m): where all rates are positive, the
    steady state. `reading` (r, probes, m) reads RECORDED[:5] off the modes, `level_C` (r, probes) is
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
        """Modes of networks with equally many lumps and the same extras; mean current and mean square of it (r,).

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
        lumps_end = count
        capacity, matrix, source = _with_extras(networks, capacity, matrix, source, joule)
        count = capacity.shape[1]
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
                for place, weight in zip(range(start, start + 3), network.probe_weight[row].tolist(), strict=True):
                    if weight:  # behind the lumps, extras stand before the deep node
                        weights[rig, row, place if place < lumps_end else count] += weight
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
        """Return probes (probes, lanes, times) at times from now of lanes on `rigs` (lanes,); nodes (lanes, m + 1)."""
        from . import kernel_modes

        rest = self.rest_C[rigs]
        modes = np.einsum("lmk,lk->lm", self.to_modes[rigs], nodes_C[:, :-1] - rest)
        rows = [READ.index(probe) for probe in probes]
        values = np.empty((len(probes), len(rigs), len(times_s)))
        reading, level = np.ascontiguousarray(self.reading[:, rows]), np.ascontiguousarray(self.level_C[:, rows])
        kernel_modes.relax(rigs, times_s, self.rate_per_s, modes, reading, level, values)
        return values

    def after(self, rigs: Index, nodes_C: Array, time_s: float | Array) -> Array:
        """Nodes (lanes, m + 1) a time later, or each lane a time of its own (lanes,)."""
        rest = self.rest_C[rigs]
        modes = np.einsum("lmk,lk->lm", self.to_modes[rigs], nodes_C[:, :-1] - rest)
        modes = modes * np.exp(np.clip(-self.rate_per_s[rigs] * np.asarray(time_s)[..., np.newaxis], None, FARTHEST))
        moved = rest + np.einsum("lkm,lm->lk", self.from_modes[rigs], modes)
        return np.concatenate([moved, nodes_C[:, -1:]], axis=1)

    def passage(self, time_s: float) -> tuple[Array, Array]:
        """What a time in s does to the nodes above the deep one: matrix (r, m, m) and constant (r, m)."""
        decay = np.exp(np.clip(-self.rate_per_s * time_s, None, FARTHEST))
        matrix = (self.from_modes * decay[:, np.newaxis, :]) @ self.to_modes
        return matrix, self.rest_C - np.einsum("rkm,rm->rk", matrix, self.rest_C)


def _with_extras(
    networks: Sequence[Network], capacity: Array, matrix: Array, source: Array, joule: Array
) -> tuple[Array, Array, Array]:
    """The system with cells of the legs between the plates and a passive heat sink under the hot one; `joule` (r,)."""
    legs, extras = networks[0].legs, networks[0].extras
    if not extras:
        return capacity, matrix, source
    rigs, inner = capacity.shape
    grown = np.zeros((rigs, inner + extras, inner + extras))
    grown[:, :inner, :inner] = matrix
    capacity = np.concatenate([capacity, np.zeros((rigs, extras))], axis=1)
    source = np.concatenate([source, np.zeros((rigs, extras))], axis=1)
    for rig, network in enumerate(networks):
        leak, to_sink = float(network.plates[CONDUCTANCE]), float(network.plates[SINK_W_PER_K])
        if legs:  # in place of 1/Θ and I²R/2: half a cell, cells, half a cell
            capacity[rig, inner : inner + legs] = network.plates[LEG_J_PER_K] / legs
            source[rig, [HOT, COLD]] -= joule[rig]
            source[rig, inner : inner + legs] = 2.0 * joule[rig] / legs
            _join(grown[rig], HOT, COLD, -leak)
            chain = [HOT, *range(inner, inner + legs), COLD]
            for place, (above, below) in enumerate(pairwise(chain)):
                _join(grown[rig], above, below, leak * legs * (2.0 if place in (0, legs) else 1.0))
        if network.passive:
            air = float(network.plates[SINK_AIR_W_PER_K])
            capacity[rig, -1] = network.plates[SINK_J_PER_K]
            source[rig, HOT] -= to_sink * network.plates[SINK_C]  # of an ideal one
            grown[rig, HOT, HOT] -= to_sink
            _join(grown[rig], HOT, inner + extras - 1, to_sink)
            grown[rig, -1, -1] += air
            source[rig, -1] = air * network.plates[SINK_C]
    return capacity, grown, source


def _join(matrix: Array, one: int, other: int, conductance: float) -> None:
    """Add a conductance between two nodes."""
    matrix[[one, other], [one, other]] += conductance
    matrix[[one, other], [other, one]] -= conductance
