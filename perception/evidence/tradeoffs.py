"""What goes with what: predictions over the observers that the data leave possible, two at a time.

Unmeasured constants move several predictions at once. Where what brings one nearer to its published
number takes another away from its own, no choice of those constants can satisfy both.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array

STRONG = 0.5
RARE = 0.001
FEWEST = 8
"""Draws below which no correlation is reported."""


@dataclass(frozen=True, slots=True)
class Answers:
    """What every plausible observer answers to one row (inf: not felt), which of them satisfy it, and its label.

    `away` is +1 where the nominal prediction is too high, −1 where it is too low, 0 where it holds.
    """

    label: str
    each: tuple[float, ...]
    holds: tuple[bool, ...]
    away: int


@dataclass(frozen=True, slots=True)
class TradeOff:
    """Two rows over the same observers: Spearman's correlation (None: one does not vary), shares that hold.

    `both_miss` is said of the nominal predictions. `against` is True where both miss and what mends one worsens the
    other, False where it mends both, and None where not both miss or the correlation is weak. `rarer`: so few observers
    satisfy both that chance alone would give as few or fewer with a probability below 0.001 (Fisher's exact test,
    one-sided).
    """

    first: str
    second: str
    correlation: float | None
    first_holds: float
    second_holds: float
    both_hold: float
    both_miss: bool
    against: bool | None
    rarer: bool

    @property
    def by_chance(self) -> float:
        """Share that would satisfy both if the two had nothing to do with each other."""
        return self.first_holds * self.second_holds


def trade_offs(rows: Sequence[Answers]) -> tuple[TradeOff, ...]:
    """Every pair of rows, in their order; nothing from fewer than eight observers."""
    found = []
    for k, first in enumerate(rows):
        for second in rows[k + 1 :]:
            n = len(first.each)
            if n < FEWEST or len(second.each) != n:
                continue
            rho = correlation(first.each, second.each)
            a, b = (float(np.mean(one.holds)) for one in (first, second))
            both = float(np.mean(np.logical_and(first.holds, second.holds)))
            strong = rho is not None and abs(rho) >= STRONG
            against = None
            if strong and rho is not None and first.away and second.away:
                against = first.away * second.away * rho < 0.0
            missed = bool(first.away and second.away)
            rarer = chance_of_as_few(n, round(a * n), round(b * n), round(both * n)) < RARE
            found.append(TradeOff(first.label, second.label, rho, a, b, both, missed, against, rarer))
    return tuple(found)


def chance_of_as_few(n: int, first: int, second: int, both: int) -> float:
    """Probability that of n observers at most `both` satisfy two rows, which `first` and `second` of them satisfy.

    >>> round(chance_of_as_few(10, 5, 5, 0), 5), chance_of_as_few(10, 10, 5, 5)
    (0.00397, 1.0)
    """
    ways = [math.comb(first, k) * math.comb(n - first, second - k) for k in range(min(both, second) + 1)]
    return sum(ways) / math.comb(n, second)


def correlation(first: Sequence[float], second: Sequence[float]) -> float | None:
    """Spearman's rank correlation; inf ranks last, None where one of the two does not vary.

    >>> correlation((1.0, 2.0, 4.0), (10.0, 20.0, float("inf")))
    1.0
    """
    ranks = [_ranks(one) for one in (first, second)]
    spread = [rank.std() for rank in ranks]
    if min(spread) == 0.0:
        return None
    centred = [rank - rank.mean() for rank in ranks]
    found = float((centred[0] * centred[1]).mean() / (spread[0] * spread[1]))
    return None if math.isnan(found) else round(found, 12)


def _ranks(values: Sequence[float]) -> Array:
    """Ranks with ties shared."""
    held = np.asarray(values, dtype=np.float64)
    _, place, count = np.unique(held, return_inverse=True, return_counts=True)
    upper = np.cumsum(count)
    ranks: Array = (upper - 0.5 * (count - 1))[place]
    return ranks
