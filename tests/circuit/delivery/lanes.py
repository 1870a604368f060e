"""The independent circuit in many lanes with held currents, cut-offs or PI loops.

A lane moves by an implicit step of second order (two stages, without ringing). Its matrix is tridiagonal, and a current
changes two elements of it; elimination runs from deep tissue outwards, so that these two come last. Under a display
that is prescribed (`Circuit.of` without module), temperatures in °C stand in the place of currents.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit

from tests.circuit.delivery.independent import KELVIN, Array, Circuit

GAMMA = 1 - np.sqrt(0.5)
FIRST_S, LONGEST_S, PER_DOUBLING = 0.005, 4.0, 32
"""Steps grow with the time since the current has changed."""
FOREVER = (-1e9, 1e9, 0.0)
"""No cut-off: a span that no display leaves."""
Index = npt.NDArray[np.int64]


@njit(cache=True)
def _factor(capacity: Array, diagonal: Array, beside: Array, step_s: float, most: int, turned: Array) -> None:
    """Inverse pivots of the first `most` nodes, from the deepest outwards."""
    for i in range(most - 1, -1, -1):
        below = beside[i] ** 2 * turned[i + 1] if i + 1 < len(capacity) else 0.0
        turned[i] = 1.0 / (diagonal[i] + capacity[i] / (GAMMA * step_s) - below)


@njit(cache=True)
def _step(
    capacity: Array, beside: Array, turned: Array, heat: Array, step_s: float, begun: Array, inside: Array, sums: Array
) -> None:
    """Move `begun` by a step in place."""
    count = len(begun)
    for stage in range(2):
        above = 0.0
        for i in range(count - 1, -1, -1):
            at = begun[i] if stage == 0 else begun[i] + (1 - GAMMA) / GAMMA * (inside[i] - begun[i])
            sums[i] = capacity[i] / (GAMMA * step_s) * at + heat[i] - above
            above = beside[i - 1] * sums[i] * turned[i] if i else 0.0
        goal = inside if stage == 0 else begun
        goal[0] = sums[0] * turned[0]
        for i in range(1, count):
            goal[i] = (sums[i] - beside[i - 1] * goal[i - 1]) * turned[i]


@njit(cache=True)
def _shown(node: Array, weight: Array, offset: Array, x: Array, which: int) -> float:
    return float(weight[which, 0] * x[node[which, 0]] + weight[which, 1] * x[node[which, 1]] + offset[which])


@njit(cache=True)
def _note(node: Array, weight: Array, offset: Array, x: Array, ends: Array) -> None:
    for which in range(4):
        value = _shown(node, weight, offset, x, which)
        ends[which, 0], ends[which, 1] = min(ends[which, 0], value), max(ends[which, 1], value)


@njit(cache=True)
def _hold(
    parts: Any, world: Index, state: Array, flow: Array, span: Array, cut: Array, ends: Array, trip: Array
) -> None:
    capacity, diagonal, beside, heat, pump, push, node, weight, offset, direct = parts
    count = capacity.shape[1]
    own, gets, turned = np.empty(count), np.empty(count), np.empty(count)
    inside, sums, kept = np.empty(count), np.empty(count), np.empty(count)
    for lane in range(len(world)):
        w, x, time, end, step, known = world[lane], state[lane, :count], 0.0, span[lane], FIRST_S, -1.0
        low, high, late = cut[lane]
        own[:], gets[:] = diagonal[w], heat[w]
        own[0] -= pump[w] * flow[lane, 0]
        own[1] += pump[w] * flow[lane, 0]
        for i in range(2):
            gets[i] += push[w, i, 0] * flow[lane, 0] + push[w, i, 1] * flow[lane, 1]
        at = offset[w] + direct[w] * flow[lane, 0]
        shown = _shown(node[w], weight[w], at, x, 2)
        if shown < low or shown > high:
            end, trip[lane] = min(end, late), 0.0
        _note(node[w], weight[w], at, x, ends[lane])
        while time < end - 1e-9:
            while time >= PER_DOUBLING * step and step < LONGEST_S:
                step *= 2.0
            size = min(step, end - time)
            if size != known:
                _factor(capacity[w], own, beside[w], size, count, turned)
                known = size
            kept[:] = x
            _step(capacity[w], beside[w], turned, gets, size, x, inside, sums)
            before, shown = shown, _shown(node[w], weight[w], at, x, 2)
            if trip[lane] > 1e8 and (shown < low or shown > high):
                edge = low if shown < low else high
                trip[lane] = time + size * (edge - before) / (shown - before)
                end, shown, x[:] = trip[lane] + late, before, kept
                continue
            time += size
            _note(node[w], weight[w], at, x, ends[lane])


@njit(cache=True)
def _regulate(parts: Any, loop: Array, world: Index, state: Array, levels: Array, period: float, ends: Array) -> None:
    capacity, diagonal, beside, heat, pump, push, node, weight, offset, _ = parts
    count = capacity.shape[1]
    own, gets, turned = np.empty(count), np.empty(count), np.empty(count)
    inside, sums = np.empty(count), np.empty(count)
    rows = max(1, int(np.ceil(period / 0.01 - 1e-9)))
    for lane in range(len(world)):
        w, x, felt, summed = world[lane], state[lane, :count], state[lane, count], state[lane, count + 1]
        kp, ki, keep, wrong, least, most, gain = loop[w]
        _factor(capacity[w], diagonal[w], beside[w], period / rows, count, turned)
        for level in levels:
            felt = keep * felt + (1 - keep) * _shown(node[w], weight[w], offset[w], x, 2)
            error = felt + wrong - level
            grown = summed + ki * error * period
            asked = (kp * error + grown) * gain
            sent = min(max(asked, least), most)
            summed = grown if sent == asked else min(max(grown, least / gain), most / gain)
            own[:], gets[:] = diagonal[w], heat[w]
            own[0] -= pump[w] * sent
            own[1] += pump[w] * sent
            for i in range(2):
                gets[i] += push[w, i, 0] * sent + push[w, i, 1] * sent**2
            _factor(capacity[w], own, beside[w], period / rows, 2, turned)
            for _ in range(rows):
                _step(capacity[w], beside[w], turned, gets, period / rows, x, inside, sums)
                _note(node[w], weight[w], offset[w], x, ends[lane])
        state[lane, count], state[lane, count + 1] = felt, summed


@dataclass(frozen=True, eq=False)
class Lanes:
    """The worlds of a circuit as arrays for the lanes; states are (lanes, n), flows as in the circuit's own worlds."""

    circuit: Circuit
    parts: tuple[Array, ...]

    @staticmethod
    def of(circuit: Circuit) -> Lanes:
        """All worlds of a circuit."""
        matrix, watch = circuit.matrix, circuit.watch
        node = np.argsort(-np.abs(watch), axis=2, kind="stable")[:, :, :2]
        assert np.abs(np.sort(np.abs(watch), axis=2)[:, :, :-2]).max() == 0.0, "a temperature is read between two nodes"
        beside = np.append(np.diagonal(matrix, 1, 1, 2), np.zeros((len(matrix), 1)), axis=1)
        push = np.zeros((len(matrix), 2, 2))
        push[:, 0, 0] = circuit.alpha * KELVIN + circuit.display[:, 0]
        push[:, 1, 0] = -circuit.alpha * KELVIN
        push[:, :, 1] = 0.5 * circuit.ohm[:, None]
        parts = (
            circuit.capacity, np.diagonal(matrix, 0, 1, 2), beside, circuit.heat, circuit.alpha, push, node,
            np.take_along_axis(watch, node, axis=2), circuit.offset, circuit.direct,
        )  # fmt: skip
        return Lanes(circuit, tuple(np.ascontiguousarray(part) for part in parts))

    def steady(self, flow: Array, square: Array) -> Array:
        """States (worlds, n + 2) under flows (worlds,) held indefinitely; the last two are a loop's own."""
        rate, heat = self.circuit.system(flow, square)
        heat[:, 0] += self.circuit.display[:, 0] * flow / self.circuit.capacity[:, 0]
        found = np.linalg.solve(-rate, heat[:, :, None])
        shown = self.circuit.read(found)[:, 2, :]
        return np.concatenate([found[:, :, 0], shown, np.zeros_like(shown)], axis=1)

    def hold(self, state: Array, world: Index, flow: Array, span_s: Array | float, cut: Array | None = None) -> Array:
        """Move states in place under flows (lanes, 2) of mean A and mean square A², and return how far lanes went.

        That is (lanes, 9): lowest and highest of what is watched, and the time at which a cut-off saw the display
        outside (1e9: never); `cut` (lanes, 3) has its edges in °C and its reaction time in s.
        """
        ends, trip = self._ends(len(world)), np.full(len(world), 1e9)
        spans = np.broadcast_to(np.asarray(span_s, dtype=np.float64), world.shape)
        never = np.broadcast_to(np.array(FOREVER), (len(world), 3))
        _hold(self.parts, world, state, flow, spans, never if cut is None else cut, ends, trip)
        return np.column_stack([ends.reshape(-1, 8), trip])

    def regulate(self, loop: Array, state: Array, world: Index, levels_C: Array, period_s: float) -> Array:
        """Move states in place under PI loops (worlds, 7), as `hold` does, by set-points one for each update.

        A loop: kp in A/K, ki in A/(K·s), share of its sensor's past, its error in K, limits of flow in A, and gain.
        """
        ends = self._ends(len(world))
        _regulate(self.parts, loop, world, state, levels_C, period_s, ends)
        return np.column_stack([ends.reshape(-1, 8), np.full(len(world), 1e9)])

    @staticmethod
    def _ends(count: int) -> Array:
        return np.tile(np.array([np.inf, -np.inf]), (count, 4, 1))


def joined(far: list[Array], lanes: int) -> Array:
    """Extremes (lanes, 9) over some."""
    found = np.tile([*[np.inf, -np.inf] * 4, 1e9], (lanes, 1))
    for one in far:
        found[:, 0:8:2] = np.minimum(found[:, 0:8:2], one[:, 0:8:2])
        found[:, 1:8:2] = np.maximum(found[:, 1:8:2], one[:, 1:8:2])
    return found
