"""Conversion of numbers between text and SI floats without losing a digit."""

import math
from fractions import Fraction
from functools import lru_cache
from numbers import Real
from typing import Literal

Control = Literal["skin", "display", "current"]
Span = tuple[int, int] | None
# A difference has a size alone, a change a sign as well; a count has no unit.
Kind = Literal["absolute", "difference", "change", "rate", "time", "current", "current_rate", "count"]

# Per kind, every spelling and its factor to SI; the first is the one that help and canonical text prefer.
UNITS: dict[Kind, dict[str, Fraction]] = {
    "absolute": {"°C": Fraction(1), "degC": Fraction(1)},
    "difference": {"°C": Fraction(1), "degC": Fraction(1), "K": Fraction(1)},
    "change": {"°C": Fraction(1), "degC": Fraction(1), "K": Fraction(1)},
    "rate": {
        "°C/s": Fraction(1),
        "degC/s": Fraction(1),
        "K/s": Fraction(1),
        "°C/min": Fraction(1, 60),
        "degC/min": Fraction(1, 60),
        "K/min": Fraction(1, 60),
    },
    "time": {"s": Fraction(1), "ms": Fraction(1, 1000), "min": Fraction(60)},
    "current": {"A": Fraction(1), "mA": Fraction(1, 1000)},
    "current_rate": {"A/s": Fraction(1), "mA/s": Fraction(1, 1000)},
    "count": {"": Fraction(1)},
}

KIND_WORDS: dict[Kind, str] = {
    "absolute": "a temperature",
    "difference": "a temperature difference",
    "change": "a temperature difference",
    "rate": "a rate of temperature",
    "time": "a time",
    "current": "a current",
    "current_rate": "a rate of current",
    "count": "a count",
}

# The range of sizes that a number other than zero may have: wide for any skin, narrow enough for exact sums.
SMALLEST, LARGEST = 1e-9, 1e9
LONGEST_NUMBER = 40
_FEW_DIGITS = 12


# The language's own sanity: wider than skin bears and modules take; what is safe is the rig's business.
LOWEST_C, HIGHEST_C = -10.0, 60.0
HIGHEST_A = 20.0
SHORTEST_S, LONGEST_S = 1e-6, 3600.0
MOST_REPEATS = 1_000_000_000
_RANGE = f"{LOWEST_C:g} to {HIGHEST_C:g} °C".replace("-", "−")


def to_si(number: str, unit: str, kind: Kind) -> float:
    """SI value of a number as written, 0.05 for ``50`` and ``ms``; ValueError, or KeyError for another kind of unit."""
    factor = UNITS[kind][unit]
    return float(exact_number(number) * factor)


def exact_number(text: str) -> Fraction:
    """Return the exact value of a decimal number as written; ValueError when it is outside what the language takes."""
    if len(text) > LONGEST_NUMBER:
        raise ValueError(f"a number has at most {LONGEST_NUMBER} characters")
    plain = text.replace("−", "-")
    rough = float(plain)
    if not math.isfinite(rough) or abs(rough) > LARGEST:
        raise ValueError(f"a number is at most {LARGEST:.0e} in size")
    if 0 < abs(rough) < SMALLEST or (rough == 0 and any(digit in "123456789" for digit in plain.lower().split("e")[0])):
        raise ValueError(f"a number other than 0 is at least {SMALLEST:.0e} in size")
    return Fraction(plain) if rough else Fraction(0)


def decimal_text(value: float) -> str:
    """Return the shortest decimal text of a float, without a trailing ``.0``: ``32``, ``0.5``, ``1e-5``."""
    mantissa, mark, exponent = repr(float(value)).partition("e")
    mantissa = mantissa.removesuffix(".0")
    return mantissa + (f"e{int(exponent)}" if mark else "")


def written(value: float, kind: Kind) -> tuple[str, str]:
    """Return number and unit that read back to exactly this SI value, in the shortest sensible unit.

    The SI unit is kept unless another one saves more than two characters.

    >>> written(0.05, "time"), written(0.001, "time"), written(1 / 60, "rate")
    (('0.05', 's'), ('1', 'ms'), ('1', '°C/min'))
    """
    best: tuple[str, str] | None = None
    for unit, factor in UNITS[kind].items():
        if "K" in unit or "degC" in unit:
            continue
        number = decimal_text(float(Fraction(decimal_text(value)) / factor))
        try:
            if to_si(number, unit, kind) != value:
                number = decimal_text(value / float(factor))
                if to_si(number, unit, kind) != value:
                    continue
        except ValueError:
            continue
        if best is None or len(number) + len(unit) < len(best[0]) + len(best[1]) - 2:
            best = (number, unit)
    if best is None:
        raise ValueError(f"{value!r} cannot be written as {KIND_WORDS[kind]}")
    return best


def quantity(value: float, kind: Kind) -> str:
    """Return an SI value as canonical text with its unit, such as ``6 °C`` or ``50 ms``."""
    return " ".join(written(value, kind)).strip()


@lru_cache(maxsize=4096)
def exact(value: float, kind: Kind) -> Fraction:
    """Return the exact SI value that the canonical text of this float states: one sixtieth for ``1 °C/min``."""
    plain = decimal_text(value)
    if len(plain) <= _FEW_DIGITS:  # so few digits state one value, whatever unit they are written in
        return Fraction(plain)
    number, unit = written(value, kind)
    return exact_number(number) * UNITS[kind][unit]


def fault(value: float, kind: Kind) -> tuple[str, str] | None:
    """Return error code and words for an SI value that no statement may have, or None.

    >>> fault(70.0, "absolute")
    ('E219', '70 °C is outside the −10 to 60 °C that the language allows')
    """
    if not math.isfinite(value) or abs(value) > LARGEST or 0 < abs(value) < SMALLEST:
        return "E218", f"{value:g} is not a number that the language takes"
    if kind == "count" and not (value == int(value) and 1 <= value <= MOST_REPEATS):
        return "E207", f"{decimal_text(value)} is not a positive whole number"
    if kind == "absolute" and not LOWEST_C <= value <= HIGHEST_C:
        return "E219", f"{decimal_text(value)} °C is outside the {_RANGE} that the language allows"
    if kind == "current" and abs(value) > HIGHEST_A:
        return "E219", f"{decimal_text(value)} A is outside the ±{HIGHEST_A:g} A that the language allows"
    if kind == "change" and value == 0:
        return "E202", "a change must not be zero"
    if kind == "difference" and value <= 0:
        return "E202", "a change has a positive size; its direction is in the word"
    if kind in ("difference", "change") and abs(value) > HIGHEST_C - LOWEST_C:
        return "E219", f"{decimal_text(value)} °C is more than the whole {_RANGE} that the language allows"
    if kind in ("rate", "current_rate") and value <= 0:
        return "E204", "a rate is positive; the direction is in the word"
    if kind == "time" and value <= 0:
        return "E203", "a time is positive"
    if kind == "time" and value < SHORTEST_S:
        return "E203", "this is shorter than a microsecond"
    if kind == "time" and value > LONGEST_S:
        return "E221", f"{decimal_text(value)} s is more than the hour that an icon may last"
    return None


def prove(owner: object, **kinds: Kind) -> None:
    """Make fields of a frozen object floats that their kinds allow, or raise ValueError; None is left alone."""
    for name, kind in kinds.items():
        value = getattr(owner, name)
        if value is None:
            continue
        if isinstance(value, bool) or not isinstance(value, Real):
            raise ValueError(f"{type(owner).__name__}.{name} must be a number, not {value!r}")
        value = float(value) + 0.0
        if found := fault(value, kind):
            raise ValueError(f"{type(owner).__name__}.{name} = {value!r}: {found[1]}")
        exact(value, kind)
        object.__setattr__(owner, name, value)


def prove_one_of(owner: object, *names: str) -> None:
    """Raise ValueError unless exactly one of the fields is given."""
    if sum(getattr(owner, name) is not None for name in names) != 1:
        raise ValueError(f"{type(owner).__name__} needs either {' or '.join(names)}, and not both")


def prove_given(owner: object, **kinds: Kind) -> None:
    """As ``prove``, for fields that may not be None."""
    for name in kinds:
        if getattr(owner, name) is None:
            raise ValueError(f"{type(owner).__name__}.{name} must be a number, not None")
    prove(owner, **kinds)
