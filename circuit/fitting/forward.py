"""A run simulated on a rig, by the same functions that simulate icons: what each measured column should be.

`display_C` is what the thermistor on the display reads: the first probe of the rig with place "display", or else the
thermistor of its controller, or else the plate itself.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..solver.drive import Drive
from ..solver.network import network_of
from ..solver.simulate import simulate_current
from ..solver.steady import state_under_current
from ..solver.trace import Trace
from .log import DRIVES, Log, LogError

RATE_HZ = 100.0

STEADY_SPREAD = 6.0
"""Noise of a logged current, in its standard deviations, within which the first rows count as one level."""


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """What a run should have measured: columns at rows, and the current at any time."""

    trace: Trace
    drive: Drive
    resistance_ohm: float
    display_probe: str | None

    def at(self, column: str, drive_s: Array, late_s: float = 0.0) -> Array:
        """Values of a column of a log (rows,) at times in s from the first row of the drive.

        `late_s`: how much later than the logged drive the module has its current; temperatures follow it, and in a
        voltage all but I·R, which belongs to the row's own current.
        """
        time_s = drive_s + late_s
        if column == "voltage_V":
            jump = self.drive.at(np.clip(drive_s, 0.0, self.trace.time_s[-1])) * self.resistance_ohm
            return self._smooth(self.trace.voltage_V - self.resistance_ohm * self.trace.current_A, time_s) + jump
        if column == "display_C" and self.display_probe is not None:
            return self._smooth(self.trace.probe(self.display_probe), time_s)
        if column.startswith("probe_"):
            return self._smooth(self.trace.probe(column.removeprefix("probe_").removesuffix("_C")), time_s)
        return self._smooth(getattr(self.trace, column), time_s)

    def _smooth(self, values: Array, time_s: Array) -> Array:
        return np.asarray(np.interp(time_s, self.trace.time_s, values), dtype=np.float64)


def predict(rig: Rig, run: Run) -> Prediction:
    """Simulate a run from rest under its first drive; RigError where it is not physical on this rig."""
    sensed, display_probe = _with_thermistor(rig)
    gain = rig.driver.transconductance_A_per_V if run.driven_by == "command_V" else 1.0
    drive = Drive(run.time_s, gain * run.drive, run.held)
    level, state = steady_level(drive.current_A), None
    if level != drive.current_A[0]:
        try:
            state = state_under_current(network_of(sensed), level)
        except ArithmeticError as problem:
            raise RigError(f"rig {rig.name}: {problem}; begin the log with a smaller current") from None
    trace = simulate_current(drive, sensed, rate_Hz=RATE_HZ, start_C=state)
    return Prediction(trace, drive, rig.module.resistance_ohm, display_probe)


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


MOST_GAP_S, MOST_GAP_ROWS = 0.5, 10
"""A gap in the drive above both needs the same drive on both sides of it."""

SAME_SHARE = 0.05
"""Share of the drive's range within which both sides of a gap count as the same."""

MAD_TO_SD = 1.4826
"""Standard deviation of normal noise over its median absolute deviation: 1/Φ⁻¹(3/4)."""

SHORTEST_S = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """A measured column: `file`, `clock` (0: that of the drive), `time_s` and `values` (rows,) without empty rows."""

    column: str
    file: str
    clock: int
    time_s: Array
    values: Array

    @property
    def temperature(self) -> bool:
        """Whether it is in °C; otherwise in V."""
        return self.column.endswith("_C")

    @property
    def resolution(self) -> float:
        """The sensor's step: the smallest difference between two of its values, 0 where it has none."""
        steps = np.diff(np.unique(np.round(self.values, 9)))
        return float(steps.min()) if len(steps) else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One run from its first row on: `drive` (rows,) of the column `driven_by` at `time_s`, and what was measured.

    `held`: each row's drive lasts until the next, otherwise it is linear between rows. `begin_s` is the time of the
    first row by the drive's own clock; `clocks` names the files of the further clocks.
    """

    name: str
    driven_by: str
    time_s: Array
    drive: Array
    held: bool
    begin_s: float
    channels: tuple[Channel, ...]
    clocks: tuple[str, ...] = ()


def runs_of(logs: Sequence[Log], held: bool) -> tuple[Run, ...]:
    """Return the runs of logs; a log without a drive goes with the one before it, or with the only one there is.

    Raises LogError for logs without a drive, without a measured column, or with a drive that is not known throughout.
    """
    if not logs:
        raise LogError("no log; name one or several files")
    driven = [log for log in logs if log.drive is not None]
    if not driven:
        found = "; ".join(f"{log.name} has {', '.join(dict(log.columns))}" for log in logs)
        cure = f"say what the file calls it by --column {DRIVES[0]}=THEIRS"
        raise LogError(f"no log has a drive: one of {' or '.join(DRIVES)} is needed ({found}); {cure}")
    groups: dict[int, list[Log]] = {id(log): [] for log in driven}
    last = driven[0]
    for log in logs:
        if id(log) in groups:
            last = log
        else:
            groups[id(last)].append(log)
    runs = tuple(_run(log, groups[id(log)], held) for log in driven)
    silent = [run.name for run in runs if not run.channels]
    if silent:
        raise LogError(
            f"{silent[0]}: nothing measured beside the drive; log display_C, and voltage_V where you can, say what the "
            f"file calls it by --column display_C=THEIRS, or name the file of the thermometer behind it"
        )
    return runs


def _run(log: Log, sensors: Sequence[Log], held: bool) -> Run:
    driven_by = log.drive
    assert driven_by is not None
    time, drive = log.time_s, log.column(driven_by)
    known = np.isfinite(drive)
    time, drive = time[known], drive[known]
    _check_gaps(log.name, driven_by, time, drive, log.time_s)
    if np.ptp(drive) == 0.0:
        raise LogError(
            f"{log.name}: {driven_by} is {drive[0]:g} in every row: nothing changes, so that nothing can be fitted; "
            f"log a run that warms and cools, such as the shipped cue calibration-drive"
        )
    begin = float(time[0])
    channels = [_channel(log, name, 0) for name in log.measured]
    for clock, sensor in enumerate(sensors, 1):
        channels += [_channel(sensor, name, clock) for name in sensor.measured]
    clocks = tuple(sensor.name for sensor in sensors)
    return Run(log.name, driven_by, time - begin, drive, held, begin, tuple(channels), clocks)


def _channel(log: Log, name: str, clock: int) -> Channel:
    values = log.column(name)
    there = np.isfinite(values)
    return Channel(name, log.name, clock, log.time_s[there], values[there])


def _check_gaps(name: str, column: str, time: Array, drive: Array, rows: Array) -> None:
    if len(time) < 2 or time[-1] - time[0] < SHORTEST_S:
        span = time[-1] - time[0] if len(time) else 0.0
        raise LogError(f"{name}: {column} is known for {span:g} s; a fit needs at least {SHORTEST_S:g} s")
    if time[0] > rows[0] + MOST_GAP_S:
        raise LogError(
            f"{name}: {column} is empty until {time[0]:g} s; cut the rows before, since the drive must be known from "
            f"the first row on"
        )
    steps = np.diff(time)
    most = max(MOST_GAP_S, MOST_GAP_ROWS * float(np.median(steps)))
    near = SAME_SHARE * max(float(np.ptp(drive)), 1e-9)
    wide = np.flatnonzero((steps > most) & (np.abs(np.diff(drive)) > near))
    if wide.size:
        k = int(wide[0])
        raise LogError(
            f"{name}: {column} is not known from {time[k]:g} to {time[k + 1]:g} s, and differs on both sides "
            f"({drive[k]:.4g} and {drive[k + 1]:.4g}); cut the log there into two files, or log it again"
        )
