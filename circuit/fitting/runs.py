"""Runs: a log with a drive, and the logs of sensors with clocks of their own that go with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..rig.rig import Rig
from .log import DRIVES, Log, LogError

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
