"""A measured log: checked columns over the time of one clock."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.files.clock import order_fault
from thermicon.base.files.column_choice import is_reading
from thermicon.base.files.inputs import read_bytes, table_fault
from thermicon.base.files.measured_table import measured, missing, recordings
from thermicon.base.files.table import read_table
from thermicon.base.files.units import like_units_of_time, unit_fault
from thermicon.base.numbers.arrays import Array

from .keys import FitError

if TYPE_CHECKING:
    import pandas as pd

DRIVES = ("current_A", "command_V")
"""What can drive a run, in the order of preference; a column behind the first that is there counts as measured."""

TEMPERATURES = ("display_C", "skin_C", "hot_plate_C")
MEASURED = (*TEMPERATURES, "voltage_V")

FEWEST_ROWS, MOST_ROWS = 20, 1_000_000
SHORTEST_S, SLOWEST_S = 1e-4, 2.0
"""Rows farther apart than 2 s show nothing of a display; closer than 0.1 ms they count days, as a rule."""


LONGEST_S = 3600.0
"""A log of whole numbers that is longer is asked for its unit of time."""


class LogError(FitError):
    """A log that cannot be used: file, row or column, what is wrong with it, and the cure."""


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """A log of one clock: `time_s` (rows,) in s, increasing, and columns (rows,), NaN where nothing was recorded.

    `sha256` is the digest of its file, empty where it came from none; `notes` say what was adjusted or left out on
    reading, `lost` which of our columns the file does not call as was said, `run` which recording of its file it is.

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
    notes: tuple[str, ...] = ()
    lost: Mapping[str, str] = field(default_factory=dict)
    run: int = 1

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
        clocked: bool = False,
    ) -> Log:
        """A checked log of columns by name, `time_s` among them; raises LogError for what cannot be a log.

        What is `clocked` has its times from a clock, whose unit is known.
        """
        values = {key: np.asarray(column, dtype=np.float64) for key, column in columns.items()}
        if "time_s" not in values:
            raise LogError(f"{name}: the column time_s (time in s) is missing; found {', '.join(values) or 'nothing'}")
        _check_lengths(name, values)
        time = values.pop("time_s")
        _check_times(name, time, clocked)
        used = {key: column for key, column in values.items() if is_known(key)}
        empty = [key for key, column in used.items() if not np.isfinite(column).any()]
        used = {key: column for key, column in used.items() if key not in empty}
        if not used:
            raise LogError(
                f"{name}: no column of a log; needed is one of {', '.join(DRIVES)}, and any of "
                f"{', '.join(MEASURED)}, with numbers in it; found time_s, {', '.join(values)}"
            )
        for key, column in {"time_s": time, **used}.items():
            if fault := unit_fault(key, column):
                raise LogError(f"{name}: {'; '.join(fault)}")
        unused = ", ".join(key for key in values if key not in (*used, *empty))
        more = [f"{name}: columns that are not used: {unused}"] if unused else []
        if empty:
            more.append(f"{name}: columns that are empty throughout, and left out: {', '.join(empty)}")
        for array in (time, *used.values()):
            array.setflags(write=False)
        return Log(name, sha256, time, tuple(used.items()), (*notes, *more))

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


def is_measured(name: str) -> bool:
    """Whether a column can be compared with a simulation."""
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
            what = f"time_s has {time[0]} rows, {key} has {shape[0] if shape else 0}"
            raise LogError(f"{name}: unequal lengths: {what}; cut the longer column")


def _check_times(name: str, time: Array, clocked: bool) -> None:
    if not np.isfinite(time).all():
        row = int(np.argmin(np.isfinite(time)))
        raise LogError(f"{name}, row {row + 1}: time_s is empty; remove the row")
    if (np.diff(time) <= 0).any():
        row, why = order_fault(time) or (int(np.argmin(np.diff(time))) + 1, "write times with more decimals")
        what = f"time_s {time[row]:g} s does not come after {time[row - 1]:g} s; times must increase"
        raise LogError(f"{name}, row {row + 1}: {what}: {why}")
    length, step = float(time[-1] - time[0]), float(np.median(np.diff(time)))
    usual = SHORTEST_S <= step <= SLOWEST_S
    like = None if clocked else like_units_of_time(time, whole=usual)
    if like and (length > LONGEST_S or not usual):
        what = f"time_s goes in steps of {step:g} over {length:g}: these look like {like[0]}; {like[1]} to have s"
        raise LogError(f"{name}: {what}{'; of a run that is as long in s, keep an hour' if usual else ''}")
    if step > SLOWEST_S:
        cure = f"a fit needs rows at most {SLOWEST_S:g} s apart: log faster"
        raise LogError(f"{name}: time_s goes in steps of {step:g} s; {cure}")


MOST_MB = 200.0
NAMES = ("time_s", *DRIVES, *MEASURED)
CURE = "leave the cell empty"


def read_log(path: str | Path | pd.DataFrame, columns: Mapping[str, str] | None = None) -> Log:
    """Read a measured log of one recording, as `read_logs` does."""
    logs = read_logs(path, columns)
    if len(logs) > 1:
        what = f"{path}: the clock starts again {len(logs) - 1} times"
        raise LogError(f"{what}: give each recording its own file, or use read_logs")
    return logs[0]


def read_logs(path: str | Path | pd.DataFrame, columns: Mapping[str, str] | None = None) -> list[Log]:
    r"""Read measured logs: a table with a line of names, its cells separated by commas, semicolons or tabs.

    A table of pandas is read as the file that it would write, with its index where that holds times. `columns` says
    what the file calls ours, such as {"display_C": "T1"}, where that does not follow from its names. Where the clock
    starts again, another log begins.
    Raises LogError for a file that is not a log, with its line or column and the cure.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "rig.csv"
    ...     rows = "".join(f"{k / 10},0.1,32.0\n" for k in range(30))
    ...     _ = path.write_text("time_s,current_A,display_C\n" + rows)
    ...     read_logs(path)
    [Log('rig.csv', 30 rows, 2.9 s: current_A, display_C)]
    """
    if isinstance(path, str | Path):
        where, data = Path(path), read_bytes(Path(path), "log", MOST_MB, LogError)
    else:
        timed = path.index.dtype.kind in "mMf" and "time_s" not in path.columns  # clocks, elapsed times, or seconds
        where, data = Path("table"), path.to_csv(index=timed, index_label="time_s").encode()
    table = read_table(data, table_fault(where, LogError), "time_s,current_A,…", MOST_ROWS, NAMES, columns)
    wanted = [name for name in dict.fromkeys(table.header) if is_known(name)]
    blind = not any(name.endswith("_C") for name in wanted)
    if table.names.doubtful or not wanted or (blind and any(is_reading(cell, "C", ()) for cell in table.header)):
        raise missing(table, "display_C", f"one of {', '.join(NAMES[1:])}")
    parts, digest, logs = recordings(table), hashlib.sha256(data).hexdigest(), list[Log]()
    unused = ", ".join([name for name in table.header if name not in ("time_s", "icon", "", *wanted)][:8])
    for run, part in enumerate(parts, 1):
        found = measured(part, wanted, CURE)
        again = [f"line {part.lines[0]}: the clock starts again: read as another recording"] if run > 1 else []
        said = (*again, *found.notes, *([f"columns that are not used: {unused}"] if unused else []))
        name = where.name if len(parts) == 1 else f"{where.name}, recording {run}"
        notes = [f"{name}: {note}" for note in said]
        values = {"time_s": found.time_s, **found.columns}
        log = Log.of(name, values, sha256=digest, notes=notes, clocked=found.clocked)
        lost = {name: f"{where.name}: {said}" for name, said in table.lost.items()}
        logs.append(replace(log, lost=lost, run=run))
    return logs
