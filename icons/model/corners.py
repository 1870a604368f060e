"""Corner points: the form of an icon that every simulator reads."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Literal

from .motion import TOLERANCE, pieces
from .statements import Broken, Leaf, Play, Repeat, Statement

Quantity = Literal["temperature_C", "current_A"]
STEP_S = 1e-7
"""How long a step is written out: shorter than any statement; the time is taken from a neighbour."""


@dataclass(frozen=True, slots=True, repr=False)
class Corners:
    """Times (s) and values (°C or A, by ``quantity``) of equal number, straight lines between; at least two corners.

    ``steps`` lists the corners at which a step begins, to be made as fast as the driver can; it is written out over
    0.1 µs. Raises ValueError unless the times begin at 0 and rise strictly and all numbers are finite.
    """

    time_s: tuple[float, ...]
    value: tuple[float, ...]
    quantity: Quantity
    steps: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_s", tuple(float(time) for time in self.time_s))
        object.__setattr__(self, "value", tuple(float(value) for value in self.value))
        if self.quantity not in ("temperature_C", "current_A"):
            raise ValueError(f'quantity must be "temperature_C" or "current_A", not {self.quantity!r}')
        if len(self.time_s) != len(self.value) or len(self.time_s) < 2:
            raise ValueError(
                f"{len(self.time_s)} times and {len(self.value)} values: equal numbers, 2 or more, are needed"
            )
        if not all(map(math.isfinite, self.time_s + self.value)):
            raise ValueError("times and values must be finite")
        if self.time_s[0] != 0 or any(b <= a for a, b in pairwise(self.time_s)):
            raise ValueError("times must begin at 0 s and rise strictly")
        if any(not 0 <= place < len(self.time_s) - 1 for place in self.steps):
            raise ValueError(f"steps {self.steps} must each be a corner that another one follows")

    def __len__(self) -> int:
        return len(self.time_s)

    def __repr__(self) -> str:
        unit = "°C" if self.quantity == "temperature_C" else "A"
        count = len(self.steps)
        steps = f", {count} step{'s' if count > 1 else ''}" if count else ""
        return (
            f"Corners({len(self)} corners, {self.duration_s:.6g} s, {self.lowest:.6g} to {self.highest:.6g} {unit}, "
            f"at most {self.steepest_per_s:.6g} {unit}/s{steps})"
        )

    @property
    def duration_s(self) -> float:
        """The time of the last corner, in s."""
        return self.time_s[-1]

    @property
    def lowest(self) -> float:
        """The lowest value, in °C or A."""
        return min(self.value)

    @property
    def highest(self) -> float:
        """The highest value, in °C or A."""
        return max(self.value)

    @property
    def steepest_per_s(self) -> float:
        """The size of the steepest slope that is not a step, in K/s or A/s."""
        points, steps = list(zip(self.time_s, self.value, strict=True)), set(self.steps)
        slopes = (abs(b[1] - a[1]) / (b[0] - a[0]) for n, (a, b) in enumerate(pairwise(points)) if n not in steps)
        return max(slopes, default=0.0)


def written_out(body: Sequence[Statement | Broken]) -> Iterator[Leaf]:
    """Yield every statement in the order in which it is played, repeats and played icons written out."""
    for part in body:
        if isinstance(part, Repeat):
            for _ in range(part.count):
                yield from written_out(part.body)
        elif isinstance(part, Play):
            yield from written_out(part.icon.statements)
        elif not isinstance(part, Broken):
            yield part


def corners(body: Sequence[Statement], start: Fraction, quantity: Quantity, tolerance: float = TOLERANCE) -> Corners:
    """Return the corner points of a checked body that starts at, and rests at, the level ``start`` (°C or A).

    Times and levels add up as exact fractions; neighbours on one straight line are merged. A sine is followed to
    within ``tolerance`` (K or A), everything else exactly.
    """
    times, levels = [Fraction(0)], [start]
    slope: Fraction | None = None
    before = slope
    level = start
    for leaf in written_out(body):
        for target, duration in pieces(leaf, level, start, tolerance):
            level = target
            if duration == 0:
                if len(times) > 1 and times[-1] == times[-2]:  # two steps in one moment are one
                    times.pop()
                    levels.pop()
                    slope = before
                if target != levels[-1]:
                    times.append(times[-1])
                    levels.append(target)
                    before, slope = slope, None
            elif (steepness := (target - levels[-1]) / duration) == slope:
                times[-1] += duration
                levels[-1] = target
            else:
                times.append(times[-1] + duration)
                levels.append(target)
                slope = steepness
    # The ends of every step are drawn apart, by less than a neighbour: the later end moves, or at the end the earlier.
    apart = Fraction(STEP_S).limit_denominator(10**9)
    steps = [n for n, (a, b) in enumerate(pairwise(times)) if a == b]
    for n in steps:
        if times[n] == times[-1]:
            times[n] -= min(apart, (times[n] - times[n - 1]) / 2)
        else:
            times[n + 1] += min(apart, (times[n + 2] - times[n + 1]) / 2)
    rising = [0.0]
    for time in times[1:]:
        rising.append(max(float(time), math.nextafter(rising[-1], math.inf)))
    return Corners(tuple(rising), tuple(map(float, levels)), quantity, tuple(steps))
