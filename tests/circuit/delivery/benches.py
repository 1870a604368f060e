"""Benches that play an export without faults."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.circuit.delivery.exported_files import Course
from tests.circuit.delivery.independent import KELVIN, Array, Circuit, Json
from tests.circuit.delivery.lanes import BEYOND, LONGEST, SUM, Lanes, joined
from tests.circuit.delivery.replay import Held


class Bench:
    """A file of held currents, or of display temperatures, on the lanes of a rig: one for each world."""

    open = True

    def __init__(self, lanes: Lanes, held: Held, ends: tuple[float, float], peak: float | None = None) -> None:
        self.lanes, self.held, self.gain, self.peak = lanes, held, lanes.circuit.gain, peak
        self.every = np.arange(len(self.gain))
        self.edges_s, self.end_s = np.cumsum(held.length_s), held.end_s
        self.least, self.most = (end * self.gain for end in ends)

    def flow(self, mean: Array | float, square: Array | float | None = None) -> Array:
        """Flows (worlds, 2) of a command."""
        flows = mean * self.gain
        return np.column_stack([flows, self.squares(flows) if square is None else square * self.gain**2])

    def squares(self, flows: Array) -> Array:
        """Mean squares of flows; a bridge switches its peak."""
        return flows**2 if self.peak is None else np.abs(flows) * self.peak * self.gain

    def watched(self, far: Array) -> Array:
        """Extremes (lanes, 4, 2) of temperatures that have limits, of `far` (lanes, 12)."""
        return far[:, :8].reshape(-1, 4, 2)

    def rest(self) -> Array:
        """States (worlds, n) at rest."""
        return self.lanes.steady(*self.flow(*self.held.rest).T)

    def unpowered(self) -> Array:
        """States of a display that was without power for long."""
        return self.lanes.steady(*self.flow(0.0).T)

    def off(self, state: Array, world: Array, span_s: float) -> Array:
        """No current; the second cut-off begins anew."""
        return self._off(self.lanes, state, world, span_s)

    @staticmethod
    def _off(lanes: Lanes, state: Array, world: Array, span_s: float) -> Array:
        longest_s = state[:, LONGEST].copy()
        far = lanes.hold(state, world, np.zeros((len(world), 2)), span_s)
        state[:, LONGEST], state[:, BEYOND] = longest_s, 0.0
        return far

    def wait(self, state: Array, span_s: float) -> Array:
        """Rest before a play."""
        return self.lanes.hold(state, self.every, self.flow(*self.held.rest), span_s)

    def run(self, state: Array, begin_s: float, end_s: float) -> Array:
        """From one time of a play and its pause to another: extremes on the way."""
        far, now = [], begin_s
        edges = [*self.edges_s[:-1], self.end_s, np.inf]
        for k in range(int(np.searchsorted(edges, begin_s + 1e-9)), len(edges)):
            until = min(edges[k], end_s)
            if until > now:
                far.append(self.lanes.hold(state, self.every, self.flow(*self.at(until)), until - now))
                now = until
            if until >= end_s:
                break
        return joined(far, len(self.every))

    def at(self, time_s: float) -> tuple[float, float]:
        """The command just before a time."""
        k = int(np.searchsorted(self.edges_s, time_s - 1e-9))
        if k == len(self.edges_s):
            return self.held.rest
        return float(self.held.mean_A[k]), float(self.held.square_A2[k])

    def hang(self, state: Array, time_s: float, span_s: float) -> Array:
        """What was commanded just before a time, for longer."""
        return self.lanes.hold(state, self.every, self.flow(*self.at(time_s)), span_s)

    def settling(self, level_C: Array | float) -> Array:
        """Flows (worlds,) that hold the display at levels, or as near to them as the driver can."""
        circuit = self.lanes.circuit
        matrix, heat = circuit.matrix, circuit.heat
        skin = np.linalg.solve(matrix[:, 2:, 2:], np.stack([matrix[:, 2:, 1], heat[:, 2:]], axis=2))
        own, got = (matrix[:, 1, 2:, None] * skin).sum(axis=1).T
        least, most, steps = self.least, self.most, np.linspace(0, 1, 401)[:, None]
        for _ in range(2):  # on the whole way, then beside the nearest
            flows = least + (most - least) * steps
            joule, pump = 0.5 * circuit.ohm * self.squares(flows), circuit.alpha * flows
            hot, cold = matrix[:, 0, 0] - pump, matrix[:, 1, 1] - own + pump
            cross = matrix[:, 0, 1]
            into = heat[:, 0] + joule + pump * KELVIN, heat[:, 1] - got + joule - pump * KELVIN
            shown = (hot * into[1] - cross * into[0]) / (hot * cold - cross**2)
            place = np.abs(shown - level_C).argmin(axis=0)
            least, most = (flows[np.clip(place + side, 0, 400), self.every] for side in (-1, 1))
        return np.asarray(flows[place, self.every])


class Display(Bench):
    """A display that is prescribed: levels in °C in the place of currents; without power no heat passes it."""

    open = False

    def __init__(self, skin: Circuit, course: Course, ends: tuple[float, float]) -> None:
        middle = 0.5 * (course.display_C[1:] + course.display_C[:-1])
        time_s = np.arange(len(course.display_C)) * course.step_s
        held = Held.of(time_s, np.append(middle, course.display_C[-1]), np.zeros(len(time_s)))
        rest = (float(course.display_C[0]), 0.0)
        super().__init__(Lanes.of(skin), Held(held.length_s, held.mean_A, held.square_A2, rest, held.last), ends)
        free = skin.matrix.copy()
        free[:, 0, 0] -= skin.display[:, 0]
        face = np.zeros_like(skin.watch)
        face[:, :2, 0] = 1.0  # under no display it is as warm as the first lump
        changed = {"matrix": free, "watch": face, "offset": 0 * skin.offset}
        self.free = Lanes.of(replace(skin, **changed, display=0 * skin.display, direct=0 * skin.direct))

    def unpowered(self) -> Array:
        return self.free.steady(*self.flow(0.0).T)

    def off(self, state: Array, world: Array, span_s: float) -> Array:
        return self._off(self.free, state, world, span_s)

    def settling(self, level_C: Array | float) -> Array:
        return np.broadcast_to(np.asarray(level_C, dtype=np.float64), len(self.every))

    def watched(self, far: Array) -> Array:
        return super().watched(far)[:, :2]


class Loop(Bench):
    """Set-points under PI loops within what a sidecar demands, with a sensor that is wrong and late."""

    open = False

    def __init__(self, lanes: Lanes, course: Course, demand: Json, update_Hz: float, rng: np.random.Generator) -> None:
        held = Held.of(
            np.arange(len(course.display_C)) * course.step_s, course.display_C, np.zeros(len(course.display_C))
        )
        super().__init__(lanes, held, demand["current_limit_A"])
        loop, count, self.period_s = demand["loop"], len(self.every), 1.0 / update_Hz
        edge = rng.random((4, count)) < 0.5
        kp, ki, lag_s, wrong = (
            np.where(at_end, rng.choice(list(span), count), rng.uniform(*span, count))
            for at_end, span in zip(
                edge,
                (loop["kp_A_per_K"], loop["ki_A_per_Ks"], (0.0, loop["sensor_lag_at_most_s"]),
                 (-loop["sensor_offset_at_most_K"], loop["sensor_offset_at_most_K"])),
                strict=True,
            )
        )  # fmt: skip
        keep = np.exp(-self.period_s / np.maximum(lag_s, 1e-6))
        self.loop = np.column_stack([kp, ki, keep, wrong, self.least, self.most, self.gain])

    def rest(self) -> Array:
        flows = self.settling(self.held.rest[0])
        state = self.lanes.steady(flows, flows**2)
        state[:, SUM] = flows / self.gain
        self.wait(state, 30.0)
        return state

    def wait(self, state: Array, span_s: float) -> Array:
        return self._regulate(state, self.held.rest[0], span_s)

    def off(self, state: Array, world: Array, span_s: float) -> Array:
        far = super().off(state, world, span_s)
        state[:, SUM] = 0.0
        return far

    def run(self, state: Array, begin_s: float, end_s: float) -> Array:
        first, last = round(begin_s / self.period_s), round(end_s / self.period_s)
        times = np.arange(first, last) * self.period_s
        levels = np.array([self.at(time + 2e-6)[0] if time < self.end_s else self.held.last[0] for time in times])
        return self.lanes.regulate(self.loop, state, self.every, levels, self.period_s)

    def hang(self, state: Array, time_s: float, span_s: float) -> Array:
        return self._regulate(state, self.at(time_s)[0] if time_s <= self.end_s else self.held.last[0], span_s)

    def _regulate(self, state: Array, level_C: float, span_s: float) -> Array:
        levels = np.full(round(span_s / self.period_s), level_C)
        return self.lanes.regulate(self.loop, state, self.every, levels, self.period_s)
