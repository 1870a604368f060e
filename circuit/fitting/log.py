"""A measured log: columns over the time of one clock, checked for what no fit could mend."""

from __future__ import annotations

import hashlib
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermicon.icons.files.table import read_table
from thermicon.icons.near_words import nearest_words

from ..arrays import Array
from ..inputs import LIKE_MILLISECONDS, quoted, read_bytes, table_fault, text_of
from ..rig.module import ZERO_C_IN_K
from .keys import FitError

DRIVES = ("current_A", "command_V")
"""What can drive a run, in the order of preference; a column behind the first that is there counts as measured."""

TEMPERATURES = ("display_C", "skin_C", "hot_plate_C")
MEASURED = (*TEMPERATURES, "voltage_V")

FEWEST_ROWS, MOST_ROWS = 20, 1_000_000
MOST_SIZE = 1e12
"""Times by the clock of a computer have ten digits; what reads a wire that is off has fewer."""
COLDEST_C, HOTTEST_C = -40.0, 150.0
"""Outside, a sensor of a display on skin is unplugged or its wire broken."""

KELVIN = (ZERO_C_IN_K + COLDEST_C, ZERO_C_IN_K + HOTTEST_C)
FAHRENHEIT_FROM, FAHRENHEIT_TO = 65.0, 130.0
"""Medians of display or skin from here on would burn; 18 to 54 °C have these numbers in °F."""

SLOWEST_S, MILLI = 2.0, 1000.0
"""A log with rows farther apart than 2 s shows nothing of a display; as a rule its times are milliseconds."""

MOST_A, MOST_V = 50.0, 200.0
"""Far above what any display on skin takes, and far below what it takes in milliamperes and millivolts."""


class LogError(FitError):
    """A log that cannot be used: file, row or column, what is wrong with it, and the cure."""


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """A log of one clock: `time_s` (rows,) in s, increasing, and columns (rows,), NaN where nothing was recorded.

    `sha256` is the digest of its file, empty where it came from none; `notes` say what was adjusted or left out on
    reading.

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
        """A checked log of columns by name, `time_s` among them; raises LogError for what cannot be a log.

        `rows` are the places of the rows in a file, and `unused` its other columns, for messages.
        """
        values = {key: np.asarray(column, dtype=np.float64) for key, column in columns.items()}
        if "time_s" not in values:
            raise LogError(f"{name}: the column time_s (time in s) is missing; found {', '.join(values) or 'nothing'}")
        _check_lengths(name, values)
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
        for key, column in used.items():
            if fault := _unit_fault(key, column):
                raise LogError(f"{name}: {fault}")
        unused = unused or ", ".join(key for key in values if key not in used)
        more = (f"{name}: columns that are not used: {unused}",) if unused else ()
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
            raise LogError(
                f"{name}: unequal lengths: time_s has {time[0]} rows, {key} has {shape[0] if shape else 0}; cut the "
                f"longer column"
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
    if fault := _unit_fault("time_s", time):
        raise LogError(f"{name}: {fault}")


def _unit_fault(column: str, values: Array) -> str | None:
    """Return why a column is not in the unit of its name, with the cure; None where it may be."""
    there = values[np.isfinite(values)]
    if not there.size:
        return None
    if (most := float(np.abs(there).max())) > MOST_SIZE:
        return f"{column} reaches {most:g}, beyond the {MOST_SIZE:g} that any instrument gives; leave that row out"
    if column == "time_s":
        return _time_fault(there)
    if column.endswith("_C"):
        return _temperature_fault(column, there)
    limit, unit, small = (MOST_A, "A", "milliamperes") if column.endswith("_A") else (MOST_V, "V", "millivolts")
    if most > limit:
        return (
            f"{column} reaches {most:g} {unit}, above {limit:g} {unit}: it looks like {small}; divide it by 1000, so "
            f"that it is in {unit}"
        )
    return None


def _time_fault(time: Array) -> str | None:
    step = float(np.median(np.diff(time)))
    if step <= SLOWEST_S:
        return None
    if step * 1e-3 >= 1e-4 and float(time[-1] - time[0]) > 60.0 and step <= SLOWEST_S * MILLI:
        return f"time_s goes in steps of {step:g} over {time[-1] - time[0]:g}: {LIKE_MILLISECONDS}"
    return f"time_s goes in steps of {step:g} s; a fit needs rows at most {SLOWEST_S:g} s apart: log faster"


def _temperature_fault(column: str, there: Array) -> str | None:
    middle = float(np.median(there))
    if KELVIN[0] < middle < KELVIN[1] and middle > HOTTEST_C:
        return f"{column} has a median of {middle:g}: these look like kelvin; subtract {ZERO_C_IN_K:g} to have °C"
    if column in ("display_C", "skin_C") and FAHRENHEIT_FROM < middle < FAHRENHEIT_TO:
        return f"{column} has a median of {middle:g}: these look like °F; convert the column to °C"
    outside = (there < COLDEST_C) | (there > HOTTEST_C)
    if outside.mean() > 0.01:
        first = float(there[np.argmax(outside)])
        return (
            f"{column} reads {first:g} °C in {100 * outside.mean():.0f} % of its rows: a sensor that is unplugged or "
            f"shorted; connect it, or remove the column"
        )
    return None


MOST_MB = 200.0
OTHER_UNIT = {
    "time_ms": ("time_s", "divide it by 1000"),
    "time_min": ("time_s", "multiply it by 60"),
    "current_mA": ("current_A", "divide it by 1000"),
    "voltage_mV": ("voltage_V", "divide it by 1000"),
    "command_mV": ("command_V", "divide it by 1000"),
    **{f"{name.removesuffix('_C')}_K": (name, "subtract 273.15") for name in MEASURED if name.endswith("_C")},
    **{f"{name.removesuffix('_C')}_F": (name, "convert it to °C") for name in MEASURED if name.endswith("_C")},
}
"""Columns in another unit than a log has, the name they should have, and how to convert them."""

MISSPELT = 0.85
"""A name of a column that is so much alike a known one is taken for a slip of the pen."""


def read_log(path: str | Path) -> Log:
    r"""Read a measured log: a table with a line of names, its cells separated by commas, semicolons or tabs.

    Raises LogError for a file that is not a log, with its line or column and the cure.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "rig.csv"
    ...     rows = "".join(f"{k / 10},0.1,32.0\n" for k in range(30))
    ...     _ = path.write_text("time_s,current_A,display_C\n" + rows)
    ...     read_log(path)
    Log('rig.csv', 30 rows, 2.9 s: current_A, display_C)
    """
    where = Path(path)
    data = read_bytes(where, "log", MOST_MB, LogError)
    digest = hashlib.sha256(data).hexdigest()
    text = text_of(data, where, "log", LogError)
    table = read_table(text, table_fault(where, LogError), "time_s,current_A,…", MOST_ROWS)
    wanted = [name for name in dict.fromkeys(table.header) if name == "time_s" or is_known(name)]
    gaps = {name: Counter[str]() for name in wanted}
    columns = {name: table.numbers(name, "leave the cell empty", gaps=gaps[name]) for name in wanted}
    _check_columns(where.name, columns, table.header)
    notes = [
        f"{where.name}: {name} is {quoted(cell)} in {count:,} of {len(table.rows):,} rows, which are taken as gaps"
        for name, counts in gaps.items()
        for cell, count in counts.items()
        if cell
    ]
    unused = ", ".join([name for name in table.header if name not in columns and name != "icon"][:8])
    places = [f"{where}:{line}" for line in table.lines]
    return Log.of(where.name, columns, sha256=digest, notes=notes, rows=places, unused=unused)


def _check_columns(name: str, columns: Mapping[str, Array], header: Sequence[str]) -> None:
    """Every missing column at once, with what was found and what another unit should be converted to."""
    wrong = [f"{found} should be {right}: {how}" for found, (right, how) in OTHER_UNIT.items() if found in header]
    missing = [] if "time_s" in columns else ["time_s (time in s)"]
    if not any(is_known(column) for column in columns):
        missing.append(f"one of {', '.join(DRIVES)}, or any of {', '.join(MEASURED)}")
    known = ("time_s", *DRIVES, *MEASURED)
    misspelt = [(cell, _misspelt(cell, known)) for cell in header if cell not in columns and cell not in OTHER_UNIT]
    wrong += [f"{cell}: did you mean {name}? Rename it" for cell, name in misspelt if name and name not in columns]
    if not missing and not wrong:
        return
    parts = [f"missing: {', and '.join(missing)}"] if missing else []
    parts += [*wrong, f"found {', '.join(header[:12])}"]
    raise LogError(f"{name}: {'; '.join(parts)}")


def _misspelt(cell: str, known: Sequence[str]) -> str | None:
    """The known column that a name is but for case or a letter."""
    close = nearest_words(cell.lower(), [name.lower() for name in known], 1, MISSPELT)
    return next((name for name in known if close and name.lower() == close[0]), None)
