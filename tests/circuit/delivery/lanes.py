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
NEVER = 1e9
"""The time in s of what does not happen, and a temperature that no display has."""
TRIP, STAGE, DOSE, RATE = range(8, 12)
"""Columns of how far lanes went, behind the extremes: when a cut-off acted, which, CEM43 in min, and K/s of skin."""
SUM, BEYOND, LONGEST = -3, -2, -1
"""Columns of states: the sum of a loop; for how long in s a display is beyond the second cut-off, and was at most."""
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
        ends[2 * which], ends[2 * which + 1] = min(ends[2 * which], value), max(ends[2 * which + 1], value)


@njit(cache=True)
def _cem43(skin: float, time: float) -> float:
    """Dose in min of a time in s."""
    if skin < 37.0:
        return 0.0
    return float((0.25 if skin < 43.0 else 0.5) ** (43.0 - min(skin, 60.0)) * time / 60.0)


@njit(cache=True)
def _hold(parts: Any, world: Index, state: Array, flow: Array, span: Array, cut: Array, far: Array) -> None:
    capacity, diagonal, beside, heat, pump, push, node, weight, offset, direct = parts
    count = capacity.shape[1]
    own, gets, turned = np.empty(count), np.empty(count), np.empty(count)
    inside, sums, kept = np.empty(count), np.empty(count), np.empty(count)
    for lane in range(len(world)):
        w, x, time, end, step, known = world[lane], state[lane, :count], 0.0, span[lane], FIRST_S, -1.0
        low, high, late, held_low, held_high, longer = cut[lane]
        own[:], gets[:] = diagonal[w], heat[w]
        own[0] -= pump[w] * flow[lane, 0]
        own[1] += pump[w] * flow[lane, 0]
        for i in range(2):
            gets[i] += push[w, i, 0] * flow[lane, 0] + push[w, i, 1] * flow[lane, 1]
        at = offset[w] + direct[w] * flow[lane, 0]
        shown, skin = _shown(node[w], weight[w], at, x, 2), _shown(node[w], weight[w], at, x, 0)
        earlier, earlier_s = skin, 0.0
        since = -state[lane, BEYOND]
        if shown < low or shown > high:
            end, far[lane, TRIP], far[lane, STAGE] = min(end, late), 0.0, 1.0
        _note(node[w], weight[w], at, x, far[lane])
        while time < end - 1e-9:
            while time >= PER_DOUBLING * step and step < LONGEST_S:
                step *= 2.0
            beyond = shown < held_low or shown > held_high
            if not beyond:
                since = time
            elif far[lane, STAGE] == 0.0 and since + longer <= time + 1e-9:
                far[lane, TRIP], far[lane, STAGE] = time, 2.0
                break
            size = min(step, end - time)
            if beyond and far[lane, STAGE] == 0.0:
                size = min(size, since + longer - time)
            if size != known:
                _factor(capacity[w], own, beside[w], size, count, turned)
                known = size
            kept[:] = x
            _step(capacity[w], beside[w], turned, gets, size, x, inside, sums)
            before, shown = shown, _shown(node[w], weight[w], at, x, 2)
            if far[lane, TRIP] > 1e8 and (shown < low or shown > high):
                edge = low if shown < low else high
                far[lane, TRIP], far[lane, STAGE] = time + size * (edge - before) / (shown - before), 1.0
                end, shown, x[:] = far[lane, TRIP] + late, before, kept
                continue
            if not beyond and (shown < held_low or shown > held_high):
                since = time + size * ((held_low if shown < held_low else held_high) - before) / (shown - before)
            time += size
            state[lane, BEYOND] = time - since if shown < held_low or shown > held_high else 0.0
            state[lane, LONGEST] = max(state[lane, LONGEST], state[lane, BEYOND])
            colder, skin = skin, _shown(node[w], weight[w], at, x, 0)
            far[lane, DOSE] += _cem43(0.5 * (colder + skin), size)
            if time - earlier_s >= 0.01 - 1e-9:
                far[lane, RATE] = max(far[lane, RATE], abs(skin - earlier) / (time - earlier_s))
                earlier, earlier_s = skin, time
            _note(node[w], weight[w], at, x, far[lane])


@njit(cache=True)
def _regulate(
    parts: Any, loop: Array, world: Index, state: Array, levels: Array, period: float, stay: Array, far: Array
) -> None:
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
                before = _shown(node[w], weight[w], offset[w], x, 0)
                _step(capacity[w], beside[w], turned, gets, period / rows, x, inside, sums)
                skin, shown = _shown(node[w], weight[w], offset[w], x, 0), _shown(node[w], weight[w], offset[w], x, 2)
                far[lane, DOSE] += _cem43(0.5 * (before + skin), period / rows)
                far[lane, RATE] = max(far[lane, RATE], abs(skin - before) * rows / period)
                beyond = shown < stay[0] or shown > stay[1]
                state[lane, BEYOND] = state[lane, BEYOND] + period / rows if beyond else 0.0
                state[lane, LONGEST] = max(state[lane, LONGEST], state[lane, BEYOND])
                _note(node[w], weight[w], offset[w], x, far[lane])
        state[lane, count], state[lane, count + 1] = felt, summed


@dataclass(frozen=True, eq=False)
class Lanes:
    """The worlds of a circuit as arrays for the lanes; states are (lanes, n), flows as in the circuit's own worlds.

    `stay_C` is the span outside of which the time of a display counts, where no cut-off says another.
    """

    circuit: Circuit
    parts: tuple[Array, ...]
    stay_C: tuple[float, float] = (-NEVER, NEVER)

    @staticmethod
    def of(circuit: Circuit, stay_C: tuple[float, float] = (-NEVER, NEVER)) -> Lanes:
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
        return Lanes(circuit, tuple(np.ascontiguousarray(part) for part in parts), stay_C)

    def steady(self, flow: Array, square: Array) -> Array:
        """States (worlds, n + 4) under flows (worlds,) held indefinitely.

        Behind the nodes are two of a loop's own, and the times BEYOND and LONGEST.
        """
        rate, heat = self.circuit.system(flow, square)
        heat[:, 0] += self.circuit.display[:, 0] * flow / self.circuit.capacity[:, 0]
        nodes = np.linalg.solve(-rate, heat[:, :, None])
        none = np.zeros((len(nodes), 3))
        return np.concatenate([nodes[:, :, 0], self.circuit.read(nodes)[:, 2, :], none], axis=1)

    def hold(self, state: Array, world: Index, flow: Array, span_s: Array | float, cut: Array | None = None) -> Array:
        """Move states in place under flows (lanes, 2) of mean A and mean square A², and return how far lanes went.

        That is (lanes, 12): lowest and highest of what is watched, and TRIP, STAGE, DOSE and RATE; a lane ends early
        where a cut-off has acted. `cut` (lanes, 6) has the edges of the first in °C and its reaction time in s, and
        the edges of the second with the time in s after which it acts.
        """
        far = joined([], len(world))
        spans = np.broadcast_to(np.asarray(span_s, dtype=np.float64), world.shape)
        never = np.broadcast_to(np.array([-NEVER, NEVER, 0.0, *self.stay_C, NEVER]), (len(world), 6))
        _hold(self.parts, world, state, flow, spans, never if cut is None else cut, far)
        return far

    def shown(self, state: Array) -> Array:
        """The display (worlds,) in °C of states, one for each world."""
        return np.asarray(self.circuit.read(state[:, : SUM - 1, None])[:, 2, 0])

    def regulate(self, loop: Array, state: Array, world: Index, levels_C: Array, period_s: float) -> Array:
        """Move states in place under PI loops (worlds, 7), as `hold` does, by set-points one for each update.

        A loop: kp in A/K, ki in A/(K·s), share of its sensor's past, its error in K, limits of flow in A, and gain.
        """
        far = joined([], len(world))
        _regulate(self.parts, loop, world, state, levels_C, period_s, np.array(self.stay_C), far)
        return far


def joined(far: list[Array], lanes: int) -> Array:
    """How far lanes (lanes, 12) went in some stretches, one after the other."""
    whole = np.tile([*[np.inf, -np.inf] * 4, NEVER, 0.0, 0.0, 0.0], (lanes, 1))
    for stretch in far:
        whole[:, 0:8:2] = np.minimum(whole[:, 0:8:2], stretch[:, 0:8:2])
        whole[:, 1:8:2] = np.maximum(whole[:, 1:8:2], stretch[:, 1:8:2])
        whole[:, TRIP] = np.minimum(whole[:, TRIP], stretch[:, TRIP])
        whole[:, [STAGE, RATE]] = np.maximum(whole[:, [STAGE, RATE]], stretch[:, [STAGE, RATE]])
        whole[:, DOSE] += stretch[:, DOSE]
    return whole
