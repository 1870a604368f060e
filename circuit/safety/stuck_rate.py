"""The current limit of a driver that keeps the skin's rate of change wherever it gets stuck."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .single_faults import Faulty, Moments

RATE = "rate of skin temperature"
Span = tuple[float, float]

ROOM = 0.97
"""Share of the limit that is used: the worst instant is searched for, not proven."""
NEAR = 0.9
"""Where the skin is this near to the fastest at the driver's own limit, a narrower one is tried."""
STEP_A = 0.01
"""Current limits are stated in such steps."""


@dataclass(frozen=True, slots=True)
class Limited:
    """Between which currents in A a driver that gets stuck must stay by itself: None where its own limits suffice.

    `rate_K_per_s` is the fastest skin: at its own limits, or, where the drives need so much that narrower limits do not
    keep the limit of rate either (`kept`), at these.
    """

    limit_A: Span | None
    rate_K_per_s: float
    kept: bool = True


def limited(drives: Sequence[Faulty], moments: Sequence[Moments]) -> Limited:
    """The widest limits for drives of a set, each stuck at moments of its own: alike for both signs where possible."""
    rule = next(rule for rule in drives[0].limits.rules if rule.quantity == RATE and rule.severity == "hard")
    most = ROOM * rule.limit

    def rate(current_A: float, at: Sequence[Moments]) -> float:
        return max(float(one.rates_K_per_s(stuck, current_A).max()) for one, stuck in zip(drives, at, strict=True))

    ends_A = drives[0].ends_A
    rates = [rate(end_A, moments) for end_A in ends_A]
    if max(rates) <= most:
        return Limited(None, max(rates))
    needs_A = [
        max(max(float((sign * one.drive.current_A).max()), sign * one.rest_A, 0.0) for one in drives)
        for sign in (-1.0, 1.0)
    ]
    widest_A = [
        abs(end_A) if fast <= most else _widest_A(drives, moments, end_A, most)
        for end_A, fast in zip(ends_A, rates, strict=True)
    ]
    alike_A = min(widest_A)
    if alike_A >= max(needs_A):
        return Limited((-alike_A, alike_A), max(rates))
    below_A, above_A = (
        max(widest, min(abs(end_A), STEP_A * math.ceil(need / STEP_A - 1e-9)))
        for widest, need, end_A in zip(widest_A, needs_A, ends_A, strict=True)
    )
    limit_A = -round(below_A, 2), round(above_A, 2)
    needed = max(rate(end_A, moments) for end_A in limit_A)
    kept = needed <= rule.limit
    return Limited(limit_A, max(rates) if kept else needed, kept)


def _widest_A(drives: Sequence[Faulty], moments: Sequence[Moments], end_A: float, most_K_per_s: float) -> float:
    """The greatest current in A of a sign, in whole steps below an end, at which the skin is slow enough."""
    fastest = []
    for one, stuck in zip(drives, moments, strict=True):
        rates = one.rates_K_per_s(stuck, end_A)
        fastest.append(stuck.take(np.flatnonzero(rates >= NEAR * rates.max())))

    def slow_enough(steps: int) -> bool:
        current_A = math.copysign(STEP_A * steps, end_A)
        rates = [one.rates_K_per_s(stuck, current_A).max() for one, stuck in zip(drives, fastest, strict=True)]
        return bool(max(rates) <= most_K_per_s)

    low, high = 0, math.ceil(abs(end_A) / STEP_A)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if slow_enough(middle) else (low, middle)
    return round(STEP_A * low, 2)
