"""The forward model of a fit: a run simulated by the same functions that simulate icons.

`display_C` is what the thermistor on the display reads: the first probe of the rig with place "display", or else the
thermistor of its controller, or else the plate itself.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..solver.displayed import trace_of_display
from ..solver.drive import Drive
from ..solver.network import network_of
from ..solver.simulate import simulate_current
from ..solver.steady import holding_current_A, state_under_current
from ..solver.trace import Trace
from .runs import DISPLAY, Run

RATE_HZ, MOST_ROWS = 100.0, 30_000
"""Rows of a simulation a second, fewer in a run that would have more than so many."""

START_ROWS, QUIETEST, STEADY_SPREAD = 100, 0.1, 6.0
"""A start has at most so many rows; the second differs from the first by no more than so many times what the quietest
tenth of them differs or bends by, each further one from those before by so many times what they differ by."""

START_SD_K = 0.3
"""A start that the first drive does not hold is known from the first reading to within this standard deviation, wider
than a sensor's zero; chosen by this project: of 72 simulated starts each was found."""


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """Predicted columns of a run at its rows, with the drive at any time; `gain` times the drive is the current."""

    trace: Trace
    drive: Drive
    resistance_ohm: float
    display_probe: str | None
    gain: float = 1.0

    def at(self, column: str, drive_s: Array, late_s: float = 0.0) -> Array:
        """Values of a column (rows,) at times in s; temperatures, and all but I·R of a voltage, are `late_s` later."""
        time_s = drive_s + late_s
        if column == "voltage_V":
            jump = self.drive.at(np.clip(drive_s, 0.0, self.trace.time_s[-1])) * self.gain * self.resistance_ohm
            return self._smooth(self.trace.voltage_V - self.resistance_ohm * self.trace.current_A, time_s) + jump
        if column == "display_C" and self.display_probe is not None:
            return self._smooth(self.trace.probe(self.display_probe), time_s)
        if column.startswith("probe_"):
            return self._smooth(self.trace.probe(column.removeprefix("probe_").removesuffix("_C")), time_s)
        return self._smooth(getattr(self.trace, column), time_s)

    def _smooth(self, values: Array, time_s: Array) -> Array:
        return np.asarray(np.interp(time_s, self.trace.time_s, values), dtype=np.float64)


def predict(rig: Rig, run: Run, phase: float = 0.0, start_K: float = 0.0) -> Prediction:
    """Simulate a run from rest, less `phase` times what its drive may be wrong by; RigError if not physical.

    Rest is the steady state of the first drive, or, where the run has a `start_C`, that which holds the display at it,
    `start_K` warmer.
    """
    rate = min(RATE_HZ, MOST_ROWS / float(run.time_s[-1]))
    if run.driven_by == DISPLAY:
        return _under_display(rig, run, rate)
    sensed, display_probe = _with_thermistor(rig)
    gain = rig.driver.transconductance_A_per_V if run.driven_by == "command_V" else 1.0
    wrong = 0.0 if run.phase is None else phase * run.phase
    drive = Drive(run.time_s, gain * (run.drive - wrong), run.held)
    level, state = gain * steady_level(run.drive), None
    if run.start_C is not None:
        level = holding_current_A(network_of(sensed), "display", run.start_C + start_K)
    if level != drive.current_A[0]:
        try:
            state = state_under_current(network_of(sensed), level)
        except ArithmeticError as problem:
            raise RigError(f"rig {rig.name}: {problem}; begin the log with a smaller current") from None
    trace = simulate_current(drive, sensed, rate_Hz=rate, start_C=state)
    logged = run.logged or Drive(run.time_s, run.drive, run.held)
    return Prediction(trace, logged, rig.module.resistance_ohm, display_probe, gain)


def start_sd_K(offset_sd_K: float) -> float:
    """Standard deviation of a start about the first reading of a sensor that may be so far off."""
    return max(START_SD_K, offset_sd_K)


def started(rig: Rig, run: Run, offset_sd_K: float = 0.0, *, contradicted: bool = False) -> Run:
    """The run with the display's first reading as its start, where the first drive would hold it elsewhere."""
    display = [channel for channel in run.channels if channel.column == DISPLAY and not channel.clock]
    if run.driven_by == DISPLAY or not display or display[0].time_s[0] > run.begin_s + run.step_s:
        return run
    start_C = float(display[0].values[0])
    try:
        held_C = float(predict(rig, run).at(DISPLAY, display[0].time_s[:1] - run.begin_s)[0])
    except RigError:
        contradicted = True
    return replace(run, start_C=start_C) if contradicted or abs(start_C - held_C) > start_sd_K(offset_sd_K) else run


def _under_display(rig: Rig, run: Run, rate_Hz: float) -> Prediction:
    """Skin and probes under a display that is known, linear between its rows, whatever moves it."""
    rows = np.arange(int(run.time_s[-1] * rate_Hz) + 2) / rate_Hz
    display = np.interp(rows, run.time_s, run.drive)
    display[0] = steady_level(run.drive)
    nothing = np.full(len(rows), np.nan)
    trace = trace_of_display(
        rig, 1.0 / rate_Hz, display, rows, icon=None, control="display", target_C=nothing, outcome=None
    )
    return Prediction(trace, Drive(run.time_s, np.zeros(len(run.time_s))), 0.0, None)


def steady_level(drive: Array) -> float:
    """The drive of the steady start: the mean of its rows."""
    return float(np.mean(drive[: steady_rows(drive)]))


def steady_rows(drive: Array) -> int:
    """Return how many of the first rows are of a steady start: as long as they differ by what those before did."""
    steps = np.abs(np.diff(drive[:START_ROWS]))
    bends = np.abs(np.diff(drive[:START_ROWS], 2)) / np.sqrt(3.0)  # of noise as large, of a smooth ramp nothing
    first = float(min(np.quantile(steps, QUIETEST), np.quantile(bends, QUIETEST) if bends.size else 0.0))
    count = 1
    while count <= len(steps):
        noise = float(np.median(steps[: count - 1])) if count > 1 else first
        if abs(drive[count] - np.mean(drive[:count])) > STEADY_SPREAD * noise:
            break
        count += 1
    return count


def _with_thermistor(rig: Rig) -> tuple[Rig, str | None]:
    """The rig with a probe for its display thermistor, and that probe's name; None where the plate is read itself."""
    named = next((probe.name for probe in rig.probes if probe.place == "display"), None)
    if named is not None or rig.controller is None or rig.controller.lag_s == 0.0:
        return rig, named
    name = "controller_thermistor"
    others = json.loads(rig.document).get("probe", [])
    added = {"name": name, "place": "display", "lag_s": rig.controller.lag_s}
    return rig.with_(probe=[*others, added]), name
