"""The best k places of a pool, by one objective: exact where that can be proven, else the best of seeded restarts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .max_min_subset import Limits, UndecidedError, max_min_subset
from .request import ChoiceError
from .subset_identification import Objective, SubsetIdentification

ENUMERATED = 20
MOST_SUBSETS = 200_000
"""Pools of up to 20 icons, and all with at most this many choices, are enumerated completely."""
ALIKE = -1.0
"""Stands for d′ between two icons that are never chosen together, such as members of one family."""
LEAST_GAIN = 1e-9
"""A swap that gains no more is rounding."""
RESTARTS = 6
"""Random choices that larger pools are also climbed from."""
FARTHEST = 12.0
"""d′ beyond which two icons alone lose nothing."""


@dataclass(frozen=True, slots=True)
class SubsetChoice:
    """Places of the chosen icons, the objective's value, its bound, whether it is reached, and choices examined."""

    chosen: tuple[int, ...]
    value: float
    bound: float
    optimal: bool
    seen: int


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
        try:
            best = max_min_subset(middle, count, must, within)
        except UndecidedError:
            raise ChoiceError(
                "it could not be decided whether any choice keeps the totals: relax one of them"
            ) from None
        if best is None:
            return None
        return SubsetChoice(best.chosen, best.value, best.bound, best.proven, best.thresholds)
    n, free = len(middle), count - len(must)
    if n <= ENUMERATED or math.comb(n - len(must), free) <= MOST_SUBSETS:
        optimum = namings.enumerated(count, objective, must, within.costs, within.most)
        return None if optimum is None else SubsetChoice(optimum[0], optimum[1], optimum[1], True, optimum[2])
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
    bound = upper_bound(namings, count, objective)
    return SubsetChoice(best, value, max(bound, value), value >= bound, seen)


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


def upper_bound(pool: SubsetIdentification, count: int, objective: Objective) -> float:
    """What no `count` icons of the pool exceed: proportion correct, bits, or bits a second.

    Every k icons hold a pair at least as bad as the worst pair of the best k; without that pair the k − 2 left hold one
    at least as bad as that of the best k − 2; and so on. Each of these pairs costs what it costs two icons alone. The
    bound may be loose: it knows nothing of three icons that confuse each other. For bits, it is one of noise-free
    presentations; the share that finitely many of them add is allowed for.
    """
    kept = float(np.mean(1.0 - pool.lapse))
    if objective == "correct":
        return kept + (1.0 - kept) / count - _disjoint(pool.pair_errors(), count) / count
    lost = _disjoint(pair_losses(pool), count) * 2.0 / count
    draws = pool.push.shape[2]
    allowed = (count - 1) ** 2 / (2.0 * count * draws * math.log(2.0))
    bits = float(min(math.log2(count) - lost + allowed, math.log2(count)))
    if objective == "bits":
        return bits
    return bits / float(np.sort(pool.durations_s)[:count].mean())


def pair_losses(pool: SubsetIdentification) -> Array:
    """Bits lost between the two of each pair by the best that anybody could do, mean over people: (n, n)."""
    distances = np.sqrt(2.0 * np.maximum(pool.half, 0.0))
    grid, lost = _loss_table()
    losses: Array = np.interp(distances, grid, lost, right=0.0).mean(axis=0)
    np.fill_diagonal(losses, 0.0)
    return losses


def _disjoint(badness: Array, count: int) -> float:
    """The least that the worst pairs of any `count` things add up to, taken one after the other without overlap."""
    total = 0.0
    for left in range(count, 1, -2):
        found = max_min_subset(-badness, left)
        if found is not None:
            total += max(-found.bound, 0.0)
    return total


@lru_cache(maxsize=1)
def _loss_table() -> tuple[Array, Array]:
    """Uncertainty (bits) that is left about which of two points d apart was felt with unit noise."""
    x = np.linspace(-9.0, 9.0, 2001)
    density = np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    grid = np.linspace(0.0, FARTHEST, 601)
    odds = grid[:, None] * x + 0.5 * grid[:, None] ** 2
    # log2(1 + e^-odds): what a presentation leaves to ask, whichever of the two it was.
    left = np.asarray(np.trapezoid(density * np.logaddexp(0.0, -odds) / math.log(2.0), x, axis=1))
    return grid, left
