"""The language's words as messages use them."""

import tomllib
from collections.abc import Iterable
from fractions import Fraction
from importlib import resources
from typing import get_args

from thermicon.base.words.near_words import nearest_words, proposals

from .statements import Shape
from .units import UNITS, Control, Kind, decimal_text, exact_number

_KEYS = ("means", "by", "doi", "licence", "tags")
WAVES: tuple[str, ...] = get_args(Shape)
_MOVES = ("cool", "warm", "change", "hold", "rest", "return", "step", "pulse")
_STATEMENTS = (*_MOVES, *WAVES, "repeat", "on", "together", "along", "play", "total", "to")
VOCABULARY: dict[str, tuple[str, ...]] = {
    "file": ("cue", "set", "icon"),
    "set": ("site", "control", "baseline", "elements", *_KEYS),
    "icon": _STATEMENTS,
    "repeat": _STATEMENTS,
    "header": _KEYS,
}
CLAUSES = (
    "by",
    "to",
    "at",
    "over",
    "for",
    "every",
    "in",
    "step",
    "starting",
    "cut",
    "most",
    "least",
    "up",
    "down",
    "all",
)
"""Words within a statement, after the first."""
CONTROLS: tuple[str, ...] = get_args(Control)

_TABLES = tomllib.loads(resources.files("thermicon.icons").joinpath("data/words.toml").read_text(encoding="utf-8"))


def _meant(name: str) -> dict[str, str]:
    """Other words that people write, each listed under its meaning."""
    return {written: meant for meant, listed in _TABLES[name].items() for written in listed.split()}


EXAMPLES: dict[str, str] = _TABLES["examples"]
"""Examples of kinds of quantity and of statements."""
WORD_ALIASES, STARTS, BOUNDS, NUMBER_WORDS = map(_meant, ("words", "starts", "bounds", "numbers"))
_UNIT_ALIASES = _meant("units")
FILLERS = frozenset(_TABLES["fillers"]["said"].split())
"""Words that leave nothing out when they go."""
LACKING = _meant("lacking")
QUOTES: dict[str, str] = _TABLES["quotes"]
"""Quotation marks that are not straight double ones, and what closes each."""
_SCALED = {unit: (known, Fraction(size)) for units, (known, size) in _TABLES["sizes"].items() for unit in units.split()}
"""Units of other sizes: the unit that the language has, and how many of it they are."""
# What is written for a minus sign: the language takes the first two.
DASHES = ("-", "−", "–", "—", "‐", "‑", "‒", "―", "﹣", "－")
JOINERS = (",", "and", "then", "&", "afterwards")


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the known word that was most likely meant, or None."""
    plain = word[:40].casefold()
    options = list(known)
    alias = WORD_ALIASES.get(plain)
    if alias in options:
        return alias
    return next(iter(proposals(plain, options, cutoff=0.6)), None)


def nearest_unit(word: str, kind: Kind) -> str | None:
    """Return the unit of this kind that was most likely meant, or None."""
    plain = word[:40].replace("℃", "°C").replace("º", "°").replace("˚", "°")
    head, slash, per = plain.partition("/")
    parts = (_UNIT_ALIASES.get(part.casefold(), part) for part in (head, per))
    for spelling in (plain, _UNIT_ALIASES.get(plain.casefold(), ""), slash.join(parts)):
        if spelling in UNITS[kind]:
            return spelling
    if word in _SCALED or head[-1:] in "Ff℉" or head.endswith(("pp", "rms")) or any(char.isdigit() for char in word):
        return None
    # What begins otherwise, or is per something else, is a unit of another size: µs, mK, °C/ms.
    same = [unit for unit in UNITS[kind] if unit[:1] == plain[:1] and unit.partition("/")[2] in (per, "")]
    return next(iter(nearest_words(plain, same)), None)


def scaled(number: str, unit: str, kind: Kind) -> str | None:
    """Return a number with a unit that the language lacks in one that it has, or None."""
    known, factor = _SCALED.get(unit, ("", Fraction(1)))
    if known not in UNITS[kind]:
        return None
    try:
        return f"{decimal_text(float(exact_number(number) * factor))} {known}"
    except ValueError:
        return None


def fahrenheit(number: str, per: str, kind: Kind) -> str | None:
    """Return a number in °F, or in °F ``per`` a time such as "/s", in °C; None where no such number is needed."""
    if f"°C{per}" not in UNITS[kind]:
        return None
    try:
        celsius = (exact_number(number) - (32 if kind == "absolute" else 0)) * Fraction(5, 9)
    except ValueError:
        return None
    return f"{decimal_text(round(float(celsius), 2))} °C{per}"


def unit_kinds(unit: str) -> list[Kind]:
    """Return the kinds of quantity that a unit can measure: none for an unknown unit."""
    return [kind for kind, units in UNITS.items() if unit in units and kind not in ("change", "count")]
