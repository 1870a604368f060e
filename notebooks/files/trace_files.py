"""Curves over time: out of a trace, or read from the file of a trace or of a measured log."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

    from thermicon.circuit import Trace

    Array = NDArray[numpy.float64]

MOST_MB = 200.0
MOST_UNPACKED_MB, MOST_ROWS = 1000.0, 10_000_000
"""What a Parquet file, which is packed, may hold."""
LARGEST = 1e9
"""Largest size of a number, far more than any sensor gives: sums of squares stay finite."""
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

    frame = _read(Path(path))
    frame.columns = [str(column).strip() for column in frame.columns]
    frame = _one_icon(frame, path, icon)
    known = [str(name) for name in frame.columns if name in COLUMNS[2:] or EXTRA.fullmatch(str(name))]
    _check_columns(frame, known, path)
    if len(frame) < 2:
        raise LogError(f"{path}: {len(frame)} rows; at least two are needed")
    time = _numbers(frame["time_s"], path)
    if not numpy.isfinite(time).all():
        raise LogError(f"{_place(frame, int(numpy.argmin(numpy.isfinite(time))), path)}: time_s is empty")
    if (back := numpy.flatnonzero(numpy.diff(time) <= 0)).size:
        row = int(back[0]) + 1
        raise LogError(
            f"{_place(frame, row, path)}: time_s {time[row]:g} s does not come after {time[row - 1]:g} s; "
            f"times must increase"
        )
    columns = {name: _numbers(frame[name], path) for name in known}
    whole = all(name in frame.columns for name in COLUMNS[1:])
    ignored = tuple(str(name) for name in frame.columns if name not in (*COLUMNS, *known))
    return Curves(Path(path).name, time, columns, whole, ignored)


def _read(path: Path) -> pd.DataFrame:
    import pandas as pd

    from thermicon.circuit.inputs import read_bytes, read_text

    if path.suffix.lower() == ".parquet":
        return _read_parquet(read_bytes(path, "trace or log", MOST_MB), path)
    text = read_text(path, "trace or log", MOST_MB)
    first = text.partition("\n")[0]
    if ";" in first and "," not in first:
        raise LogError(f"{path}:1: columns are separated by semicolons; save it with commas and decimal points")
    try:
        header = [name.strip() for name in next(csv.reader([first]))]
        frame = pd.read_csv(io.StringIO(text), skip_blank_lines=False, dtype=object, skipinitialspace=True)
    except (csv.Error, pd.errors.ParserError, pd.errors.EmptyDataError) as problem:
        raise LogError(f"{path}: not a table of comma-separated values ({problem})") from None
    if doubled := [name for place, name in enumerate(header) if name in header[:place]]:
        raise LogError(f"{path}:1: the column {doubled[0]} appears twice; remove one of them")
    if not isinstance(frame.index, pd.RangeIndex):  # pandas takes cells without a name for the names of the rows
        cells = f"a row has more cells than the {len(header)} columns that the first line names"
        raise LogError(f"{path}: {cells}; write decimal points, not commas, or name all columns")
    return frame.dropna(how="all")


def _read_parquet(data: bytes, path: Path) -> pd.DataFrame:
    """The table of a Parquet file, whose size when unpacked is looked at first."""
    from thermicon.circuit.inputs import require_pyarrow

    require_pyarrow(path, LogError)
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
        frame: pd.DataFrame = file.read().to_pandas()
        return frame
    except (ValueError, OSError, NotImplementedError, KeyError) as problem:
        raise LogError(f"{path}: not a Parquet file that can be read ({problem})") from None


def _one_icon(frame: pd.DataFrame, path: str, icon: str | None) -> pd.DataFrame:
    from thermicon.icons.near_words import did_you_mean

    from ..messages import usage

    names = [str(name) for name in frame["icon"].dropna().unique()] if "icon" in frame else []
    if icon is None:
        if len(names) > 1:
            raise usage(f"{path} has traces of {len(names)} icons; name one of {', '.join(names)}", "--icon")
        return frame
    if not names:
        return frame
    if icon not in names:
        raise LogError(f"{path}: no trace of {icon}; {did_you_mean(icon, names)}")
    return frame[frame["icon"] == icon]


def _check_columns(frame: pd.DataFrame, known: list[str], path: str) -> None:
    from thermicon.circuit.solver.trace import COLUMNS
    from thermicon.icons.near_words import did_you_mean

    found = ", ".join(str(name) for name in frame.columns[:8])
    if "time_s" not in frame:
        raise LogError(f"{path}: the column time_s (time in s) is missing; found {found}")
    if not known:
        other = next((str(name) for name in frame.columns if name not in ("time_s", "icon")), "")
        raise LogError(
            f"{path}: none of its columns is one of a trace, such as display_C or skin_C; found {found}"
            f"{f'; {other}: {did_you_mean(other, COLUMNS[2:])}' if other else ''}"
        )


def _numbers(column: Any, path: str) -> Array:
    import pandas as pd

    from thermicon.circuit.inputs import quoted

    values: Array = pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)
    texts = column.to_numpy(dtype=object)
    for row in numpy.flatnonzero(~(numpy.abs(values) <= LARGEST)):
        text = "" if pd.isna(texts[row]) else str(texts[row]).strip()
        if text:
            said = f"{column.name} is {quoted(text)}, not a finite number of at most {LARGEST:g}"
            raise LogError(f"{_place(column, int(row), path)}: {said}; correct it, or leave the cell empty")
    return values


def _place(rows: Any, row: int, path: str) -> str:
    """Where a row stands: the line of a CSV file, which has a header; the row of another."""
    place = int(rows.index[row])
    return f"{path}:{place + 2}" if Path(path).suffix.lower() == ".csv" else f"{path}, row {place + 1}"
