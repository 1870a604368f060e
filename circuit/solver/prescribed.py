"""Skin under a display whose temperature is prescribed, as by a thermode with its own control loop.

Without a module the circuit is linear and time-invariant: C·dx/dt = −G·x + g₀·u·e₀, with temperatures above the deep
node's and u that of the display. Its modes are solved exactly for a display that is linear between instants.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from ..arrays import Array, Index
from ..rig.rig import Rig
from .network import COLD, HOT, RECORDED, SKIN, Network, skin_network_of

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
        """Return FELT (7, rows) and the modes at the end, for a display (rows,) linear between rows `step_s` apart.

        `rows` are the places of some quantities in FELT; None: all.

        >>> modes = modes_of(Rig.load("thenar"))
        >>> felt, _ = modes.run(np.full(3, 32.0), 0.01, modes.steady(32.0))
        >>> bool(np.ptp(felt[0]) == 0.0)
        True
        """
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

    def display_for_skin(
        self, target_C: Array, step_s: float, start_C: float, slew_K_per_s: float, limits_C: tuple[float, float]
    ) -> Array:
        """Return the display (rows,) in °C that takes the face of the skin to targets (rows,), the first held before.

        As the inverse of a module does, each level comes from one implicit step over the period, which damps it, and
        the state moves by the exact one. `slew_K_per_s` and `limits_C` are those of the thermode.
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
        per_K = float(self.reading[row] @ (self.drive_per_s / self.rate_per_s) + self.direct[row])
        return self.deep_C + (skin_C - float(self.offset_C[row])) / per_K


@lru_cache(maxsize=256)
def modes_of(rig: Rig, insulated: bool = False) -> SkinModes:
    """Return the modes of a rig's skin in contact; `insulated`: under a display that conducts no heat.

    >>> round(modes_of(Rig.load("thenar")).display_holding_skin_C(32.0), 2)
    31.96
    """
    return modes_on(skin_network_of(rig), insulated)


def modes_on(network: Network, insulated: bool = False, readings: tuple[Index, Array] | None = None) -> SkinModes:
    """Return the modes of a network's skin; its plates play no part. `readings` are recorded after FELT."""
    capacity, g, perfusion = network.capacity_J_per_K, network.conductance_W_per_K, network.perfusion_W_per_K
    first = 0.0 if insulated else float(g[0])
    matrix = np.diag(np.concatenate([[first], g[1:-1]]) + g[1:] + perfusion)
    inner = np.arange(len(capacity) - 1)
    matrix[inner, inner + 1] = matrix[inner + 1, inner] = -g[1:-1]
    root = np.sqrt(capacity)
    rates, vectors = np.linalg.eigh(matrix / np.outer(root, root))
    shape = vectors / root[:, np.newaxis]  # lumps = shape @ modes
    felt = [RECORDED.index(probe) for probe in FELT]
    rows = list(zip(network.probe_start[felt], network.probe_weight[felt], strict=True))
    rows += [] if readings is None else list(zip(*readings, strict=True))
    weights = np.zeros((len(rows), len(capacity) + 3))
    for row, (start, three) in enumerate(rows):
        weights[row, start : start + 3] = three
    below, direct = weights[:, SKIN:-1], weights[:, COLD]
    offset = weights.sum(axis=1) * network.deep_C  # zero for heat flows
    assert not weights[:, HOT].any()
    unlumps = vectors.T * root
    return SkinModes(network.deep_C, rates, first * vectors[0] / root[0], below @ shape, direct, offset, shape, unlumps)


def shown(setpoint_C: Array, step_s: float, lag_s: float = 0.0, slew_K_per_s: float = np.inf) -> Array:
    """Return the display (rows,) in °C of a thermode that follows set-points (rows,), `step_s` apart, from rest.

    First-order lag, exact for set-points that are linear between rows, and no faster than its slew rate.

    >>> shown(np.array([30.0, 31.0, 31.0]), 0.1, slew_K_per_s=5.0).tolist()
    [30.0, 30.5, 31.0]
    """
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
    """What a mode keeps over a step, and the weights in s of a linear forcing at its beginning and its end."""
    x = rate_per_s * step_s
    keep = np.exp(-x)
    safe = np.where(x < SMALL, 1.0, x)
    whole = np.where(x < SMALL, 1.0 - 0.5 * x, -np.expm1(-x) / safe)
    late = np.where(x < SMALL, 0.5 - x / 6.0, (1.0 - whole) / safe)
    return keep, step_s * (whole - late), step_s * late
