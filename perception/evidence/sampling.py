"""Draws from the posterior of all constants.

Chains do not know of each other, so that R-hat compares independent runs.
"""

import hashlib
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from importlib.metadata import version
from multiprocessing import get_context

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.cores import quiet_blas

from ..observer.draws import PosteriorDraws
from ..observer.draws_file import APPROXIMATE, DrawsHeader
from ..observer.priors import LABORATORIES, load_priors
from ..pilot.laboratory_file import off_centre
from .chains import CHAINS, ESS, R_HAT, Chain, Diagnostics, Reference, Run, diagnose, extend, learn
from .posterior import Maximum, Posterior, maximise
from .results import inputs_digest, load_constants
from .rows import load_rows
from .surrogate import Surrogate

BLOCK = 100
"""Steps of a chain between two looks at the diagnostics."""
LEAST_STEPS, MOST_STEPS = 1000, 20_000
BURN_IN = 0.1
"""Share of the steps that is left out at the start; chains have warmed up while the surrogate learnt."""
DRAWS = 1000
ENOUGH_ESS = 600.0
"""Chains go on until every constant has so many effective draws, more than what counts as converged."""
Progress = Callable[[int, int, str], None]


@dataclass(frozen=True, slots=True)
class SampledPosterior:
    """A sampled posterior: `chains` (chains, steps, n) in SDs of the prior after burn-in, and their diagnostics."""

    posterior: Posterior
    chains: Array
    likelihoods: int
    diagnostics: Diagnostics
    seed: int

    @property
    def vectors(self) -> Array:
        """DRAWS vectors (DRAWS, n), evenly spaced along all chains."""
        steps = self.chains.reshape(-1, self.chains.shape[2])
        return steps[np.linspace(0, len(steps) - 1, DRAWS).round().astype(np.int64)]

    def draws(self) -> PosteriorDraws:
        """The draws in each constant's own unit, with a header that says where they come from."""
        emcee = f"emcee {version('emcee')}, {CHAINS} chains of {self.chains.shape[1]} steps after burn-in"
        worst = float(self.diagnostics.r_hat.max()), float(self.diagnostics.ess.min())
        header = header_of(self.posterior, emcee, self.seed, self.likelihoods, *worst)
        return draws_of(self.posterior, self.vectors, header)


def sample(
    posterior: Posterior,
    seed: int = 0,
    *,
    workers: int = 1,
    least_steps: int = LEAST_STEPS,
    most_steps: int = MOST_STEPS,
    progress: Progress = lambda done, most, words: None,
) -> SampledPosterior:
    """Sample until every constant has converged with draws to spare, or for `most_steps`: the seed alone decides."""
    start, most = maximise(posterior, shipped_vector(posterior)), CHAINS * most_steps
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn")) if workers > 1 else nullcontext(None)
    with pool as shared:
        run: Run = map if shared is None else shared.map
        surrogate, reference, points, begun = learn(
            posterior,
            Reference.at(start.vector, start.covariance),
            seed,
            run,
            lambda count: progress(count, count + most, "learning the surrogate"),
        )
        chains, steps, enough = list(begun), 0, False
        while steps < most_steps and not (steps >= least_steps and enough):
            more = min(BLOCK, most_steps - steps)
            chains = list(run(_extended, [(chain, posterior, reference, surrogate, more) for chain in chains]))
            steps += more
            found = diagnose(posterior.priors.names, _kept(chains, reference))
            enough = found.converged and float(found.ess.min()) > ENOUGH_ESS
            progress(len(points) + CHAINS * steps, len(points) + most, repr(found))
    return SampledPosterior(posterior, _kept(chains, reference), len(points) + CHAINS * steps, found, seed)


def _extended(part: tuple[Chain, Posterior, Reference, Surrogate, int]) -> Chain:
    chain, posterior, reference, surrogate, steps = part
    with quiet_blas():
        return extend(chain, posterior.residuals, reference, surrogate, steps)


def _kept(chains: Sequence[Chain], reference: Reference) -> Array:
    """Vectors (chains, steps, n) after burn-in."""
    first = 1 + round(BURN_IN * (len(chains[0]) - 1))
    return reference.vector(np.stack([chain.white[first:] for chain in chains]))


def shipped_vector(posterior: Posterior) -> Array:
    """The shipped maximum of the posterior's variant, as a place to begin."""
    known = {each.name: each.value for each in load_constants(posterior.variable)}
    return (posterior.priors.places(known) - posterior.priors.middle) / posterior.priors.sd


def at_shipped(posterior: Posterior) -> Maximum:
    """The shipped constants in place of a maximum, for their predictions."""
    vector = shipped_vector(posterior)
    return Maximum(posterior, vector, np.eye(vector.size), 0.0, posterior.predictions(vector), 0)


def approximate_draws(found: Maximum, seed: int = 0) -> PosteriorDraws:
    """Draws from the normal approximation at a maximum, marked as such: a stand-in where nothing was sampled."""
    normal = np.random.default_rng(seed).standard_normal((DRAWS, found.vector.size))
    reference = Reference.at(found.vector, found.covariance)
    header = header_of(found.posterior, f"{APPROXIMATE} at the maximum", seed, found.rounds, 1.0, float(DRAWS))
    return draws_of(found.posterior, reference.vector(normal), header)


def header_of(posterior: Posterior, sampler: str, seed: int, likelihoods: int, r_hat: float, ess: float) -> DrawsHeader:
    """The header of draws from a posterior."""
    return DrawsHeader(
        inputs_digest(),
        hashlib.sha256(repr(load_rows()).encode()).hexdigest()[:16],
        hashlib.sha256(repr(load_priors()).encode()).hexdigest()[:16],
        f"thermicon {version('thermicon')}",
        posterior.variable,
        tuple(sorted(posterior.left_out)),
        sampler,
        seed,
        likelihoods,
        r_hat,
        ess,
        r_hat < R_HAT and ess > ESS,
        tuple(f"{place} {channel}" for place in LABORATORIES for channel in ("cold", "warm")),
    )


def draws_of(posterior: Posterior, vectors: Array, header: DrawsHeader) -> PosteriorDraws:
    """Draws in the constants' own units from vectors (draws, n) in SDs of the prior; the nominal one comes first."""
    priors = posterior.priors
    rows = [list(priors.values(priors.middle + priors.sd * vector).values()) for vector in vectors]
    nominal = in_the_middle(posterior, vectors)
    order = [nominal, *(k for k in range(len(rows)) if k != nominal)]
    return PosteriorDraws(header, priors.names, np.array([rows[k] for k in order]))


def in_the_middle(posterior: Posterior, vectors: Array) -> int:
    """Number of the vector nearest to the medians of constants and of predicted rows together, in SDs of the draws."""
    predicted = np.array([[found[row.key] for row in posterior.rows] for found in map(posterior.predictions, vectors)])
    constants = [k for k, prior in enumerate(posterior.priors.each) if prior.mechanism != "laboratories"]
    return int((off_centre(vectors[:, constants]) + off_centre(predicted)).argmin())
