"""Components of the distance of two icons: direction, intensity, rate, duration, pattern, onset.

Each has its unit and the value that is just noticeable back to back.
Direction, rate and onset go by the rules of thumb on pairs; intensity and pattern by the sensory noise,
which is 1 d′; duration by the uncertainty of the two moments that bound it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..identification.distance import smooth
from ..observer.observer import CHANNELS, Channel, Observer
from ..sensation.features import directions, excursion_rate_K_per_s
from ..sensation.percept import Percept, perceive
from .rules import load_rules

if TYPE_CHECKING:
    from thermicon.circuit import Trace

COMPONENTS = ("direction", "intensity", "rate", "duration", "pattern", "onset")
SENSORY_NOISE = 1.0
HALF = 0.5
LEAST_SENSATION = 0.05
"""A course that stays below this (d′) has no duration, rate or pattern."""
BLUR_REACH = 6.0
"""The blur of an onset has faded after this many times its uncertainty."""
GRID = np.linspace(-0.5, 2.0, 251)
"""Where courses are compared, in durations after the first half of the peak."""


@dataclass(frozen=True, slots=True)
class DistanceComponent:
    """One component of the distance of two icons.

    Attributes
    ----------
    name
        `direction`, `intensity`, `rate`, `duration`, `pattern` or `onset`.
    value
        The difference; None where there is nothing to compare, as for an icon that is not felt.
    unit
        Unit of `value`; a rate is a factor, whose unit is 1, of two rates in K/s.
    noticeable
        Value that is just noticeable back to back, in the same unit.
    a, b
        Values of each icon, where each has one.

    See Also
    --------
    distance_components : Computes all six.
    """

    name: str
    value: float | None
    unit: str
    noticeable: float
    a: float | None = None
    b: float | None = None

    @property
    def above(self) -> bool | None:
        """Whether it is at least just noticed; None where there is nothing to compare."""
        return None if self.value is None else self.value >= self.noticeable

    @property
    def times(self) -> float | None:
        """How often the just noticeable value goes into it; factors by their logarithms.

        >>> DistanceComponent("onset", 0.5, "s", 0.2).times, round(DistanceComponent("rate", 2.0, "1", 1.43).times, 2)
        (2.5, 1.94)
        """
        if self.value is None:
            return None
        if self.unit == "1":
            return math.log(self.value) / math.log(self.noticeable)
        return self.value / self.noticeable

    def to_dict(self) -> dict[str, str | float | bool | None]:
        """The keys of the ranking file."""
        return {
            "part": self.name,
            "value": self.value,
            "unit": self.unit,
            "noticeable": self.noticeable,
            "above": self.above,
            "a": self.a,
            "b": self.b,
        }

    def __repr__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        if self.value is None:
            return f"DistanceComponent({self.name}: nothing to compare)"
        return f"DistanceComponent({self.name} {self.value:.3g}{unit}, just noticeable {self.noticeable:.3g}{unit})"


@dataclass(frozen=True, slots=True)
class Course:
    """What one icon brings to every comparison: order of directions, rates, felt onset and the course of sensation.

    `peak` is the largest smoothed sensation of a channel in d′ and `total` √(cold² + warm²) of both over the time
    since the first half of its peak, in shares of that peak, on `GRID`. `strongest` is that peak and `duration_s` the
    time from first to last half of it (None: nothing felt).
    """

    order: tuple[Channel, ...]
    rate_K_per_s: dict[Channel, float]
    peak: dict[Channel, float]
    strongest: float
    duration_s: float | None
    total: Array
    onset_s: float | None
    channel: Channel | None


def distance_components(
    a: Trace, b: Trace, observer: Observer | None = None, felt: tuple[Percept, Percept] | None = None
) -> tuple[DistanceComponent, ...]:
    """Split the distance of two simulated icons for a nominal person into six components.

    `direction` is the strongest sensation (d′) in a direction whose place in the order of directions differs;
    `intensity` the difference of the strongest sensations (d′); `rate` the factor between the steepest rates at a
    receptor, that of the first direction where the two share none; `duration` and `onset` are differences in s;
    `pattern` is the largest difference (d′) that remains of the courses of total sensation when onset, duration and
    intensity are made the same.

    Parameters
    ----------
    a, b
        Traces of `simulate`.
    observer
        The person (None: the nominal one).
    felt
        Percepts of the two, where they are known already.

    Returns
    -------
    tuple of DistanceComponent
        Direction, intensity, rate, duration, pattern, onset.

    Raises
    ------
    ValueError
        For traces without a uniform clock.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import read_cue
    >>> icons, rig = read_cue("six-icons"), Rig.load("thenar")
    >>> parts = distance_components(*(simulate(icons[name], rig) for name in ("cooling-step", "warming-step")))
    """
    person = Observer.load() if observer is None else observer
    percepts = (perceive(a, person), perceive(b, person)) if felt is None else felt
    first, second = (course(trace, percept, person) for trace, percept in zip((a, b), percepts, strict=True))
    return course_components(first, second, person)


def course(trace: Trace, felt: Percept, observer: Observer) -> Course:
    """What one icon brings to its comparisons; compute it once for an icon that is compared with many."""
    # The blur reaches back before the start of the cue, so that a cue that starts later has the same course.
    ahead = math.ceil(BLUR_REACH * observer.onset_uncertainty_s / felt.dt_s)
    psi = np.pad(np.stack([felt.psi_cold, felt.psi_warm]), ((0, 0), (ahead, 0)), mode="edge")
    cold, warm = smooth(psi, felt.dt_s, observer.onset_uncertainty_s)
    total = np.hypot(cold, warm)
    strongest, duration, shape = float(total.max()), None, np.zeros(GRID.size)
    if strongest >= LEAST_SENSATION:
        start, end = _half_times(total, felt.dt_s)
        duration = max(end - start, felt.dt_s)
        shape = np.interp(start + GRID * duration, felt.dt_s * np.arange(total.size), total) / strongest
    order = directions(trace)
    return Course(
        order=order,
        rate_K_per_s={channel: abs(excursion_rate_K_per_s(trace, channel)) for channel in order},
        peak={"cold": float(cold.max()), "warm": float(warm.max())},
        strongest=strongest,
        duration_s=duration,
        total=shape,
        onset_s=felt.onset_s,
        channel=felt.channel,
    )


def course_components(a: Course, b: Course, observer: Observer) -> tuple[DistanceComponent, ...]:
    """The six components from the courses of the two icons."""
    weaker = min(a.strongest, b.strongest)
    moments = math.sqrt(2.0) * observer.onset_uncertainty_s
    duration = _apart(a.duration_s, b.duration_s)
    pattern = None if duration is None else weaker * float(np.abs(a.total - b.total).max())
    return (
        DistanceComponent("direction", _direction(a, b), "d′", observer.criterion),
        DistanceComponent("intensity", abs(a.strongest - b.strongest), "d′", SENSORY_NOISE, a.strongest, b.strongest),
        _rate(a, b),
        DistanceComponent("duration", duration, "s", moments, a.duration_s, b.duration_s),
        DistanceComponent("pattern", pattern, "d′", SENSORY_NOISE),
        _onset(a, b),
    )


def _direction(a: Course, b: Course) -> float:
    """Strongest sensation in a direction that comes at another place in the order, or in one of the two alone."""
    other = [
        max(one.peak[channel] for one in (a, b) if channel in one.order)
        for channel in CHANNELS
        if _place(a, channel) != _place(b, channel)
    ]
    return max(other, default=0.0)


def _place(one: Course, channel: Channel) -> int | None:
    return one.order.index(channel) if channel in one.order else None


def _rate(a: Course, b: Course) -> DistanceComponent:
    """The largest factor between rates in a shared direction; else that between the rates of the first directions."""
    needed = load_rules().one("rate ratio").central
    shared = [(a.rate_K_per_s[channel], b.rate_K_per_s[channel]) for channel in a.order if channel in b.order]
    if not shared and a.order and b.order:
        shared = [(a.rate_K_per_s[a.order[0]], b.rate_K_per_s[b.order[0]])]
    moving = [(x, y) for x, y in shared if min(x, y) > 0.0]
    if not moving:
        return DistanceComponent("rate", None, "1", needed)
    x, y = max(moving, key=lambda pair: max(pair) / min(pair))
    return DistanceComponent("rate", max(x, y) / min(x, y), "1", needed, x, y)


def _onset(a: Course, b: Course) -> DistanceComponent:
    both: Channel = "warm" if a.channel == b.channel == "warm" else "cold"
    needed = load_rules().one("onset", channel=both).central
    return DistanceComponent("onset", _apart(a.onset_s, b.onset_s), "s", needed, a.onset_s, b.onset_s)


def _apart(a: float | None, b: float | None) -> float | None:
    return None if a is None or b is None else abs(a - b)


def _half_times(total: Array, dt_s: float) -> tuple[float, float]:
    """First and last moment (s) at which a course has half its peak, between samples by straight lines."""
    half = HALF * float(total.max())
    over = np.flatnonzero(total >= half)
    first, last = int(over[0]), int(over[-1])
    start, end = float(first), float(last)
    if first > 0:
        start -= (total[first] - half) / (total[first] - total[first - 1])
    if last < total.size - 1:
        end += (total[last] - half) / (total[last] - total[last + 1])
    return dt_s * float(start), dt_s * float(end)
