"""What an icon is made of: frozen statements in SI floats that prove themselves; shapes stand in ``shapes``."""

from dataclasses import dataclass, field
from numbers import Integral
from typing import TYPE_CHECKING, Literal, get_args

from .shapes import Heading, Pulse, Step, Wave
from .units import MOST_REPEATS, Kind, Span, prove, prove_given, prove_one_of

if TYPE_CHECKING:
    from .icon import Icon

Bound = Literal["exactly", "at most", "at least"]


@dataclass(frozen=True, slots=True)
class Ramp:
    """``warm``, ``cool``, ``change``: by a difference (K) or to a temperature (°C), at a rate (K/s) or over a time (s).

    The difference is signed for ``change``, which takes both directions, and positive for the others. Raises
    ValueError for a value outside the language's range.

    >>> Ramp("cool", by_K=6, rate_K_per_s=3)
    Ramp(direction='cool', by_K=6.0, to_C=None, rate_K_per_s=3.0, duration_s=None)
    """

    direction: Heading
    by_K: float | None = None
    to_C: float | None = None
    rate_K_per_s: float | None = None
    duration_s: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.direction not in get_args(Heading):
            raise ValueError(f'Ramp.direction must be "warm", "cool" or "change", not {self.direction!r}')
        prove_one_of(self, "by_K", "to_C")
        prove_one_of(self, "rate_K_per_s", "duration_s")
        size: Kind = "change" if self.direction == "change" else "difference"
        prove(self, by_K=size, to_C="absolute", rate_K_per_s="rate", duration_s="time")


@dataclass(frozen=True, slots=True)
class Current:
    """``to`` under control current: to a current (A), at a rate (A/s) or over a time (s); ValueError when out of range.

    >>> Current(0.5, rate_A_per_s=1)
    Current(to_A=0.5, rate_A_per_s=1.0, duration_s=None)
    """

    to_A: float
    rate_A_per_s: float | None = None
    duration_s: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_one_of(self, "rate_A_per_s", "duration_s")
        prove_given(self, to_A="current")
        prove(self, rate_A_per_s="current_rate", duration_s="time")


@dataclass(frozen=True, slots=True)
class Hold:
    """``hold``: stay at the present level for a time (s); ValueError when it is not positive or over an hour.

    >>> Hold(4)
    Hold(duration_s=4.0)
    """

    duration_s: float
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_given(self, duration_s="time")


@dataclass(frozen=True, slots=True)
class Rest:
    """``rest``: stay at baseline for a time (s); ValueError when it is not positive or over an hour.

    >>> Rest(1)
    Rest(duration_s=1.0)
    """

    duration_s: float
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_given(self, duration_s="time")


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
        prove_one_of(self, "rate_per_s", "duration_s")
        prove(self, rate_per_s="rate", duration_s="time")


@dataclass(frozen=True, slots=True)
class Total:
    """``total``: how long (s) the whole icon must last, exactly, at most or at least; checked, it moves nothing.

    >>> Total(10, "at most")
    Total(duration_s=10.0, bound='at most')
    """

    duration_s: float
    bound: Bound = "exactly"
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.bound not in get_args(Bound):
            raise ValueError(f'Total.bound must be "exactly", "at most" or "at least", not {self.bound!r}')
        prove_given(self, duration_s="time")


@dataclass(frozen=True, slots=True)
class Play:
    """``play``: all statements of another icon, which begins at baseline; ValueError for anything but an icon.

    >>> from thermicon.icons import Icon
    >>> Play(Icon("wait", (Rest(1),))).icon.name
    'wait'
    """

    icon: "Icon"
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if not hasattr(self.icon, "statements") or not hasattr(self.icon, "corners"):
            raise ValueError(f"Play.icon must be an Icon, not {self.icon!r}")


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
        if isinstance(self.count, bool) or not isinstance(self.count, Integral) or not 1 <= self.count <= MOST_REPEATS:
            raise ValueError(f"Repeat.count must be a whole number from 1 to {MOST_REPEATS}, not {self.count!r}")
        body = tuple(self.body)
        if not body or not all(isinstance(part, (Repeat, Play, Broken, *LEAVES)) for part in body):
            raise ValueError("Repeat.body must hold at least one statement, and nothing else")
        if any(isinstance(part, Total) for part in body):
            raise ValueError("Repeat.body may not hold a Total, which concerns the whole icon")
        object.__setattr__(self, "count", int(self.count))
        object.__setattr__(self, "body", body)


LEAVES = (Ramp, Current, Hold, Rest, Return, Total, Step, Pulse, Wave)
Leaf = Ramp | Current | Hold | Rest | Return | Total | Step | Pulse | Wave
Statement = Leaf | Repeat | Play
