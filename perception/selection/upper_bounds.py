"""What no choice of k can exceed, when not every choice can be looked at.

Every k icons hold a pair at least as bad as the worst pair of the best k; without that pair the k − 2 left hold one at
least as bad as that of the best k − 2; and so on. Each of these pairs costs what it costs two icons alone. The bounds
may be loose: they know nothing of three icons that confuse each other.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from ..arrays import Array
from .max_min_subset import max_min_subset
from .subset_identification import Objective, SubsetIdentification

FARTHEST = 12.0


def upper_bound(pool: SubsetIdentification, count: int, objective: Objective) -> float:
    """What no `count` icons of the pool exceed: proportion correct, bits, or bits a second.

    For bits, one of noise-free presentations; the share that finitely many of them add is allowed for.
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
