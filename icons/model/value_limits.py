"""What a number in an icon may be: the language's own limits, and the proofs that statements run on construction."""

import math
from numbers import Real
from typing import Literal

from .units import LARGEST, SMALLEST, Kind, decimal_text, exact

Control = Literal["skin", "display", "current"]
Span = tuple[int, int] | None

# The language's own sanity: wider than skin bears and modules take; what is safe is the rig's business.
LOWEST_C, HIGHEST_C = -10.0, 60.0
HIGHEST_A = 20.0
SHORTEST_S, LONGEST_S = 1e-6, 3600.0
MOST_REPEATS = 1_000_000_000
_RANGE = f"{LOWEST_C:g} to {HIGHEST_C:g} °C".replace("-", "−")


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


def prove_number(owner: object, name: str, kind: Kind) -> None:
    """Make a field of a frozen object a float that its kind allows, or raise ValueError; None is left alone."""
    value = getattr(owner, name)
    if value is None:
        return
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ValueError(f"{type(owner).__name__}.{name} must be a number, not {value!r}")
    value = float(value) + 0.0
    found = fault(value, kind)
    if found:
        raise ValueError(f"{type(owner).__name__}.{name} = {value!r}: {found[1]}")
    exact(value, kind)
    object.__setattr__(owner, name, value)


def prove_one_of(owner: object, *names: str) -> None:
    """Raise ValueError unless exactly one of the fields is given."""
    if sum(getattr(owner, name) is not None for name in names) != 1:
        raise ValueError(f"{type(owner).__name__} needs either {' or '.join(names)}, and not both")


def prove_given(owner: object, name: str, kind: Kind) -> None:
    """As ``prove_number``, for a field that may not be None."""
    if getattr(owner, name) is None:
        raise ValueError(f"{type(owner).__name__}.{name} must be a number, not None")
    prove_number(owner, name, kind)
