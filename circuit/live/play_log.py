"""The log of a play on the disk."""

from __future__ import annotations

import itertools
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any

import numpy as np

from thermicon.base.files.atomic import complete_or_absent
from thermicon.base.numbers.arrays import Array

from ..delivery.pack import plain
from ..solver.trace import write_trace
from .logged_line import LineRow
from .ready import SENSORS, ReadyDrive

COLUMNS = (
    *("time_s", "host_s", "icon", "event", "set_point_C"),
    *(f"probe_{name}_C" for name in SENSORS),
    *("current_A", "voltage_V"),
)
FLUSHED_EVERY_S = 1.0
DECIMALS = (4, 4, 4, 5, 4)
Logged = tuple[LineRow, float, str]
"""A turn, the time of this computer at which it was known, and what begins in it."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPlay:
    """What was measured of an icon: `columns` (rows,) of its log by name, 0 s where the drive's first row was sent.

    `rms_K` is of its loop's sensor from the predicted one while the icon played, NaN where it did not; `files` are the
    names of log, predicted trace and settings, empty where nothing was written.
    """

    name: str
    columns: Mapping[str, Array]
    rms_K: float
    ended: bool
    files: tuple[str, ...] = ()

    @property
    def display_C(self) -> tuple[float, float]:
        """Lowest and highest °C of the loop's sensor while the icon played."""
        played = self.columns["probe_loop_C"][self.columns["time_s"] >= 0.0]
        return (float(played.min()), float(played.max())) if len(played) else (np.nan, np.nan)


class PlayLog:
    """Writes the log of one play after the other into a folder; without a folder it only keeps what was measured.

    While plays go on, times count from a log's first row. `finish` counts them from the drive's first row, which takes
    long and therefore comes when the output is off.
    """

    def __init__(self, folder: Path | None, about: Mapping[str, Any]) -> None:
        self._folder, self._about = folder, dict(about)
        self._file: IO[str] | None = None
        self._rows: list[Logged] = []
        self._stem, self._mark, self._flushed_s = "", "", 0.0
        self._ended: list[tuple[str, list[Logged], ReadyDrive, float, Mapping[str, Any]]] = []

    def open(self, name: str) -> None:
        """Begin the log of an icon's play."""
        used, stems = {ended[0] for ended in self._ended}, (f"{name}-{times}" for times in itertools.count(2))
        self._stem, self._rows = next(stem for stem in itertools.chain([name], stems) if stem not in used), []
        if self._folder is not None:
            self._file = (self._folder / f"{self._stem}.log.csv").open("x", encoding="utf-8", newline="\n")
            self._file.write(",".join(COLUMNS) + "\n")

    def mark(self, text: str) -> None:
        """Say in the next row what begins."""
        self._mark = f"{self._mark}; {text}" if self._mark else text

    def take(self, rows: Sequence[LineRow], host_s: float) -> None:
        """Write turns that the device reported at a time of this computer."""
        for row in rows:
            self._rows.append((row, host_s, self._mark))
            if self._file is not None:
                self._file.write(_line(self._stem, *self._rows[-1], self._rows[0][0].time_s))
            self._mark = ""
        if self._file is not None and rows and rows[-1].time_s >= self._flushed_s + FLUSHED_EVERY_S:
            self._flushed_s = rows[-1].time_s
            self._file.flush()

    def end(self, drive: ReadyDrive, began_s: float, settings: Mapping[str, Any]) -> None:
        """End the log of a play whose first row was sent at a time of the device, infinity where none was."""
        if self._file is not None:
            self._file.close()
        self._ended.append((self._stem, self._rows, drive, began_s, settings))

    def finish(self) -> tuple[MeasuredPlay, ...]:
        """Put events and times into each log, and write the prediction and what was set beside it."""
        return tuple(self._finished(*ended) for ended in self._ended)

    def _finished(
        self, stem: str, rows: list[Logged], drive: ReadyDrive, began_s: float, settings: Mapping[str, Any]
    ) -> MeasuredPlay:
        times = np.array([row.time_s for row, _, _ in rows])
        first = int(np.searchsorted(times, began_s + 1e-9))  # the turn that began before could not know it
        has_begun = first < len(times)
        zero_s = float(times[first]) if has_begun else float(times[0]) if len(times) else 0.0
        for event in drive.events if has_begun else ():
            at = int(np.searchsorted(times, zero_s + event.time_s - 1e-6))
            if at < len(times):
                row, host_s, said = rows[at]
                rows[at] = row, host_s, f"{said}; {event.name}" if said else event.name
        measured = _measured(rows, drive, zero_s, has_begun)
        if self._folder is None:
            return measured
        names = tuple(f"{stem}.{end}" for end in ("log.csv", "predicted.csv", "log.json"))
        with complete_or_absent(self._folder / names[0]) as draft:
            lines = (_line(stem, *each, zero_s) for each in rows)
            draft.write_text("".join([",".join(COLUMNS) + "\n", *lines]), encoding="utf-8", newline="\n")
        write_trace(replace(drive.trace, icon=drive.name), self._folder / names[1])
        content = {**self._about, "icon": drive.name, "drive_sha256": drive.sha256, "rms_K": measured.rms_K, **settings}
        with complete_or_absent(self._folder / names[2]) as draft:
            draft.write_text(json.dumps(plain(content), indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
        return replace(measured, files=names)


def _line(name: str, row: LineRow, host_s: float, said: str, zero_s: float) -> str:
    cells = (row.set_point_C, row.loop_C, row.second_C, row.current_A, row.voltage_V)
    shown = ["" if cell is None else f"{cell:.{digits}f}" for cell, digits in zip(cells, DECIMALS, strict=True)]
    return ",".join([f"{row.time_s - zero_s:.4f}", f"{host_s:.4f}", name, said, *shown]) + "\n"


def _measured(rows: Sequence[Logged], drive: ReadyDrive, zero_s: float, has_begun: bool) -> MeasuredPlay:
    """The columns as arrays, and how far the loop's sensor was from its prediction."""
    table = np.array([[np.nan if cell is None else cell for cell in row] for row, _, _ in rows], dtype=float)
    columns = dict(zip(("time_s", *COLUMNS[4:]), table.reshape(-1, 6).T, strict=True))
    columns["time_s"] = columns["time_s"] - zero_s
    trace, time_s = drive.trace, columns["time_s"]
    played = (time_s >= 0.0) & (time_s <= trace.time_s[-1]) & has_begun
    due_C = np.interp(time_s[played], trace.time_s, dict(trace.probes)[SENSORS[0]])
    off_K = columns[COLUMNS[5]][played] - due_C
    rms_K = float(np.sqrt(np.mean(off_K**2))) if len(off_K) else float("nan")
    ended = bool(has_begun and len(time_s) and time_s[-1] >= drive.rows[-1][0] - 1e-6)
    return MeasuredPlay(drive.name, columns, rms_K, ended)
