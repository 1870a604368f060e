"""Exact solutions of the circuit by its modes.

With a constant current the circuit is linear: C·dx/dt = −K·x + b. K is symmetric, since the Peltier heat of a plate
depends on that plate alone, so C^(−1/2)·K·C^(−1/2) has real modes. A negative rate is a rig that heats without
end.
Skin under a display whose temperature is given, as by a thermode, has no module: C·dx/dt = −G·x + g₀·u·e₀, with
temperatures above the deep node's and u that of the display.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from itertools import pairwise

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from ..rig.module import ZERO_C_IN_K
from ..rig.rig import Rig
from ..rig.skin import column_of
from . import network as net
from .network import COLD, HOT, RECORDED, SKIN, Network

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
        """Modes of networks of one size; mean current and mean square (r,), by which a bridge that switches heats."""
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
        capacity, matrix, source = _with_sinks(networks, capacity, matrix, source)
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
                    if weight:  # behind the lumps, a passive sink stands before the deep node
                        weights[rig, row, place if place < lumps_end else count] += weight
        level = np.einsum("rpk,rk->rp", weights[:, :, :-1], rest) + weights[:, :, -1] * deep[:, np.newaxis]
        return ConstantCurrent(rates, to_modes, from_modes, rest, weights[:, :, :-1] @ from_modes, level)

    def only(self, rigs: Sequence[int]) -> ConstantCurrent:
        """The modes of some rigs, in that order."""
        return ConstantCurrent(*(getattr(self, field.name)[list(rigs)] for field in fields(self)))

    def run(self, rigs: Index, nodes_C: Array, times_s: Array, probes: Sequence[str]) -> Array:
        """Return probes (probes, lanes, times) at times from now of lanes on `rigs` (lanes,); nodes (lanes, m + 1)."""
        rest, rows = self.rest_C[rigs], [READ.index(probe) for probe in probes]
        modes = np.einsum("lmk,lk->lm", self.to_modes[rigs], nodes_C[:, :-1] - rest)
        values = np.empty((len(probes), len(rigs), len(times_s)))
        for rig in np.unique(rigs).tolist():  # its lanes share the decays
            lanes = np.flatnonzero(rigs == rig)
            decay = np.exp(np.minimum(-np.outer(self.rate_per_s[rig], times_s), FARTHEST))
            weighed = self.reading[rig, rows][:, np.newaxis] * modes[lanes]
            values[:, lanes] = weighed @ decay + self.level_C[rig, rows][:, np.newaxis, np.newaxis]
        return values

    def after(self, rigs: Index, nodes_C: Array, time_s: float | Array) -> Array:
        """Nodes (lanes, m + 1) a time later, or each lane a time of its own (lanes,)."""
        rest = self.rest_C[rigs]
        modes = np.einsum("lmk,lk->lm", self.to_modes[rigs], nodes_C[:, :-1] - rest)
        modes = modes * np.exp(np.clip(-self.rate_per_s[rigs] * np.asarray(time_s)[..., np.newaxis], None, FARTHEST))
        moved = rest + np.einsum("lkm,lm->lk", self.from_modes[rigs], modes)
        return np.concatenate([moved, nodes_C[:, -1:]], axis=1)

    def passage(self, time_s: float) -> tuple[Array, Array]:
        """The change of the nodes above the deep one in a time in s: matrix (r, m, m) and constant (r, m)."""
        decay = np.exp(np.clip(-self.rate_per_s * time_s, None, FARTHEST))
        matrix = (self.from_modes * decay[:, np.newaxis, :]) @ self.to_modes
        return matrix, self.rest_C - np.einsum("rkm,rm->rk", matrix, self.rest_C)


def _with_sinks(
    networks: Sequence[Network], capacity: Array, matrix: Array, source: Array
) -> tuple[Array, Array, Array]:
    """The system with a passive heat sink under the hot plate, where the networks have one."""
    if not networks[0].passive:
        return capacity, matrix, source
    rigs, inner = capacity.shape
    grown = np.zeros((rigs, inner + 1, inner + 1))
    grown[:, :inner, :inner] = matrix
    capacity = np.concatenate([capacity, np.zeros((rigs, 1))], axis=1)
    source = np.concatenate([source, np.zeros((rigs, 1))], axis=1)
    for rig, network in enumerate(networks):
        to_sink, air = float(network.plates[net.SINK_W_PER_K]), float(network.plates[net.SINK_AIR_W_PER_K])
        capacity[rig, -1] = network.plates[net.SINK_J_PER_K]
        source[rig, HOT] -= to_sink * network.plates[net.SINK_C]  # of an ideal one
        grown[rig, HOT, -1] = grown[rig, -1, HOT] = -to_sink  # its share at the hot plate is there already
        grown[rig, -1, -1] = to_sink + air
        source[rig, -1] = air * network.plates[net.SINK_C]
    return capacity, grown, source


FELT = RECORDED[RECORDED.index("display_C") :]
"""What a run under a prescribed display records: RECORDED without the hot plate, which a thermode does not have."""

SMALL = 1e-6
"""Below this λ·Δt the series replaces quotients that would lose digits."""


@dataclass(frozen=True, slots=True, eq=False)
class SkinModes:
    """A skin column as n modes: `rate_per_s` (n,), `drive_per_s` (n,) of a display of 1 K, readings of FELT.

    A reading is `reading @ z + direct · u + offset_C`, with modes z and display u in K above the deep node. `lumps`
    (n, n) turns modes into temperatures of lumps, in K above the deep node, and `unlumps` does the reverse.
    """

    deep_C: float
    rate_per_s: Array
    drive_per_s: Array
    reading: Array
    direct: Array
    offset_C: Array
    lumps: Array
    unlumps: Array

    def steady(self, display_C: float) -> Array:
        """Modes (n,) that a display held at a temperature leads to."""
        return np.asarray(self.drive_per_s / self.rate_per_s * (display_C - self.deep_C))

    def run(
        self, display_C: Array, step_s: float, modes: Array, rows: Sequence[int] | None = None
    ) -> tuple[Array, Array]:
        """FELT (7, rows), or some `rows` of it, and the modes at the end, for a display (rows,) linear between rows."""
        from . import kernel_modes

        keep, now, then = step_weights(self.rate_per_s, step_s)
        reading, direct, offset = self.reading, self.direct, self.offset_C
        if rows is not None:
            reading, direct, offset = reading[list(rows)], direct[list(rows)], offset[list(rows)]
        values, end = np.empty((len(reading), len(display_C))), modes.copy()
        kernel_modes.follow_display(
            display_C - self.deep_C, keep, now, then, self.drive_per_s, reading, direct, offset, end, values
        )
        return values, end

    def at(self, time_s: Array, display_C: Array) -> Array:
        """First reading (rows,) under a display (rows,) linear between any times, from a steady state."""
        steps, modes = np.round(np.diff(time_s), 12), self.steady(float(display_C[0]))
        values = np.empty(len(time_s))
        breaks = np.flatnonzero(np.diff(steps)) + 1  # equal steps are taken together
        for begin, end in pairwise([0, *breaks.tolist(), len(steps)]):
            felt, modes = self.run(display_C[begin : end + 1], float(steps[begin]), modes, [0])
            values[begin : end + 1] = felt[0]
        return values

    def relax(self, times_s: Array, display_C: float, modes: Array) -> Array:
        """Return FELT (7, times) at times after now, with the display held; `modes` (n,) are those of now."""
        rest = self.steady(display_C)
        z = rest[:, np.newaxis] + (modes - rest)[:, np.newaxis] * np.exp(-np.outer(self.rate_per_s, times_s))
        steady_C = self.direct * (display_C - self.deep_C) + self.offset_C
        return np.asarray(self.reading @ z + steady_C[:, np.newaxis])

    def after(self, time_s: float, display_C: float, modes: Array) -> Array:
        """Modes (n,) a time later, with the display held."""
        rest = self.steady(display_C)
        return np.asarray(rest + (modes - rest) * np.exp(-self.rate_per_s * time_s))

    def per_K(self, row: int) -> float:
        """Steady change of a reading for each K of the display."""
        return float(self.direct[row] + self.reading[row] @ (self.drive_per_s / self.rate_per_s))

    def rest(self, row: int, display_C: float) -> float:
        """A reading under a display held at a temperature in °C for long."""
        return self.per_K(row) * (display_C - self.deep_C) + float(self.offset_C[row])

    def rise(self, row: int, step_s: float, rows: int) -> Array:
        """Change (rows,) of a reading, `step_s` apart, under a display that rises by 1 K/s from the first on."""
        from . import kernel_modes

        response = np.empty(rows)
        weight = self.reading[row] * self.drive_per_s / self.rate_per_s
        kernel_modes.rise(float(self.direct[row]), weight, self.rate_per_s, step_s, response)
        return response

    def display_for_skin(
        self, target_C: Array, step_s: float, start_C: float, slew_K_per_s: float, limits_C: tuple[float, float]
    ) -> Array:
        """The display (rows,) in °C that takes the face of the skin to targets (rows,), the first held before.

        As the inverse of a module does, each level comes from one implicit step over the period, which damps it, and
        the state moves by the exact one. Slew rate and limits are those of the thermode.
        """
        row = FELT.index("skin_C")
        weight, direct = self.reading[row], float(self.direct[row])
        keep, now, then = step_weights(self.rate_per_s, step_s)
        damped, gain = 1.0 / (1.0 + self.rate_per_s * step_s), step_s * self.drive_per_s
        per_display = float(weight @ (damped * gain)) + direct
        modes, level, most = self.steady(start_C), start_C - self.deep_C, slew_K_per_s * step_s
        low, high = limits_C[0] - self.deep_C, limits_C[1] - self.deep_C
        displays_C = np.empty(len(target_C))
        displays_C[0] = start_C
        for k, target in enumerate((target_C - self.offset_C[row]).tolist()[1:], 1):
            needed_C = (target - float(weight @ (damped * modes))) / per_display
            new = min(max(needed_C, level - most, low), level + most, high)
            modes = keep * modes + self.drive_per_s * (now * level + then * new)
            level = new
            displays_C[k] = new + self.deep_C
        return displays_C

    def display_holding_skin_C(self, skin_C: float) -> float:
        """Temperature of the display in °C that holds the face of the skin at one in steady state."""
        row = FELT.index("skin_C")
        return self.deep_C + (skin_C - float(self.offset_C[row])) / self.per_K(row)


@lru_cache(maxsize=256)
def modes_of(rig: Rig, insulated: bool = False) -> SkinModes:
    """The modes of a rig's skin in contact; `insulated`: under a display that conducts no heat."""
    return modes_on(net.skin_network_of(rig), insulated)


@lru_cache(maxsize=64)
def thermode_modes(
    rig: Rig, depths_m: tuple[float, ...], contact_m2K_per_W: float, effusivity: float = 1.0
) -> SkinModes:
    """Modes of a rig's skin under a thermode of another contact, with so many times the effusivity of living layers.

    In place of FELT, °C and then W/m² into the skin are read at depths below the face.

    >>> thermode_modes(Rig.load("forearm"), (0.15e-3,), 2.5e-4).rise(0, 0.5, 3).round(2)
    array([0.  , 0.11, 0.33])
    """
    skin = rig.skin.with_effusivity(effusivity)
    column = column_of(skin, rig.column.blood_capacity_J_per_m3K)
    resistance = column.resistance_m2K_per_W.copy()
    resistance[0] += contact_m2K_per_W
    place = np.concatenate([[0.0], np.cumsum(resistance)])
    at = [contact_m2K_per_W + skin.resistance_to_m2K_per_W(depth) for depth in depths_m]
    readings = net.stacked(
        [read(each, place) for read in (net.temperature_weights, net.smooth_flow_weights) for each in at]
    )
    g = 1.0 / resistance
    return _modes(rig.deep_C, column.capacity_J_per_m2K, g, column.perfusion_W_per_m2K, float(g[0]), readings)


def modes_on(network: Network, insulated: bool = False, readings: tuple[Index, Array] | None = None) -> SkinModes:
    """Return the modes of a network's skin; its plates play no part. `readings` are recorded after FELT."""
    g, felt = network.conductance_W_per_K, [RECORDED.index(probe) for probe in FELT]
    rows = network.probe_start[felt], network.probe_weight[felt]
    if readings is not None:
        rows = np.concatenate([rows[0], readings[0]]), np.concatenate([rows[1], readings[1]])
    first, perfusion = 0.0 if insulated else float(g[0]), network.perfusion_W_per_K
    return _modes(network.deep_C, network.capacity_J_per_K, g, perfusion, first, rows, dense=True)


def _modes(
    deep_C: float, capacity: Array, g: Array, perfusion: Array, first: float, readings: tuple[Index, Array],
    dense: bool = False,
) -> SkinModes:  # fmt: skip
    """Modes of lumps; the `dense` solver takes longer, and rounds as it always did."""
    from scipy.linalg import eigh_tridiagonal

    diagonal, root = np.concatenate([[first], g[1:-1]]) + g[1:] + perfusion, np.sqrt(capacity)
    if dense:
        matrix, inner = np.diag(diagonal), np.arange(len(capacity) - 1)
        matrix[inner, inner + 1] = matrix[inner + 1, inner] = -g[1:-1]
        rates, vectors = np.linalg.eigh(matrix / np.outer(root, root))
    else:
        rates, vectors = eigh_tridiagonal(diagonal / capacity, -g[1:-1] / (root[1:] * root[:-1]), check_finite=False)
    shape = vectors / root[:, np.newaxis]  # lumps = shape @ modes
    weights = np.zeros((len(readings[0]), len(capacity) + 3))
    for row, (start, three) in enumerate(zip(*readings, strict=True)):
        weights[row, start : start + 3] = three
    below, direct = weights[:, SKIN:-1], weights[:, COLD]
    offset = weights.sum(axis=1) * deep_C  # zero for heat flows
    assert not weights[:, HOT].any()
    drive, rate_per_s = first * vectors[0] / root[0], np.asarray(rates, dtype=np.float64)
    return SkinModes(deep_C, rate_per_s, drive, below @ shape, direct, offset, shape, vectors.T * root)


def shown(setpoint_C: Array, step_s: float, lag_s: float = 0.0, slew_K_per_s: float = np.inf) -> Array:
    """The display (rows,) in °C that follows set-points from rest: first-order lag, exact for lines, and slew rate."""
    most = slew_K_per_s * step_s
    if lag_s <= 0 and np.abs(np.diff(setpoint_C)).max(initial=0.0) <= most:
        return setpoint_C.copy()
    keep, now, then = (0.0, 0.0, 1.0)
    if lag_s > 0:
        weights = step_weights(np.array([1.0 / lag_s]), step_s)
        keep, now, then = float(weights[0][0]), float(weights[1][0]) / lag_s, float(weights[2][0]) / lag_s
    level, before, reached = float(setpoint_C[0]), float(setpoint_C[0]), []
    for target_C in setpoint_C.tolist():
        goal = keep * level + now * before + then * target_C
        level, before = min(max(goal, level - most), level + most), target_C
        reached.append(level)
    return np.array(reached)


def step_weights(rate_per_s: Array, step_s: float) -> tuple[Array, Array, Array]:
    """The decay of a mode over a step, and the weights in s of a linear forcing at its beginning and its end."""
    x = rate_per_s * step_s
    keep = np.exp(-x)
    safe = np.where(x < SMALL, 1.0, x)
    whole = np.where(x < SMALL, 1.0 - 0.5 * x, -np.expm1(-x) / safe)
    late = np.where(x < SMALL, 0.5 - x / 6.0, (1.0 - whole) / safe)
    return keep, step_s * (whole - late), step_s * late
