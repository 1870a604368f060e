"""What was measured over time, out of a table: times in s and columns in SI units, checked alike for every command."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .clock import PLAIN_CURE, order_fault, seconds_of, spread
from .table import LONGEST_CELL, Table, as_number
from .units import impossible, like_units_of_time, unit_fault

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

TIME = "time_s"


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """Times (rows,) in s that do not fall, columns (rows,) with NaN in gaps, the line of each row, and notes."""

    time_s: Array
    columns: dict[str, Array]
    lines: tuple[int, ...]
    notes: tuple[str, ...]


def missing(table: Table, name: str, what: str = "") -> Exception:
    """The fault of a column that a table does not have, with what may be it."""
    if name in table.names.doubtful:
        own = table.names.doubtful[name]
        return table.fault("table", table.line, f"{' and '.join(own)} may be {name}", say_which(name, own[0]))
    others = [own for own in table.header if own and own not in (*table.names.renamed, TIME, "icon")]
    close = next((own for own in others if own.lower()[:1] == name[0]), others[0] if others else "THEIRS")
    said = f"the column {name}{f' ({what})' if what else ''} is missing; found {table.found}"
    return table.fault("table", table.line, said, say_which(name, close))


def say_which(name: str, own: str) -> str:
    """How a command line and Python say which column is meant."""
    quoted = f'"{name}={own}"' if set(own) & set(" ()[]/&;*|<>$'°") else f"{name}={own}"
    return f'say which it is: --column {quoted} (in Python columns={{"{name}": "{own}"}})'


def measured(
    table: Table, names: Sequence[str], cure: str, *, gaps: bool = True, steps: bool = False, most: float = math.inf
) -> Measured:
    """Return times and the columns called ``names``, in SI units; raises faults of the table with their cures.

    Units that names in the file say are converted, error values of sensors are left out, stamps of a clock with too few
    digits are spread, and notes say so. Without ``gaps`` a cell that is empty is a fault, and rows with an error value
    are left out; with ``steps`` two readings at one time are a step, otherwise times rise. ``cure`` is for such cells.
    """
    import numpy as np

    time, lines = _times(table), np.array(table.lines)
    counts = {name: Counter[str]() for name in names}
    columns = {name: table.numbers(name, cure, gaps=counts[name] if gaps else None, most=most) for name in names}
    for name, unit in table.names.units.items():
        if name in columns and (unit.factor, unit.plus) != (1.0, 0.0):
            columns[name] = columns[name] * unit.factor + unit.plus
    notes = [*table.notes]
    kept = np.ones(len(time), dtype=bool)
    if len(time) > 1:  # a row that stands twice
        same = [np.diff(time) == 0, *(np.diff(np.nan_to_num(column, nan=-1e300)) == 0 for column in columns.values())]
        twice = np.flatnonzero(np.logical_and.reduce(same)) + 1
        if twice.size <= 0.1 * len(time) and (np.diff(time) == 0).sum() == twice.size:
            kept[twice] = False
            notes += [f"rows that stand twice count once: {twice.size}"] if twice.size else []
    for name in names:
        wrong = impossible(name, columns[name]) & kept
        for value in np.unique(columns[name][wrong]):
            counts[name][f"{value:g}"] += int((columns[name][wrong] == value).sum())
        if gaps:
            columns[name] = np.where(wrong, np.nan, columns[name])
        else:
            kept &= ~wrong
    left = [
        f"{name} is {cell!r} in {count:,} of {len(time):,} rows"
        for name, cells in counts.items()
        for cell, count in cells.most_common(3)
        if cell
    ]
    if left:
        notes.append(f"{', '.join(left)}, which are {'taken as gaps' if gaps else 'left out'}")
    time, lines = time[kept], lines[kept]
    columns = {name: column[kept] for name, column in columns.items()}
    if (found := order_fault(time)) is not None:
        row, why = found
        what = f"time_s {time[row]:.9g} s does not come after {time[row - 1]:.9g} s; times must increase"
        raise table.fault("time", int(lines[row]), what, why)
    time, count = spread(time, list(columns.values()), steps)
    if count:
        notes.append(f"the clock has too few digits: {count:,} rows at the time of the row before were spread")
    for name in names:
        if (fault := unit_fault(name, columns[name])) is not None:
            raise table.fault("unit", None, *fault)
    if like := like_units_of_time(time):
        step, length = np.median(np.diff(time)), time[-1] - time[0]
        what = f"time_s goes in steps of {step:g} over {length:g}: these look like {like[0]}"
        notes.append(f"{what}; if they are, {like[1]} to have s")
    return Measured(time, columns, tuple(lines.tolist()), tuple(notes))


def _times(table: Table) -> Array:
    """The column of times, as numbers, or as times of day with or without dates."""
    import numpy as np

    cells = list(table.texts(TIME))
    unit = table.names.units.get(TIME)
    first = next(filter(None, cells), "")
    if not math.isnan(as_number(first, table.mark)) or ":" not in first:
        return table.numbers(TIME, "remove the row") * (unit.factor if unit else 1.0)
    times, wrong = seconds_of(cells)
    if wrong is not None:
        cell = cells[wrong][:LONGEST_CELL]
        what = f"{TIME} is {cell!r}, not a time" if cell else f"{TIME} is empty"
        raise table.fault("cell", table.lines[wrong], what, PLAIN_CURE if cell else "remove the row")
    return np.array(times)
