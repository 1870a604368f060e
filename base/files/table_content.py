"""The content of a table's text: names, rows, and lines that are neither, which are counted and quoted."""

from __future__ import annotations

import csv
import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .column_names import unit_of
from .labelled_lines import labelled_rows
from .layout import (
    COMMENTS,
    LONGEST_CELL,
    LONGEST_FOOT,
    NOTHINGS,
    TableLayout,
    is_number,
    rows_of,
    with_units,
)

if TYPE_CHECKING:
    from .table import Fault

FEW = 8
"""Columns, lines and cells that a message lists."""
WHOLE, POINT = re.compile(r"[-+−]?\d+"), re.compile(r"[-+−]?\d*\.\d+")
DECIMALS = "; where these are decimal commas, write decimal points, or put semicolons between the cells"


@dataclass(slots=True)
class Content:
    """What stands in a text: names, rows and their lines, the line of names, the mark, notes, and the lines above."""

    header: list[str]
    rows: list[list[str]]
    places: list[int]
    line: int
    mark: str
    notes: list[str]
    above: str = ""
    unnamed: str = ""


def labelled(text: str) -> Content | None:
    """The content of a text whose lines name their numbers; None for any other."""
    if not (found := labelled_rows(text)):
        return None
    header, rows, places = found
    others = sum(map(bool, map(str.strip, text.split("\n")))) - len(rows)
    notes = [f"lines that do not name {', '.join(header[:FEW])} were left out: {others}"] if others else []
    return Content(header, rows, places, places[0], ",", notes)


def laid_out(text: str, layout: TableLayout, fault: Fault, example: str, most_rows: int) -> Content:
    """The content of a text by its layout; raises a fault where it has none."""
    if text.lstrip().startswith(("{", "[{", "[\n{")):
        raise fault("binary", None, "this is JSON, not a table", "write its records as CSV")
    if not (layout.names or layout.width):
        raise fault("table", None, "no line names the columns", f"the first line is such as: {example}")
    header, rows, places, left = _read(text, layout, fault, most_rows)
    notes = _left_out(layout, [*left, *((0, cells) for cells in layout.units if not any(map(unit_of, cells)))])
    gap = any(places[0] < place < places[-1] for place, _ in left) if places else False
    above = "" if gap else "\n".join(layout.above)  # a rate says no times where rows are lost
    content = Content(header, rows, places, layout.line, layout.mark, notes, above)
    lacking = layout.width - len(layout.names) if layout.names and header[0] == "1" else 0
    if lacking == 1 and _is_counted(rows):
        content.header = ["", *with_units(layout.names, layout.units)]  # row numbers have no name in printed tables
    elif lacking and layout.mark == "," and rows and _with_decimals(rows, lacking):
        content.header = with_units(layout.names, layout.units)
    elif lacking:
        content.line = 0
        content.unnamed = f"rows have {layout.width} cells, where the line of names has {len(layout.names)}"
        content.unnamed += DECIMALS * (layout.mark == "," and not any("." in cell for row in rows[:1] for cell in row))
    return content


def _read(
    text: str, layout: TableLayout, fault: Fault, most_rows: int
) -> tuple[list[str], list[list[str]], list[int], list[tuple[int, list[str]]]]:
    """Names, rows and their lines, and the lines below the names that are no rows; raises a fault for a misfit."""
    header, rows, places = [cell.strip('"') for cell in layout.names], list[list[str]](), list[int]()
    header = with_units(header, layout.units)
    if layout.width == len(header) + 1 and '\n"1"' in text:
        header.insert(0, "")  # R names no column of row numbers
    if len(header) < layout.width and (layout.key or not header):
        header = [str(at + 1) for at in range(layout.width)]
    left, place = list[tuple[int, list[str]]](), layout.start
    try:
        for place, row, good in rows_of(layout, text):
            if row == layout.names or row in layout.units:
                continue
            if not good:
                left.append((place, row))
            elif any(row[len(header) :]):
                what = f"{len(row)} cells, where the first line names {len(header)}"
                help = "write decimal points, put names with commas in quotes, or put semicolons between the cells"
                raise fault("table", place, what, help)
            else:
                rows.append(row)
                places.append(place)
                if len(rows) > most_rows:
                    break
    except csv.Error as problem:
        raise fault("table", place + 1, f"this row cannot be read ({problem})", "save it as CSV") from None
    foot = layout.key[0] if layout.key else 0
    while len(rows) > 1 and layout.key and len(left) < LONGEST_FOOT and _is_word(rows[-1][foot : foot + 1]):
        left.append((places.pop(), rows.pop()))
    return header, rows, places, left


def _is_word(cells: Sequence[str]) -> bool:
    return bool(cells and cells[0] and cells[0].lower() not in NOTHINGS and not is_number(cells[0]))


def _left_out(layout: TableLayout, left: Sequence[tuple[int, list[str]]]) -> list[str]:
    """Notes on the lines that are no rows: above the names, and among or below the rows."""
    above = sum(bool(line.strip()) and not line.startswith(COMMENTS) for line in layout.above)
    notes = [f"lines above the names were passed over: {above}"] if above else []
    if left:
        quoted = ", ".join(repr(layout.mark.join(row)[:LONGEST_CELL]) for _, row in sorted(left)[:3])
        notes.append(f"lines that are no rows were left out: {len(left)} ({quoted})")
    return notes


def _is_counted(rows: Sequence[list[str]]) -> bool:
    """Whether the first cells number the rows, and those behind them rise as times do."""
    try:
        numbers, behind = [int(row[0]) for row in rows], [float(row[1].replace(",", ".")) for row in rows]
    except (ValueError, IndexError):
        return False
    rising = all(after > before for before, after in itertools.pairwise(behind))
    return len(rows) > 1 and rising and numbers == list(range(numbers[0], numbers[0] + len(rows)))


def _with_decimals(rows: Sequence[list[str]], lacking: int) -> bool:
    """Join whole numbers with the digits behind their decimal commas, where that leaves as many cells as names."""
    pairs = [at for at in range(min(map(len, rows)) - 1)
             if all(WHOLE.fullmatch(row[at]) and row[at + 1].isdecimal() and len(row[at + 1]) == len(rows[0][at + 1])
                    for row in rows)]  # fmt: skip
    if len(pairs) != lacking or any(POINT.fullmatch(cell) for row in rows for cell in row):
        return False
    for row in rows:
        for at in reversed(pairs):
            row[at : at + 2] = [f"{row[at]}.{row[at + 1]}"]
    return True
