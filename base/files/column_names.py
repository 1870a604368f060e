"""Column names of instruments matched to the project's columns.

A unit stands in brackets, behind a slash, a comma, a space or an underscore: ``Temp (°C)``, ``T_display/degC``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple


class Unit(NamedTuple):
    """A unit: the SI unit that ends our names, and by which factor and addition a number becomes one in it."""

    ours: str
    factor: float = 1.0
    plus: float = 0.0


SPELLINGS = {
    "s sec secs second seconds sekunden 秒": Unit("s"),
    "ms msec msecs millisecond milliseconds millis": Unit("s", 1e-3),
    "us µs μs usec microsecond microseconds": Unit("s", 1e-6),
    "ns nsec nanosecond nanoseconds": Unit("s", 1e-9),
    "min mins minute minutes": Unit("s", 60.0),
    "h hr hour hours": Unit("s", 3600.0),
    "c °c ºc ℃ øc ¡c degc deg.c degree.c degrees.c cel celsius deg.celsius degree.celsius degrees.celsius": Unit(
        "C"
    ),  # ø, ¡: DOS, old Macs
    "k kelvin": Unit("C", 1.0, -273.15),
    "f °f ºf ℉ øf ¡f degf deg.f degrees.f fahrenheit": Unit("C", 1 / 1.8, -32 / 1.8),
    "mc m°c mdegc millidegc millicelsius": Unit("C", 1e-3),
    "a amp amps ampere amperes": Unit("A"),
    "ma milliamp milliamps milliampere": Unit("A", 1e-3),
    "v volt volts": Unit("V"),
    "mv millivolt millivolts": Unit("V", 1e-3),
}
UNITS = {spelling: unit for spellings, unit in SPELLINGS.items() for spelling in spellings.split()}

TIME = {
    "time",
    "timestamp",
    "時間",
    "时间",
    "datenum",
    "datetime",
    "zeit",
    "uhrzeit",
    "zeitstempel",
    "elapsed",
    "temps",
    "tiempo",
    "tempo",
}
BESIDE_TIME = {"x", "value", "date", "datum", "relative", "local", "utc", "gmt", "system", "stamp", "scan", "since",
               "start", "run", "of", "day"}  # fmt: skip
THERMAL = {"t", "temp", "temps", "temperature", "temperatur", "température", "temperatura", "温度"}
IDLE = {"actual", "act", "measured", "mean", "avg", "ave", "last", "value", "output", "average", "ist", "istwert",
        "reading", "sensor", "ch", "channel", "tec", "drive"}  # fmt: skip
OTHERS = {
    "i": "current", "strom": "current", "courant": "current", "corriente": "current", "corrente": "current",
    "u": "voltage", "spannung": "voltage", "tension": "voltage", "hot side": "hot plate", "hotplate": "hot plate",
    "sink": "hot plate", "heat sink": "hot plate", "heatsink": "hot plate", "電流": "current", "電圧": "voltage",
    "set point": "setpoint", "soll": "setpoint", "haut": "skin", "vsense": "current", "plus": "voltage",
}  # fmt: skip
"""Other words for what our names say."""

LATEX = str.maketrans("", "", "$\\^~")
BRACKET = re.compile(r"[\s_]*[(\[{<]([^)\]}>]*)[)\]}>]")
BEHIND = re.compile(
    r"(.*?)(?:\s*[/,|]\s*|\s+in\s+|[\s_]+|(?=[°º℃℉]))([^\s_/,|()\[\]]+|deg(?:rees)?[ .]\w+)(?:\s*\(.*)?"
)
SPICE = re.compile(r"([vi])\((.+)\)", re.IGNORECASE)
LONGEST_NAME = 200
HUMP = re.compile(r"(?<=[a-zà-ÿ])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def unit_of(text: str) -> Unit | None:
    """The unit that a text such as [Deg C] or ms is; None where it is none."""
    plain = re.sub(r"\^?\\circ", "°", text).translate(LATEX).strip(" ()[]{}<>\"'").lower().removeprefix("unix ")
    return UNITS.get(re.sub(r"[\s_]+", ".", plain)) if plain else None


def parted(cell: str) -> tuple[str, Unit | None]:
    """The words of a name without its unit, and the unit."""
    for text in (cell, HUMP.sub(" ", cell)) if len(cell) <= LONGEST_NAME else ():
        for found in BRACKET.finditer(text):
            if unit := unit_of(found[1]):
                return text[: found.start()], unit
        if (behind := BEHIND.fullmatch(text)) and (unit := unit_of(behind[2])):
            return behind[1], unit
    unit = unit_of(cell) if len(cell) > 1 else None  # "ms", but not the least value, "min"
    return ("time", unit) if unit and unit.ours == "s" and unit.factor <= 1 else (cell, None)


def meant(cell: str, names: Iterable[str]) -> tuple[str, Unit | None] | None:
    """Which of our ``names`` a cell of a header means, and its unit (None: not said); None where it means none.

    >>> meant("Display Temp (°F)", ["time_s", "display_C"])[0], meant("Current", ["current_A"])
    ('display_C', None)
    """
    known = {name.lower(): name for name in names}
    if cell.lower() in known:
        return known[cell.lower()], None
    if (found := SPICE.fullmatch(cell)) and not unit_of(found[2]):
        word = found[2].lower()
        ours = known.get(word) or f"{OTHERS.get(word, '')}_{'A' if found[1] in 'iI' else 'V'}"
        return (ours, None) if ours in known.values() else None
    text, unit = parted(cell)
    if unit and text in known.values() and text.endswith(f"_{unit.ours}"):
        return text, unit
    words = [word for word in re.split(r"[\W_\d]+", HUMP.sub(" ", text).lower()) if word]
    if unit is None or unit.ours == "s":
        of_time = set(words) & TIME and set(words) <= TIME | BESIDE_TIME
        if of_time or words == ["x", "value"] or (unit and words == ["t"]):
            return ("time_s", unit) if "time_s" in known else None
    core = " ".join(word for word in words if word not in THERMAL | IDLE)
    core = OTHERS.get(core, core or ("temperature" if set(words) & THERMAL and (unit or words != ["t"]) else ""))
    ours = f"{core.replace(' ', '_')}_{unit.ours if unit else 'C'}".lower()
    return (known[ours], unit) if ours in known else None


@dataclass(frozen=True, slots=True)
class NamedHeader:
    """A header in our names where they are known: what those that were renamed are called, and what was ambiguous."""

    header: tuple[str, ...]
    renamed: Mapping[str, tuple[str, Unit]]
    doubtful: Mapping[str, tuple[str, ...]]


def named(cells: Sequence[str], names: Iterable[str], theirs: Mapping[str, str]) -> NamedHeader:
    """Read a header: ours, what ``theirs`` gives, what means one of ours; of two that may, the one with a unit."""
    renamed, doubtful = dict[str, tuple[str, Unit]](), dict[str, tuple[str, ...]]()
    places = {name: [(cells.index(own), parted(own)[1] or (unit_of(own) if len(own) > 1 else None))]
              for name, own in theirs.items() if own in cells}  # fmt: skip
    new, said = [f"({cell})" if cell in places else cell for cell in cells], set(places)
    for at, cell in enumerate(cells):
        if cell not in names and cell not in theirs.values() and not re.fullmatch("probe_.+_C", cell):
            found = meant(cell, names)
            if found and found[0] not in said.union(cells):
                places.setdefault(found[0], []).append((at, found[1]))
    for name, several in places.items():
        best = [one for one in several if one[1] or len(several) == 1]
        if len(best) == 1:
            at, unit = best[0]
            new[at], renamed[name] = name, (cells[at], unit or Unit(""))
        else:
            doubtful[name] = tuple(cells[at] for at, _ in several)
    return NamedHeader(tuple(new), renamed, doubtful)
