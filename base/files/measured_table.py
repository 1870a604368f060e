"""A table of measured columns over time in SI units."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .clock import order_fault, seconds_of, spread
from .column_names import Unit, parted
from .table import Table
from .units import POSSIBLE_C, SENSED_C, errors, like_units_of_time, unit_fault

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..checks.arguments import InputError

    Array = NDArray[np.float64]

TIME, ROW = "time_s", "remove the row"
CLOCK_CURE = "write times as seconds from any start, or as 2026-03-02 23:59:58.050"


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredTable:
    """Times (rows,) in s that do not fall, columns (rows,) with NaN in gaps, the line of each row, and notes."""

    time_s: Array
    columns: dict[str, Array]
    lines: tuple[int, ...]
    notes: tuple[str, ...]


def missing(table: Table, name: str, what: str) -> InputError:
    """The fault of a column that a table does not have, or may have twice, and how to say which it is."""
    name, what = (name, what) if TIME in table.header else (TIME, "time in s")
    name, several = next(iter(table.names.doubtful.items()), (name, ()))
    free = set(table.header) - {*table.names.renamed, TIME, "icon", ""}
    units = {cell: parted(cell)[1] for cell in table.header if cell in free}
    close = [cell for cell, unit in units.items() if unit and unit.ours == name.rpartition("_")[2]]
    close = close or [cell for cell, unit in units.items() if unit is None]
    theirs = several[0] if several else close[0] if len(close) == 1 else "THEIRS"
    said = f"{' and '.join(several)} may be {name}" if several else ""
    said = said or f"the column {name} ({what}) is missing; found {table.found}"
    return table.fault("table", table.line, said, "say which it is").to(columns={name: theirs})


def measured(
    table: Table, names: Sequence[str], cure: str, *, gaps: bool = True, steps: bool = False, ours: bool = False
) -> MeasuredTable:  # fmt: skip
    """Return times and the columns called ``names``, in SI units; raises faults of the table with their cures.

    Without ``gaps`` an empty cell is a fault, with this ``cure``, and rows with an error value are left out; with
    ``steps`` two readings at one time are a step. What is ``ours``, a simulated trace, may have any value.
    """
    import numpy as np

    if TIME not in table.header:
        raise missing(table, TIME, "time in s")
    time, lines, notes = _times(table), np.array(table.lines), list(table.notes)
    counts = {name: Counter[str]() for name in names}
    columns = {name: table.numbers(name, cure, counts[name] if gaps else None) for name in names}
    for name, (_, unit) in table.names.renamed.items():
        if name in columns:
            columns[name] = columns[name] * unit.factor + unit.plus
    if (few := len(time)) < 2:
        what = f"{few or 'no'} row{'s' * (not few)} below the names of the columns"
        raise table.fault("table", None, what, "at least two are needed, a start and an end")
    rows = np.nan_to_num(np.stack([time, *columns.values()]), nan=-1e300)
    kept = np.append(True, (np.diff(rows) != 0).any(axis=0))
    if 0 < (twice := int((~kept).sum())) == int((np.diff(time) == 0).sum()) <= 0.1 * len(time):
        notes.append(f"rows that stand twice count once: {twice}")
    else:
        kept[:] = True
        first = np.unique(rows, axis=1, return_index=True)[1] if (np.diff(time) < 0).any() else ()
        if len(first) and (np.diff(time[np.sort(first)]) >= 0).all():
            kept = np.isin(np.arange(len(time)), first)
            notes.append(f"rows that were sent again count once: {len(time) - len(first):,}")
    for name, column in () if ours else columns.items():
        wrong = errors(column, SENSED_C if name.startswith("hot_plate") else POSSIBLE_C) & name.endswith("_C")
        counts[name].update(f"{value:g}" for value in column[wrong])
        kept &= gaps | ~wrong
        columns[name] = np.where(wrong, np.nan, column)
    left = [f"{name} is {cell!r} in {count:,} of {len(time):,} rows"
            for name, cells in counts.items() for cell, count in cells.most_common(3) if cell]  # fmt: skip
    notes += [f"{', '.join(left)}, which are {'taken as gaps' if gaps else 'left out'}"] if left else []
    time, lines, columns = time[kept], lines[kept], {name: column[kept] for name, column in columns.items()}
    if fall := order_fault(time):
        row, why = fall
        what = f"time_s {time[row]:.9g} s does not come after {time[row - 1]:.9g} s; times must increase"
        raise table.fault("time", int(lines[row]), what, why)
    if (found := spread(time, steps)) is None:
        what = f"the clock does not tell {len(time):,} rows apart"
        raise table.fault("time", None, what, "write times with more decimals")
    time, count = found
    if count:
        notes.append(f"the clock has too few digits: {count:,} rows at the time of the row before were spread")
    for name, column in () if ours else columns.items():
        if (fault := unit_fault(name, column)) is not None:
            raise table.fault("unit", None, *fault)
    if not ours and (like := like_units_of_time(time)):
        what = f"time_s goes in steps of {np.median(np.diff(time)):g} over {time[-1] - time[0]:g}, read as s"
        notes.append(f"{what}: these look like {like[0]}; if they are, {like[1]} to have s")
    return MeasuredTable(time, columns, tuple(lines.tolist()), tuple(notes))


def _times(table: Table) -> Array:
    cells, unit = list(table.texts(TIME)), table.names.renamed.get(TIME, ("", Unit("s")))[1]
    if not any(cells) and cells:
        raise table.fault("time", None, "time_s is empty in every row", "add the times, from the interval between rows")
    odd = [row for row, cell in enumerate(cells) if ":" not in cell]
    if 2 * len(odd) >= len(cells):
        return table.numbers(TIME, CLOCK_CURE if len(odd) < len(cells) else ROW) * unit.factor
    if odd or (times := seconds_of(cells)) is None:
        row = [*odd, 0][0]
        what = f"time_s is {cells[row]!r}, not a time" if cells[row] else "time_s is empty"
        raise table.fault("cell", table.lines[row], what, ROW if odd else CLOCK_CURE)
    return times
