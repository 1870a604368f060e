"""The words of the language for messages: what stands where, what is not there yet, what people write instead."""

from collections.abc import Iterable
from fractions import Fraction
from typing import get_args

from ..near_words import nearest_words
from .statements import Shape
from .units import UNITS, Control, Kind, decimal_text, exact_number

_KEYS = ("means", "by", "doi", "licence", "tags")
WAVES: tuple[str, ...] = get_args(Shape)
_STATEMENTS = (
    "cool",
    "warm",
    "change",
    "hold",
    "rest",
    "return",
    "step",
    "pulse",
    *WAVES,
    "repeat",
    "play",
    "total",
    "to",
)
VOCABULARY: dict[str, tuple[str, ...]] = {
    "file": ("cue", "set", "icon"),
    "set": ("site", "control", "baseline", *_KEYS),
    "icon": _STATEMENTS,
    "repeat": _STATEMENTS,
    "header": _KEYS,
}
CONTROLS: tuple[str, ...] = get_args(Control)

NOT_YET: dict[str, str] = {
    "on": "a display with several elements cannot be addressed; write one icon for the one element",
}

EXAMPLES: dict[str, str] = {
    "absolute": 'a temperature such as "26 °C", or a change such as "by 6 °C"',
    "difference": 'a difference such as "6 °C" or "6 K"',
    "rate": 'a rate such as "3 °C/s" or "1 °C/min"',
    "time": 'a time such as "4 s", "200 ms" or "1 min"',
    "current": 'a current such as "0.5 A" or "500 mA"',
    "current_rate": 'a rate such as "1 A/s" or "100 mA/s"',
    "cool": 'for example: "cool by 6 °C at 3 °C/s"',
    "warm": 'for example: "warm by 4 °C at 3 °C/s"',
    "hold": 'for example: "hold for 4 s"',
    "rest": 'for example: "rest for 1 s"',
    "return": 'for example: "return at 3 °C/s"',
    "change": 'for example: "change by -6 °C at 3 °C/s"',
    "step": 'for example: "step by -6 °C", "step cool by 6 °C" or "step to 26 °C"',
    "pulse": 'for example: "pulse by -3 °C for 500 ms" or "pulse cool by 3 °C for 500 ms"',
    **dict.fromkeys(WAVES, 'for example: "sine by 3 °C every 4 s for 12 s"'),
    "total": 'for example: "total 10 s" or "total at most 10 s"',
    "play": 'for example: "play other-icon"',
}


def _meant(words: dict[str, str]) -> dict[str, str]:
    """What people write instead, by itself, from lists of it by what is meant."""
    return {written: meant for meant, listed in words.items() for written in listed.split()}


WORD_ALIASES = _meant({
    "warm": "heat warming raise",
    "cool": "chill cooling lower",
    "hold": "stay keep wait",
    "rest": "pause",
    "repeat": "loop",
    "return": "back",
    "means": "meaning",
    "by": "author",
    "licence": "license",
    "tags": "tag",
    "cue": "version",
    "icon": "pattern",
    "every": "each",
    "sine": "sinus",
    "change": "ramp",
    "total": "total-time duration",
})  # fmt: skip
# What a wave or a step may have been meant to do first.
STARTS = _meant({
    "warm": "warm hot warming heating up upwards high rising",
    "cool": "cool cold cooling down downwards low falling",
})  # fmt: skip
BOUNDS = _meant({
    "at most": "most < <= ≤ under below max maximum up",
    "at least": "least > >= ≥ over above min minimum",
})  # fmt: skip
NUMBER_WORDS = _meant({
    "1": "one a an once", "2": "two twice", "3": "three thrice", "4": "four", "5": "five", "6": "six", "7": "seven",
    "8": "eight", "9": "nine", "10": "ten", "11": "eleven", "12": "twelve", "20": "twenty", "0": "zero",
    "0.5": "half ½", "0.25": "¼", "0.75": "¾",
})  # fmt: skip
# What is written for a minus sign: the language takes the first two.
DASHES = ("-", "−", "–", "—", "‐", "‑", "‒", "―", "﹣", "－")
JOINERS = (",", "and", "then", "&", "afterwards")
QUOTES: dict[str, str] = {
    "“": "”“",
    "„": "“”",
    "”": "”",
    "«": "»",
    "»": "«",
    "‘": "’‘",
    "‚": "‘’",
    "'": "'",
    "`": "`'´",
}
"""Quotation marks that are not straight double ones, and what closes each."""

# Units of other sizes: the unit that the language has, and how many of it they are.
_SCALED: dict[str, tuple[str, Fraction]] = {
    **dict.fromkeys(("µs", "μs", "us", "usec", "microseconds"), ("ms", Fraction(1, 1000))),
    **dict.fromkeys(("ns", "nanoseconds"), ("ms", Fraction(1, 1_000_000))),
    **dict.fromkeys(("h", "hr", "hour", "hours"), ("min", Fraction(60))),
    **dict.fromkeys(("mK", "millikelvin"), ("K", Fraction(1, 1000))),
    "mK/s": ("K/s", Fraction(1, 1000)),
    "K/ms": ("K/s", Fraction(1000)),
    "°C/ms": ("°C/s", Fraction(1000)),
    **dict.fromkeys(("µA", "μA", "uA"), ("mA", Fraction(1, 1000))),
    "A/ms": ("A/s", Fraction(1000)),
    "mA/ms": ("A/s", Fraction(1)),
}
_UNIT_ALIASES = _meant({
    "°C": "c °c celsius deg ° degree degrees",
    "K": "kelvin kelvins k",
    "°C/s": "c/s °c/s °c/sec deg/s degrees/s",
    "°C/min": "c/min °c/min",
    "K/s": "k/sec k/s",
    "s": "sec secs second seconds",
    "ms": "msec millisecond milliseconds",
    "min": "m mins minute minutes",
    "A": "a amp amps ampere amperes",
    "mA": "ma",
    "A/s": "a/s",
    "mA/s": "ma/s",
})  # fmt: skip


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the known word that was most likely meant, or None.

    >>> nearest("coool", ["warm", "cool"]), nearest("heat", ["warm", "cool"]), nearest("x", ["warm"])
    ('cool', 'warm', None)
    """
    plain = word[:40].casefold()
    options = list(known)
    alias = WORD_ALIASES.get(plain)
    if alias in options:
        return alias
    return next(iter(nearest_words(plain, options)), None)


def nearest_unit(word: str, kind: Kind) -> str | None:
    """Return the unit of this kind that was most likely meant, or None.

    >>> nearest_unit("seconds", "time"), nearest_unit("℃", "absolute"), nearest_unit("watt", "time")
    ('s', '°C', None)
    """
    plain = word[:40].replace("℃", "°C").replace("º", "°").replace("˚", "°")
    head, slash, per = plain.partition("/")
    parts = (_UNIT_ALIASES.get(part.casefold(), part) for part in (head, per))
    for spelling in (plain, _UNIT_ALIASES.get(plain.casefold(), ""), slash.join(parts)):
        if spelling in UNITS[kind]:
            return spelling
    if word in _SCALED or head[-1:] in "Ff℉" or any(char.isdigit() for char in word):
        return None
    # What begins otherwise, or is per something else, is a unit of another size: µs, mK, °C/ms.
    same = [unit for unit in UNITS[kind] if unit[:1] == plain[:1] and unit.partition("/")[2] in (per, "")]
    return next(iter(nearest_words(plain, same)), None)


def scaled(number: str, unit: str, kind: Kind) -> str | None:
    """Return a number with a unit that the language lacks in one that it has, or None.

    >>> scaled("500", "µs", "time"), scaled("3", "mK", "difference"), scaled("3", "mK", "time")
    ('0.5 ms', '0.003 K', None)
    """
    known, factor = _SCALED.get(unit, ("", Fraction(1)))
    if known not in UNITS[kind]:
        return None
    try:
        return f"{decimal_text(float(exact_number(number) * factor))} {known}"
    except ValueError:
        return None


def unit_kinds(unit: str) -> list[Kind]:
    """Return the kinds of quantity that a unit can measure: none for an unknown unit.

    >>> unit_kinds("K"), unit_kinds("ms")
    (['difference'], ['time'])
    """
    return [kind for kind, units in UNITS.items() if unit in units and kind not in ("change", "count")]
