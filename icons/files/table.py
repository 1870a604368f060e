"""The one reader of tables: text with a line of names and rows of cells, as numbers or texts by column.

Commas, semicolons or tabs separate the cells; where it is not commas, decimal commas are numbers too. Lines that begin
with #, and the line by which spreadsheets name the separator, are passed over.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Kind = Literal["table", "size", "cell"]
Fault = Callable[[Kind, int | None, str, str], Exception]
"""Makes the error for a fault: its kind, the line in the file, what is wrong, and the cure."""

MARKS = ("\t", ",", ";")
ASIDE = ("#", "sep=")
NOTHINGS = ("n/a", "na", "nan", "null")
"""What loggers write for a missing number."""
NO_NAME = re.compile(r"[-+\d.,;eE\s]*|n/a|nan")
"""A cell that names no column."""
FEW, LONGEST_CELL = 8, 60
"""Columns that a message lists, and characters of a cell that it quotes."""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of cells below a ``header`` of names; ``lines`` are where they stand in the file, ``line`` the header."""

    header: tuple[str, ...]
    line: int
    rows: tuple[list[str], ...]
    lines: tuple[int, ...]
    fault: Fault
    mark: str = ","

    @property
    def found(self) -> str:
        """Names of the first columns, for messages."""
        names = [name[:LONGEST_CELL] for name in self.header[:FEW]]
        return ", ".join(names) + (", …" if len(self.header) > FEW else "")

    def texts(self, name: str) -> Iterator[str]:
        """Cells of a column; raises a fault where two columns have this name."""
        if self.header.count(name) > 1:
            raise self.fault("table", self.line, f"the column {name} appears twice", "rename or remove one of them")
        at = self.header.index(name)
        return (row[at].strip() if at < len(row) else "" for row in self.rows)

    def records(self, names: Sequence[str]) -> Iterator[tuple[int, dict[str, str]]]:
        """Line and cells by name of each row, of those columns that there are."""
        there = [name for name in names if name in self.header]
        for line, *cells in zip(self.lines, *map(self.texts, there), strict=True):
            yield line, dict(zip(there, cells, strict=True))

    def numbers(
        self, name: str, cure: str, *, gaps: Counter[str] | None = None, most: float = math.inf
    ) -> NDArray[np.float64]:
        """Return a column (rows,) of finite numbers of at most ``most``; raises a fault, with the ``cure``, otherwise.

        With ``gaps``, empty cells and what loggers write for a missing number are NaN, and counted there.
        """
        import numpy as np

        values = np.empty(len(self.rows))
        for row, cell in enumerate(self.texts(name)):
            if gaps is not None and (not cell or cell.lower() in NOTHINGS):
                values[row] = math.nan
                gaps[cell] += 1
            elif abs(value := as_number(cell, self.mark)) <= most and math.isfinite(value):
                values[row] = value
            else:
                limit = "" if most == math.inf else f" of at most {most:g}"
                quoted = repr(cell if len(cell) <= LONGEST_CELL else f"{cell[:LONGEST_CELL]}…")
                what = f"{name} is {quoted}, not a finite number{limit}" if cell else f"{name} is empty"
                units = cell and not row and math.isnan(value)
                better = "units belong in the names of the columns; remove this row" if units else cure
                raise self.fault("cell", self.lines[row], what, better)
        return values


def as_number(cell: str, mark: str = ",") -> float:
    """Return the number in a cell, NaN where there is none; a decimal comma counts where ``mark`` is another."""
    plain = cell.replace(",", ".") if mark != "," and cell.count(",") == 1 and "." not in cell else cell
    try:
        return math.nan if "_" in plain else float(plain)
    except ValueError:
        return math.nan


def read_table(text: str, fault: Fault, example: str, most_rows: int) -> Table:
    """Return the table in a text; raises a fault for rows that do not fit the line of names, and for too many.

    ``example`` is such a line, for messages.

    >>> table = read_table("a;b\\n1,5;2\\n", lambda *about: ValueError(about), "a,b", 10)
    >>> table.numbers("a", "").tolist(), list(table.records(["b"]))
    ([1.5], [(2, {'b': '2'})])
    """
    head = next((line for line in io.StringIO(text) if line.strip() and not line.startswith(ASIDE)), "")
    mark = max(MARKS, key=head.count) if any(mark in head for mark in MARKS) else ","
    lines = csv.reader(io.StringIO(text, newline=""), delimiter=mark)
    header, line = list[str](), 0
    rows, places = list[list[str]](), list[int]()
    try:
        for row in lines:
            if not any(cell.strip() for cell in row) or row[0].startswith(ASIDE):
                continue
            if not header:
                header, line = [cell.strip() for cell in row], lines.line_num
                if all(map(NO_NAME.fullmatch, header)):
                    what = "this line holds numbers, not the names of columns"
                    raise fault("table", line, what, f"put {example} above it")
                continue
            if len(row) > len(header) and any(cell.strip() for cell in row[len(header) :]):
                what = f"{len(row)} cells, where the first line names {len(header)}"
                help = "write decimal points, put names with commas in quotes, or put semicolons between the cells"
                raise fault("table", lines.line_num, what, help)
            rows.append(row)
            places.append(lines.line_num)
            if len(rows) > most_rows:
                raise fault("size", None, f"more than {most_rows:,} rows", "keep every tenth row, or cut the file")
    except csv.Error as problem:
        raise fault("table", lines.line_num, f"this row cannot be read ({problem})", "save it as CSV") from None
    if not header:
        raise fault("table", None, "no line names the columns", f"the first line is such as: {example}")
    return Table(tuple(header), line, tuple(rows), tuple(places), fault, mark)
