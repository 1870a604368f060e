"""The one reader of tables: text with a line of names and rows of cells, as numbers or texts by column.

Commas, semicolons, tabs or spaces separate the cells; where it is not commas, decimal commas are numbers too. What
stands above the names, lines that begin with #, and the line by which spreadsheets name the separator, are passed over.
"""

from __future__ import annotations

import csv
import io
import itertools
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from .column_names import Named, meant, named, unit_of
from .table_text import table_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Kind = Literal["table", "size", "cell", "empty", "binary", "coding", "time", "unit"]
Fault = Callable[[Kind, int | None, str, str], Exception]
"""Makes the error for a fault: its kind, the line in the file, what is wrong, and the cure."""

MARKS = ("\t", ",", ";")
ASIDE = ("#", "sep=")
NOTHINGS = ("n/a", "na", "#n/a", "nan", "null", "none", "-", "--", "---", "ol", "ovl", "overload")
OVERLOADS = (9.9e37, 9.91e37)
"""What loggers write for a missing number, and instruments by SCPI for one that is out of range or none."""
NO_NAME = re.compile(r"[-+\d.,;eE\s]*|n/a|nan")
"""A cell that names no column."""
WITH_UNIT = re.compile(r"([-+−]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?)\s*([^\d\s].*)")
GROUPED = re.compile(r"[-+−]?\d{1,3}(?:([., ' ])\d{3})+(?:[.,]\d+)?")
FEW, LONGEST_CELL, MOST_ABOVE, LONGEST_LINE = 8, 60, 200, 100_000
"""Columns that a message lists, characters of a cell that it quotes; lines, and of each how much, to find names."""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of cells below a ``header`` of names; ``lines`` are where they stand in the file, ``line`` the header.

    ``names`` says what was renamed, and the units that names in the file say; ``notes`` say what was passed over.
    """

    header: tuple[str, ...]
    line: int
    rows: tuple[list[str], ...]
    lines: tuple[int, ...]
    fault: Fault
    mark: str
    names: Named
    notes: tuple[str, ...]

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

        with suppress(ValueError):  # a column of plain numbers, as most are, is read at once
            texts = list(self.texts(name))
            plain = np.array(list(map(float, texts)))
            if (np.abs(plain) <= min(most, OVERLOADS[-1] / 2)).all() and "_" not in "".join(texts):
                return plain
        values = np.empty(len(self.rows))
        for row, cell in enumerate(self.texts(name)):
            value = as_number(cell, self.mark) if cell else math.nan
            if gaps is not None and (not cell or cell.lower() in NOTHINGS or abs(value) in OVERLOADS):
                values[row] = math.nan
                gaps[cell] += 1
            elif abs(value) <= most and math.isfinite(value):
                values[row] = value
            else:
                limit = "" if most == math.inf else f" of at most {most:g}"
                quoted = repr(cell if len(cell) <= LONGEST_CELL else f"{cell[:LONGEST_CELL]}…")
                what = f"{name} is {quoted}, not a finite number{limit}" if cell else f"{name} is empty"
                raise self.fault("cell", self.lines[row], what, self._cure(name, row, cell) or cure)
        return values

    def _cure(self, name: str, row: int, cell: str) -> str:
        """What helps against a cell that is no number, by what it holds."""
        if GROUPED.fullmatch(cell):
            return "write numbers without marks between thousands"
        if (found := WITH_UNIT.fullmatch(cell)) and unit_of(found[2]):
            theirs = self.names.renamed.get(name, name)
            return f"write {found[1]}; units belong in the names of the columns, as in {theirs} [{found[2]}]"
        alone = len(self.header) > 1 and {other.strip() for other in self.rows[row]} <= {"", cell}
        return "remove this line, which is no row of the table" if cell and alone else ""


def as_number(cell: str, mark: str = ",") -> float:
    """Return the number in a cell, NaN where there is none; a decimal comma counts where ``mark`` is another."""
    plain = cell.replace(",", ".") if mark != "," and cell.count(",") == 1 and "." not in cell else cell
    try:
        return math.nan if "_" in plain else float(plain.replace("−", "-"))
    except ValueError:
        return math.nan


def read_table(
    data: bytes, fault: Fault, example: str, most_rows: int, names: Sequence[str] = (),
    theirs: Mapping[str, str] | None = None,
) -> Table:  # fmt: skip
    """Return the table in the bytes of a file; raises a fault for rows that do not fit the line of names.

    ``example`` is such a line, for messages. That line is the one that has the most of ``names``, of what means the
    same, and of what ``theirs`` calls them; where none has any, the first line.

    >>> table = read_table(b"a;b\\n1,5;2\\n", lambda *about: ValueError(about), "a,b", 10)
    >>> table.numbers("a", "").tolist(), list(table.records(["b"]))
    ([1.5], [(2, {'b': '2'})])
    """
    theirs, text = theirs or {}, table_text(data, fault, example)
    above, mark, skipped = _line_of_names(text, names, theirs)
    lines = _rows(text, above, mark, fault)
    line, first = next(lines, (0, [""]))
    header = [cell.strip().strip('"') for cell in first]
    if not any(header):
        raise fault("table", None, "no line names the columns", f"the first line is such as: {example}")
    if all(map(NO_NAME.fullmatch, header)):
        put = example if mark == "," or not header[1:] else f"{len(header)} names such as {example.replace(',', mark)}"
        raise fault("table", line, "this line holds numbers, not the names of columns", f"put {put} above it")
    rows, places = list[list[str]](), list[int]()
    for place, row in lines:
        if (
            rows
            and row[0][:1].isdigit() > header[0][:1].isdigit()
            and len(row) <= len(header)
            and len(rows) < most_rows
        ):
            rows.append(row)  # neither names again nor a rule
            places.append(place)
            continue
        bare = [cell.strip() for cell in row[: len(header)]]
        if row[0].startswith(ASIDE) or bare == header or all(set(cell) <= {"-", "=", "*"} for cell in bare):
            continue  # names that stand again, and rules between pages
        said = [] if rows else [cell for cell in bare if cell.strip(" ()[]-")]  # a row of units, but for a word
        if sum(unit_of(cell) is None for cell in said) < 0.5 * len(said) and not re.search(r"\d", "".join(said)):
            header = [f"{name} [{cell.strip(' ()[]')}]" if unit_of(cell) else name
                      for name, cell in itertools.zip_longest(header, bare, fillvalue="")]  # fmt: skip
            continue
        if len(row) > len(header) and any(cell.strip() for cell in row[len(header) :]):
            what = f"{len(row)} cells, where the first line names {len(header)}"
            help = "write decimal points, put names with commas in quotes, or put semicolons between the cells"
            raise fault("table", place, what, help)
        rows.append(row)
        places.append(place)
        if len(rows) > most_rows:
            raise fault("size", None, f"more than {most_rows:,} rows", "keep every tenth row, or cut the file")
    ours = named(header, names, theirs)
    notes = [f"lines above the names were passed over: {skipped}"] if skipped else []
    read = [f"{name} from {own!r}" for name, own in ours.renamed.items()
            if theirs.get(name) != own or ours.units[name].factor != 1 or ours.units[name].plus]  # fmt: skip
    notes += [f"read {', '.join(read[:FEW])}{', …' if len(read) > FEW else ''}"] if read else []
    lost = [f"{own!r}, to be {name}" for name, own in theirs.items() if own not in header]
    notes += [f"no column is called {', and none '.join(lost)}"] if lost else []
    return Table(ours.header, line, tuple(rows), tuple(places), fault, mark, ours, tuple(notes))


def _line_of_names(text: str, names: Sequence[str], theirs: Mapping[str, str]) -> tuple[int, str, int]:
    """How many lines stand above the names, what separates the cells, and how many of those lines say something."""
    lines = [line[:LONGEST_LINE] for line, _ in zip(io.StringIO(text), range(MOST_ABOVE), strict=False)]
    first = next((at for at, line in enumerate(lines) if line.strip() and not line.startswith(ASIDE)), len(lines))
    best, place, mark = 0.0, first, ""
    for at, line in enumerate(lines):
        for each in (*MARKS, " "):
            cells = _cells(line.lstrip("# ") if line.startswith("# ") else line, each)
            known = [cell for cell in cells if cell in names or cell in theirs.values()]
            alike = {found[0] for cell in cells if len(cell) <= LONGEST_CELL and (found := meant(cell, names))}
            score = float(len(alike.union(known)))
            below = next((_cells(row, each) for row in lines[at + 1 :] if row.strip()), [])
            fits = len(cells) == len(below) > 1
            score = score + 0.5 * fits if score and (fits or each != " ") else 0.0
            if score > best:
                best, place, mark = score, at, each
    if not best:
        head = "".join(lines[first : first + 1])
        mark = max(MARKS, key=head.count) if any(one in head for one in MARKS) else " "
    return place, mark, sum(bool(line.strip()) and not line.startswith(ASIDE) for line in lines[:place])


def _cells(line: str, mark: str) -> list[str]:
    return line.split() if mark == " " else [cell.strip() for cell in next(csv.reader([line], delimiter=mark), [])]


def _rows(text: str, above: int, mark: str, fault: Fault) -> Iterator[tuple[int, list[str]]]:
    """Rows that are not empty, each with its line in the file, from the line of names on."""
    stream: Iterator[str] = itertools.islice(io.StringIO(text, newline=""), above, None)
    first = next(stream, "")
    stream = itertools.chain([first.lstrip("# ") if first.startswith("#") else first], stream)
    if mark == " ":
        stream, mark = ("\t".join(line.split()) for line in stream), "\t"
    reader = csv.reader(stream, delimiter=mark)
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                yield above + reader.line_num, row
    except csv.Error as problem:
        what = f"this row cannot be read ({problem})"
        raise fault("table", above + reader.line_num, what, "save it as CSV") from None
