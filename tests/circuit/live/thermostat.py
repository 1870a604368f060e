"""A faulty temperature controller on the independent circuit in simulated time.

Rules: a thermistor follows its plate with a lag, and has an offset and a step; a wire that breaks reads the end of the
span; a loop turns every 10 ms and holds its current meanwhile; a watchdog counts from the last feed and nothing else
feeds it; a relay cuts all power, also that of a driver that is stuck; after a loss of supply a controller is off. A
hand that is not there is a contact that lets ten thousand times less heat through.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.circuit.delivery.independent import Circuit, worlds_of
from tests.circuit.delivery.lanes import RATE, Lanes
from thermicon.circuit import Export
from thermicon.circuit.delivery.delivered_drive import ModuleDrive
from thermicon.circuit.live.live_player import LivePlayer, play_in_order
from thermicon.circuit.live.play_live import live_numbers
from thermicon.circuit.live.play_log import MeasuredPlay, PlayLog
from thermicon.circuit.play.logged_line import LineRow
from thermicon.circuit.safety.demands import Demands

TURN_S = 0.01
FAULTS = (
    *("silent host", "loop open", "loop frozen", "loop off", "second open", "second frozen", "second off"),
    *("swapped before", "swapped", "stuck", "power lost"),
)


def drives_of(made: Export) -> dict[str, ModuleDrive]:
    found = [each.delivery for each in made.prepared if isinstance(each.delivery, ModuleDrive)]
    return {each.icon.name: each for each in found}


def demands_of(made: Export) -> Demands:
    return Demands.strictest([each.verdict.demands for each in made.prepared])


@dataclass
class Thermistor:
    """A sensor of a display."""

    felt_C: float
    lag_s: float = 0.1
    off_K: float = 0.0
    step_K: float = 0.0
    fault: str = ""
    lie_K: float = 3.0
    reads_C: float = 0.0

    def follow(self, display_C: float, noise_K: float) -> None:
        self.felt_C += (display_C - self.felt_C) * -math.expm1(-TURN_S / self.lag_s)
        if self.fault == "frozen":
            return
        reads_C = self.felt_C + self.off_K + noise_K + (self.lie_K if self.fault == "off" else 0.0)
        self.reads_C = round(reads_C / self.step_K) * self.step_K if self.step_K else reads_C
        if self.fault == "open":
            self.reads_C = -273.0


class Thermostat:
    """The device, which is its own clock; `at` lets something happen at a time in s."""

    def __init__(self, made: Export, rng: np.random.Generator, world: int | None = None) -> None:
        document = json.loads(made.rig.document)
        worlds = worlds_of(document, rng, 1)
        chosen = worlds[int(rng.integers(len(worlds))) if world is None else world]
        self.circuit = Circuit.of(document, [chosen, {**chosen, "contact_resistance_relative": 1e4}])
        self.lanes, self.rng, self.demands = Lanes.of(self.circuit), rng, demands_of(made)
        self.state = self.lanes.steady(np.zeros(2), np.zeros(2))[:1].copy()
        self.world = np.zeros(1, dtype=np.int64)
        self.loop, self.second = Thermistor(self.display_C), Thermistor(self.display_C)
        self.sign, self.stuck_A = 1.0, math.nan
        self.now_s = self.fed_s = 0.0
        self.turns = 0
        self.goal_C: float | None = None
        self.test_A: float | None = None
        self.sum_A = self.current_A = self.beyond_s = 0.0
        self.why = ""
        self.has_power, self.hangs_s = True, 0.0
        self.off_at_s = math.inf
        self.far, self.rate = np.array([np.inf, -np.inf] * 4), 0.0
        self.reported: list[LineRow] = []
        self.fell_K: dict[str, float] = {}
        self.skin_C: list[tuple[float, float]] = []
        self.events: list[tuple[float, Callable[[], None]]] = []
        self.kp, self.ki, _ = self.demands.loop.played if self.demands.loop else (0.0, 0.0, 0.0)

    @property
    def display_C(self) -> float:
        return float(self.state[0, 1])

    @property
    def is_on(self) -> bool:
        return self.goal_C is not None or self.test_A is not None

    def at(self, time_s: float, happens: Callable[[], None]) -> None:
        self.events.append((time_s, happens))

    def clock(self) -> float:
        return self.now_s

    def sleep(self, seconds: float) -> None:
        until_s = self.now_s + seconds
        while (self.turns + 1) * TURN_S <= until_s + 1e-9:
            self.turns += 1
            self.now_s = max(self.now_s, self.turns * TURN_S)
            self.turn()
        self.now_s = max(self.now_s, until_s)
        if self.hangs_s:
            seconds, self.hangs_s = self.hangs_s, 0.0
            self.sleep(seconds)

    def turn(self) -> None:
        for event in [each for each in self.events if each[0] <= self.now_s + 1e-9]:
            self.events.remove(event)
            event[1]()
        for sensor in (self.loop, self.second):
            sensor.follow(self.display_C, float(self.rng.normal(0.0, 1e-3)))
        cut, held = self.demands.cut_off_display_C, self.demands.held_cut_off_display_C
        second_C = self.second.reads_C
        self.beyond_s += TURN_S
        if held is None or self.current_A == 0.0 or held.low <= second_C <= held.high:
            self.beyond_s = 0.0
        trips = (
            ("the host was silent", self.is_on and self.now_s - self.fed_s > 1.0),
            ("cut-off", not cut.low <= second_C <= cut.high),
            ("second cut-off", held is not None and self.beyond_s > held.longer_than_s),
            ("no supply", not self.has_power),
        )
        for why, is_so in trips:
            if is_so:
                self.cut(why)
        wanted_A, low_A, high_A = self.test_A or 0.0, *(self.demands.current_limit_A or (0.0, 0.0))
        if self.goal_C is not None:
            error_K = self.loop.reads_C - self.goal_C
            grown_A = self.sum_A + self.ki * error_K * TURN_S
            wanted_A = self.kp * error_K + grown_A
            self.sum_A = grown_A if low_A <= wanted_A <= high_A else self.sum_A
        self.current_A = min(max(wanted_A, low_A), high_A)
        if not math.isnan(self.stuck_A) and self.is_on:
            self.current_A = self.stuck_A
        skin = self.circuit.read(self.state[:, : self.circuit.capacity.shape[1], None])[self.world[0], 0, 0]
        self.skin_C.append((self.now_s, float(skin)))
        self.reported.append(LineRow(self.now_s, self.goal_C, self.loop.reads_C, second_C, self.current_A, None))
        flow_A = self.sign * float(self.circuit.gain[0]) * self.current_A
        went = self.lanes.hold(self.state, self.world, np.array([[flow_A, flow_A**2]]), TURN_S)[0]
        if not self.world[0]:
            self.far[0::2] = np.minimum(self.far[0::2], went[0:8:2])
            self.far[1::2] = np.maximum(self.far[1::2], went[1:8:2])
            self.rate = max(self.rate, float(went[RATE]))

    def cut(self, why: str) -> None:
        self.off()
        self.why = self.why or why

    def break_by(self, fault: str, lie_K: float, stuck_A: float) -> None:
        """Let a fault begin now."""
        which, _, how = fault.partition(" ")
        if which in ("loop", "second"):
            sensor = self.loop if which == "loop" else self.second
            sensor.fault, sensor.lie_K = how, lie_K
        elif fault == "silent host":
            self.hangs_s = 3.0
        elif fault == "stuck":
            self.stuck_A = stuck_A
        elif fault == "power lost":
            self.has_power = False
            self.at(self.now_s + 1.0, lambda: setattr(self, "has_power", True))
        else:
            self.swap()

    def touch(self, has_hand: bool) -> None:
        self.world[0] = 0 if has_hand else 1

    def swap(self) -> None:
        self.sign = -self.sign

    def open(self) -> None:
        self.why = ""

    def rest_row(self, name: str, level_C: float) -> float:
        return level_C

    def play_rows(self, name: str, rows: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        return list(rows)

    def began_s(self, host_s: float) -> float:
        return host_s

    def send(self, row: float) -> None:
        self._put(row, None)

    def test(self, current_A: float) -> bool:
        self._put(None, current_A)
        return True

    def _put(self, goal_C: float | None, test_A: float | None) -> None:
        if not self.is_on:
            self.fed_s, self.sum_A = self.now_s, 0.0
        if not self.why:
            self.goal_C, self.test_A, self.off_at_s = goal_C, test_A, math.inf

    def feed(self) -> None:
        self.fed_s = self.now_s

    def off(self) -> None:
        if self.is_on:
            self.off_at_s = self.now_s
        self.goal_C = self.test_A = None

    def read(self) -> float:
        return self._reading(self.loop)

    def read_second(self) -> float:
        return self._reading(self.second)

    def _reading(self, sensor: Thermistor) -> float:
        if self.why:
            raise RuntimeError(f"switched off by itself: {self.why}")
        return sensor.reads_C

    def status(self) -> dict[str, Any]:
        return {"identity": "thermostat", "stopped": self.why}

    def rows(self) -> list[LineRow]:
        rows, self.reported = self.reported, []
        return rows


def played(
    device: Thermostat, made: Export, names: Sequence[str], rest_s: float | None = None, pause_s: float = 10.0
) -> tuple[tuple[MeasuredPlay, ...], str]:
    """Play icons on a device; `rest_s` in place of the rest that is demanded."""
    numbers = live_numbers(demands_of(made), True)
    numbers = numbers if rest_s is None else numbers._replace(rest_s=rest_s)
    player = LivePlayer(device, numbers, PlayLog(None), device.clock, device.sleep)
    why = play_in_order(player, [drives_of(made)[name] for name in names], pause_s)
    return player.log.finish({}), why
