"""Shapes that a statement may take beside the ramp: step, pulse and the four waves, as frozen statements."""

from dataclasses import dataclass, field
from typing import Literal, get_args

from .units import Span, prove, prove_given, prove_one_of

Shape = Literal["sine", "square", "triangle", "sawtooth"]
Start = Literal["warm", "cool", "up", "down"]
Heading = Literal["warm", "cool", "change"]


@dataclass(frozen=True, slots=True)
class Step:
    """``step``: to another level as fast as the driver can: by K or A, or to °C or A; it takes no time.

    With ``warm`` or ``cool`` a difference is positive and in K; with ``change`` it is signed. ValueError otherwise.

    >>> Step("change", by_K=-6)
    Step(direction='change', by_K=-6.0, to_C=None, by_A=None, to_A=None)
    """

    direction: Heading = "change"
    by_K: float | None = None
    to_C: float | None = None
    by_A: float | None = None
    to_A: float | None = None
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_one_of(self, "by_K", "to_C", "by_A", "to_A")
        _prove_heading(self, self.direction, self.by_A is not None or self.to_A is not None)
        prove(self, by_K="change" if self.direction == "change" else "difference", to_C="absolute")
        _prove_current_change(self, self.by_A)
        prove(self, by_A="current", to_A="current")


@dataclass(frozen=True, slots=True)
class Pulse:
    """``pulse``: a step by K or A, held for a time (s), and a step back; signed unless ``warm`` or ``cool``.

    >>> Pulse("cool", by_K=3, duration_s=0.5)
    Pulse(direction='cool', by_K=3.0, by_A=None, duration_s=0.5)
    """

    direction: Heading = "change"
    by_K: float | None = None
    by_A: float | None = None
    duration_s: float = 1.0
    span: Span = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        prove_one_of(self, "by_K", "by_A")
        _prove_heading(self, self.direction, self.by_A is not None)
        prove(self, by_K="change" if self.direction == "change" else "difference")
        _prove_current_change(self, self.by_A)
        prove(self, by_A="current")
        prove_given(self, duration_s="time")


@dataclass(frozen=True, slots=True)
class Wave:
    """A wave about the present level: amplitude in K or A, period and duration in s, and which way it starts.

    Unless ``cut``, the duration holds whole periods, so that the wave ends where it began. ``warm`` and ``up`` start
    upwards, ``cool`` and ``down`` downwards. Raises ValueError otherwise.

    >>> Wave("sine", by_K=3, period_s=4, duration_s=12, start="cool")
    Wave(shape='sine', by_K=3.0, by_A=None, period_s=4.0, duration_s=12.0, start='cool', cut=False)
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


def _prove_heading(owner: object, direction: str, current: bool) -> None:
    if direction not in get_args(Heading):
        raise ValueError(f'{type(owner).__name__}.direction must be "warm", "cool" or "change", not {direction!r}')
    if current and direction != "change":
        raise ValueError(f'{type(owner).__name__}: a current is changed, not "{direction}"ed')


def _prove_current_change(owner: object, by_A: float | None) -> None:
    if by_A == 0:
        raise ValueError(f"{type(owner).__name__}.by_A = 0: a change must not be zero")
