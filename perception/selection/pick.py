"""The best k places of a pool, by one objective: exact where all can be looked at, else the best of seeded restarts."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .max_min_subset import Limits, SubsetChoice, max_min_subset
from .request import Objective
from .subset_identification import SubsetIdentification

MOST_SUBSETS = 200_000
"""Pools with at most this many choices, such as all of up to 20 icons, are enumerated completely."""
ALIKE = -1.0
"""Stands for d′ between two icons that are never chosen together, such as members of one family."""
LEAST_GAIN = 1e-9
"""A swap that gains no more is rounding."""
RESTARTS = 6
"""Random choices that larger pools are also climbed from."""


def pick(
    middle: Array,
    namings: SubsetIdentification | None,
    count: int,
    objective: Objective,
    must: Sequence[int] = (),
    limits: Limits | None = None,
    seed: int = 0,
) -> SubsetChoice | None:
    """The best `count` by one objective: of median d′ (n, n) for `worst`, else of the namings; None: no choice fits."""
    within = limits or Limits.none(len(middle))
    if namings is None or objective == "worst":
        return max_min_subset(middle, count, must, within)
    if math.comb(len(middle) - len(must), count - len(must)) <= MOST_SUBSETS:
        optimum = namings.enumerated(count, objective, must, within)
        return None if optimum is None else SubsetChoice(optimum[0], optimum[1], optimum[1], optimum[2])
    return _climbed(middle, namings, count, objective, must, within, seed)


def _climbed(
    middle: Array,
    namings: SubsetIdentification,
    count: int,
    objective: Objective,
    must: Sequence[int],
    limits: Limits,
    seed: int,
) -> SubsetChoice | None:
    """The best of the widest choice and of random ones, each improved by single swaps until none helps."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 6]))
    others = [k for k in range(len(middle)) if k not in must]
    widest = pick(middle, None, count, "worst", must, limits)
    if widest is None:
        return None
    drawn = [
        (*must, *sorted(int(k) for k in rng.choice(others, count - len(must), replace=False))) for _ in range(RESTARTS)
    ]
    best, value, seen = widest.chosen, -math.inf, 0
    for start in [widest.chosen, *(one for one in drawn if limits.kept(one))]:
        chosen, score, looked = climb(namings, start, objective, middle, must, limits)
        seen += looked
        if score > value + 1e-12:
            best = tuple(sorted(chosen))
            value = namings.score(best, objective)
    return SubsetChoice(best, value, max(ceiling(namings, count, objective), value), seen)


def ceiling(namings: SubsetIdentification, count: int, objective: Objective) -> float:
    """What `count` icons that are never confused would score: lapses are answered at random."""
    kept = float(np.mean(1.0 - namings.lapse))
    if objective == "correct":
        return kept + (1.0 - kept) / count
    shortest = np.sort(namings.durations_s)[:count].mean()
    return math.log2(count) if objective == "bits" else float(math.log2(count) / shortest)


def climb(
    namings: SubsetIdentification,
    start: Sequence[int],
    objective: Objective,
    middle: Array,
    must: Sequence[int],
    limits: Limits,
) -> tuple[list[int], float, int]:
    """Single swaps that improve an objective until none does: the places, their score, and how many were tried."""
    chosen, score, tried = list(start), namings.score(start, objective), 0
    while True:
        allowed = swaps(chosen, middle, must, limits)
        found = namings.swapped(chosen, objective, allowed)
        tried += int(allowed.sum())
        place, other = (int(k) for k in np.unravel_index(int(found.argmax()), found.shape))
        if not found[place, other] > score + LEAST_GAIN:
            return chosen, score, tried
        score, chosen[place] = float(found[place, other]), other


def swaps(chosen: Sequence[int], middle: Array, must: Sequence[int], limits: Limits) -> NDArray[np.bool_]:
    """Which icon (chosen, n) may replace a chosen one: not one that must stay, none alike another, within limits."""
    allowed = np.ones((len(chosen), len(middle)), dtype=bool)
    allowed[:, list(chosen)] = False
    for place, thing in enumerate(chosen):
        rest = [k for k in chosen if k != thing]
        allowed[place] &= (middle[rest] > ALIKE).all(axis=0) & (thing not in must)
        if limits.most:
            for other in np.flatnonzero(allowed[place]):
                allowed[place, other] = limits.kept([*rest, int(other)])
    return allowed
