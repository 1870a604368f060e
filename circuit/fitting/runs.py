"""Runs of logs: drives with their measured columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..solver.drive import Drive
from .between import MOST_UPDATES, means, noise_sd, one_phase, tells_all, unknown_display
from .log import DRIVES, Log, LogError

if TYPE_CHECKING:
    from ..rig.rig import Rig

DISPLAY = "display_C"
"""What drives a run where no current is known: skin and probes follow the display, whatever moves it."""

LONG_S, LONG_ROWS, REST_S = 300.0, 1500, 10.0
"""A log that is longer than both is fitted for so long, from so much rest on before its drive changes first."""

FINEST_S, MOST_STEPS, MOST_READINGS = 0.01, 30_000, 8_000
"""A drive that is known is simulated by means over so long or of so many steps; of more readings some are fitted."""

MOST_GAP_S, MOST_GAP_ROWS = 0.5, 10
"""A gap in the drive above both needs the same drive on both sides of it."""

SAME_SHARE = 0.05
"""Share of the drive's range within which both sides of a gap count as the same."""

SHORTEST_S = 5.0

MOST_MOVED, LEAST_MOVED_K = 1.2, 1e-3
"""Skin follows a display and moves less; noise and a slow rest may make it seem to move more by so much, and rounding,
of a display that is held, by any."""


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

    @property
    def noise(self) -> float:
        """SD of what changes from row to row, in the quietest rows."""
        return noise_sd(self.time_s, self.values, self.resolution)


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """One run from its first row on: `drive` (rows,) of the column `driven_by` at `time_s`, and what was measured.

    `begin_s` is the time of the first row by the drive's own clock; `clocks` names the files of the further clocks, and
    `shifts` are about what to add to their times. `unknown` (rows − 1,) is the SD of the drive's mean between rows,
    None where the rows tell it; `phase` (rows,) what all rows are wrong by, as one SD, if a loop was read at one phase
    of its steps. `points`: the rows, `step_s` apart, miss updates of the driver. `logged`: the drive of each row, where
    `drive` has means. `start_C`: the display's first reading, where the first drive would hold it elsewhere.
    """

    name: str
    driven_by: str
    time_s: Array
    step_s: float
    drive: Array
    begin_s: float
    channels: tuple[Channel, ...]
    clocks: tuple[str, ...] = ()
    shifts: tuple[float, ...] = ()
    unknown: Array | None = None
    phase: Array | None = None
    points: bool = False
    notes: tuple[str, ...] = ()
    logged: Drive | None = None
    start_C: float | None = None

    @property
    def held(self) -> bool:
        """Whether each row's drive lasts until the next, as a current does; a display is linear between rows."""
        return self.driven_by != DISPLAY


def runs_of(logs: Sequence[Log], rig: Rig | None = None) -> tuple[Run, ...]:
    """The runs of logs; one without a drive goes with the log before it. Without a current the display is the drive.

    Without a `rig`, which has the driver's rate, rows tell all. LogError for a drive that is not known throughout.
    """
    if not logs:
        raise LogError("no log; name one or several files")
    thermode = None if rig is None else rig.thermode
    drives = {} if thermode else {id(log): log.drive for log in logs if log.drive is not None}
    if not drives and any(_deeper(name) for log in logs for name in log.measured):
        drives = {id(log): DISPLAY for log in logs if DISPLAY in log.measured}
    if not drives:
        found = "; ".join(f"{log.name} has {', '.join(dict(log.columns))}" for log in logs)
        deeper = f"{DISPLAY} with skin_C or a probe in the skin"
        if rig is not None and thermode:
            raise LogError(f"rig {rig.name} is a thermode, whose display is the drive: {deeper} is needed ({found})")
        needed = f"one of {' or '.join(DRIVES)} is needed, or {deeper} ({found})"
        raise LogError(f"no log has a drive: {needed}; say what the file calls it").to(columns={DRIVES[0]: "THEIRS"})
    driven = [log for log in logs if id(log) in drives]
    groups: dict[int, list[Log]] = {id(log): [] for log in driven}
    last = driven[0]
    for log in logs:
        if id(log) in groups:
            last = log
        else:
            groups[id(last)].append(log)
    runs = tuple(_run(log, drives[id(log)], groups[id(log)], rig) for log in driven)
    silent = [run.name for run in runs if not run.channels]
    if silent:
        raise LogError(
            f"{silent[0]}: nothing measured beside the drive; log display_C, and voltage_V where you can, name the "
            f"file of the thermometer behind it, or say what the file calls it"
        ).to(columns={"display_C": "THEIRS"})
    return runs


def _deeper(name: str) -> bool:
    """Whether a column follows a display without a current: skin and probes do."""
    return name == "skin_C" or name.startswith("probe_")


def _run(log: Log, driven_by: str, sensors: Sequence[Log], rig: Rig | None) -> Run:
    part = _part(log.time_s, log.column(driven_by), alone=not sensors)
    time, drive = log.time_s[part], log.column(driven_by)[part]
    known = np.isfinite(drive)
    time, drive = time[known], drive[known]
    _check_gaps(log.name, driven_by, time, drive, log.time_s[part])
    if np.ptp(drive) == 0.0:
        raise LogError(
            f"{log.name}: {driven_by} is {drive[0]:g} in every row: nothing changes, so that nothing can be fitted; "
            f"log a run that warms and cools, such as the shipped cue calibration-drive"
        )
    for recording in (log, *sensors):
        _check_exchanged(recording)
        if rig is not None:
            _check_probes(recording, rig)
    begin, alone = float(time[0]), driven_by == DISPLAY
    step = round(float(np.median(np.diff(time))), 9)  # differences of late times are off by rounding
    channels = []
    for clock, recording in enumerate((log, *sensors)):
        rows = slice(None) if clock else part
        for name in (name for name in recording.measured if _deeper(name) or not alone):
            values = recording.column(name)[rows]
            there = np.flatnonzero(np.isfinite(values))
            there = there[:: max(1, -(-len(there) // MOST_READINGS))]
            if there.size:
                channels.append(Channel(name, recording.name, clock, recording.time_s[rows][there], values[there]))
    unknown, phase, points = None, None, False
    if alone:
        unknown = unknown_display(time, drive)
    elif rig is not None and not tells_all(time, drive, rig.update_Hz):
        unknown, points = 0.5 * np.abs(np.diff(drive)), step * rig.update_Hz > MOST_UPDATES
        display = dict(log.columns).get(DISPLAY)
        if display is not None and np.isfinite(display[part][known]).any():
            phase = one_phase(time, drive, display[part][known])
    logged, many = None, max(int(FINEST_S / step + 1e-6), len(time) // MOST_STEPS)
    if unknown is None and many > 1:
        logged = Drive(time - begin, drive, held=True)
        time, drive = means(time, drive, many * step)
    notes = []
    if part.stop is not None:
        what = f"{time[0] - log.time_s[0]:.0f} to {time[-1] - log.time_s[0]:.0f} s are fitted"
        notes.append(f"{log.name}: is long: {what}; to fit another part, cut it out")
    return Run(
        log.name, driven_by, time - begin, step, drive, begin, tuple(channels),
        tuple(sensor.name for sensor in sensors), (0.0,) * len(sensors), unknown, phase, points, tuple(notes), logged,
    )  # fmt: skip


def _part(time: Array, drive: Array, alone: bool) -> slice:
    """The rows that are fitted: of a long log without further clocks, from some rest before its first change on."""
    length = max(LONG_S, LONG_ROWS * float(np.median(np.diff(time))))
    if not alone or time[-1] - time[0] <= length:
        return slice(None)
    there = np.flatnonzero(np.isfinite(drive))
    moved = there[np.abs(drive[there] - drive[there[:1]]) > SAME_SHARE * np.ptp(drive[there])]
    begin = time[moved[0]] - REST_S if moved.size else time[0]
    return slice(int(np.searchsorted(time, begin)), int(np.searchsorted(time, begin + length)))


def _check_exchanged(log: Log) -> None:
    if {DISPLAY, "skin_C"} <= set(log.measured):
        moves = [float(np.subtract(*np.nanpercentile(log.column(name), [95, 5]))) for name in (DISPLAY, "skin_C")]
        if moves[1] > MOST_MOVED * max(moves[0], LEAST_MOVED_K):
            raise LogError(
                f"{log.name}: skin_C changes by {moves[1]:.2g} K, and {DISPLAY}, which moves it, by {moves[0]:.2g} K "
                f"alone: exchange both columns, or remove the wrong one"
            )


def _check_probes(log: Log, rig: Rig) -> None:
    there = [f"probe_{probe.name}_C" for probe in rig.probes]
    for column in log.measured:
        if column.startswith("probe_") and column not in there:
            name = column.removeprefix("probe_").removesuffix("_C")
            probe = f'probe=[{{name="{name}", place="skin", depth_mm=0.5}}]'
            has = f" (it has {', '.join(there)})" if there else ""
            raise LogError(
                f"{log.name}: {column}: rig {rig.name} has no such probe{has}; say where it is by the key "
                f"{probe} of the rig, or remove the column"
            )


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
