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
from ..solver.displayed import part_of, trace_of_display
from ..solver.drive import Drive
from ..solver.landing import start_under
from ..solver.modes import shown
from ..solver.simulate import rows_until, simulate_current
from ..solver.trace import Trace
from .log import DRIVES, Log, LogError

RATE_HZ = 100.0
SETTLED_A, MOST_TURNS = 1e-8, 40
"""A drive in volts is solved for its current to 10 nA, far below what any log resolves."""

STEADY_SPREAD = 6.0
"""Noise of a logged current, in its standard deviations, within which the first rows count as one level."""


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


def predict(rig: Rig, run: Run, before_A: float = 0.0) -> Prediction:
    """Simulate a run; `before_A` is how much more current than the first row's it was steady under.

    Raises RigError where the run is not physical on this rig.
    """
    if rig.thermode is not None:
        return _on_thermode(rig, run)
    sensed, display_probe = _with_thermistor(rig)
    ohm = rig.module.resistance_ohm
    if run.driven_by != "voltage_V":
        gain = rig.driver.transconductance_A_per_V if run.driven_by == "command_V" else 1.0
        drive = Drive(run.time_s, gain * run.drive, run.held)
        return Prediction(_play(sensed, drive, before_A), drive, ohm, display_probe)
    current = run.drive / ohm
    for _ in range(MOST_TURNS):
        drive = Drive(run.time_s, current, run.held)
        found = Prediction(_play(sensed, drive, before_A), drive, ohm, display_probe)
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


def _play(rig: Rig, drive: Drive, before_A: float) -> Trace:
    level = steady_level(drive.current_A)
    if not before_A and level == drive.current_A[0]:
        return simulate_current(drive, rig, rate_Hz=RATE_HZ)
    try:
        state = start_under(rig, level + before_A)
    except ArithmeticError as problem:
        raise RigError(f"rig {rig.name}: {problem}; begin the log with a smaller current") from None
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


MOST_GAP_S, MOST_GAP_ROWS = 0.5, 10
"""A gap in the drive above both needs the same drive on both sides of it."""

SAME_SHARE = 0.05
"""Share of the drive's range within which both sides of a gap count as the same."""

MAD_TO_SD = 1.4826
"""Standard deviation of normal noise over its median absolute deviation: 1/Φ⁻¹(3/4)."""

SHORTEST_S = 5.0
MOST_OF_LIMIT = 20.0
"""A current of more than 20 times the driver's limit is in another unit."""


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
    first row by the drive's own clock; `clocks` names the files of the further clocks, `unused`
    the columns that are not used.
    """

    name: str
    driven_by: str
    time_s: Array
    drive: Array
    held: bool
    begin_s: float
    channels: tuple[Channel, ...]
    clocks: tuple[str, ...] = ()
    unused: str = ""


def runs_of(logs: Sequence[Log], rig: Rig, held: bool) -> tuple[Run, ...]:
    """Return the runs of logs; a log without a drive goes with the one before it, or with the only one there is.

    Raises LogError for logs without a drive, without a measured column, or with a drive that is not known throughout.
    """
    if not logs:
        raise LogError("no log; name one or several files")
    driven = [log for log in logs if _drive_of(log, rig) is not None]
    if not driven:
        found = "; ".join(f"{log.name} has {', '.join(dict(log.columns))}" for log in logs)
        raise LogError(
            f"no log has a drive: one of {', '.join(DRIVES if rig.pump else DRIVES[-1:])} is needed for rig {rig.name} "
            f"({found})"
        )
    groups: dict[int, list[Log]] = {id(log): [] for log in driven}
    last = driven[0]
    for log in logs:
        if id(log) in groups:
            last = log
        else:
            groups[id(last)].append(log)
    runs = tuple(_run(log, groups[id(log)], rig, held) for log in driven)
    silent = [run.name for run in runs if not run.channels]
    if silent:
        raise LogError(
            f"{silent[0]}: nothing measured beside the drive; log display_C, and voltage_V where you can, or name the "
            f"file of the thermometer behind it"
        )
    return runs


def _drive_of(log: Log, rig: Rig) -> str | None:
    """The column that drives a rig: set-points (or else the display) a thermode, a current or voltage a module."""
    there = dict(log.columns)
    if rig.thermode is None:
        return next((name for name in DRIVES[:-1] if name in there), None)
    if "setpoint_C" in there:
        return "setpoint_C"
    return "display_C" if "display_C" in there and "skin_C" in there else None


def _run(log: Log, sensors: Sequence[Log], rig: Rig, held: bool) -> Run:
    driven_by = _drive_of(log, rig)
    assert driven_by is not None
    time, drive = log.time_s, log.column(driven_by)
    known = np.isfinite(drive)
    time, drive = time[known], drive[known]
    _check_gaps(log.name, driven_by, time, drive, log.time_s)
    _check_size(log.name, driven_by, drive, rig)
    begin = float(time[0])
    channels = [_channel(log, name, 0) for name in log.measured if name != driven_by]
    for clock, sensor in enumerate(sensors, 1):
        channels += [_channel(sensor, name, clock) for name in sensor.measured]
    clocks = tuple(sensor.name for sensor in sensors)
    return Run(log.name, driven_by, time - begin, drive, held, begin, tuple(channels), clocks, log.unused)


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


def _check_size(name: str, column: str, drive: Array, rig: Rig) -> None:
    if np.ptp(drive) == 0.0:
        raise LogError(
            f"{name}: {column} is {drive[0]:g} in every row: nothing changes, so that nothing can be fitted; log a run "
            f"that warms and cools, such as the shipped cue calibration-drive"
        )
    if column != "current_A":
        return
    limit, most = rig.driver.current_max_A, float(np.abs(drive).max())
    if most > MOST_OF_LIMIT * limit:
        raise LogError(
            f"{name}: current_A reaches {most:g} A, the driver of rig {rig.name} gives {limit:g} A: it looks like "
            f"milliamperes; divide the column by 1000"
        )
