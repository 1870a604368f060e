"""Layout of a table in a text, judged by the agreement of its rows: mark between cells, names, rows, and the rest."""

from __future__ import annotations

import csv
import io
import itertools
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from .column_names import meant, parted, unit_of

MARKS = ("\t", ",", ";", "|", ", ", "  ", " ")
COMMENTS = ("#", "%", "; ", "//", "sep=", '"sep=')
NOTHINGS = ("n/a", "na", "#n/a", "nan", "null", "none", "-", "--", "---", "ol", "ovl", "overload")
NUMBER = re.compile(r"[-+−]?[-\d.,:/'’]*\d([eE][-+]?\d+)?")
"""A number, a date or a time of day, as no name of a column is."""
CLOCK = re.compile(
    r"[\[(]?(?:[\w/.-]+(?:[ ,T] ?|(?<=\d):)){0,4}\d{1,3}:\d\d(?::\d\d)*(?:[.,:]\d+)?(?: ?[AaPp]\.?[Mm]\.?)?"
    r"(?:Z| ?[+-]\d\d:?\d\d)?[\])]?"
)
VALUE = re.compile(
    r"(?:[-+−] *)?(?:\d+(?:[.,]\d*)?|[.,]\d+|\d{1,3}(?:[.,'’ ]\d{3})+(?:[.,]\d+)?)(?:[eE][-+]?\d+)?"
    r"|\d{1,4}([-/.])\d{1,2}\1\d{1,4}"
)
"""A number, or a date."""
WITH_UNIT = re.compile(r"([-+−]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?)\s*([^\d\s(].*)")
RULE = set("-=*+_")
LONGEST_CLOCK = 40
SAMPLE, LONGEST_LINE, LONGEST_CELL, LONGEST_FOOT = 300, 10_000, 60, 20
"""Lines and their characters by which a layout is judged, characters of a name, and lines below the rows."""
Row = tuple[int, list[str]]


@dataclass(slots=True)
class TableLayout:
    """A table in a text: ``names``, the ``line`` where they stand (0: nowhere), the width of its rows, and the mark.

    ``units`` stand in lines of their own, ``key`` are the columns of numbers, ``start`` is the line of the first row.
    """

    mark: str
    names: list[str]
    line: int
    units: list[list[str]]
    start: int
    key: tuple[int, ...]
    width: int
    above: tuple[str, ...]

    @property
    def numbered(self) -> bool:
        """Whether no line names the columns, so that positions do."""
        return not self.line


def is_number(cell: str) -> bool:
    """Whether a cell is a number, a time, or a number with its unit."""
    if VALUE.fullmatch(cell) or is_clock(cell):
        return True
    found = WITH_UNIT.fullmatch(cell)
    return bool(found and unit_of(found[2]))


def is_clock(cell: str) -> bool:
    """Whether a cell is a time of day, with or without its date.

    >>> is_clock("[2026-03-02 23:59:58.100]"), is_clock("0 days 00:00:01"), is_clock("Time: 9:41")
    (True, True, False)
    """
    return ":" in cell and len(cell) <= LONGEST_CLOCK and CLOCK.fullmatch(cell) is not None


def is_told(cells: Sequence[str]) -> bool:
    """Whether a line says something of the table, as comments and LabChart's ``TopValue=`` do, and is no row of it."""
    return cells[0].startswith(COMMENTS) or cells[0].endswith("=")


def is_rule(cells: Sequence[str]) -> bool:
    """Whether cells draw a line between parts of a table."""
    return all(set(cell) <= RULE for cell in cells)


def cells_of(lines: Iterator[str], mark: str) -> Iterator[Row]:
    """Rows that are not empty, each with the number of lines above it."""
    if mark in (" ", "  ", ", "):
        split = re.compile(r", +" if mark == ", " else r"\s+" if mark == " " else r"\s{2,}|\t")
        lines, mark = (split.sub("\t", line.strip()) for line in lines), "\t"
    reader, above = csv.reader(lines, delimiter=mark, skipinitialspace=mark != "\t"), 0
    for row in reader:
        cells = [" ".join(cell.split()) if "\n" in cell else cell.strip() for cell in row]
        if any(cells):
            yield above, cells
        above = reader.line_num


def layout_of(text: str, names: Sequence[str], theirs: Mapping[str, str]) -> TableLayout:
    """Return the layout by which most rows agree; of several, the one whose names are known.

    Without ``time_s`` among the names, rows may be words, so that all lines below the names are rows.

    >>> layout_of("dip 3\\ntime_s;Plate\\n;°C\\n0;32\\n0,1;31\\n", ["time_s"], {}).units
    [['', '°C']]
    """
    lines = [line[:LONGEST_LINE] for line in itertools.islice(io.StringIO(text), SAMPLE)]
    head = max((at for at, line in enumerate(lines) if line.startswith("***End_of_Header***")), default=-1)
    best, chosen = -1.0, TableLayout(",", [], 0, [], 0, (), 0, ())
    for mark in MARKS:
        rows = list[Row]()
        with suppress(csv.Error):
            rows.extend(cells_of(iter(lines), mark))
        score, layout = _judged([row for row in rows if row[0] > head], mark, names, theirs, lines)
        if score > best:
            best, chosen = score, layout
    return chosen


def _judged(
    rows: list[Row], mark: str, names: Sequence[str], theirs: Mapping[str, str], lines: Sequence[str]
) -> tuple[float, TableLayout]:
    """How far rows agree where a mark parts them, and their layout."""
    shares = [_share(cells) for _, cells in rows]
    sizes = Counter[int]()
    for (_, cells), share in zip(rows, shares, strict=True):
        sizes[len(cells)] += share * (1 if share == 1 else 0.999)  # type: ignore[assignment]
    width = max(sizes, key=lambda size: (sizes[size], size), default=0) if any(shares) else 0
    words = {word for word in (*names, *theirs.values()) if not is_number(word)}
    alike = [share > 0 and len(cells) <= width and not _is_stamped(cells) and words.isdisjoint(cells)
             for (_, cells), share in zip(rows, shares, strict=True)]  # fmt: skip
    exact = [good and len(cells) == width for good, (_, cells) in zip(alike, rows, strict=True)]
    told = [at for at, (_, cells) in enumerate(rows) if not (is_told(cells) or is_rule(cells))]
    pairs = itertools.zip_longest(told, told[1:])
    first = next((at for at, after in pairs if exact[at] and (after is None or alike[after])), len(rows))
    while first and shares[first - 1] == 1 and 1 < len(rows[first - 1][1]) < width:  # rows that end early
        first -= 1
    row = rows[first][1] if first < len(rows) else []
    named = [(*_names(cells, width, names, theirs, lines[above : above + 1], row, mark), at)
             for at, (above, cells) in enumerate(rows[:first])]  # fmt: skip
    known = [each for each in named if each[0] >= 0.9]
    last = 1 if "time_s" in names else -1  # right above the rows; where rows are words, the first line
    likely = max(named, key=lambda each: (each[0], last * each[2]), default=None)
    best = max(known, key=lambda each: (each[0], -each[2]), default=likely)
    if best is None or best[0] <= 0:
        best = None
    if width and best is not None and mark == " " and len(best[1]) not in (width, width - 1):
        best = None
    agreed = sum(share for share, good in zip(shares[first:], alike[first:], strict=True) if good)
    score = agreed / max(len(rows) - first, 1) * (1.0 if width > 1 else 0.6)
    if best is not None:
        score += 0.3 * min(best[0], 3.0) + 0.5 * (len(best[1]) == width)
    key = _columns_of_numbers([cells for _, cells in rows[first:]], width)
    at = best[2] if best else -1
    between = [cells for _, cells in rows[at + 1 : first]] if best and width else []
    if "time_s" not in names:
        key, between, first = (), [], at + 1
    start = rows[first][0] if first < len(rows) and (width or best) else rows[at][0] + 1 if best else 0
    above = tuple(lines[: rows[at][0] if best else start])
    line = rows[at][0] + 1 if best else 0
    return score, TableLayout(mark, list(best[1]) if best else [], line, between, start, key, width, above)


def _is_stamped(cells: Sequence[str]) -> bool:
    """Whether cells are words behind a clock, as names are in the log of a terminal."""
    clock = max((at for at, cell in enumerate(cells) if is_clock(cell)), default=len(cells))
    behind = [cell for cell in cells[clock + 1 :] if re.search(r"\w", cell)]
    return bool(behind) and not any(is_number(cell) or cell.startswith("{") for cell in behind)


def _share(cells: Sequence[str]) -> float:
    """The part of the cells that are numbers, of those that hold anything; 0 for a comment."""
    if is_told(cells):
        return 0.0
    there = [cell for cell in cells if cell and cell.lower() not in NOTHINGS]
    return sum(map(is_number, there)) / len(there) if there else 0.0


def _columns_of_numbers(rows: Sequence[Sequence[str]], width: int) -> tuple[int, ...]:
    full = [row for row in rows if len(row) == width]
    return tuple(at for at in range(width) if 2 * sum(is_number(row[at]) for row in full) > len(full))


def _names(
    cells: list[str],
    width: int,
    names: Sequence[str],
    theirs: Mapping[str, str],
    line: Sequence[str],
    row: Sequence[str],
    mark: str,
) -> tuple[float, list[str]]:
    """How well cells name the columns of rows of a width, from 0.9 on by known names, and the cells."""
    plain = [cell.lstrip("#%; ") if not at else cell for at, cell in enumerate(cells)]
    if not plain[0] and cells[0] in ("#", "%", ";") and (len(plain) > width or mark in (" ", "  ")):
        plain = plain[1:]
    again = 0.0
    if width and len(plain) not in (width, width - 1):
        ways = (next(cells_of(iter([line[0].lstrip("#%; ")]), mark), (0, plain))[1] for mark in ("  ", *MARKS) if line)
        other = next((way for way in ways if len(way) == width > 1), None)
        plain, again = ([" ".join(cell.strip(",;").split()) for cell in other], 0.2) if other else (plain, 0.0)
    while width and len(plain) > width and not plain[-1]:
        plain = plain[:-1]
    pairs = list(itertools.zip_longest(plain, row[: len(plain)], fillvalue=""))
    if any(is_clock(cell) and is_clock(below) for cell, below in pairs):
        plain = ["time" if is_clock(cell) else "" if cell == below else cell for cell, below in pairs]
    words = [cell for cell in plain if len(cell) <= LONGEST_CELL]
    known = {cell for cell in plain if cell in names or cell in theirs.values()}
    known.update(found[0] for cell in words if (found := meant(cell, names)))
    numbers = [cell for cell in words if NUMBER.fullmatch(cell)]
    fits = not numbers and (len(plain) in (width, width - 1) and width > 0 if width else len(plain) > 1)
    if known:
        exact = 0.5 if len(plain) == width or not width else 0.4
        return len(known) + exact * fits - 0.9 * bool(numbers) - again, plain
    there = [cell for cell in plain if cell and cell != "time"]
    if not fits or not there or is_rule(there) or not re.search(r"[^\W\d]", "".join(there)) or "\t" in plain[0]:
        return 0.0, plain
    units = sum(unit_of(cell) is not None for cell in there)
    return 0.5 * len(there) / max(len(plain), 1) - 0.4 * units / len(there) - again, plain


def rows_of(layout: TableLayout, text: str) -> Iterator[tuple[int, list[str], bool]]:
    """The lines below the names, each with its number and cells, and whether these are a row of the table."""
    stream = itertools.islice(io.StringIO(text), layout.start, None)
    first, last = (layout.key[0], layout.key[-1]) if layout.key else (0, 0)
    for at, cells in cells_of(stream, layout.mark):
        place = layout.start + at + 1
        if (
            last < len(cells) <= layout.width
            and cells[first][:1].isdigit()
            and cells[last][-1:].isdigit()
            and layout.key
        ):
            yield place, cells, True
        elif not (is_told(cells) or is_rule(cells)):
            there = [cells[key] for key in layout.key if key < len(cells)]
            said = [cell for cell in there if cell and cell.lower() not in NOTHINGS]
            whole = not layout.key or any(map(is_number, said)) or (not said and len(cells) > 1)
            yield place, cells, whole and not (layout.key and len(said) > 1 and _is_stamped(said))


def with_units(names: list[str], units: Sequence[Sequence[str]]) -> list[str]:
    """Names with the units that stand in lines of their own."""
    for row in units:
        there = [cell for cell in row if cell.strip(" ()[]-")]
        some = [cell for cell in there if unit_of(cell) and len(cell.strip(" ()[]")) > 1]
        if some or 2 * sum(unit_of(cell) is not None for cell in there) > len(there):
            names = [f"{name} [{cell.strip(' ()[]')}]" if unit_of(cell) and not parted(name)[1] else name
                     for name, cell in itertools.zip_longest(names, row[: len(names)], fillvalue="")]  # fmt: skip
    return names
