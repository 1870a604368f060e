"""Curves over time from traces or files and their differences at common times."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy

from thermicon.base.checks.arguments import InputError
from thermicon.base.files.inputs import read_bytes, table_fault
from thermicon.base.files.measured_table import measured, missing
from thermicon.base.files.table import read_table
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.near_words import did_you_mean
from thermicon.base.words.number_text import number, span
from thermicon.circuit.solver.trace import COLUMNS

from ..messages import usage

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.circuit import Trace

MOST_MB = 200.0
MOST_ROWS = 10_000_000
CURE = "correct it, or leave the cell empty"
EXTRA = re.compile(r"probe_.+_C")
HELD = ("current_A", "voltage_V")
"""What jumps in a trace: the value of a row counts until the next, so between rows it is not interpolated."""
CLOSE_S = 1e-9


class TraceFileError(InputError):
    """A trace or log that cannot be read or compared; the text says where and what to change."""


@dataclass(frozen=True, slots=True)
class Curves:
    """Columns (rows,) by name over `time_s`; NaN where nothing was recorded. `whole`: with all columns of a trace."""

    name: str
    time_s: Array
    columns: Mapping[str, Array]
    whole: bool
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Aligned:
    """Two things at common times: for every column that both have, their values (A, B), NaN where one has none.

    `said` tells in a sentence at which times they are compared.
    """

    name_a: str
    name_b: str
    time_s: Array
    columns: dict[str, tuple[Array, Array]]
    said: str


def curves_of(trace: Trace, name: str) -> Curves:
    """Return a trace as curves under a name that people know it by."""
    frame = trace.to_frame().drop(columns="icon")
    columns = {str(column): frame[column].to_numpy(dtype=float) for column in frame.columns if column != "time_s"}
    return Curves(name, trace.time_s, columns, whole=True)


def read_curves(path: str, icon: str | None = None, theirs: Mapping[str, str] | None = None) -> Curves:
    """Return the curves in the file of a trace or log; of a file with several icons, those of `icon`.

    `theirs` says what the file calls our columns. Raises TraceFileError that says what is wrong and where.
    """
    where, example = Path(path), "time_s,display_C,skin_C"
    data = read_bytes(where, "trace or log", MOST_MB, TraceFileError)
    table = read_table(data, table_fault(path, TraceFileError), example, MOST_ROWS, COLUMNS[1:], theirs)
    known = [name for name in dict.fromkeys(table.header) if name in COLUMNS[2:] or EXTRA.fullmatch(name)]
    if not known:
        raise missing(table, "display_C", "or another one of a trace, such as skin_C")
    if "icon" in table.header:
        cells = list(table.texts("icon"))
        names = list(dict.fromkeys(cells))
        if icon is None and len(names) > 1:
            raise usage(f"{path} has traces of {len(names)} icons; name one of {', '.join(names)}", "--icon")
        if icon is not None and icon not in names:
            raise TraceFileError(f"{path}: no trace of {icon}; {did_you_mean(icon, names)}")
        rows = [row for row, name in enumerate(cells) if icon in (None, name)]
        kept = tuple(table.rows[row] for row in rows), tuple(table.lines[row] for row in rows)
        table = replace(table, rows=kept[0], lines=kept[1])
    whole = all(name in table.header and name not in table.names.renamed for name in COLUMNS[1:])
    found = measured(table, known, CURE, ours=whole)
    ignored = [name for name in table.header if name and name not in (*COLUMNS, *known)][:8]
    notes = [f"ignored columns that no trace has: {', '.join(ignored)}"] if ignored else []
    return Curves(where.name, found.time_s, found.columns, whole, (*found.notes, *notes))


def align(a: Curves, b: Curves) -> Aligned:
    """Lay two sets of curves on common times: those of a log where the other is a whole trace, else those of B.

    Raises TraceFileError where they share no time or no column.
    """
    lead, other = (a, b) if b.whole and not a.whole else (b, a)
    low, high = max(a.time_s[0], b.time_s[0]), min(a.time_s[-1], b.time_s[-1])
    rows = (lead.time_s >= low - CLOSE_S) & (lead.time_s <= high + CLOSE_S)
    if rows.sum() < 2:
        spans = " and ".join(f"{each.name} {span(each.time_s[0], each.time_s[-1], 's', 2)}" for each in (a, b))
        raise TraceFileError(f"no two rows at a common time: {spans}; shift time_s of one of them")
    time = lead.time_s[rows]
    columns: dict[str, tuple[Array, Array]] = {}
    for name in (name for name in lead.columns if name in other.columns):
        own, foreign = lead.columns[name][rows], _at(other, name, time)
        pair = (own, foreign) if lead is a else (foreign, own)
        if (numpy.isfinite(pair[0]) & numpy.isfinite(pair[1])).any():
            columns[name] = pair
    if not columns:
        has = "; ".join(f"{each.name} has {', '.join(each.columns)}" for each in (a, b))
        raise TraceFileError(f"no column with values in both: {has}")
    said = f"compared at {len(time)} times, {span(time[0], time[-1], 's', 2)}"
    if len(a.time_s) != len(b.time_s) or not numpy.allclose(a.time_s, b.time_s, rtol=0.0, atol=CLOSE_S):
        said = f"compared at the {len(time)} times of {lead.name} in the common span, "
        said += f"{span(time[0], time[-1], 's', 2)}; {other.name} interpolated between its rows"
    return Aligned(a.name, b.name, time, columns, said)


def _at(curves: Curves, name: str, time: Array) -> Array:
    """Values of a column at other times: linear between the rows that have one, held for what jumps in a trace."""
    there = numpy.isfinite(curves.columns[name])
    times, values = curves.time_s[there], curves.columns[name][there]
    if not there.any():
        return numpy.full(len(time), numpy.nan)
    if curves.whole and name in HELD:
        place = numpy.searchsorted(times, time + CLOSE_S, side="right") - 1
        return numpy.where(place >= 0, values[numpy.maximum(place, 0)], numpy.nan)
    inside = (time >= times[0] - CLOSE_S) & (time <= times[-1] + CLOSE_S)
    return numpy.where(inside, numpy.interp(time, times, values), numpy.nan)


def differences(both: Aligned) -> pd.DataFrame:
    """Differences B minus A of every common column: one row each, in `unit`, temperatures in K.

    `largest` is signed, at `largest_s`; `rms` and `mean` are over the common times, each counted once.
    """
    import pandas as pd

    rows = []
    for name, (a, b) in both.columns.items():
        difference = b - a
        there = numpy.isfinite(difference)
        worst = int(numpy.nanargmax(numpy.abs(difference)))
        rows.append(
            {
                "column": name,
                "unit": unit_of_difference(name),
                "largest": float(difference[worst]),
                "largest_s": float(both.time_s[worst]),
                "rms": float(numpy.sqrt(numpy.mean(difference[there] ** 2))),
                "mean": float(numpy.mean(difference[there])),
                "rows": int(there.sum()),
            }
        )
    return pd.DataFrame(rows)


def unit_of_difference(column: str) -> str:
    """Unit of a difference in a column of a trace.

    >>> [unit_of_difference(name) for name in ("skin_C", "current_A", "heat_flow_skin_W_per_m2")]
    ['K', 'A', 'W/m²']
    """
    if column.endswith("_W_per_m2"):
        return "W/m²"
    return {"C": "K", "A": "A", "V": "V"}[column.rpartition("_")[2]]


def quantity(column: str) -> str:
    """Name of a column as people say it."""
    if column.endswith("_W_per_m2"):
        return f"heat flow, {column.removeprefix('heat_flow_').removesuffix('_W_per_m2').replace('_', ' ')}"
    return column.rpartition("_")[0].replace("_", " ")


def with_unit(value: float, unit: str) -> str:
    """Write a difference with the decimals that make sense for its unit.

    >>> with_unit(-0.0426, "K"), with_unit(1289.4, "W/m²")
    ('−0.043 K', '1289 W/m²')
    """
    return f"{number(value, 0 if unit == 'W/m²' else 3)} {unit}"
