"""A simulated temperature controller around the module of a rig, with a watchdog and a cut-off of its own."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.rig import Rig
from ..safety.demands import Demands
from ..solver.batch_inputs import Intervals, State, bank_of, run_on
from ..solver.network import COLD, HOT, network_of
from ..solver.steady import state_under_current
from .logged_line import LineRow

TURN_S = 0.01
LONGEST_SILENCE_S = 1.0
"""A device waits for its host for so long at most, however long a drive would be safe without it."""
NOISE_K = 0.002


@dataclass(frozen=True, slots=True)
class ControllerSettings:
    """The limits that a controller is set to, in s, °C and A; gains in A/K, A/(K·s) and A·s/K, and its sensor's lag."""

    watchdog_s: float
    low_C: float
    high_C: float
    held_low_C: float
    held_high_C: float
    held_s: float
    lowest_A: float
    highest_A: float
    kp_A_per_K: float
    ki_A_per_Ks: float
    kd_As_per_K: float
    lag_s: float

    @staticmethod
    def of(demands: Demands, peak_A: float) -> ControllerSettings:
        """What drives demand that need at most a current; one limit for both signs unless they need more."""
        assert demands.loop is not None and demands.current_limit_A is not None
        cut, held, (low_A, high_A) = demands.cut_off_display_C, demands.held_cut_off_display_C, demands.current_limit_A
        both_A = max(min(-low_A, high_A), peak_A)
        return ControllerSettings(
            min(demands.watchdog_s, LONGEST_SILENCE_S),
            cut.low,
            cut.high,
            held.low if held else cut.low,
            held.high if held else cut.high,
            held.longer_than_s if held else math.inf,
            max(low_A, -both_A),
            min(high_A, both_A),
            *demands.loop.played,
            demands.loop.playing_sensor_lag_s,
        )


class SimulatedController:
    """The circuit of a rig under a loop that turns a hundred times a second, as a `LoggedLine`.

    It goes on by itself: each call first makes the turns that the clock asks for. Its two sensors lag alike, with noise
    of 2 mK. A stop by itself is left by `open` alone.
    """

    def __init__(self, rig: Rig, settings: ControllerSettings, clock: Callable[[], float], seed: int = 0) -> None:
        self._rig, self._settings, self._clock = rig, settings, clock
        self._bank, self._lane = bank_of(rig), np.zeros(1, dtype=np.int64)
        self._nodes_C: Array = state_under_current(network_of(rig), 0.0)
        self._felt_C = self._display_C = float(self._nodes_C[COLD])
        self._noise = np.random.default_rng(seed)
        self._read_C = (self._felt_C, self._felt_C)
        self._goal_C: float | None = None
        self._test_A: float | None = None
        self._integral_A = self._current_A = self._beyond_s = 0.0
        self._begun_s = self._fed_s = self._turned_s = clock()
        self._turns = 0
        self._stopped = ""
        self._rows: list[LineRow] = []
        self._lock = threading.RLock()

    def open(self) -> None:
        """Leave a stop; nothing is put out."""
        with self._lock:
            self._go_on()
            self._stopped = ""

    def send(self, row: float) -> None:
        """Hold the display at a set-point in °C."""
        self._put(row, None)

    def test(self, current_A: float) -> bool:
        """Put out a current in A."""
        self._put(None, current_A)
        return True

    def feed(self) -> None:
        """Count the silence of the host from now on."""
        with self._lock:
            self._go_on()
            self._fed_s = self._clock()

    def off(self) -> None:
        """Put out nothing."""
        with self._lock:
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
        with self._lock:
            self._go_on()
            rows, self._rows = self._rows, []
            return rows

    def status(self) -> Mapping[str, object]:
        """Return what it is set to, by the names of demands."""
        own = self._settings
        with self._lock:
            self._go_on()
        return {
            "identity": f"simulated controller on the circuit of rig {self._rig.name}",
            "stopped": self._stopped,
            "watchdog_s": own.watchdog_s,
            "cut_off_display_C": (own.low_C, own.high_C, TURN_S),
            "held_cut_off_display_C": (own.held_low_C, own.held_high_C, own.held_s),
            "current_limit_A": (own.lowest_A, own.highest_A),
            "loop": (own.kp_A_per_K, own.ki_A_per_Ks, own.kd_As_per_K, own.lag_s, TURN_S),
            "zero_current_at_most_s": 0.0,  # no hand is on it
            "second_sensor": True,
            "probes": {"loop": own.lag_s, "second": own.lag_s},
            "settings": asdict(own),
        }

    def _put(self, goal_C: float | None, test_A: float | None) -> None:
        with self._lock:
            self._go_on()
            if self._goal_C is None and self._test_A is None:
                self._fed_s, self._integral_A = self._clock(), 0.0
            if not self._stopped:
                self._goal_C, self._test_A = goal_C, test_A

    def _reading(self, sensor: int) -> float:
        with self._lock:
            self._go_on()
            if self._stopped:
                raise RuntimeError(f"the device switched off by itself: {self._stopped}")
            return self._read_C[sensor]

    def _go_on(self) -> None:
        """Make the turns until now."""
        now_s = self._clock()
        while self._turned_s + TURN_S <= now_s + 1e-9:
            self._turns += 1
            self._turned_s = self._begun_s + TURN_S * self._turns
            self._turn()

    def _turn(self) -> None:
        display_C, before_C, lag_s = float(self._nodes_C[COLD]), self._felt_C, max(self._settings.lag_s, 1e-6)
        decay = math.exp(-TURN_S / lag_s)
        mean = (1.0 - decay) * lag_s / TURN_S  # of what was felt, while the display was linear
        self._felt_C = decay * before_C + (mean - decay) * self._display_C + (1.0 - mean) * display_C
        self._display_C = display_C
        first_K, second_K = self._noise.normal(0.0, NOISE_K, 2).tolist()
        self._read_C = self._felt_C + first_K, self._felt_C + second_K
        self._check(self._read_C[1])
        if self._stopped:
            self._goal_C = self._test_A = None
        module, hotter_K = self._rig.module, float(self._nodes_C[HOT]) - display_C
        self._current_A = self._wanted_A((self._felt_C - before_C) / TURN_S)
        volts = module.seebeck_V_per_K * hotter_K + self._current_A * module.resistance_ohm
        self._rows.append(LineRow(self._turned_s, self._goal_C, *self._read_C, self._current_A, volts))
        flow_A = np.full((1, 1), self._current_A)
        held = Intervals(np.array([0.0, TURN_S]), np.array([-1, 0]), flow_A, flow_A)
        state = State(self._nodes_C[np.newaxis])
        self._nodes_C = run_on(self._bank, self._lane, self._lane, held, state, ("display_C",))[1].nodes_C[0]

    def _check(self, second_C: float) -> None:
        """The device's own stops, by its own sensor and clock."""
        own, is_on = self._settings, self._goal_C is not None or self._test_A is not None
        if is_on and self._turned_s - self._fed_s > own.watchdog_s:
            self._stopped = f"the host was silent for {own.watchdog_s:g} s"
        if not own.low_C <= second_C <= own.high_C:
            self._stopped = f"the second sensor read {second_C:.2f} °C, outside {own.low_C:g} … {own.high_C:g} °C"
        is_beyond = self._current_A != 0.0 and not own.held_low_C <= second_C <= own.held_high_C
        self._beyond_s = self._beyond_s + TURN_S if is_beyond else 0.0
        if self._beyond_s > own.held_s:
            self._stopped = f"the second sensor was outside {own.held_low_C:g} … {own.held_high_C:g} °C for too long"

    def _wanted_A(self, rate_K_per_s: float) -> float:
        """The current of the loop or of a test, within the limits; the integral stops there."""
        own, wanted_A, grown_A = self._settings, self._test_A or 0.0, 0.0
        if self._goal_C is not None:
            error_K = self._read_C[0] - self._goal_C
            grown_A = self._integral_A + own.ki_A_per_Ks * error_K * TURN_S
            wanted_A = own.kp_A_per_K * error_K + grown_A + own.kd_As_per_K * rate_K_per_s
        limited_A = min(max(wanted_A, own.lowest_A), own.highest_A)
        if limited_A == wanted_A and self._goal_C is not None:
            self._integral_A = grown_A
        return limited_A
