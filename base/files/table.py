"""The reader of tables: a line of names above rows of cells.

Commas, semicolons, tabs or spaces separate the cells; where it is not commas, decimal commas are numbers too. What
stands above the names, lines that begin with #, and the line by which spreadsheets name the separator, are passed over.
"""

from __future__ import annotations

import contextlib
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

from ..checks.arguments import InputError
from .column_names import NamedHeader, meant, named, unit_of
from .table_text import table_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Kind = Literal["table", "size", "cell", "empty", "binary", "time", "unit"]
Fault = Callable[[Kind, int | None, str, str], InputError]
"""Makes the error for a fault: its kind, the line in the file, what is wrong, and the cure."""

MARKS = ("\t", ",", ";", "|", " ")
ASIDE = ("#", "sep=")
NOTHINGS = ("n/a", "na", "#n/a", "nan", "null", "none", "-", "--", "---", "ol", "ovl", "overload")
OVERLOADS = (9.9e37, 9.91e37)
"""What loggers write for a missing number, and instruments by SCPI for one that is out of range or none."""
LARGEST = 1e38
"""Beyond what SCPI writes; sums of squares stay finite."""
NUMBER = re.compile(r"[-+−]?[-\d.,:/]*\d([eE][-+]?\d+)?")
"""A number or a time of day, as no name of a column is."""
QUOTED_DECIMAL = re.compile(r'"[-−]?(\d+,\d{1,2}|0,\d+|\d+,\d{4,})"')
"""Shows that decimals have commas, where commas also separate the cells; 1,234 may be a thousand."""
WITH_UNIT = re.compile(r"([-+−]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?)\s*([^\d\s].*)")
GROUPED = re.compile(r"[-+−]?\d{1,3}(?:([., ' ])\d{3})+(?:[.,]\d+)?")
FEW, LONGEST_CELL, MOST_ABOVE, LONGEST_LINE = 8, 60, 200, 10_000
"""Columns that a message lists, characters of a cell that it quotes; lines, and of each how much, to find names."""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of cells below a ``header`` of names; ``lines`` are where they stand in the file, ``line`` the header.

    ``names`` says what was renamed, and the units that names in the file say; ``notes`` say what was passed over,
    ``lost`` by our names what the file does not call as was said.
    """

    header: tuple[str, ...]
    line: int
    rows: tuple[list[str], ...]
    lines: tuple[int, ...]
    fault: Fault
    mark: str
    names: NamedHeader
    notes: tuple[str, ...]
    lost: Mapping[str, str]

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
        return (row[at] if at < len(row) else "" for row in self.rows)

    def records(self, names: Sequence[str]) -> Iterator[tuple[int, dict[str, str]]]:
        """Line number of each row, with its cells by the names of the columns present."""
        there = [name for name in names if name in self.header]
        for line, *cells in zip(self.lines, *map(self.texts, there), strict=True):
            yield line, dict(zip(there, cells, strict=True))

    def numbers(self, name: str, cure: str, gaps: Counter[str] | None = None) -> NDArray[np.float64]:
        """A column (rows,) of finite numbers, or faults with a ``cure``; ``gaps`` counts what is NaN in its place."""
        import numpy as np

        with suppress(ValueError):  # a column of plain numbers, as most are, is read at once
            texts = list(self.texts(name))
            plain = np.array(list(map(float, texts)))
            if (np.abs(plain) <= OVERLOADS[-1] / 2).all() and "_" not in "".join(texts):
                return plain
        values = np.empty(len(self.rows))
        for row, cell in enumerate(self.texts(name)):
            value = as_number(cell, self.mark) if cell else math.nan
            if gaps is not None and (not cell or cell.lower() in NOTHINGS or abs(value) in OVERLOADS):
                values[row] = math.nan
                gaps[cell] += 1
            elif abs(value) <= LARGEST:
                values[row] = value
            else:
                limit = f" of at most {LARGEST:g}" if abs(value) < math.inf else ""
                quoted = repr(cell if len(cell) <= LONGEST_CELL else f"{cell[:LONGEST_CELL]}…")
                what = f"{name} is {quoted}, not a finite number{limit}" if cell else f"{name} is empty"
                raise self.fault("cell", self.lines[row], what, self._cure(name, row, cell) or cure)
        return values

    def _cure(self, name: str, row: int, cell: str) -> str:
        if GROUPED.fullmatch(cell):
            return "write numbers without marks between thousands"
        if (found := WITH_UNIT.fullmatch(cell)) and unit_of(found[2]):
            theirs = self.names.renamed.get(name, (name,))[0]
            return f"write {found[1]}; units belong in the names of the columns, as in {theirs} [{found[2]}]"
        alone = len(self.header) > 1 and set(self.rows[row]) <= {"", cell}
        return "remove this line, which is not a row of the table" if cell and alone else ""


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
    line, header = next(lines, (0, [""]))
    header = [cell.strip('"') for cell in header]
    if not any(header):
        raise fault("table", None, "no line names the columns", f"the first line is such as: {example}")
    if all(not cell or NUMBER.fullmatch(cell) or cell.lower() in NOTHINGS for cell in header):
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
        bare = row[: len(header)]
        if row[0].startswith(ASIDE) or bare == header or all(set(cell) <= {"-", "=", "*"} for cell in bare):
            continue  # names that stand again, and rules between pages
        said = [] if rows else [cell for cell in bare if cell.strip(" ()[]-")]  # a row of units, but for a word
        if sum(unit_of(cell) is None for cell in said) < 0.5 * len(said) and not re.search(r"\d", "".join(said)):
            full = {name: f"{name} [{cell.strip(' ()[]')}]" for name, cell in zip(header, bare, strict=False)
                    if unit_of(cell)}  # fmt: skip
            header = [full.get(name, name) for name in header]
            theirs = {name: full.get(cell, cell) for name, cell in theirs.items()}
            continue
        if not rows and len(row) == len(header) + 1 and '\n"1"' in text:
            header.insert(0, "")  # R names no column of row numbers
        if any(row[len(header) :]):
            what = f"{len(row)} cells, where the first line names {len(header)}"
            help = "write decimal points, put names with commas in quotes, or put semicolons between the cells"
            raise fault("table", place, what, help)
        rows.append(row)
        places.append(place)
        if len(rows) > most_rows:
            raise fault("size", None, f"more than {most_rows:,} rows", "split the file, or keep every tenth reading")
    if not header[0] and rows and ":" in rows[0][0]:
        header[0] = "Time"  # PicoLog leaves the name of its clock empty
    firsts = dict[str, int]()
    for at, name in enumerate(header):
        first = firsts.setdefault(name, at)
        if name and rows and first < at and all(row[first : first + 1] == row[at : at + 1] for row in rows):
            header[at] = ""  # SPICE programs and LabVIEW may write their times beside each column
    ours = named(header, names, theirs)
    for name, (own, unit) in ours.renamed.items():
        if unit.ours not in ("", name.rpartition("_")[2]) and "_" in name:
            raise fault("unit", line, f"{own!r} is in another unit than {name}", "name another column")
    notes = [f"lines above the names were passed over: {skipped}"] if skipped else []
    read = [f"{name} from {own!r}" for name, (own, unit) in ours.renamed.items()
            if theirs.get(name) != own or unit[1:] != (1, 0)]  # fmt: skip
    notes += [f"read {', '.join(read[:FEW])}{', …' if len(read) > FEW else ''}"] if read else []
    absent = {name: f"{own!r}, to be {name}" for name, own in theirs.items() if own not in header}
    missed = f"no column is called {', and none '.join(absent.values())}; found {', '.join(ours.header[:FEW])}"
    notes += [missed] if absent else []
    decimal = "" if mark == "," and QUOTED_DECIMAL.search(text) else mark
    lost = dict.fromkeys(absent, missed)
    return Table(ours.header, line, tuple(rows), tuple(places), fault, decimal, ours, tuple(notes), lost)


def _line_of_names(text: str, names: Sequence[str], theirs: Mapping[str, str]) -> tuple[int, str, int]:
    """The number of lines above the names, the separator of cells, and how many of those lines have text."""
    lines = [line[:LONGEST_LINE] for line in itertools.islice(io.StringIO(text), MOST_ABOVE)]
    head = max((at for at, line in enumerate(lines) if line.startswith("***End_of_Header***")), default=-1)
    first = next((at for at, line in enumerate(lines) if line.strip() and not line.startswith(ASIDE)), len(lines))
    best, place, mark = 0.0, first, ""
    for each in MARKS:
        rows = list[tuple[int, list[str]]]()
        with contextlib.suppress(csv.Error):
            rows.extend(_cells((line.lstrip("# ") for line in lines), each))
        for (at, cells), (_, below) in itertools.pairwise([*rows, (0, [])]):
            known = {cell for cell in cells if cell in names or cell in theirs.values()}
            words = [cell for cell in cells if len(cell) <= LONGEST_CELL]
            score = float(len(known.union(found[0] for cell in words if (found := meant(cell, names)))))
            numbers = any(map(NUMBER.fullmatch, words))
            fits = not numbers and len(below) - len(cells) in (0, 1) and len(below) > 1
            score = score + 0.5 * fits - 0.9 * numbers if score and (fits or each != " ") else 0.0
            if score > best and at > head:
                best, place, mark = score, at, each
    if not best:
        line = "".join(lines[first : first + 1])
        mark = max(MARKS[:-1], key=line.count) if any(one in line for one in MARKS[:-1]) else " "
    return place, mark, sum(bool(line.strip()) and not line.startswith(ASIDE) for line in lines[:place])


def _cells(lines: Iterator[str], mark: str) -> Iterator[tuple[int, list[str]]]:
    """Rows that are not empty, each with the number of lines above it."""
    if mark == " ":
        lines, mark = ("\t".join(line.split()) for line in lines), "\t"
    reader, above = csv.reader(lines, delimiter=mark), 0
    for row in reader:
        cells = [" ".join(cell.split()) if "\n" in cell else cell.strip() for cell in row]
        if any(cells):
            yield above, cells
        above = reader.line_num


def _rows(text: str, above: int, mark: str, fault: Fault) -> Iterator[tuple[int, list[str]]]:
    """Rows that are not empty, each with its line in the file, from the line of names on."""
    place, stream = above + 1, itertools.islice(io.StringIO(text), above, None)
    first = next(stream, "")
    lines = itertools.chain([first.lstrip("# ") if first.startswith("#") else first], stream)
    try:
        for at, cells in _cells(lines, mark):
            place = above + at + 1
            yield place, cells
    except csv.Error as problem:
        raise fault("table", place + 1, f"this row cannot be read ({problem})", "save it as CSV") from None
