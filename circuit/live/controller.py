"""A simulated temperature controller around the module of a rig."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..play.logged_line import LineRow
from ..rig.rig import Rig
from ..safety.demands import DEMANDS, Demands
from ..solver.batch_inputs import Intervals, State, bank_of, run_on
from ..solver.network import COLD, HOT, network_of
from ..solver.steady import state_under_current

TURN_S = 0.01
LONGEST_SILENCE_S = 1.0
"""A device waits so long for its host, however long a drive would be safe without it."""
NOISE_K = 0.002


def settings_of(demands: Demands, peak_A: float) -> Demands:
    """What a controller is set to that meets demands; one current limit for both signs, unless drives need more."""
    assert demands.loop is not None
    assert demands.current_limit_A is not None
    low_A, high_A = demands.current_limit_A
    both_A = max(min(-low_A, high_A), peak_A)
    kp, ki, _ = demands.loop.played
    return replace(
        demands,
        watchdog_s=min(demands.watchdog_s or LONGEST_SILENCE_S, LONGEST_SILENCE_S),
        cut_off_display_C=replace(demands.cut_off_display_C, react_within_s=TURN_S),
        current_limit_A=(max(low_A, -both_A), min(high_A, both_A)),
        zero_current_at_most_s=0.0,  # no hand is on it
        loop=replace(
            demands.loop,
            kp_A_per_K=(kp, kp),
            ki_A_per_Ks=(ki, ki),
            delay_at_most_s=TURN_S,
            sensor_lag_at_most_s=demands.loop.playing_sensor_lag_s,
        ),
    )


class SimulatedController:
    """The circuit of a rig under a loop with a watchdog and a cut-off, as a `LoggedLine`.

    Each call first makes the turns that the clock asks for. Both sensors lag alike, with noise of 2 mK. Only `open`
    ends a stop.
    """

    def __init__(self, rig: Rig, settings: Demands, clock: Callable[[], float], seed: int = 0) -> None:
        self._rig, self._settings, self._clock = rig, settings, clock
        self._bank = bank_of(rig)
        self._nodes_C = state_under_current(network_of(rig), 0.0)
        self._felt_C = self._display_C = float(self._nodes_C[COLD])
        self._nodes_after(0.0)  # the first time takes seconds, to compile: now, while no clock runs
        self._noise = np.random.default_rng(seed)
        self._read_C = (self._felt_C, self._felt_C)
        self._goal_C: float | None = None
        self._test_A: float | None = None
        self._integral_A = self._current_A = self._beyond_s = 0.0
        self._begun_s = self._turned_s = self._fed_s = clock()
        self._turns = 0
        self._stopped = ""
        self._rows: list[LineRow] = []
        self.fell_K: dict[str, float] = {}  # the guard tests the polarity
        self._lock = threading.Lock()  # sensors are read in a thread of their own

    def open(self) -> None:
        """Leave a stop; nothing is put out."""
        self._go_on()
        self._stopped = ""

    def close(self) -> None:
        """Nothing to let go."""

    def send(self, row: float) -> None:
        """Hold the display at a set-point in °C."""
        self._put(row, None)

    def test(self, current_A: float) -> bool:
        """Put out a current in A."""
        self._put(None, current_A)
        return True

    def feed(self) -> None:
        """Count the silence of the host from now on."""
        self._go_on()
        self._fed_s = self._clock()

    def off(self) -> None:
        """Put out nothing."""
        self._go_on()
        self._goal_C = self._test_A = None

    def read(self) -> float:
        """Return the °C of the loop's sensor."""
        return self._reading(0)

    def read_second(self) -> float:
        """Return the °C of the cut-off's sensor."""
        return self._reading(1)

    def rows(self) -> list[LineRow]:
        """Return the turns since the last call."""
        self._go_on()
        with self._lock:
            rows, self._rows = self._rows, []
        return rows

    def rest_row(self, name: str, level_C: float) -> float:
        """The controller holds a set-point."""
        return level_C

    def play_rows(self, name: str, rows: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        """The controller takes one set-point after the other."""
        return list(rows)

    def began_s(self, host_s: float) -> float:
        """Both have one clock."""
        return host_s

    def status(self) -> Mapping[str, object]:
        """Return what it is set to, by the names of demands."""
        self._go_on()
        identity = f"simulated controller on the circuit of rig {self._rig.name}"
        settings = {name: getattr(self._settings, name) for name in DEMANDS}
        return {**settings, "identity": identity, "stopped": self._stopped}

    def _put(self, goal_C: float | None, test_A: float | None) -> None:
        self._go_on()
        if not self._is_on:
            self._fed_s, self._integral_A = self._clock(), 0.0
        if not self._stopped:
            self._goal_C, self._test_A = goal_C, test_A

    @property
    def _is_on(self) -> bool:
        return self._goal_C is not None or self._test_A is not None

    def _reading(self, sensor: int) -> float:
        self._go_on()
        if self._stopped:
            raise RuntimeError(f"the device switched off by itself: {self._stopped}")
        return self._read_C[sensor]

    def _go_on(self) -> None:
        """Make the turns until now."""
        with self._lock:
            now_s = self._clock()
            while self._turned_s + TURN_S <= now_s + 1e-9:
                self._turns += 1
                self._turned_s = self._begun_s + TURN_S * self._turns
                self._turn()

    def _turn(self) -> None:
        """Read, check, put out a current until the next turn, and let the circuit follow."""
        display_C, lag_s = float(self._nodes_C[COLD]), self._settings.loop.sensor_lag_at_most_s  # type: ignore[union-attr]
        before_C = self._felt_C
        decay = math.exp(-TURN_S / lag_s) if lag_s > 0.0 else 0.0
        mean = (1.0 - decay) * lag_s / TURN_S  # of what was felt, while the display was linear
        self._felt_C = decay * before_C + (mean - decay) * self._display_C + (1.0 - mean) * display_C
        self._display_C = display_C
        first_K, second_K = self._noise.normal(0.0, NOISE_K, 2).tolist()
        self._read_C = self._felt_C + first_K, self._felt_C + second_K
        self._check(self._read_C[1])
        if self._stopped:
            self._goal_C = self._test_A = None
        module = self._rig.module
        back_V = module.seebeck_V_per_K * (float(self._nodes_C[HOT]) - display_C)
        self._current_A = self._wanted_A((self._felt_C - before_C) / TURN_S, back_V)
        voltage_V = back_V + self._current_A * module.resistance_ohm
        self._rows.append(LineRow(self._turned_s, self._goal_C, *self._read_C, self._current_A, voltage_V))
        self._nodes_C = self._nodes_after(self._current_A)

    def _nodes_after(self, current_A: float) -> Array:
        """The °C of all nodes after a turn under a current."""
        lane, flow_A = np.zeros(1, dtype=np.int64), np.full((1, 1), current_A)
        turn = Intervals(np.array([0.0, TURN_S]), np.array([-1, 0]), flow_A, flow_A)
        state = State(self._nodes_C[np.newaxis])
        return np.asarray(run_on(self._bank, lane, lane, turn, state, ("display_C",))[1].nodes_C[0])

    def _check(self, second_C: float) -> None:
        """The device's own stops, by its own sensor and clock."""
        cut, held = self._settings.cut_off_display_C, self._settings.held_cut_off_display_C
        if self._is_on and self._turned_s - self._fed_s > self._settings.watchdog_s:
            self._stopped = f"the host was silent for {self._settings.watchdog_s:g} s"
        if not cut.low <= second_C <= cut.high:
            self._stopped = f"its second sensor read {second_C:.2f} °C, outside {cut.low:g} … {cut.high:g} °C"
        if held is not None:
            is_beyond = self._current_A != 0.0 and not held.low <= second_C <= held.high
            self._beyond_s = self._beyond_s + TURN_S if is_beyond else 0.0
            if self._beyond_s > held.longer_than_s:
                self._stopped = f"its second sensor was outside {held.low:g} … {held.high:g} °C for too long"

    def _wanted_A(self, rate_K_per_s: float, back_V: float) -> float:
        """The current of the loop or of a test, within the limits of current and voltage; the integral stops there."""
        assert self._settings.loop is not None
        assert self._settings.current_limit_A is not None
        kp, ki, kd = self._settings.loop.played
        most_V, ohm = self._rig.driver.voltage_limit_V, self._rig.module.resistance_ohm
        low_A = max(self._settings.current_limit_A[0], (-most_V - back_V) / ohm)
        high_A = min(self._settings.current_limit_A[1], (most_V - back_V) / ohm)
        if self._goal_C is None:
            return min(max(self._test_A, low_A), high_A) if self._test_A else 0.0
        error_K = self._read_C[0] - self._goal_C
        grown_A = self._integral_A + ki * error_K * TURN_S
        wanted_A = kp * error_K + grown_A + kd * rate_K_per_s
        if low_A <= wanted_A <= high_A:
            self._integral_A = grown_A
        return min(max(wanted_A, low_A), high_A)
