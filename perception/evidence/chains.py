"""Markov chains of a posterior.

In coordinates w where the normal approximation at the maximum is standard normal, a step is one of three, drawn anew:

- where trajectories along the surrogate end, accepted by the ratio of posterior to surrogate (`surrogate`);
- √(1 − β²)·w + β·ξ with ξ standard normal, accepted by the ratio of posterior to approximation (preconditioned
  Crank–Nicolson; Cotter, Roberts, Stuart & White 2013);
- w + ξ of a length for many dimensions, accepted by the posterior: a random walk, for the tails.

emcee runs the chains. The surrogate learns around the maximum, then where it walks itself, then where chains of the
posterior go. The last matters most: a surrogate never goes where it is wrongly low, but a chain that gets there by
small steps stays until the surrogate knows the place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from thermicon.base.files.records import RecordError
from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.cores import quiet_blas

from .posterior import Posterior
from .surrogate import NARROW, WIDE, LimitFeatures, Surrogate, fit_surrogate

LONG, MIDDLE = 0.7, 0.85
"""Shares of the steps: along the surrogate up to the first, Crank–Nicolson up to the second, then random walk."""
TRAJECTORIES = 3
BETA, WALK = 0.3, 1.7
"""β of Crank–Nicolson; length of a random walk in SDs over the root of the number of constants."""


IMPOSSIBLE = -1e300


@dataclass(frozen=True, slots=True)
class Reference:
    """The normal approximation: `middle` (n,) and lower triangular `factor` (n, n), in SDs of the prior."""

    middle: Array
    factor: Array

    @classmethod
    def at(cls, middle: Array, covariance: Array) -> Reference:
        """The approximation by its middle and covariance."""
        return cls(middle, np.linalg.cholesky(covariance).astype(np.float64))

    def vector(self, white: Array) -> Array:
        """Vectors (..., n) of the posterior from coordinates in which the approximation is standard normal."""
        return self.middle + white @ self.factor.T

    def white(self, vectors: Array) -> Array:
        """The other way round."""
        return np.linalg.solve(self.factor, (vectors - self.middle).T).T.astype(np.float64)


@dataclass(frozen=True, slots=True)
class Chain:
    """One chain so far: `white` (steps, n) coordinates, their log posterior, and the generator's state behind them."""

    white: Array
    log_posterior: Array
    random: tuple[Any, ...]

    def __len__(self) -> int:
        return int(self.white.shape[0])


def begin(size: int, seed: int, number: int) -> Chain:
    """A chain of no steps that starts at a draw from the normal approximation."""
    start = np.random.default_rng([seed, number]).standard_normal(size)
    random = np.random.RandomState(np.random.MT19937(np.random.SeedSequence([seed, number, 1])))
    return Chain(start[None], np.full(1, np.nan), tuple(random.get_state(legacy=True)))


def extend(
    chain: Chain, residuals: Callable[[Array], Array], reference: Reference, surrogate: Surrogate, steps: int
) -> Chain:
    """The chain with more steps, for which half the squares of `residuals` are the negative log density."""
    import emcee

    size = reference.middle.size

    def log_posterior(white: Array) -> float:
        missed = residuals(reference.vector(white))
        density = -0.5 * float(missed @ missed)
        return density if np.isfinite(density) else IMPOSSIBLE

    def propose(white: Array, random: np.random.RandomState) -> tuple[Array, Array]:
        kind = random.random_sample()
        if kind < LONG:
            proposed = surrogate.walk(white[0], random, TRAJECTORIES)[None]
            ratio = surrogate.log_density(white[0])[0] - surrogate.log_density(proposed[0])[0]
            return proposed, np.array([ratio])
        noise = random.standard_normal(white.shape)
        if kind < MIDDLE:
            proposed = np.sqrt(1.0 - BETA**2) * white + BETA * noise
            return proposed, 0.5 * (np.square(proposed).sum(axis=1) - np.square(white).sum(axis=1))
        return white + WALK / np.sqrt(size) * noise, np.zeros(1)

    sampler = emcee.EnsembleSampler(1, size, log_posterior, moves=emcee.moves.MHMove(propose))
    known = chain.log_posterior[-1:]
    start = emcee.State(chain.white[-1:], log_prob=None if np.isnan(known).any() else known, random_state=chain.random)
    end = sampler.run_mcmc(start, steps, skip_initial_state_check=True)
    return Chain(
        np.concatenate([chain.white, sampler.get_chain()[:, 0]]),
        np.concatenate([chain.log_posterior, sampler.get_log_prob()[:, 0]]),
        tuple(end.random_state),
    )


R_HAT, ESS = 1.01, 400.0
"""Chains have converged where every constant has an R-hat below and a bulk effective sample size above (Vehtari et
al. 2021)."""


@dataclass(frozen=True, slots=True)
class Diagnostics:
    """Rank-normalised split R-hat (n,) and bulk effective sample size (n,) of every constant, by name."""

    names: tuple[str, ...]
    r_hat: Array
    ess: Array

    @property
    def converged(self) -> bool:
        """Whether every constant has converged."""
        return bool((self.r_hat < R_HAT).all() and (self.ess > ESS).all())

    @property
    def worst(self) -> str:
        """The constant with the largest R-hat or, where that is fine, the least effective sample size."""
        if float(self.r_hat.max()) >= R_HAT:
            return self.names[int(self.r_hat.argmax())]
        return self.names[int(self.ess.argmin())]

    def __repr__(self) -> str:
        state = "converged" if self.converged else "not converged"
        return f"{state}, worst {self.worst}: R-hat up to {self.r_hat.max():.3f}, ESS from {self.ess.min():.0f}"


def require_extra() -> None:
    """Raise a RecordError with the cure where sampler or diagnostics are not installed."""
    try:
        import arviz_stats  # noqa: F401
        import emcee  # noqa: F401
    except ImportError:
        missing = "sampling needs emcee and arviz-stats, which are not installed"
        raise RecordError(f'{missing}: pip install "thermicon[calibrate]"') from None


def diagnose(names: tuple[str, ...], chains: Array) -> Diagnostics:
    """Diagnostics of chains (chains, steps, n)."""
    stats = import_module("arviz_stats.base").array_stats
    columns = range(chains.shape[2])
    r_hat = np.array([float(stats.rhat(chains[:, :, k])) for k in columns])
    ess = np.array([float(stats.ess(chains[:, :, k], method="bulk")) for k in columns])
    return Diagnostics(names, np.nan_to_num(r_hat, nan=np.inf), np.nan_to_num(ess))


AROUND, ROUNDS = 2400, (1200, 1200)
"""Points from the normal approximation, and from each next surrogate; a quadratic has 1596 coefficients a row."""
CHAINS, CHAIN_ROUNDS, CHAIN_STEPS = 4, 14, 250
"""Chains that visit the posterior while the surrogate learns, how often it learns from them, and steps in between."""
WALKERS, WARM_UP, BETWEEN = 12, 20, 2
"""Walkers along the surrogate, and trajectories before the first and between two points."""
PART = 50
"""Vectors that a worker gets at once."""
Run = Callable[..., Iterable[Any]]
"""`map`, or that of a pool of processes."""


@dataclass(frozen=True, slots=True)
class Points:
    """Known residuals: `vectors` (points, n) in SDs of the prior, `misses` (points, all rows) in SDs."""

    vectors: Array
    misses: Array

    def __len__(self) -> int:
        return int(self.vectors.shape[0])

    def joined(self, other: Points) -> Points:
        """Both together."""
        return Points(np.concatenate([self.vectors, other.vectors]), np.concatenate([self.misses, other.misses]))


def learn(
    posterior: Posterior, reference: Reference, seed: int, run: Run, progress: Callable[[int], None]
) -> tuple[Surrogate, Reference, Points, tuple[Chain, ...]]:
    """The surrogate of a posterior, its coordinates, the points it was fitted to, and chains that have warmed up.

    The posterior is wider than `reference`, the normal approximation: each walk gives the coordinates of the next.
    """
    random = np.random.RandomState(np.random.MT19937(np.random.SeedSequence([seed, 1 << 20])))

    def evaluated(vectors: Array) -> Points:
        parts = np.array_split(vectors, max(1, len(vectors) // PART))
        return Points(vectors, np.concatenate(list(run(_misses_at, [(posterior, part) for part in parts]))))

    points = evaluated(reference.vector(random.standard_normal((AROUND, reference.middle.size))))
    for size in ROUNDS:
        progress(len(points))
        surrogate = fitted(posterior, reference, points)
        vectors = reference.vector(walked(surrogate, random, size))
        points = points.joined(evaluated(vectors))
        reference = Reference.at(vectors.mean(axis=0), np.cov(vectors.T))
    chains = tuple(begin(reference.middle.size, seed, number) for number in range(CHAINS))
    for _ in range(CHAIN_ROUNDS):
        progress(len(points))
        surrogate = fitted(posterior, reference, points, WIDE)
        visited = list(run(_visited, [(chain, posterior, reference, surrogate) for chain in chains]))
        chains = tuple(chain for chain, _ in visited)
        for _, seen in visited:
            points = points.joined(seen)
    ends = tuple(Chain(chain.white[-1:], chain.log_posterior[-1:], chain.random) for chain in chains)
    return fitted(posterior, reference, points, WIDE), reference, points, ends


def _visited(part: tuple[Chain, Posterior, Reference, Surrogate]) -> tuple[Chain, Points]:
    """A chain with more steps, and the points where it looked; a job of one worker process."""
    chain, posterior, reference, surrogate = part
    seen = []

    def residuals(vector: Array) -> Array:
        misses = posterior.misses(vector)
        seen.append((vector, misses))
        return np.concatenate([misses[posterior.counted], vector])

    with quiet_blas():
        chain = extend(chain, residuals, reference, surrogate, CHAIN_STEPS)
    vectors, misses = (np.stack(each) for each in zip(*seen, strict=True))
    return chain, Points(vectors, misses)


def fitted(
    posterior: Posterior, reference: Reference, points: Points, reach: tuple[float, float] = NARROW
) -> Surrogate:
    """The surrogate of the rows that count."""
    white, misses = reference.white(points.vectors), points.misses[:, posterior.counted]
    return fit_surrogate(white, misses, reference.middle, reference.factor, LimitFeatures.of(posterior.priors), reach)


def walked(surrogate: Surrogate, random: np.random.RandomState, points: int) -> Array:
    """Coordinates (points, n) along the surrogate."""
    visited: list[Array] = []
    for _ in range(WALKERS):
        place = surrogate.walk(np.zeros(surrogate.middle.size), random, WARM_UP)
        for _ in range(points // WALKERS):
            place = surrogate.walk(place, random, BETWEEN)
            visited.append(place)
    return np.stack(visited)


def _misses_at(part: tuple[Posterior, Array]) -> Array:
    """Misses (points, rows) of all rows, left out or not, at vectors (points, n); a job of one worker process."""
    posterior, vectors = part
    with quiet_blas():
        return np.stack([posterior.misses(vector) for vector in vectors])
