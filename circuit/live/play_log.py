"""The log of a play on the disk."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import IO, Any

import numpy as np

from thermicon.base.files.atomic import OutputError, complete_or_absent
from thermicon.base.numbers.arrays import Array

from ..delivery.delivered_drive import ModuleDrive
from ..delivery.formats.form import events_in
from ..delivery.pack import plain
from ..play.logged_line import LineRow
from ..play.watch import Stopped
from ..solver.trace import Trace, write_trace
from .ready import SENSORS

MEASURED = ("set_point_C", *(f"probe_{name}_C" for name in SENSORS), "current_A", "voltage_V")
COLUMNS = ("time_s", "host_s", "icon", "event", *MEASURED)
FLUSHED_EVERY_S = 1.0
Seen = Callable[[str, Sequence[LineRow]], None]
"""What gets the name of an icon and turns of its log as they come."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPlay:
    """What was measured of an icon: `columns` (rows,) of its log by name, 0 s where the drive's first row was sent.

    `rms_K` is of the loop's sensor from the predicted one while the icon played, NaN where it did not; `files` are the
    names of log, predicted trace and settings, empty where nothing was written.
    """

    name: str
    columns: Mapping[str, Array]
    predicted: Trace
    rms_K: float
    ended: bool
    files: tuple[str, ...] = ()

    @property
    def told(self) -> str:
        """How far the display was from the prediction, in words."""
        return f"{1e3 * self.rms_K:.0f} mK rms" if math.isfinite(self.rms_K) else "not begun"


@dataclass(slots=True)
class _OpenLog:
    """Turns of one play, each with the computer's time at which it was known and what begins in it."""

    stem: str
    delivery: ModuleDrive
    rows: list[tuple[LineRow, float, str]] = field(default_factory=list)
    began_s: float = math.inf


class PlayLog:
    """Writes the log of one play after the other into a folder; without a folder it keeps what was measured.

    `seen` gets turns as they come. While plays go on, times count from a log's first row. `finish` counts them from the
    drive's first row; that takes long, and comes when the output is off.
    """

    def __init__(self, folder: Path | None, seen: Seen = lambda name, rows: None) -> None:
        self._folder, self._seen = folder, seen
        self._file: IO[str] | None = None
        self._logs: list[_OpenLog] = []
        self._times = Counter[str]()
        self._mark, self._flushed_s = "", 0.0
        self.unfinished = ""

    def open(self, delivery: ModuleDrive) -> None:
        """Begin the log of an icon's play."""
        name = delivery.icon.name
        self._times[name] += 1
        stem = name if self._times[name] == 1 else f"{name}.{self._times[name]}"
        self._logs.append(_OpenLog(stem, delivery))
        if self._folder is not None:
            self.close()
            self._file = (self._folder / f"{stem}.log.csv").open("x", encoding="utf-8", newline="\n")
            self._file.write(",".join(COLUMNS) + "\n")

    def mark(self, text: str) -> None:
        """Say in the next row what begins."""
        self._mark = f"{self._mark}; {text}" if self._mark else text

    def began(self, time_s: float) -> None:
        """Say when the first row of the icon was sent, by the clock of the device."""
        self._logs[-1].began_s = time_s

    def take(self, rows: Sequence[LineRow], host_s: float) -> None:
        """Write turns that the device reported at a time of this computer."""
        log = self._logs[-1]
        self._seen(log.delivery.icon.name, rows)
        try:
            for row in rows:
                log.rows.append((row, host_s, self._mark))
                self._mark = ""
                if self._file is not None:
                    self._file.write(_line(log, len(log.rows) - 1, log.rows[0][0].time_s))
            if self._file is not None and rows and rows[-1].time_s >= self._flushed_s + FLUSHED_EVERY_S:
                self._flushed_s = rows[-1].time_s
                self._file.flush()
        except OSError as problem:
            with suppress(OSError):
                self.close()
            self._file = None  # what is measured is kept, and written at the end where there is room again
            raise Stopped(
                f"the log cannot be written ({problem.strerror}); make room, or give another folder"
            ) from None

    def close(self) -> None:
        """Close the file that is written."""
        if self._file is not None:
            self._file.close()

    def finish(self, about: Mapping[str, Any]) -> tuple[MeasuredPlay, ...]:
        """Put events and times into each log, and write the prediction and what was set beside it.

        Where that cannot be written, `unfinished` says why, the log stays as it was, and its play has no files.
        """
        self.close()
        return tuple(self._finished(log, about) for log in self._logs if log.rows)

    def _finished(self, log: _OpenLog, about: Mapping[str, Any]) -> MeasuredPlay:
        measured, zero_s = _measured(log)
        if self._folder is None:
            return measured
        try:
            return replace(measured, files=_written(self._folder, log, zero_s, measured, about))
        except (OSError, OutputError) as problem:
            self.unfinished = f"{log.stem}.log.csv has no prediction beside it, which could not be written ({problem})"
            return measured


def _measured(log: _OpenLog) -> tuple[MeasuredPlay, float]:
    """What was measured, and the time of the log's first row of the drive."""
    trace, times = log.delivery.trace, np.array([row.time_s for row, _, _ in log.rows])
    first = int(np.searchsorted(times, log.began_s + 1e-9))  # the turn that began before could not know it
    has_begun = first < len(times)
    zero_s = float(times[first if has_begun else 0])
    for event in events_in(log.delivery) if has_begun else ():
        at = int(np.searchsorted(times, zero_s + event.time_s - 1e-6))
        if at < len(times):
            row, host_s, text = log.rows[at]
            log.rows[at] = row, host_s, f"{text}; {event.name}" if text else event.name
    table = np.array([[math.nan if cell is None else cell for cell in row] for row, _, _ in log.rows])
    columns = dict(zip(("time_s", *MEASURED), table.T, strict=True))
    columns["time_s"] = time_s = columns["time_s"] - zero_s
    played = (time_s >= 0.0) & (time_s <= trace.time_s[-1]) & has_begun
    due_C = np.interp(time_s[played], trace.time_s, dict(trace.probes)[SENSORS[0]])
    off_K = columns[MEASURED[1]][played] - due_C
    rms_K = float(np.sqrt(np.mean(off_K**2))) if has_begun else math.nan
    ended = bool(has_begun and time_s[-1] >= log.delivery.file_s - 1e-6)
    return MeasuredPlay(log.delivery.icon.name, columns, trace, rms_K, ended), zero_s


def _written(
    folder: Path, log: _OpenLog, zero_s: float, measured: MeasuredPlay, about: Mapping[str, Any]
) -> tuple[str, ...]:
    """Write the log as it is after the play, the prediction and what was set, and return their names."""
    names = tuple(f"{log.stem}.{end}" for end in ("log.csv", "predicted.csv", "log.json"))
    with complete_or_absent(folder / names[0]) as draft:
        lines = [_line(log, number, zero_s) for number in range(len(log.rows))]
        draft.write_text("".join([",".join(COLUMNS) + "\n", *lines]), encoding="utf-8", newline="\n")
    write_trace(replace(measured.predicted, icon=log.stem), folder / names[1])
    content = plain({**about, "icon": measured.name, "rms_K": measured.rms_K, "ended": measured.ended})
    with complete_or_absent(folder / names[2]) as draft:
        draft.write_text(json.dumps(content, indent=2, ensure_ascii=False, default=asdict) + "\n", encoding="utf-8")
    return names


def _line(log: _OpenLog, number: int, zero_s: float) -> str:
    row, host_s, text = log.rows[number]
    cells = ["" if cell is None else f"{cell:.5f}" for cell in row[1:]]
    return ",".join([f"{row.time_s - zero_s:.4f}", f"{host_s:.4f}", log.stem, text, *cells]) + "\n"
