"""Statements: the frozen parts of an icon in SI units."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from numbers import Integral
from typing import TYPE_CHECKING, Literal, get_args

from .units import MOST_REPEATS, Kind, Span, prove, prove_given, prove_one_of

if TYPE_CHECKING:
    from .icon import Icon

Bound = Literal["exactly", "at most", "at least"]
Shape = Literal["sine", "square", "triangle", "sawtooth"]
Start = Literal["warm", "cool", "up", "down"]
Heading = Literal["warm", "cool", "change"]


@dataclass(frozen=True, slots=True)
class Ramp:
    """``warm``, ``cool``, ``change``: by a difference (K) or to a temperature (°C), at a rate (K/s) or over a time (s).

    The difference is signed for ``change``, which takes both directions, and positive for the others. Raises
    ValueError for a value outside the language's range.
    """

    direction: Heading
    by_K: float | None = None
    to_C: float | None = None
    rate_K_per_s: float | None = None
    duration_s: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        _prove_heading(self)
        prove_one_of(self, "by_K", "to_C")
        prove_one_of(self, "rate_K_per_s", "duration_s")
        size: Kind = "change" if self.direction == "change" else "difference"
        prove(self, by_K=size, to_C="absolute", rate_K_per_s="rate", duration_s="time")


@dataclass(frozen=True, slots=True)
class Current:
    """``to`` under control current: to a current (A), at a rate (A/s) or over a time (s)."""

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
    """``hold``: stay at the present level for a time (s); ValueError when it is not positive or over an hour."""

    duration_s: float
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_given(self, duration_s="time")


@dataclass(frozen=True, slots=True)
class Rest:
    """``rest``: stay at baseline for a time (s); ValueError when it is not positive or over an hour."""

    duration_s: float
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_given(self, duration_s="time")


@dataclass(frozen=True, slots=True)
class Return:
    """``return``: go back to baseline at a rate (K/s, or A/s under control current) or over a time (s)."""

    rate_per_s: float | None = None
    duration_s: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_one_of(self, "rate_per_s", "duration_s")
        prove(self, rate_per_s="rate", duration_s="time")


@dataclass(frozen=True, slots=True)
class Step:
    """``step``: to another level as fast as the driver can: by K or A, or to °C or A; it takes no time.

    With ``warm`` or ``cool`` a difference is positive and in K; with ``change`` it is signed. ValueError otherwise.
    """

    direction: Heading = "change"
    by_K: float | None = None
    to_C: float | None = None
    by_A: float | None = None
    to_A: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_one_of(self, "by_K", "to_C", "by_A", "to_A")
        _prove_heading(self)
        size: Kind = "change" if self.direction == "change" else "difference"
        prove(self, by_K=size, to_C="absolute", by_A="current", to_A="current")


@dataclass(frozen=True, slots=True)
class Pulse:
    """``pulse``: a step by K or A, held for a time (s), and a step back; signed unless ``warm`` or ``cool``."""

    direction: Heading = "change"
    by_K: float | None = None
    by_A: float | None = None
    duration_s: float = 1.0
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_one_of(self, "by_K", "by_A")
        _prove_heading(self)
        prove(self, by_K="change" if self.direction == "change" else "difference", by_A="current")
        prove_given(self, duration_s="time")


@dataclass(frozen=True, slots=True)
class Wave:
    """A wave about the present level: amplitude in K or A, period and duration in s, and which way it starts.

    Unless ``cut``, the duration holds whole periods, so that the wave ends where it began. ``warm`` and ``up`` start
    upwards, ``cool`` and ``down`` downwards. Raises ValueError otherwise.
    """

    shape: Shape
    by_K: float | None = None
    by_A: float | None = None
    period_s: float = 1.0
    duration_s: float = 1.0
    start: Start | None = None
    cut: bool = False
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.shape not in get_args(Shape):
            raise ValueError(f"Wave.shape must be one of {', '.join(get_args(Shape))}, not {self.shape!r}")
        prove_one_of(self, "by_K", "by_A")
        prove(self, by_K="difference", by_A="current")
        if self.by_A is not None and self.by_A <= 0:
            raise ValueError(f'Wave.by_A = {self.by_A!r}: an amplitude is positive; to begin downwards, start "down"')
        prove_given(self, period_s="time", duration_s="time")
        up, down = ("warm", "cool") if self.by_A is None else ("up", "down")
        if self.start is None:
            object.__setattr__(self, "start", up)
        elif self.start not in (up, down):
            raise ValueError(f'Wave.start must be "{up}" or "{down}" here, not {self.start!r}')
        if not isinstance(self.cut, bool):
            raise ValueError(f"Wave.cut must be True or False, not {self.cut!r}")

    @property
    def sign(self) -> int:
        """1 for a wave that starts upwards, -1 for one that starts downwards."""
        return 1 if self.start in ("warm", "up") else -1


@dataclass(frozen=True, slots=True)
class Total:
    """``total``: how long (s) the whole icon must last, exactly, at most or at least; checked, it moves nothing."""

    duration_s: float
    bound: Bound = "exactly"
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.bound not in get_args(Bound):
            raise ValueError(f'Total.bound must be "exactly", "at most" or "at least", not {self.bound!r}')
        prove_given(self, duration_s="time")


@dataclass(frozen=True, slots=True)
class Play:
    """``play``: all statements of another icon, which begins at baseline; ValueError for anything but an icon."""

    icon: "Icon"
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if not hasattr(self.icon, "statements") or not hasattr(self.icon, "corners"):
            raise ValueError(f"Play.icon must be an Icon, not {self.icon!r}")


@dataclass(frozen=True, slots=True)
class Broken:
    """A placeholder for a statement that could not be read while a file is checked; no icon holds one."""

    span: Span = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Repeat:
    """``repeat``: a body of statements, count times over; ValueError without a body or a positive whole count."""

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


def played_icons(body: tuple[Statement, ...]) -> "Iterator[Icon]":
    """Yield the icons that statements play, in order, those within repeats included."""
    for part in body:
        if isinstance(part, Play):
            yield part.icon
        elif isinstance(part, Repeat):
            yield from played_icons(part.body)  # type: ignore[arg-type]


def all_played(body: tuple[Statement, ...], seen: set[int] | None = None) -> "Iterator[Icon]":
    """Yield the icons that statements play, and those that these play in turn, each object once."""
    seen = set() if seen is None else seen
    for icon in played_icons(body):
        if id(icon) not in seen:
            seen.add(id(icon))
            yield icon
            yield from all_played(icon.statements, seen)


def _prove_heading(owner: Ramp | Step | Pulse) -> None:
    name, by_A, to_A = type(owner).__name__, getattr(owner, "by_A", None), getattr(owner, "to_A", None)
    if owner.direction not in get_args(Heading):
        raise ValueError(f'{name}.direction must be "warm", "cool" or "change", not {owner.direction!r}')
    if owner.direction != "change" and (by_A is not None or to_A is not None):
        raise ValueError(f'{name}: a current is changed, not "{owner.direction}"ed')
    if by_A == 0:
        raise ValueError(f"{name}.by_A = 0: a change must not be zero")
