"""The reader of tables: columns by our names, whatever a file calls them and whatever else stands in it."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from ..checks.arguments import InputError
from .column_choice import chosen, name_by_words, stated_rate, stated_unit
from .column_names import NamedHeader, Unit, parted, unit_of
from .labelled_lines import parted_cells
from .layout import LONGEST_CELL, NOTHINGS, WITH_UNIT, layout_of
from .table_content import FEW as FEW
from .table_content import labelled, laid_out
from .table_text import table_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Kind = Literal["table", "size", "cell", "empty", "binary", "time", "unit"]
Fault = Callable[[Kind, int | None, str, str], InputError]
"""Makes the error for a fault: its kind, the line in the file, what is wrong, and the cure."""

OVERLOADS = (9.9e37, 9.91e37)
"""What loggers write for a missing number, and instruments by SCPI for one that is out of range or none."""
LARGEST = 1e38
"""Beyond what SCPI writes; sums of squares stay finite."""
QUOTED_DECIMAL = re.compile(r'"[-−]?(\d+,\d{1,2}|0,\d+|\d+,\d{4,})"')
"""Shows that decimals have commas, where commas also separate the cells; 1,234 may be a thousand."""
GROUPED = re.compile(r"[-+−]?\d{1,3}(?:([., ' ])\d{3})+(?:[.,]\d+)?")
SIGNED = re.compile(r"^([-+−]) +(?=\d)")
"""A sign with blanks behind it, as Graphtec's loggers write."""
DATED = re.compile(r"(\d{1,2})[. -]{1,2}([A-Za-zäé]{3})[a-zäé.]*")
MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
GERMAN = str.maketrans({"ä": "a", "i": "y", "k": "c", "z": "c"})
FEW_BAD = 0.05
"""Larger shares of cells that are no numbers are no slips, so that no row is to be removed."""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of cells below a ``header`` of names; ``lines`` are where they stand in the file, ``line`` the header.

    ``names`` says what was renamed, and the units that names in the file say; ``notes`` say what was passed over,
    ``lost`` by our names what the file does not call as was said, ``unnamed`` why the names are not those of the rows.
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
    unnamed: str = ""

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
                raise self.fault("cell", self.lines[row], what, self._cure(name, row, cell, cure, gaps is not None))
        return values

    def _cure(self, name: str, row: int, cell: str, cure: str, gaps: bool) -> str:
        date = DATED.fullmatch(cell)
        if date and (month := date[2].lower().translate(GERMAN)) in MONTHS:
            was = f"{cell} was {date[1]}.{MONTHS.index(month) + 1}"
            return f"a spreadsheet made dates of numbers: {was}; export the numbers again as text"
        known, cells = ("", *NOTHINGS) if gaps else (), zip(self.lines, self.texts(name), strict=True)
        bad = [line for line, each in cells if math.isnan(as_number(each, self.mark)) and each.lower() not in known]
        if GROUPED.fullmatch(cell):
            return "write numbers without marks between thousands"
        theirs, own = self.names.renamed.get(name, (name, Unit("")))
        own = own if own.ours else Unit(name.rpartition("_")[2])
        if (found := WITH_UNIT.fullmatch(cell)) and unit_of(found[2]) == own:
            return f"write {found[1]}; units belong in the names of the columns, as in {theirs} [{found[2]}]"
        alone = len(self.header) > 1 and set(self.rows[row]) <= {"", cell}
        if len(bad) > FEW_BAD * len(self.rows) > 1:
            return f"{len(bad)} of {len(self.rows)} rows have no number there: export it again, or name another column"
        if cell and alone:
            return "remove this line, which is not a row of the table"
        others = [str(line) for line in bad if line != self.lines[row]]
        return f"{cure}; likewise in line {' and '.join(others)}" if others else cure


def as_number(cell: str, mark: str = ",") -> float:
    """Return the number in a cell, NaN where there is none; a decimal comma counts where ``mark`` is another."""
    cell = SIGNED.sub(r"\1", cell.replace("'", "").replace("’", ""))
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

    ``example`` is such a line, for messages. The names are known by ``names``, by what means the same and by what
    ``theirs`` calls them, or because they stand above the rows; where no line names the columns, their positions do.

    >>> table = read_table(b"a;b\\n1,5;2\\n", lambda *about: ValueError(about), "a,b", 10)
    >>> table.numbers("a", "").tolist(), list(table.records(["b"]))
    ([1.5], [(2, {'b': '2'})])
    """
    theirs, (text, coding) = theirs or {}, table_text(data, fault, example)
    content = labelled(text) or laid_out(text, layout_of(text, names, theirs), fault, example, most_rows)
    rows, places, line, notes = content.rows, content.places, content.line, content.notes
    if len(rows) > most_rows:
        raise fault("size", None, f"more than {most_rows:,} rows", "split the file, or keep every tenth reading")
    header = parted_cells(content.header, rows)
    if "time_s" in names:
        name_by_words(header, rows)
    theirs = {name: _column(cell, header) for name, cell in theirs.items()}
    if not header[0] and rows and ":" in rows[0][0]:
        header[0] = "Time"  # PicoLog leaves the name of its clock empty
    firsts = dict[str, int]()
    for at, name in enumerate(header):
        first = firsts.setdefault(name, at)
        if name and rows and first < at and all(row[first : first + 1] == row[at : at + 1] for row in rows):
            header[at] = ""  # SPICE programs and LabVIEW may write their times beside each column
    notes += [f"the text was read as {coding}"] if coding else []
    rate = stated_rate(content.above) if "time_s" in names else None
    named_columns = [at for at, name in enumerate(header) if name]
    if len(named_columns) == 1 and rows and "time_s" in names:
        at = named_columns[0]
        stated = "" if parted(header[at])[1] else stated_unit(content.above)
        header[at] += f" [{stated}]" if stated else ""
    ours = chosen(header, rows, names, theirs, rate, notes)
    places = places[len(places) - len(rows) :]
    for name, (own, unit) in ours.renamed.items():
        if unit.ours not in ("", name.rpartition("_")[2]) and "_" in name:
            raise fault("unit", line, f"{own!r} is in another unit than {name}", "name another column")
    read = [f"{name} from {own!r}" for name, (own, unit) in ours.renamed.items()
            if theirs.get(name) != own or unit[1:] != (1, 0)]  # fmt: skip
    notes += [f"read {', '.join(read[:FEW])}{', …' if len(read) > FEW else ''}"] if read else []
    absent = {name: f"{own!r}, to be {name}" for name, own in theirs.items() if own not in header}
    missed = f"no column is called {', and none '.join(absent.values())}; found {', '.join(ours.header[:FEW])}"
    notes += [missed] if absent else []
    decimal = "" if content.mark == "," and QUOTED_DECIMAL.search(text) else content.mark
    return Table(
        header=ours.header,
        line=line,
        rows=tuple(rows),
        lines=tuple(places),
        fault=fault,
        mark=decimal,
        names=ours,
        notes=tuple(notes),
        lost=dict.fromkeys(absent, missed),
        unnamed=content.unnamed,
    )


def _column(cell: str, header: Sequence[str]) -> str:
    """The column that a user means by its name, by its name without a unit, or by its position, counted from 1."""
    if cell in header or (cell.isdecimal() and 1 <= int(cell) <= len(header)):
        return cell if cell in header else header[int(cell) - 1] or cell
    bare = [name for name in header if cell.lower() in (name.lower(), name.partition(" [")[0].lower())]
    return bare[0] if len(bare) == 1 else cell
