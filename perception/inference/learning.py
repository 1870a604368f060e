"""Where a surrogate learns: points around the maximum first, then points that the surrogate itself takes for likely."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .chains import Reference
from .posterior import Posterior
from .surrogate import Surrogate, fit_surrogate

AROUND, ROUNDS = 2400, (1200, 1200)
"""Points from the normal approximation, and from each next surrogate; a quadratic has 1431 coefficients a row."""
WALKERS, WARM_UP, BETWEEN = 12, 20, 2
"""Walkers along the surrogate, and trajectories before the first and between two points."""
Evaluate = Callable[[Array], Array]


@dataclass(frozen=True, slots=True)
class Points:
    """Where residuals are known: `vectors` (points, n) in SDs of the prior, `misses` (points, all rows) in SDs."""

    vectors: Array
    misses: Array

    def __len__(self) -> int:
        return int(self.vectors.shape[0])

    def joined(self, other: Points) -> Points:
        """Both together."""
        return Points(np.concatenate([self.vectors, other.vectors]), np.concatenate([self.misses, other.misses]))


def learn(
    posterior: Posterior,
    reference: Reference,
    seed: int,
    evaluate: Evaluate,
    known: Points | None = None,
    progress: Callable[[int], None] | None = None,
) -> tuple[Surrogate, Points]:
    """The surrogate of a posterior and the points that it was fitted to; `known` points of the same rows count too.

    `evaluate` gives the misses of all rows (points, rows) at vectors (points, n). What is learnt depends on the seed
    alone.
    """
    random = np.random.RandomState(np.random.MT19937(np.random.SeedSequence([seed, 1 << 20])))
    points = known
    if points is None:
        vectors = reference.vector(random.standard_normal((AROUND, reference.middle.size)))
        points = Points(vectors, evaluate(vectors))
    for size in ROUNDS:
        if progress is not None:
            progress(len(points))
        surrogate = fitted(posterior, reference, points)
        vectors = reference.vector(walked(surrogate, random, size))
        points = points.joined(Points(vectors, evaluate(vectors)))
    return fitted(posterior, reference, points), points


def fitted(posterior: Posterior, reference: Reference, points: Points) -> Surrogate:
    """The surrogate of the rows that count."""
    counted = posterior.counted
    return fit_surrogate(reference.white(points.vectors), points.misses[:, counted], reference.middle, reference.factor)


def walked(surrogate: Surrogate, random: np.random.RandomState, points: int) -> Array:
    """Coordinates (points, n) along the surrogate."""
    visited: list[Array] = []
    for _ in range(WALKERS):
        place = surrogate.walk(np.zeros(surrogate.middle.size), random, WARM_UP)
        for _ in range(points // WALKERS):
            place = surrogate.walk(place, random, BETWEEN)
            visited.append(place)
    return np.stack(visited)


def misses_at(posterior: Posterior, vectors: Sequence[Array] | Array) -> Array:
    """Misses of all rows, left out or not, at vectors (points, n)."""
    return np.stack([posterior.misses(vector) for vector in vectors])
