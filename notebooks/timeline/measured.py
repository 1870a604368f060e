"""A measured log over the simulated curves of an icon: read and aligned once, compared in every frame."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.icons.number_text import number, signed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from thermicon.circuit import Trace
    from thermicon.circuit.fitting.log import Log
    from thermicon.circuit.fitting.overlay import Beside, Overlay

MOST_ROWS = 20_000
"""Rows that a log is thinned to, so that it can be compared in every frame of a drag."""
SHOWN = {
    "display_C": ("temperature", "measured display", "grey"),
    "skin_C": ("temperature", "measured skin", "ink"),
    "current_A": ("current", "measured current", "ink"),
}
"""Panel, label and role of the columns that are drawn; others are compared in words."""
UNITS = {"C": ("K", 2), "A": ("A", 3), "V": ("V", 2)}
DOTS: tuple[tuple[int, int], float] = ((2, 3), 2.75)


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """A log with what is added to its times (s) to lie on the clock of the icon, and whether that was set by hand."""

    log: Log
    shift_s: float
    by_hand: bool = False


def read_measured(path: Path) -> Log:
    """Read a log as ``thermicon fit`` does, thinned where it is long; raises LogError, with place and cure."""
    from thermicon.circuit.fitting.log import Log, read_log

    log = read_log(path)
    every = -(-len(log.time_s) // MOST_ROWS)
    if every == 1:
        return log
    columns = {"time_s": log.time_s[::every], **{name: values[::every] for name, values in log.columns}}
    thinned = f"{log.name}: one row in {every} of {len(log.time_s):,} is shown"
    return Log.of(log.name, columns, sha256=log.sha256, notes=(*log.notes, thinned))


def read_uploaded(files: Mapping[str, bytes]) -> Log:
    """Read a log that came through the page; raises LogError."""
    from thermicon.circuit.fitting.log import LogError

    if len(files) != 1:
        raise LogError(f"one log at a time; got {', '.join(files) or 'nothing'}")
    ((name, data),) = files.items()
    with TemporaryDirectory(prefix="thermicon-") as folder:
        path = Path(folder) / Path(name).name
        path.write_bytes(data)
        try:
            return read_measured(path)
        except LogError as wrong:
            raise LogError(str(wrong).replace(f"{folder}{os.sep}", "")) from None


def aligned(log: Log, trace: Trace) -> Measured:
    """Return the log on the clock of a trace, by correlation; raises LogError where they have nothing in common."""
    from thermicon.circuit.fitting.overlay import overlay

    return Measured(log, overlay(trace, log).shift_s)


def beside(measured: Measured, trace: Trace) -> tuple[Overlay | None, str]:
    """The log beside a trace, with how far apart they are in words; None, with the reason, where it cannot lie there.

    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.circuit.fitting.laboratory import calibration_icon, synthetic_log
    >>> rig = Rig.load("thenar")
    >>> log, trace = synthetic_log(rig, seed=1, columns=["display_C"]), simulate(calibration_icon(), rig)
    >>> beside(aligned(log, trace), trace)[1].partition(",")[0].startswith("synthetic.csv: current rms ")
    True
    """
    from thermicon.circuit.fitting.log import LogError
    from thermicon.circuit.fitting.overlay import overlay

    try:
        laid = overlay(trace, measured.log, shift_s=measured.shift_s)
    except LogError as wrong:
        return None, str(wrong)
    how = "set by hand" if measured.by_hand else "by correlation"
    parts = "; ".join(_words(column) for column in laid.columns)
    return laid, f"{laid.name}: {parts}; measured − simulated, shifted by {number(laid.shift_s, 2)} s ({how})"


def shown_curves(laid: Overlay, time_s: NDArray[np.float64]) -> list[tuple[str, str, str, str, NDArray[Any]]]:
    """Panel, key, label, role and values on the trace's clock of every column that is drawn; NaN where none is."""
    curves = []
    for column in laid.columns:
        if column.column in SHOWN:
            panel, label, role = SHOWN[column.column]
            values = np.interp(time_s, column.time_s, column.measured, left=np.nan, right=np.nan)
            curves.append((panel, f"measured {column.column}", label, role, values))
    return curves


def _words(column: Beside) -> str:
    name, _, unit = column.column.rpartition("_")
    said, digits = UNITS[unit]
    largest = signed(column.largest, f"+.{digits}f")
    words = name.replace("_", " ")
    return f"{words} rms {number(column.rms, digits)} {said}, largest {largest} {said} at {column.largest_s:.2f} s"
