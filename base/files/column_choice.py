"""Choice of a table's columns by what they hold where their names do not say it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from .column_names import NamedHeader, named, parted, unit_of
from .layout import NOTHINGS, NUMBER, VALUE, is_clock

TIME = "time_s"
READINGS = ("temperature_C", "display_C", "skin_C")
SETTING = re.compile(
    r"(?i)(?<![^\W_])(set|set[- _]?(point|temp\w*|t)|sp|soll\w*|target|command\w*|demand|consigne)(?![^\W_])"
)
"""Words of what is asked of a controller, which is no reading."""
BARE_MS = re.compile(r"(?i)ms(?:ec)?\b(?! *\w)")
PROBE = re.compile("probe_.+_C")
ELSEWHERE = re.compile(
    r"(?i)(?<![^\W_])(ambient|room|air|cold[- ]?junction|cjc|raum\w*|umgebung\w*|board|chip)(?![^\W_])"
)
"""Words of temperatures that no display or skin has."""
RATE = re.compile(
    r"(?i)(?:sampl\w*[ _]?(?:rate|interval|period|freq\w*)|interval|increment)[\W_]{0,9}"
    r"([\d.]+)\s?(k?hz|[mµu]?s(?:ec)?)\b"
    r"|([\d.]+)\s?(m?s(?:ec)?)/sample|\bdelta_x\t([\d.e+-]+)"
)


def is_setting(name: str) -> bool:
    """Whether a column is what a controller was told, and not a reading.

    >>> is_setting("1010 Target Object Temperature [°C]"), is_setting("Offset (°C)")
    (True, False)
    """
    return SETTING.search(name) is not None


def is_reading(name: str, unit: str, header: Sequence[str]) -> bool:
    """Whether a column says a unit that ends our names, and may be of a display or skin.

    >>> is_reading("Plate (°C)", "C", ()), is_reading("Room (°C)", "C", ()), is_reading("Ch A", "A", ("Ch B",))
    (True, False, False)
    """
    own = parted(name)[1] or (unit_of(name) if len(name) > 1 else None)
    lettered = any(other[:-1] == name[:-1] for other in header if other != name)  # channels A, B and C
    elsewhere = is_setting(name) or ELSEWHERE.search(name) or PROBE.fullmatch(name)
    return own is not None and own.ours == unit and not (elsewhere or lettered)


def stated_rate(text: str) -> tuple[float, str] | None:
    """Seconds between rows that a text states, and its words.

    >>> stated_rate("dip.acq\\n100 msec/sample")
    (0.1, '100 msec/sample')
    """
    if not (found := RATE.search(text)):
        return None
    number, unit = float(found[1] or found[3] or found[5]), (found[2] or found[4] or "s").lower()
    if number <= 0:
        return None
    if unit.endswith("hz"):
        return 1 / (number * (1000 if unit[0] == "k" else 1)), found[0].strip()
    return number * {"m": 1e-3, "µ": 1e-6, "u": 1e-6}.get(unit[0], 1.0), found[0].strip()


def stated_unit(text: str) -> str:
    """The only unit of temperature among the words of a text; empty where there is none, or where there are several.

    >>> stated_unit("ChannelTitle=\\tPlate\\nUnitName=\\t°C")
    '°C'
    """
    words = (word.strip(' "') for word in re.split(r"[\t,;=:\n]", text))
    units = {word for word in words if len(word) > 1 and (unit := unit_of(word)) and unit.ours == "C"}
    return units.pop() if len(units) == 1 else ""


def chosen(
    header: list[str], rows: list[list[str]], names: Sequence[str], theirs: Mapping[str, str],
    rate: tuple[float, str] | None, notes: list[str],
) -> NamedHeader:  # fmt: skip
    """Our names of the columns: as they say, else the only clock is time, and the only column in °C or A is taken."""
    if TIME in names:
        _add_milliseconds(header, rows)
        header[:] = [name if name in (*names, *theirs.values()) or not rows or _holds(rows, at) else ""
                     for at, name in enumerate(header)]  # fmt: skip
    ours = named(header, names, theirs)
    guesses, free = dict[str, str](), [at for at, cell in enumerate(ours.header) if cell == header[at] and cell]
    if TIME in names and TIME not in (*ours.header, *ours.doubtful):
        clocks = [
            at
            for at in free
            if rows and all(is_clock(cell) for row in (rows[0], rows[-1]) for cell in row[at : at + 1])
        ]
        clocks = clocks or [at for at in free if (own := parted(header[at])[1]) and own.ours == "s"]
        if len(clocks) == 1:
            guesses[TIME] = header[clocks[0]]
        elif not clocks and rate is not None:
            for place, row in enumerate(rows):
                row[len(header) :] = []
                row += [""] * (len(header) - len(row)) + [f"{place * rate[0]:.9g}"]
            header.append(TIME)
            notes.append(f"no column holds times: they follow from {rate[1]!r}")
    for unit, wanted in (("C", READINGS), ("A", ("current_A",))):
        name = next((name for name in names if name in wanted), "")
        vague = {each for each, cells in ours.doubtful.items() if not any(parted(cell)[1] for cell in cells)}
        there = {*ours.header, *ours.doubtful, *theirs} - vague
        alike = [header[at] for at in free if is_reading(header[at], unit, header) and header[at] not in names]
        if name and not there & set(wanted) and len(alike) == 1:
            guesses[name] = alike[0]
            notes.append(f"{alike[0]!r} is taken as {name}, as the only column in {'°C' if unit == 'C' else unit}")
    ours = named(header, names, {**theirs, **guesses}) if guesses or TIME in header else ours
    return _without_idle(ours, header, rows, theirs)


def _without_idle(
    ours: NamedHeader, header: list[str], rows: Sequence[list[str]], theirs: Mapping[str, str]
) -> NamedHeader:
    """Doubt a reading of one value throughout that was taken by its name, where another in °C varies."""
    for name in {*ours.renamed} & {*READINGS} - {*theirs}:
        own = ours.header.index(name)
        if _varies(rows, own) or {*ours.header} & {*READINGS} - {name}:
            continue
        others = [cell for at, cell in enumerate(ours.header) if is_reading(cell, "C", header) and _varies(rows, at)]
        if others:
            cells = [header[own] if cell == name else cell for cell in ours.header]
            renamed = {each: said for each, said in ours.renamed.items() if each != name}
            ours = NamedHeader(tuple(cells), renamed, {**ours.doubtful, name: (*others, header[own])})
    return ours


def _varies(rows: Sequence[list[str]], at: int) -> bool:
    """Whether a column has two different cells."""
    return any(at < len(row) and row[at] != rows[0][at] for row in rows if at < len(rows[0]))


def _holds(rows: Sequence[list[str]], at: int) -> bool:
    """Whether any row has something in a column."""
    return any(at < len(row) and row[at] and row[at].lower() not in NOTHINGS for row in rows)


def _add_milliseconds(header: list[str], rows: Sequence[list[str]]) -> None:
    """Join a clock of whole seconds with its milliseconds, where these stand in the column behind it."""
    for at in range(len(header) - 1):
        behind = [row[at + 1] if at + 1 < len(row) else "" for row in rows] if BARE_MS.match(header[at + 1]) else []
        if behind and all(cell.isdecimal() and len(cell) < 4 for cell in behind) and is_clock(rows[0][at]):
            for row in rows:
                row[at] += f".{row[at + 1]:0>3}"
            header[at], header[at + 1] = "Time", ""


def name_by_words(header: list[str], rows: Sequence[list[str]]) -> None:
    """Name a column by the one word that stands beside its number in every row: its unit, or the name it lacks."""
    full = [row for row in rows if len(row) >= len(header)]
    for at in range(len(header) if full else 0):
        words = {row[at] for row in full}
        word = words.pop() if len(words) == 1 else ""
        beside = (at - 1, at + 1) if header[at] != str(at + 1) else (at + 1, at - 1)  # "Reading, Unit"; "T: 32.1"
        for number in beside if word and not NUMBER.fullmatch(word) else ():
            if 0 <= number < len(header) and VALUE.fullmatch(full[0][number]) and not parted(header[number])[1]:
                if unit_of(word):
                    header[number] += f" [{word}]"
                    break
                if header[number] == str(number + 1) and parted(word)[1]:
                    header[number] = word
                    break
