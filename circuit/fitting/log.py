"""A measured log: columns over the time of one clock, checked for what no fit could mend."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..solver.trace import Trace
from .keys import FitError
from .log_units import unit_fault

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .overlay import Overlay

DRIVES = ("current_A", "command_V", "voltage_V", "setpoint_C")
"""What can drive a run, in the order of preference; a column behind the first that is there counts as measured."""

TEMPERATURES = ("display_C", "skin_C", "hot_plate_C")
MEASURED = (*TEMPERATURES, "voltage_V")

FEWEST_ROWS, MOST_ROWS = 20, 1_000_000
MOST_SIZE = 1e12
"""Times by the clock of a computer have ten digits; what reads a wire that is off has fewer."""
UNEQUAL = 0.02
"""Share of the rows that may be empty at the end of a column: more is a column that ended earlier."""


class LogError(FitError):
    """A log that cannot be used: file, row or column, what is wrong with it, and the cure.

    Examples
    --------
    >>> try:
    ...     Log.of("rig.csv", {"time_s": range(30), "current_A": [0.1] * 29})
    ... except LogError as problem:
    ...     print(problem)
    rig.csv: unequal lengths: time_s has 30 rows, current_A has 29; cut the longer column
    """


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """A log of one clock.

    Attributes
    ----------
    name
        Name of the file.
    sha256
        Digest of the file's bytes; empty for a log that came from no file.
    time_s
        Times (rows,) in s by its own clock, increasing.
    columns
        Name and values (rows,) of every column; NaN where nothing was recorded.
    notes
        What was adjusted or left out on reading.
    unused
        The file's columns that are not used, as people read them.

    Examples
    --------
    >>> log = Log.of("rig.csv", {"time_s": range(30), "current_A": [0.1] * 30, "display_C": [32.0] * 30})
    >>> log
    Log('rig.csv', 30 rows, 29 s: current_A, display_C)
    """

    name: str
    sha256: str
    time_s: Array
    columns: tuple[tuple[str, Array], ...]
    notes: tuple[str, ...] = field(default=())
    unused: str = ""

    def __repr__(self) -> str:
        span = self.time_s[-1] - self.time_s[0]
        return f"Log({self.name!r}, {len(self.time_s)} rows, {span:g} s: {', '.join(dict(self.columns))})"

    @staticmethod
    def of(
        name: str,
        columns: Mapping[str, Sequence[float] | Array],
        *,
        sha256: str = "",
        notes: Sequence[str] = (),
        rows: Sequence[str] | None = None,
        unused: str = "",
    ) -> Log:
        """Return a checked log of columns by name, `time_s` among them.

        `rows` are the places of the rows in a file, and `unused` its other columns, for messages.
        Raises LogError for what cannot be a log.
        """
        values = {key: np.asarray(column, dtype=np.float64) for key, column in columns.items()}
        if "time_s" not in values:
            raise LogError(f"{name}: the column time_s (time in s) is missing; found {', '.join(values) or 'nothing'}")
        _check_lengths(name, values)
        _check_size(name, {key: column for key, column in values.items() if key == "time_s" or is_known(key)}, rows)
        time = values.pop("time_s")
        _check_times(name, time, rows)
        for key in (*DRIVES, *TEMPERATURES):
            if key in values and not np.isfinite(values[key]).any():
                raise LogError(f"{name}: {key} holds no number at all; remove the column, or connect the sensor")
        used = {key: column for key, column in values.items() if is_known(key)}
        if not used:
            raise LogError(
                f"{name}: no column of a log; needed is one of {', '.join(DRIVES)}, and any of "
                f"{', '.join(MEASURED)}; found time_s, {', '.join(values)}"
            )
        _check_ends(name, used)
        for key, column in used.items():
            if fault := unit_fault(key, column):
                raise LogError(f"{name}: {fault}")
        unused = unused or ", ".join(key for key in values if key not in used)
        more = (f"{name}: columns that are not used: {unused}",) if unused else ()
        for array in (time, *used.values()):
            array.setflags(write=False)
        return Log(name, sha256, time, tuple(used.items()), (*notes, *more), unused)

    @property
    def drive(self) -> str | None:
        """The column that drives the run; None for a log of sensors alone, which goes with another log."""
        there = dict(self.columns)
        return next((name for name in DRIVES if name in there), None)

    @property
    def measured(self) -> tuple[str, ...]:
        """Columns to be compared with a simulation."""
        return tuple(name for name, _ in self.columns if is_measured(name) and name != self.drive)

    def column(self, name: str) -> Array:
        """Values (rows,) of a column; raises KeyError with the columns there are."""
        there = dict(self.columns)
        if name not in there:
            raise KeyError(f"no column {name} in {self.name}; there is {', '.join(there)}")
        return there[name]

    def beside(self, trace: Trace, shift_s: float | None = None) -> Overlay:
        """Lay the log beside a trace on the trace's clock: shift, rms and largest miss; see `overlay`."""
        from .overlay import overlay

        return overlay(trace, self, shift_s=shift_s)

    def draw_beside(self, trace: Trace, ax: Axes) -> None:
        """Draw the measured temperatures into the Axes of a trace's plot."""
        from .fit_figure import draw_measured

        draw_measured(self.beside(trace), ax)


def is_measured(name: str) -> bool:
    """Whether a column can be compared with a simulation.

    >>> is_measured("probe_thermistor_C"), is_measured("pressure_kPa")
    (True, False)
    """
    return name in MEASURED or (name.startswith("probe_") and name.endswith("_C"))


def is_known(name: str) -> bool:
    """Whether a log may have this column."""
    return name in DRIVES or is_measured(name)


def _check_lengths(name: str, values: Mapping[str, Array]) -> None:
    lengths = {key: column.shape for key, column in values.items()}
    time = lengths["time_s"]
    if len(time) != 1 or time[0] < FEWEST_ROWS:
        raise LogError(f"{name}: {math.prod(time)} rows; a fit needs at least {FEWEST_ROWS}")
    if time[0] > MOST_ROWS:
        raise LogError(f"{name}: {time[0]:,} rows; the limit is {MOST_ROWS:,}: keep every tenth row")
    for key, shape in lengths.items():
        if shape != time:
            raise LogError(
                f"{name}: unequal lengths: time_s has {time[0]} rows, {key} has {shape[0] if shape else 0}; cut the "
                f"longer column"
            )


def _check_size(name: str, values: Mapping[str, Array], rows: Sequence[str] | None) -> None:
    """A number that no instrument gives would be infinite in the sum of squares."""
    for key, column in values.items():
        wild = np.flatnonzero(np.abs(column) > MOST_SIZE)
        if wild.size:
            row = int(wild[0])
            raise LogError(
                f"{_place(name, row, rows)}: {key} is {column[row]:g}, beyond the {MOST_SIZE:g} that any instrument "
                f"gives; {'remove the row' if key == 'time_s' else 'leave the cell empty'}"
            )


def _place(name: str, row: int, rows: Sequence[str] | None) -> str:
    return rows[row] if rows else f"{name}, row {row + 1}"


def _check_times(name: str, time: Array, rows: Sequence[str] | None) -> None:
    if not np.isfinite(time).all():
        row = int(np.argmin(np.isfinite(time)))
        raise LogError(f"{_place(name, row, rows)}: time_s is empty; remove the row")
    back = np.flatnonzero(np.diff(time) <= 0)
    if back.size:
        row = int(back[0]) + 1
        raise LogError(
            f"{_place(name, row, rows)}: time_s {time[row]:g} s does not come after {time[row - 1]:g} s; times must "
            f"increase: sort the rows, or give each recording its own file"
        )
    if fault := unit_fault("time_s", time):
        raise LogError(f"{name}: {fault}")


def _check_ends(name: str, values: Mapping[str, Array]) -> None:
    """A column that ends well before the others was cut, or its logger stopped."""
    last = {key: int(np.flatnonzero(np.isfinite(column))[-1]) for key, column in values.items()
            if np.isfinite(column).any()}  # fmt: skip
    longest = max(last.values(), default=0)
    for key, row in last.items():
        if longest - row > max(UNEQUAL * longest, 2):
            raise LogError(
                f"{name}: unequal lengths: {key} ends in row {row + 1}, the log in row {longest + 1}; cut the log "
                f"there, or save the columns of each instrument as a file of its own"
            )
