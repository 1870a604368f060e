"""A run simulated on a rig, by the same functions that simulate icons: what each measured column should be.

`display_C` is what the thermistor on the display reads: the first probe of the rig with place "display", or else the
thermistor of its controller, or else the plate itself.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..solver.displayed import part_of, trace_of_display
from ..solver.drive import Drive
from ..solver.landing import start_under
from ..solver.modes import shown
from ..solver.network import COLD, HOT, SKIN
from ..solver.simulate import rows_until, simulate_current
from ..solver.trace import Trace
from .runs import MAD_TO_SD, Run

RATE_HZ = 100.0
SETTLED_A, MOST_TURNS = 1e-8, 40
"""A drive in volts is solved for its current to 10 nA, far below what any log resolves."""

STEADY_SPREAD = 6.0
"""Noise of a logged current, in its standard deviations, within which the first rows count as one level."""

SKIN_DEPTHS_M = (0.5e-3, 3e-3)
"""How deep a start that is not steady reaches into the skin: what heat diffuses in some seconds, and in a minute."""

Start = tuple[float, float, float, float, float]
"""A start that is not steady under the first row's drive: how much more current in A it was steady under before, and
how far display, hot plate, and skin near the surface and deeper are from that state in K."""


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """What a run should have measured: columns at rows, and the current at any time."""

    trace: Trace
    drive: Drive | None
    resistance_ohm: float
    display_probe: str | None

    def at(self, column: str, drive_s: Array, late_s: float = 0.0) -> Array:
        """Values of a column of a log (rows,) at times in s from the first row of the drive.

        `late_s`: how much later than the logged drive the module has its current; temperatures follow it, and in a
        voltage all but I·R, which belongs to the row's own current.
        """
        time_s = drive_s + late_s
        if column == "voltage_V":
            assert self.drive is not None
            jump = self.drive.at(np.clip(drive_s, 0.0, self.trace.time_s[-1])) * self.resistance_ohm
            return self._smooth(self.trace.voltage_V - self.resistance_ohm * self.trace.current_A, time_s) + jump
        if column == "display_C" and self.display_probe is not None:
            return self._smooth(self.trace.probe(self.display_probe), time_s)
        if column.startswith("probe_"):
            return self._smooth(self.trace.probe(column.removeprefix("probe_").removesuffix("_C")), time_s)
        return self._smooth(getattr(self.trace, column), time_s)

    def _smooth(self, values: Array, time_s: Array) -> Array:
        return np.asarray(np.interp(time_s, self.trace.time_s, values), dtype=np.float64)


def predict(rig: Rig, run: Run, start: Start | None = None) -> Prediction:
    """Simulate a run; `start` is what differs from the steady state of the first row.

    Raises RigError where the run is not physical on this rig.
    """
    if rig.thermode is not None:
        return _on_thermode(rig, run)
    sensed, display_probe = _with_thermistor(rig)
    ohm = rig.module.resistance_ohm
    if run.driven_by != "voltage_V":
        gain = rig.driver.transconductance_A_per_V if run.driven_by == "command_V" else 1.0
        drive = Drive(run.time_s, gain * run.drive, run.held)
        return Prediction(_play(sensed, drive, start), drive, ohm, display_probe)
    current = run.drive / ohm
    for _ in range(MOST_TURNS):
        drive = Drive(run.time_s, current, run.held)
        found = Prediction(_play(sensed, drive, start), drive, ohm, display_probe)
        seebeck_V = found.at("voltage_V", run.time_s) - drive.at(run.time_s) * ohm
        better = (run.drive - seebeck_V) / ohm
        change, current = float(np.abs(better - current).max()), better
        if change < SETTLED_A:
            return found
    others = f"; columns that are not used: {run.unused}" if run.unused else ""
    raise RigError(
        f"rig {rig.name}: no current follows from voltage_V of {run.name}, which is taken as the drive since there is "
        f"no column current_A or command_V{others}; give the current as current_A, or check voltage_V and the module"
    )


def _play(rig: Rig, drive: Drive, start: Start | None) -> Trace:
    level = steady_level(drive.current_A)
    if start is None and level == drive.current_A[0]:
        return simulate_current(drive, rig, rate_Hz=RATE_HZ)
    try:
        state = start_under(rig, level + (0.0 if start is None else start[0]))
    except ArithmeticError as problem:
        raise RigError(f"rig {rig.name}: {problem}; begin the log with a smaller current") from None
    if start is not None:
        state = state.copy()
        state[COLD] += start[1]
        state[HOT] += start[2]
        depth = rig.column.depth_m
        for change_K, reach_m in zip(start[3:], SKIN_DEPTHS_M, strict=True):
            state[SKIN : SKIN + len(depth)] += change_K * np.exp(-depth / reach_m)
    return simulate_current(drive, rig, rate_Hz=RATE_HZ, start_C=state)


def steady_level(current_A: Array) -> float:
    """Return the current of the steady start: the mean of the first rows that differ by noise alone."""
    noise = MAD_TO_SD * float(np.median(np.abs(np.diff(current_A)))) / np.sqrt(2.0)
    away = np.abs(current_A - current_A[0]) > STEADY_SPREAD * noise
    count = int(np.argmax(away)) if away.any() else len(current_A)
    return float(current_A[0]) if noise == 0.0 else float(np.mean(current_A[: max(1, count)]))


def _with_thermistor(rig: Rig) -> tuple[Rig, str | None]:
    """The rig with a probe for its display thermistor, and that probe's name; None where the plate is read itself."""
    named = next((probe.name for probe in rig.probes if probe.place == "display"), None)
    if named is not None or rig.controller is None or rig.controller.lag_s == 0.0:
        return rig, named
    name = "controller_thermistor"
    others = json.loads(rig.document).get("probe", [])
    added = {"name": name, "place": "display", "lag_s": rig.controller.lag_s}
    return rig.with_(probe=[*others, added]), name


def _on_thermode(rig: Rig, run: Run) -> Prediction:
    """A thermode follows its logged set-points; without them, the logged display is what the skin gets."""
    thermode = rig.thermode
    assert thermode is not None
    rows = rows_until(float(run.time_s[-1]), RATE_HZ)
    step = part_of(1.0 / thermode.update_Hz)
    times: Array = np.arange(int(np.ceil(rows[-1] / step - 1e-9)) + 1, dtype=np.float64) * step
    level = np.interp(times, run.time_s, run.drive)
    if run.driven_by == "setpoint_C":
        if run.held:
            place = np.searchsorted(run.time_s, times + 1e-9, side="right") - 1
            level = run.drive[np.clip(place, 0, len(run.drive) - 1)]
        limits = thermode.lowest_C, thermode.highest_C
        level = shown(np.clip(level, *limits), step, thermode.lag_s, thermode.slew_K_per_s)
    nothing = np.full(len(rows), np.nan)
    trace = trace_of_display(
        rig, step, level, rows, icon=None, control="drive", target_C=nothing, outcome=None,
    )  # fmt: skip
    return Prediction(trace, None, float("nan"), None)
