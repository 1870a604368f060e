"""Curves over time: out of a trace, or read from the file of a trace or of a measured log."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from thermicon.circuit import Trace

    Array = NDArray[numpy.float64]

MOST_MB = 200.0
MOST_UNPACKED_MB, MOST_ROWS = 1000.0, 10_000_000
"""What a Parquet file, which is packed, may hold."""
LARGEST = 1e9
"""Largest size of a number, far more than any sensor gives: sums of squares stay finite."""
CURE = "correct it, or leave the cell empty"
EXTRA = re.compile(r"probe_.+_C")


class LogError(Exception):
    """A trace or log that cannot be read or compared; the text says where and what to change."""


@dataclass(frozen=True, slots=True)
class Curves:
    """Columns (rows,) by name over `time_s`; NaN where nothing was recorded. `whole`: with all columns of a trace."""

    name: str
    time_s: Array
    columns: Mapping[str, Array]
    whole: bool
    ignored: tuple[str, ...] = field(default=())


def curves_of(trace: Trace, name: str) -> Curves:
    """Return a trace as curves under a name that people know it by."""
    frame = trace.to_frame().drop(columns="icon")
    columns = {str(column): frame[column].to_numpy(dtype=float) for column in frame.columns if column != "time_s"}
    return Curves(name, trace.time_s, columns, whole=True)


def read_curves(path: str, icon: str | None = None) -> Curves:
    """Return the curves in the file of a trace or log; of a file with several icons, those of `icon`.

    Raises LogError that says what is wrong and where.
    """
    from thermicon.circuit.solver.trace import COLUMNS

    where = Path(path)
    source = _of_parquet(where) if where.suffix.lower() == ".parquet" else _of_text(where)
    known = [name for name in source.names if name in COLUMNS[2:] or EXTRA.fullmatch(name)]
    _check_columns(source.names, known, path)
    time = source.column("time_s")
    rows = _rows_of(source.icons, path, icon) if source.icons else numpy.arange(len(time))
    time = time[rows]
    if len(time) < 2:
        raise LogError(f"{path}: {len(time)} rows; at least two are needed")
    if not numpy.isfinite(time).all():
        raise LogError(f"{source.place(rows[numpy.argmin(numpy.isfinite(time))])}: time_s is empty")
    if (back := numpy.flatnonzero(numpy.diff(time) <= 0)).size:
        row = int(back[0]) + 1
        raise LogError(
            f"{source.place(rows[row])}: time_s {time[row]:g} s does not come after {time[row - 1]:g} s; "
            f"times must increase"
        )
    columns = {name: source.column(name)[rows] for name in known}
    whole = all(name in source.names for name in COLUMNS[1:])
    ignored = tuple(name for name in source.names if name not in (*COLUMNS, *known))
    return Curves(where.name, time, columns, whole, ignored)


@dataclass(frozen=True, slots=True)
class _Source:
    """Columns of a file by name: ``column`` reads one (rows,), ``place`` says where a row stands."""

    names: tuple[str, ...]
    icons: list[str] | None
    column: Callable[[str], Array]
    place: Callable[[int], str]


def _of_text(path: Path) -> _Source:
    from thermicon.circuit.inputs import read_text, table_fault
    from thermicon.icons.files.table import read_table

    text = read_text(path, "trace or log", MOST_MB)
    table = read_table(text, table_fault(path, LogError), "time_s,display_C,skin_C", MOST_ROWS)
    icons = list(table.texts("icon")) if "icon" in table.header else None

    def column(name: str) -> Array:
        return table.numbers(name, CURE, gaps=Counter(), most=LARGEST)

    return _Source(table.header, icons, column, lambda row: f"{path}:{table.lines[row]}")


def _of_parquet(path: Path) -> _Source:
    """The columns of a Parquet file, whose size when unpacked is looked at first."""
    from thermicon.circuit.inputs import quoted, read_bytes, require_pyarrow

    require_pyarrow(path, LogError)
    data = read_bytes(path, "trace or log", MOST_MB)
    import pandas as pd
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        file = pq.ParquetFile(pa.BufferReader(data))
        groups = [file.metadata.row_group(k).total_byte_size for k in range(file.metadata.num_row_groups)]
        if sum(groups) > MOST_UNPACKED_MB * 1e6 or file.metadata.num_rows > MOST_ROWS:
            raise LogError(
                f"{path}: {file.metadata.num_rows:,} rows, {sum(groups) / 1e6:,.0f} MB unpacked; the limit is "
                f"{MOST_ROWS:,} rows and {MOST_UNPACKED_MB:g} MB: keep every tenth row"
            )
        frame = file.read().to_pandas()
    except (ValueError, OSError, NotImplementedError, KeyError) as problem:
        raise LogError(f"{path}: not a Parquet file that can be read ({problem})") from None

    def column(name: str) -> Array:
        cells = frame[name]
        values: Array = pd.to_numeric(cells, errors="coerce").to_numpy(dtype=float)
        for row in numpy.flatnonzero(~(numpy.abs(values) <= LARGEST)):
            if not pd.isna(cells.iloc[row]):
                said = f"{name} is {quoted(cells.iloc[row])}, not a finite number of at most {LARGEST:g}"
                raise LogError(f"{path}, row {row + 1}: {said}; {CURE}")
        return values

    icons = [str(name) for name in frame["icon"]] if "icon" in frame else None
    return _Source(tuple(map(str, frame.columns)), icons, column, lambda row: f"{path}, row {row + 1}")


def _rows_of(icons: list[str], path: str, icon: str | None) -> NDArray[numpy.intp]:
    from thermicon.icons.near_words import did_you_mean

    from ..messages import usage

    names = list(dict.fromkeys(icons))
    if icon is None and len(names) > 1:
        raise usage(f"{path} has traces of {len(names)} icons; name one of {', '.join(names)}", "--icon")
    if icon is not None and icon not in names:
        raise LogError(f"{path}: no trace of {icon}; {did_you_mean(icon, names)}")
    return numpy.flatnonzero([icon in (None, name) for name in icons])


def _check_columns(names: Sequence[str], known: Sequence[str], path: str) -> None:
    from thermicon.circuit.solver.trace import COLUMNS
    from thermicon.icons.near_words import did_you_mean

    found = ", ".join(names[:8])
    if "time_s" not in names:
        raise LogError(f"{path}: the column time_s (time in s) is missing; found {found}")
    if not known:
        other = next((name for name in names if name not in ("time_s", "icon")), "")
        raise LogError(
            f"{path}: none of its columns is one of a trace, such as display_C or skin_C; found {found}"
            f"{f'; {other}: {did_you_mean(other, COLUMNS[2:])}' if other else ''}"
        )
