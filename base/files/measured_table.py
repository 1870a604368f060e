"""A table of measured columns over time in SI units."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..words.number_text import count_of
from .clock import DAY_S, HOUR_S, STARTED_AGAIN, order_fault, seconds_of, spread
from .column_choice import is_setting
from .column_names import Unit, parted
from .layout import is_number
from .table import FEW, Table, as_number
from .table_content import DECIMALS
from .units import (
    ON_SKIN_C,
    POSSIBLE_C,
    SENSED_C,
    USUAL_A,
    errors,
    is_days,
    like_units_of_time,
    too_fast,
    unit_fault,
)  # fmt: skip

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..checks.arguments import InputError

    Array = NDArray[np.float64]

TIME, ROW = "time_s", "remove the row"
ON_DISPLAY = ("temperature_C", "display_C", "skin_C")
MOST_ALIKE = 0.95
"""The part of a column's cells that must be such as one of ours has, to be proposed."""
UNPADDED = re.compile(r"\d+[.,]\d{1,3}")
"""Seconds, a point, and the milliseconds as a whole number, as sketches print them."""
COUNTER = re.compile(r"(?i)^(\d+|#|n[or]?\.?)$|frame|index|seq|sample|record|scan|row|step|entry|count|point")
"""Names of columns that may number the rows."""
CLOCK_CURE = "write times as seconds from any start, or as 2026-03-02 23:59:58.050"


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredTable:
    """Times (rows,) in s that do not fall, columns (rows,) with NaN in gaps, the line of each row, and notes.

    What is ``clocked`` has its times from a clock, whose unit is known.
    """

    time_s: Array
    columns: dict[str, Array]
    lines: tuple[int, ...]
    notes: tuple[str, ...]
    clocked: bool


def missing(table: Table, name: str, what: str) -> InputError:
    """The fault of columns that a table does not have, or may have twice, and how to say which they are."""
    needed = [] if name in (TIME, *table.header) else [name]
    needed = needed if TIME in table.header else [TIME, *needed]
    theirs = {each: candidates(table, each) for each in needed}
    first = needed[0]
    said = f"the column {first} ({what if first == name else 'time in s'}) is missing; found {table.found}"
    if not table.line and table.rows:
        row = ", ".join(table.rows[0][:FEW])
        said = f"no line names the {count_of(len(table.header), 'column')}; the first row is {row}"
        said = f"{table.unnamed}; the first row is {row}" if table.unnamed else said
    several = [(each, cells) for each, cells in theirs.items() if len(cells) > 1]
    for each, cells in several:
        said += f"; {' and '.join(cells[:FEW])} may be {each}"
    known = {each: cells[0] for each, cells in theirs.items() if cells and theirs[first]}
    if DECIMALS in table.unnamed:
        return table.fault("table", None, said, "whole numbers would be read without their decimals")
    free = {parted(cell)[1] for cell in {*table.header} - {*table.names.renamed, TIME, "icon", ""}}
    if not known and not any(unit is None or unit.ours == first.rpartition("_")[2] for unit in free):
        cure = "no column is left that may be it: give a table that has it"
        return table.fault("table", table.line or None, said, cure)
    return table.fault("table", table.line or None, said, "say which it is").to(columns=known or {first: "THEIRS"})


def candidates(table: Table, name: str) -> list[str]:
    """Columns that may be one of ours: those that may mean it, in its unit, or with numbers such as it has.

    Of the last, the one that varies most comes first, as what is driven does.
    """
    import numpy as np

    if name in table.names.doubtful:
        return list(table.names.doubtful[name])
    free = set(table.header) - {*table.names.renamed, TIME, "icon", ""}
    units = {cell: parted(cell)[1] for cell in table.header if cell in free and not is_setting(cell)}
    alike = [cell for cell, unit in units.items() if unit and unit.ours == name.rpartition("_")[2]]
    bare = [cell for cell, unit in units.items() if unit is None]
    if alike or not table.rows:
        return alike or bare[: len(bare) == 1]
    likely = [cell for cell in bare if table.header.count(cell) == 1 and _may_be(name, table, cell)]
    return likely[:1] if name == TIME else sorted(likely, key=lambda cell: -float(np.nanstd(_sampled(table, cell))))


def _sampled(table: Table, cell: str) -> Array:
    """Numbers of a column (rows,) from up to 400 rows all over the table, NaN where there is none."""
    import numpy as np

    texts = list(table.texts(cell))[:: len(table.rows) // 400 + 1]
    return np.array([as_number(text, table.mark) for text in texts])


def _may_be(name: str, table: Table, cell: str) -> bool:
    """Whether some cells of a column rise as times do, or vary as temperatures of a display do."""
    import numpy as np

    values = _sampled(table, cell)
    sound = values[np.isfinite(values)]
    if len(sound) < MOST_ALIKE * len(values) or len(sound) < 2:
        return False
    rising = bool((np.diff(sound) > 0).mean() >= MOST_ALIKE)
    counted = COUNTER.search(cell) and bool((np.diff(sound) == len(table.rows) // 400 + 1).all())
    if name == TIME or rising or not np.ptp(sound):
        return name == TIME and rising and not counted  # numbers of rows are no times
    low, high = ON_SKIN_C if name.endswith("_C") else USUAL_A
    sound = sound - 273.15 * (name.endswith("_C") and np.median(sound) > 273.15)
    return bool(((sound >= low) & (sound <= high)).mean() >= MOST_ALIKE)


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
    lines, notes = np.array(table.lines), list(table.notes)
    time, clocked = _times(table, notes)
    counts = {name: Counter[str]() for name in names}
    columns = {name: table.numbers(name, cure, counts[name] if gaps else None) for name in names}
    for name, (_, unit) in table.names.renamed.items():
        if name in columns:
            columns[name] = columns[name] * unit.factor + unit.plus
    if sources := _interleaved(table, columns):
        what = f"rows of {' and '.join(map(repr, sources[:FEW]))} follow one another in one column"
        raise table.fault("table", None, what, "keep the rows of one of them, or give each a column of its own")
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
    stated = table.names.renamed.get(TIME, ("", Unit("s")))[1].factor
    for name, column in () if ours else columns.items():
        if (fault := unit_fault(name, column)) is not None:
            raise table.fault("unit", None, *fault)
        if not clocked and name in ON_DISPLAY and (fast := too_fast(name, time, column, stated)):
            if fast[0]:
                raise table.fault("unit", None, *fast[1:])
            notes.append("; ".join(fast[1:]))
    if not ours and not clocked and (like := like_units_of_time(time)):
        what = f"time_s goes in steps of {np.median(np.diff(time)):g} over {time[-1] - time[0]:g}, read as s"
        notes.append(f"{what}: these look like {like[0]}; if they are, {like[1]} to have s")
    return MeasuredTable(time, columns, tuple(lines.tolist()), tuple(notes), clocked)


def _interleaved(table: Table, columns: Mapping[str, Array]) -> list[str]:
    """Words beside the rows of several sources, each of which varies less by itself than they do together."""
    import numpy as np

    for name in table.header:
        if name in (*columns, TIME, "") or table.header.count(name) > 1:
            continue
        words = np.array(list(table.texts(name)))
        sources, which = np.unique(words, return_inverse=True)
        mixed = 2 <= len(sources) <= min(FEW, len(words) // 4) and (words[1:] != words[:-1]).mean() > 0.3
        if mixed and not any(map(is_number, sources)):
            own = [np.flatnonzero(which == k) for k in range(len(sources))]
            for values in columns.values():
                apart = sum(float(np.nansum(np.abs(np.diff(values[rows])))) for rows in own)
                if apart < 0.5 * float(np.nansum(np.abs(np.diff(values)))):
                    return [str(source) for source in sources]
    return []


def recordings(table: Table) -> list[Table]:
    """A table cut where its clock starts again; whole where it does not, or where rows are only sent again."""
    import numpy as np

    if TIME not in table.header:
        return [table]
    time, _ = _times(table, [])
    fall = order_fault(time)
    if not fall or fall[1] != STARTED_AGAIN or len(set(map(tuple, table.rows))) < len(table.rows):
        return [table]
    ends = [0, *(np.flatnonzero(np.diff(time) < 0) + 1).tolist(), len(time)]
    return [replace(table, rows=table.rows[begin:end], lines=table.lines[begin:end])
            for begin, end in itertools.pairwise(ends)]  # fmt: skip


def _times(table: Table, notes: list[str]) -> tuple[Array, bool]:
    """Times (rows,) in s, and whether a clock tells them; what was made of them goes to the notes."""
    import numpy as np

    cells, unit = list(table.texts(TIME)), table.names.renamed.get(TIME, ("", Unit("s")))[1]
    if not any(cells) and cells:
        raise table.fault("time", None, "time_s is empty in every row", "add the times, from the interval between rows")
    odd = [row for row, cell in enumerate(cells) if ":" not in cell]
    if 2 * len(odd) >= len(cells):
        time = table.numbers(TIME, CLOCK_CURE if len(odd) < len(cells) else ROW) * unit.factor
        if is_days(time):
            notes.append(f"time_s begins at {time[0]:.9g}: read as days, as spreadsheets count")
            return np.round((time - time[0]) * DAY_S, 4), True
        if order_fault(time) and all(map(UNPADDED.fullmatch, cells)):
            parts = np.array([re.split("[.,]", cell) for cell in cells], dtype=np.float64)
            padded = parts @ [1.0, 1e-3] * unit.factor
            if (np.diff(padded) > 0).all():
                notes.append(f"time_s {cells[1]} is read as {padded[1]:g}: its milliseconds have no leading zeros")
                return padded, False
        return time, False
    if odd or (times := seconds_of(cells)) is None:
        row = [*odd, 0][0]
        what = f"time_s is {cells[row]!r}, not a time" if cells[row] else "time_s is empty"
        raise table.fault("cell", table.lines[row], what, ROW if odd else CLOCK_CURE)
    falls = np.flatnonzero(np.diff(times) < 0)
    if falls.size == 1 and abs(times[falls[0] + 1] - times[falls[0]] + HOUR_S) < 0.1 * HOUR_S:
        notes.append("the clock goes back by an hour, as at the end of summer time: read on")
        times = times + HOUR_S * (np.arange(len(times)) > falls[0])
    return times, True
