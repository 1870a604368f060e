"""What an icon is made of: frozen statements in SI floats that prove themselves, and what each does to the level."""

import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from thermicon.icons.units import LARGEST, SMALLEST, Kind, decimal_text, exact

Control = Literal["skin", "display", "current"]
Direction = Literal["warm", "cool"]
Span = tuple[int, int] | None

# The language's own sanity: wider than skin bears and modules take; what is safe is the rig's business.
LOWEST_C, HIGHEST_C = -10.0, 60.0
HIGHEST_A = 20.0
SHORTEST_S, LONGEST_S = 1e-6, 3600.0
MOST_REPEATS = 1_000_000_000


def fault(value: float, kind: Kind) -> tuple[str, str] | None:
    """Return error code and words for an SI value that no statement may have, or None.

    >>> fault(70.0, "absolute")
    ('E219', '70 °C is outside the −10 to 60 °C that the language allows')
    """
    if not math.isfinite(value) or abs(value) > LARGEST or 0 < abs(value) < SMALLEST:
        return "E218", f"{value:g} is not a number that the language takes"
    if kind == "absolute" and not LOWEST_C <= value <= HIGHEST_C:
        return "E219", f"{decimal_text(value)} °C is outside the −10 to 60 °C that the language allows"
    if kind == "current" and abs(value) > HIGHEST_A:
        return "E219", f"{decimal_text(value)} A is outside the ±20 A that the language allows"
    if kind == "difference" and value <= 0:
        return "E202", "a change has a positive size; its direction is in the word"
    if kind == "difference" and value > HIGHEST_C - LOWEST_C:
        return "E219", f"{decimal_text(value)} °C is more than the whole −10 to 60 °C that the language allows"
    if kind in ("rate", "current_rate") and value <= 0:
        return "E204", "a rate is positive; the direction is in the word"
    if kind == "time" and value <= 0:
        return "E203", "a time is positive"
    if kind == "time" and value < SHORTEST_S:
        return "E203", "this is shorter than a microsecond"
    if kind == "time" and value > LONGEST_S:
        return "E221", f"{decimal_text(value)} s is more than the hour that an icon may last"
    return None


def _number(owner: object, name: str, kind: Kind) -> None:
    value = getattr(owner, name)
    if value is None:
        return
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{type(owner).__name__}.{name} must be a number, not {value!r}")
    value = float(value) + 0.0
    found = fault(value, kind)
    if found:
        raise ValueError(f"{type(owner).__name__}.{name} = {value!r}: {found[1]}")
    exact(value, kind)
    object.__setattr__(owner, name, value)


def _one_of(owner: object, first: str, second: str) -> None:
    if (getattr(owner, first) is None) == (getattr(owner, second) is None):
        raise ValueError(f"{type(owner).__name__} needs either {first} or {second}, and not both")


@dataclass(frozen=True, slots=True)
class Change:
    """``warm`` or ``cool``: by a difference (K) or to a temperature (°C), at a rate (K/s) or over a time (s).

    Raises ValueError for a value that is not positive or outside the language's range.

    >>> Change("cool", by_K=6, rate_K_per_s=3)
    Change(direction='cool', by_K=6.0, to_C=None, rate_K_per_s=3.0, duration_s=None)
    """

    direction: Direction
    by_K: float | None = None
    to_C: float | None = None
    rate_K_per_s: float | None = None
    duration_s: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.direction not in ("warm", "cool"):
            raise ValueError(f'Change.direction must be "warm" or "cool", not {self.direction!r}')
        _one_of(self, "by_K", "to_C")
        _one_of(self, "rate_K_per_s", "duration_s")
        _number(self, "by_K", "difference")
        _number(self, "to_C", "absolute")
        _number(self, "rate_K_per_s", "rate")
        _number(self, "duration_s", "time")


@dataclass(frozen=True, slots=True)
class Drive:
    """``to`` under control current: to a current (A), at a rate (A/s) or over a time (s); ValueError when out of range.

    >>> Drive(0.5, rate_A_per_s=1)
    Drive(to_A=0.5, rate_A_per_s=1.0, duration_s=None)
    """

    to_A: float
    rate_A_per_s: float | None = None
    duration_s: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        _one_of(self, "rate_A_per_s", "duration_s")
        _number(self, "to_A", "current")
        _number(self, "rate_A_per_s", "current_rate")
        _number(self, "duration_s", "time")
        if self.to_A is None:
            raise ValueError("Drive.to_A must be a number, not None")


@dataclass(frozen=True, slots=True)
class Hold:
    """``hold``: stay at the present level for a time (s); ValueError when it is not positive or over an hour.

    >>> Hold(4)
    Hold(duration_s=4.0)
    """

    duration_s: float
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        _duration(self)


@dataclass(frozen=True, slots=True)
class Rest:
    """``rest``: stay at baseline for a time (s); ValueError when it is not positive or over an hour.

    >>> Rest(1)
    Rest(duration_s=1.0)
    """

    duration_s: float
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        _duration(self)


@dataclass(frozen=True, slots=True)
class Return:
    """``return``: go back to baseline at a rate (K/s, or A/s under control current) or over a time (s).

    >>> Return(3)
    Return(rate_per_s=3.0, duration_s=None)
    """

    rate_per_s: float | None = None
    duration_s: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        _one_of(self, "rate_per_s", "duration_s")
        _number(self, "rate_per_s", "rate")
        _number(self, "duration_s", "time")


@dataclass(frozen=True, slots=True)
class Broken:
    """Stands for a statement that could not be read, while the rest of a file is checked; no icon holds one."""

    span: Span = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Repeat:
    """``repeat``: a body of statements, count times over; ValueError without a body or a positive whole count.

    >>> Repeat(3, (Hold(1),))
    Repeat(count=3, body=(Hold(duration_s=1.0),))
    """

    count: int
    body: "tuple[Statement | Broken, ...]"
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if isinstance(self.count, bool) or not isinstance(self.count, int) or not 1 <= self.count <= MOST_REPEATS:
            raise ValueError(f"Repeat.count must be a whole number from 1 to {MOST_REPEATS}, not {self.count!r}")
        body = tuple(self.body)
        if not body or not all(isinstance(part, (Repeat, Broken, *LEAVES)) for part in body):
            raise ValueError("Repeat.body must hold at least one statement, and nothing else")
        object.__setattr__(self, "body", body)


LEAVES = (Change, Drive, Hold, Rest, Return)
Leaf = Change | Drive | Hold | Rest | Return
Statement = Leaf | Repeat


def _duration(owner: Hold | Rest) -> None:
    if owner.duration_s is None:
        raise ValueError(f"{type(owner).__name__}.duration_s must be a number, not None")
    _number(owner, "duration_s", "time")


def advance(leaf: Leaf, level: Fraction, rest: Fraction) -> tuple[Fraction, Fraction]:
    """Return the level (°C or A) behind a statement and the time (s) it takes, both exact.

    >>> advance(Change("cool", by_K=6, rate_K_per_s=3), Fraction(32), Fraction(32))
    (Fraction(26, 1), Fraction(2, 1))
    """
    rate: Fraction | None = None
    match leaf:
        case Change():
            sign = 1 if leaf.direction == "warm" else -1
            target = level + sign * exact(leaf.by_K, "difference") if leaf.by_K is not None else level
            if leaf.to_C is not None:
                target = exact(leaf.to_C, "absolute")
            if leaf.rate_K_per_s is not None:
                rate = exact(leaf.rate_K_per_s, "rate")
        case Drive():
            target = exact(leaf.to_A, "current")
            if leaf.rate_A_per_s is not None:
                rate = exact(leaf.rate_A_per_s, "current_rate")
        case Return():
            target = rest
            if leaf.rate_per_s is not None:
                rate = exact(leaf.rate_per_s, "rate")
        case _:
            target = level
    if rate is not None:
        return target, abs(target - level) / rate
    assert leaf.duration_s is not None
    return target, exact(leaf.duration_s, "time")
