"""Lines that name their own numbers, as JSON or as label:value, and cells that hold JSON."""

from __future__ import annotations

import ast
import json
import re
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress

from .column_names import unit_of
from .layout import WITH_UNIT

LABELLED = re.compile(
    r"(?<![\w.:/\[-])([A-Za-z_°][\w.°%]*)\s?[:=]\s?([-+−]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)(?![\d:])"
    r"(?: ?([A-Za-z°µ]+)(?![\w:=]))?"
)
OBJECT = re.compile(r"\{.*\}")
EPOCH = re.compile(r"(?<!\S)(\d{10}(?:\.\d+)?|\d{13}|\d{16}|\d{19})(?!\S)")
BEGIN = re.compile(r"^[\[(]?([\d/T. -]*\d:\d\d:\d\d(?:[.,]\d+)?)")
TRIED, MOST = 40, 0.8
"""Lines that are tried, and the part of them that must name their numbers alike."""


def labelled_rows(text: str) -> tuple[list[str], list[list[str]], list[int]] | None:
    """Names, rows of cells, and their lines, of a text whose lines name their numbers; None for any other.

    >>> labelled_rows("t_ms:0,Plate:32\\nt_ms:100,Plate:31.5\\n")
    (['t_ms', 'Plate'], [['0', '32'], ['100', '31.5']], [1, 2])
    >>> labelled_rows('{"t": 0, "plate": {"C": 32}}\\n')[0]
    ['t', 'plate.C']
    """
    lines = text.split("\n")
    tried = [line for line in lines[: 4 * TRIED] if line.strip()][:TRIED]
    for reader in (_of_object, _of_labels):
        sets = [tuple(read) for line in tried if (read := reader(line))]
        usual = max(set(sets), key=sets.count, default=())
        if sets.count(usual) < max(MOST * len(tried), 1):
            continue
        rows, places, names = list[list[str]](), list[int](), list(usual)
        for place, line in enumerate(lines, 1):
            read = reader(line)
            if read and set(names) <= set(read):
                rows.append([read[name] for name in names])
                places.append(place)
        return names, rows, places
    return None


def _of_object(line: str) -> dict[str, str]:
    found = OBJECT.search(line)
    inner = flat(found[0]) if found and line.count('""') < 2 else {}
    return {**_clock(line[: found.start()]), **inner} if found and inner else {}


def _of_labels(line: str) -> dict[str, str]:
    pairs = LABELLED.findall(line[:1000])
    if not pairs:
        return {}
    rest = LABELLED.sub(" ", line)
    named = {f"{name} [{unit}]" if unit and unit_of(unit) else name: number for name, number, unit in pairs}
    return {**_clock(rest), **named}


def _clock(rest: str) -> dict[str, str]:
    """The clock at the beginning of a line, or seconds since 1970 anywhere in it."""
    if begun := BEGIN.match(rest.strip()):
        return {"time": begun[1]}
    found = EPOCH.search(rest)
    return {"time_s": f"{float(found[1]) / 10 ** (3 * ((len(found[1].split('.')[0]) - 10) // 3)):.6f}"} if found else {}


def flat(cell: str) -> dict[str, str]:
    """The numbers and texts of a JSON object, or of a printed dictionary, by names with points; empty for another."""
    read: object = None
    for load in (json.loads, ast.literal_eval):
        with suppress(ValueError, SyntaxError, RecursionError, MemoryError, TypeError):
            read = load(cell)
            break
    flattened = dict[str, str]()
    pending = list(read.items()) if isinstance(read, Mapping) else []
    while pending:
        name, value = pending.pop(0)
        if isinstance(value, Mapping):
            pending = [*((f"{name}.{inner}", each) for inner, each in value.items()), *pending]
        else:
            flattened[str(name)] = "" if value is None else str(value)
    return flattened


def parted_cells(header: list[str], rows: list[list[str]]) -> list[str]:
    """Take units, labels and JSON out of the cells of columns that have one form in all rows; returns the names."""
    header = list(header)
    for at in range(len(header)):
        column = [row[at] if at < len(row) else "" for row in rows]
        there = [cell for cell in column if cell]
        if not there or there[0][-1:].isdigit() or there[0].lower() in ("nan", "-"):
            continue
        if there[0].startswith("{") and (keys := flat(there[0])):
            objects = [flat(cell) for cell in column]
            header[at] = next(iter(keys))
            for row, each in zip(rows, objects, strict=True):
                row[at : at + 1] = [each.get(header[at], "")]
                row += [""] * (len(header) - len(row)) + [each.get(key, "") for key in list(keys)[1:]]
            header += list(keys)[1:]
            continue
        found = [WITH_UNIT.fullmatch(cell) for cell in there]
        units = Counter(each[2] for each in found if each).most_common(1)
        if not units or units[0][1] < MOST * len(found) or unit_of(unit := units[0][0]) is None:
            continue
        header[at] = f"{header[at]} [{unit}]"
        for row in rows:
            if at < len(row) and (part := WITH_UNIT.fullmatch(row[at])) and part[2] == unit:
                row[at] = part[1]
    return header
