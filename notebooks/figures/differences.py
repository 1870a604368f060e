"""Two sets of curves laid on common times, and how far apart they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy

from thermicon.icons.number_text import number, span

from ..files.trace_files import Curves, LogError

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

    Array = NDArray[numpy.float64]

HELD = ("current_A", "voltage_V")
"""What jumps in a trace: the value of a row counts until the next, so between rows it is not interpolated."""


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


def align(a: Curves, b: Curves) -> Aligned:
    """Lay two sets of curves on common times: those of a log where the other is a whole trace, else those of B.

    Raises LogError where they share no time or no column.
    """
    lead, other = (a, b) if b.whole and not a.whole else (b, a)
    names = [name for name in lead.columns if name in other.columns]
    low, high = max(a.time_s[0], b.time_s[0]), min(a.time_s[-1], b.time_s[-1])
    rows = (lead.time_s >= low - 1e-9) & (lead.time_s <= high + 1e-9)
    if rows.sum() < 2:
        spans = " and ".join(f"{each.name} {span(each.time_s[0], each.time_s[-1], 's', 2)}" for each in (a, b))
        raise LogError(f"no two rows at a common time: {spans}; shift time_s of one of them")
    time = lead.time_s[rows]
    columns: dict[str, tuple[Array, Array]] = {}
    for name in names:
        own, foreign = lead.columns[name][rows], _at(other, name, time)
        pair = (own, foreign) if lead is a else (foreign, own)
        if (numpy.isfinite(pair[0]) & numpy.isfinite(pair[1])).any():
            columns[name] = pair
    if not columns:
        has = "; ".join(f"{each.name} has {', '.join(each.columns)}" for each in (a, b))
        raise LogError(f"no column with values in both: {has}")
    same = len(a.time_s) == len(b.time_s) and bool(numpy.allclose(a.time_s, b.time_s, rtol=0.0, atol=1e-9))
    said = f"compared at {len(time)} times, {span(time[0], time[-1], 's', 2)}"
    if not same:
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
        place = numpy.searchsorted(times, time + 1e-9, side="right") - 1
        return numpy.where(place >= 0, values[numpy.maximum(place, 0)], numpy.nan)
    slack = 1e-9
    inside = (time >= times[0] - slack) & (time <= times[-1] + slack)
    return numpy.where(inside, numpy.interp(time, times, values), numpy.nan)


def differences(both: Aligned) -> pd.DataFrame:
    """How far B is from A in every common column: a row each, differences in `unit`, temperatures in K.

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
    """Name of a column as people say it.

    >>> quantity("cold_receptor_C"), quantity("heat_flow_skin_W_per_m2"), quantity("probe_t2_C")
    ('cold receptor', 'heat flow, skin', 'probe t2')
    """
    bare = column.removesuffix("_W_per_m2")
    if bare.startswith("heat_flow_"):
        return f"heat flow, {bare.removeprefix('heat_flow_').replace('_', ' ')}"
    return bare.rpartition("_")[0].replace("_", " ") if bare == column else bare.replace("_", " ")


def with_unit(value: float, unit: str) -> str:
    """Write a difference with the decimals that make sense for its unit.

    >>> with_unit(-0.0426, "K"), with_unit(1289.4, "W/m²")
    ('−0.043 K', '1289 W/m²')
    """
    return f"{number(value, 0 if unit == 'W/m²' else 3)} {unit}"
