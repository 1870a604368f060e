"""PI loops with lag, delay, wrong sensors or a cut-off on the independent circuit.

Every lane is one controller around the rig in one world of its uncertainty. It shares nothing with thermicon but the
files: set-points, and what their sidecar demands. A cut-off on a second sensor ends with zero current for good.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.circuit.delivery.exported_files import Course
from tests.circuit.delivery.followed import Follower
from tests.circuit.delivery.independent import Array, Json, worlds_of
from tests.circuit.delivery.replay import SESSION_S, Worst, exposure

IN_A_FAULT_K = 1.0
"""Skin and receptors may pass their limits by so much."""


@dataclass
class Controllers:
    """Gains and flaws of controllers (L,); `bound` chooses a kind of anti-windup."""

    kp: Array
    ki: Array
    kd: Array
    lag_s: Array
    delay_s: Array
    offset_K: Array
    second_K: Array
    bound: Array

    @staticmethod
    def within(loop: Json, rng: np.random.Generator, count: int) -> Controllers:
        """By chance within what a sidecar demands of the loop, often at its edges."""

        def some(low: float, high: float) -> Array:
            inside = rng.uniform(low, high, count)
            return np.where(rng.random(count) < 0.5, rng.choice([low, high], count), inside)

        offset = loop["sensor_offset_at_most_K"]
        return Controllers(
            some(*loop["kp_A_per_K"]), some(*loop["ki_A_per_Ks"]), np.full(count, loop["kd_As_per_K"]),
            some(0.0, loop["sensor_lag_at_most_s"]), some(0.0, loop["delay_at_most_s"]), some(-offset, offset),
            some(-offset, offset), rng.random(count) < 0.5,
        )  # fmt: skip

    @staticmethod
    def of_any_kind(loop: Json, rng: np.random.Generator, count: int) -> Controllers:
        """Far beyond those demands: too strong, too slow, late, and with a sensor that is wrong by kelvins."""
        some = Controllers.within(loop, rng, count)
        some.kp = np.exp(rng.uniform(np.log(0.05), np.log(20), count))
        some.ki = some.kp * np.exp(rng.uniform(np.log(0.02), np.log(5), count))
        some.kd = np.where(rng.random(count) < 0.3, rng.uniform(0, 0.5, count), 0.0)
        some.lag_s, some.delay_s = rng.uniform(0, 0.6, count), rng.uniform(0, 0.6, count)
        some.offset_K = np.where(rng.random(count) < 0.5, rng.uniform(-3, 3, count), some.offset_K)
        return some


class Bench:
    """A rig in some worlds, one for each controller, with the current limits and the cut-off of a sidecar."""

    def __init__(self, rig: Json, demands: Json, which: Controllers, rng: np.random.Generator) -> None:
        known, count = worlds_of(rig, rng, 8), len(which.kp)
        lively = [one for one in known if one["gain_relative"] > 0 and one["contact_resistance_relative"] < 0]
        pools = [lively or known, known]
        worlds = [(pool := pools[int(rng.random() < 0.4)])[int(rng.integers(len(pool)))] for _ in range(count)]
        self.follower, self.which = Follower(rig, rng, worlds=worlds), which
        gain = self.follower.circuit.gain
        self.least_A, self.most_A = (limit * gain for limit in demands["current_limit_A"])
        cut = demands["cut_off_display_C"]
        self.low_C, self.high_C, self.react_s = cut["low"], cut["high"], cut["react_within_s"]
        held = demands["held_cut_off_display_C"] or {"low": -1e9, "high": 1e9, "longer_than_s": 1e9}
        self.held_C, self.held_s = (held["low"], held["high"]), held["longer_than_s"]
        self.period_s = self.follower.period_s

    def start(self, level_C: float) -> None:
        """At rest at the first set-point, as the loop's own sensor shows it."""
        amperes = np.clip(self.follower.holding(level_C - self.which.offset_K), self.least_A, self.most_A)
        self.state = self.follower._steady(amperes)
        self.display = self.follower.circuit.read(self.state[:, :, None])[:, 2, 0]
        self.felt, self.sum_A = self.display.copy(), amperes / self.follower.circuit.gain
        self.seen = [self.felt + self.which.offset_K] * (1 + int(np.ceil(self.which.delay_s.max() / self.period_s)))
        self.off_in_s, self.beyond_s = np.full(len(self.felt), np.inf), np.zeros(len(self.felt))

    def copy(self) -> Bench:
        """The same bench, to go on from here in another way."""
        other = object.__new__(Bench)
        other.__dict__.update(self.__dict__)
        other.seen = list(self.seen)
        return other

    def play(
        self, levels_C: Array, stuck_A: Array | None = None, wrong_K: float = 0.0, every: int = 0, fault: str = ""
    ) -> tuple[Array, list[Bench]]:
        """Watched rows (rows, L, 4) under set-points, or a current that is stuck; `every`: copies on the way.

        The loop's sensor may be `frozen`, the wires may be `swapped`.
        """
        which, gain = self.which, self.follower.circuit.gain
        keep = np.where(which.lag_s > 0, np.exp(-self.follower.row_s / np.maximum(which.lag_s, 1e-9)), 0.0)
        behind = np.floor(which.delay_s / self.period_s + 1e-9).astype(int)
        lanes, states, copies = np.arange(len(self.felt)), [self.state], []
        for number, level in enumerate(levels_C):
            if every and number % every == 0:
                copies.append(self.copy())
            before = np.array(
                [
                    self.seen[-1 - k][lane]
                    for lane, k in zip(lanes, np.minimum(behind + 1, len(self.seen) - 1), strict=True)
                ]
            )
            reading = self.seen[-1] if fault == "frozen" else self.felt + which.offset_K + wrong_K
            self.seen = [*self.seen[1:], reading]
            now = np.array([self.seen[-1 - k][lane] for lane, k in zip(lanes, behind, strict=True)])
            error = now - level
            grown = self.sum_A + which.ki * error * self.period_s
            asked = which.kp * error + grown + which.kd * (now - before) / self.period_s
            sent = np.clip(asked * gain, self.least_A, self.most_A)
            free = np.abs(sent - asked * gain) < 1e-12
            clipped = np.clip(grown, self.least_A / gain, self.most_A / gain)
            self.sum_A = np.where(free, grown, np.where(which.bound, clipped, self.sum_A))
            if stuck_A is not None:
                sent = stuck_A
            elif fault == "swapped":
                sent = -sent
            second = self.display + which.second_K
            beyond = (second < self.held_C[0]) | (second > self.held_C[1])
            self.beyond_s = np.where(beyond & np.isinf(self.off_in_s), self.beyond_s + self.period_s, 0.0)
            trips = (second < self.low_C) | (second > self.high_C) | (self.beyond_s > self.held_s)
            self.off_in_s = np.minimum(self.off_in_s - self.period_s, np.where(trips, self.react_s, np.inf))
            amperes = np.where(self.off_in_s < self.period_s * 0.5, 0.0, sent)
            for state in self.follower.update(amperes, self.state):
                states.append(state)
                before_C, self.display = self.display, self.follower.circuit.read(state[:, :, None])[:, 2, 0]
                shown_C = np.where(which.lag_s > 0, 0.5 * (before_C + self.display), self.display)
                self.felt = keep * self.felt + (1 - keep) * shown_C
            self.state = states[-1]
        return self.follower.circuit.read(np.array(states).transpose(1, 2, 0)).transpose(2, 0, 1), copies

    def judge(self, rows: Array, worst: Worst, wider_K: float = 0.0, rates: bool = True) -> None:
        """Levels and rates."""
        worst.levels(rows, wider_K)
        if rates:
            worst.rates(rows, np.full(len(rows) - 1, self.follower.row_s))


def at_work(
    rig: Json, demands: Json, course: Course, which: Controllers, rng: np.random.Generator, plays: int, pause_s: float,
    *, doses: bool = True, faults: int = 0,
) -> Worst:  # fmt: skip
    """Play set-points by controllers some times with a pause, the last time with single faults at some instants."""
    worst, bench = Worst(), Bench(rig, demands, which, rng)
    alike = demands["current_limit_A"][0] == -demands["current_limit_A"][1]
    bench.start(float(course.display_C[0]))
    levels = bench.follower.levels_of(course, 0.0)
    between = bench.follower.levels_of(course, min(pause_s, 20.0))
    for number in range(plays):
        last = number == plays - 1
        every = max(1, len(levels) // faults) if faults and last else 0
        rows, copies = bench.play(levels if last else between, every=every)
        bench.judge(rows, worst)
    if doses:
        assert not np.isfinite(bench.off_in_s).any(), "no cut-off acts on a healthy play"
        count = max(1, int((SESSION_S + pause_s) / (len(levels) * bench.period_s + pause_s) + 1e-9))
        worst.doses(*(count * each for each in exposure(rows, np.full(len(rows) - 1, bench.follower.row_s))))
    after, _ = bench.play(np.full(round(10.0 / bench.period_s), course.display_C[-1]))
    bench.judge(after, worst)
    for number, copy in enumerate(copies):
        level = np.full(round(4.0 / bench.period_s), levels[min(number * every, len(levels) - 1)])
        lies_K = float(rng.choice([-8.0, -5.0, -2.0, 1.5, 3.0, 8.0]))
        for stuck, wrong_K, fault in (
            (bench.least_A, 0.0, ""), (bench.most_A, 0.0, ""), (None, lies_K, ""), (None, 0.0, "frozen"),
            (None, 0.0, "swapped"),
        ):  # fmt: skip
            other = copy.copy()
            rows, _ = other.play(level, stuck, wrong_K, fault=fault)
            # Where the icons need more current of one sign, wires that are swapped in mid-play move the skin too fast.
            other.judge(rows, worst, IN_A_FAULT_K, rates=fault != "swapped" or alike)
    return worst
