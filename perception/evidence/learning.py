"""Where a surrogate learns: around the maximum, then where it walks itself, then where chains of the posterior go.

The last matters most: a surrogate never goes where it is wrongly low, but a chain that gets there by small steps stays
until the surrogate knows the place.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.circuit.cores import quiet_blas

from ..arrays import Array
from .chains import Chain, Reference, begin
from .posterior import Posterior
from .surrogate import NARROW, WIDE, LimitFeatures, Surrogate, fit_surrogate

AROUND, ROUNDS = 2400, (1200, 1200)
"""Points from the normal approximation, and from each next surrogate; a quadratic has 1431 coefficients a row."""
CHAINS, CHAIN_ROUNDS, CHAIN_STEPS = 4, 6, 250
"""Chains that visit the posterior while the surrogate learns, how often it learns from them, and steps in between."""
WALKERS, WARM_UP, BETWEEN = 12, 20, 2
"""Walkers along the surrogate, and trajectories before the first and between two points."""
Evaluate = Callable[[Array], Array]
Visit = Callable[[Sequence[Chain], Reference, Surrogate], Sequence[tuple[Chain, "Points"]]]
"""Extends chains by CHAIN_STEPS each, and gives the points where they looked."""


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
    visit: Visit,
    progress: Callable[[int], None] | None = None,
) -> tuple[Surrogate, Reference, Points, tuple[Chain, ...]]:
    """The surrogate of a posterior, its coordinates, the points it was fitted to, and chains that have warmed up.

    `reference` is the normal approximation at the maximum; the posterior is wider, so that each round's walk gives the
    coordinates of the next. `evaluate` gives the misses of all rows (points, rows) at vectors (points, n). What is
    learnt depends on the seed alone.
    """
    random = np.random.RandomState(np.random.MT19937(np.random.SeedSequence([seed, 1 << 20])))
    vectors = reference.vector(random.standard_normal((AROUND, reference.middle.size)))
    points = Points(vectors, evaluate(vectors))
    for size in ROUNDS:
        if progress is not None:
            progress(len(points))
        surrogate = fitted(posterior, reference, points)
        vectors = reference.vector(walked(surrogate, random, size))
        points = points.joined(Points(vectors, evaluate(vectors)))
        reference = Reference.at(vectors.mean(axis=0), np.cov(vectors.T))
    chains = tuple(begin(reference.middle.size, seed, number) for number in range(CHAINS))
    for _ in range(CHAIN_ROUNDS):
        if progress is not None:
            progress(len(points))
        visited = visit(chains, reference, fitted(posterior, reference, points, WIDE))
        chains = tuple(chain for chain, _ in visited)
        for _, seen in visited:
            points = points.joined(seen)
    return fitted(posterior, reference, points, WIDE), reference, points, tuple(chain.last for chain in chains)


class Recorder:
    """A posterior that remembers where it was looked at."""

    def __init__(self, posterior: Posterior) -> None:
        self.posterior = posterior
        self.seen: list[tuple[Array, Array]] = []

    def residuals(self, vector: Array) -> Array:
        """Residuals of the posterior."""
        misses = self.posterior.misses(vector)
        self.seen.append((vector, misses))
        return np.concatenate([misses[self.posterior.counted], vector])

    @property
    def points(self) -> Points:
        """All points so far."""
        return Points(np.stack([vector for vector, _ in self.seen]), np.stack([misses for _, misses in self.seen]))


def fitted(
    posterior: Posterior, reference: Reference, points: Points, reach: tuple[float, float] = NARROW
) -> Surrogate:
    """The surrogate of the rows that count."""
    counted = posterior.counted
    return fit_surrogate(
        reference.white(points.vectors),
        points.misses[:, counted],
        reference.middle,
        reference.factor,
        LimitFeatures.of(posterior.priors),
        reach,
    )


def walked(surrogate: Surrogate, random: np.random.RandomState, points: int) -> Array:
    """Coordinates (points, n) along the surrogate."""
    visited: list[Array] = []
    for _ in range(WALKERS):
        place = surrogate.walk(np.zeros(surrogate.middle.size), random, WARM_UP)
        for _ in range(points // WALKERS):
            place = surrogate.walk(place, random, BETWEEN)
            visited.append(place)
    return np.stack(visited)


def misses_at(part: tuple[Posterior, Array]) -> Array:
    """Misses (points, rows) of all rows, left out or not, at vectors (points, n); a job of one worker process."""
    posterior, vectors = part
    with quiet_blas():
        return np.stack([posterior.misses(vector) for vector in vectors])
