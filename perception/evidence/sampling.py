"""The posterior of all constants: chains on several cores, resumed where they stopped, thinned to equal draws.

Chains do not know of each other, so that R-hat compares independent runs, and the result depends on the seed and
neither on the number of processes nor on interruptions.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from thermicon.circuit.cores import quiet_blas
from thermicon.circuit.records import RecordError
from thermicon.icons.atomic import complete_or_absent

from ..arrays import Array
from ..observer.draws import PosteriorDraws
from ..observer.draws_file import APPROXIMATE, DrawsHeader
from ..observer.priors import LABORATORIES, load_priors
from .chains import ESS, R_HAT, Chain, Diagnostics, Reference, diagnose, extend
from .learning import CHAIN_STEPS, CHAINS, Points, Recorder, fitted, learn, misses_at
from .maximum import Maximum, maximise
from .posterior import Posterior
from .results import inputs_digest, load_constants
from .rows import load_rows
from .surrogate import WIDE, Surrogate

BLOCK = 100
"""Steps of a chain between two looks at the diagnostics, and between two savings."""
LEAST_STEPS, MOST_STEPS = 1000, 20_000
BURN_IN = 0.1
"""Share of the steps that is left out at the start; chains have warmed up while the surrogate learnt."""
DRAWS = 1000
ENOUGH_ESS = 600.0
"""Chains go on until every constant has so many effective draws, more than what counts as converged."""
POINTS, PART = "points.npz", 50
Progress = Callable[[int, int, str], None]


@dataclass(frozen=True, slots=True)
class Sampled:
    """A sampled posterior: `chains` (chains, steps, n) in SDs of the prior after burn-in, and their diagnostics."""

    posterior: Posterior
    chains: Array
    likelihoods: int
    diagnostics: Diagnostics
    seed: int

    @property
    def vectors(self) -> Array:
        """DRAWS vectors (DRAWS, n), evenly spaced along all chains."""
        return thinned(self.chains)

    def draws(self) -> PosteriorDraws:
        """The draws in each constant's own unit, with a header that says where they come from."""
        emcee = f"emcee {version('emcee')}, {CHAINS} chains of {self.chains.shape[1]} steps after burn-in"
        found = self.diagnostics
        header = header_of(
            self.posterior, emcee, self.seed, self.likelihoods, float(found.r_hat.max()), float(found.ess.min())
        )
        return draws_of(self.posterior, self.vectors, header)


def sample(
    posterior: Posterior,
    seed: int = 0,
    *,
    keep: Path | None = None,
    workers: int = 1,
    least_steps: int = LEAST_STEPS,
    most_steps: int = MOST_STEPS,
    progress: Progress | None = None,
) -> Sampled:
    """Sample until every constant has converged with effective draws to spare, or until `most_steps` of each chain.

    Parameters
    ----------
    posterior, seed
        What is sampled; the same seed gives the same draws on the same computer, whose rounding they depend on.
    keep
        A folder for the chains, from which a later call goes on.
    workers
        Processes.
    least_steps, most_steps
        Steps of each chain.
    progress
        Called with (likelihoods so far, the most there may be, diagnostics in words).

    Raises
    ------
    RecordError
        Where the folder holds chains of another posterior or seed.

    """
    start = maximise(posterior, shipped_vector(posterior))
    reference = Reference.at(start.vector, start.covariance)
    if keep is not None:
        _check_folder(keep, posterior, seed)
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn")) if workers > 1 else nullcontext(None)
    with pool as shared:
        run: Callable[..., Iterable[Any]] = map if shared is None else shared.map

        def evaluate(vectors: Array) -> Array:
            parts = np.array_split(vectors, max(1, len(vectors) // PART))
            return np.concatenate(list(run(misses_at, [(posterior, part) for part in parts])))

        def visit(chains: Sequence[Chain], at: Reference, by: Surrogate) -> list[tuple[Chain, Points]]:
            return list(run(_visited, [(chain, posterior, at, by) for chain in chains]))

        def learnt(count: int) -> None:
            if progress is not None:
                progress(count, count + CHAINS * most_steps, "learning the surrogate")

        learned = load_learned(keep)
        if learned is None:
            surrogate, reference, points, begun = learn(posterior, reference, seed, evaluate, visit, learnt)
            _save_learned(keep, reference, points, begun)
        else:
            reference, points, begun = learned
            surrogate = fitted(posterior, reference, points, WIDE)
        chains = [_resumed(keep, number, chain) for number, chain in enumerate(begun)]
        while True:
            steps = min(len(chain) for chain in chains) - 1
            found = diagnose(posterior.priors.names, _kept(chains, reference)) if steps >= BLOCK else None
            done = sum(len(chain) - 1 for chain in chains)
            if progress is not None:
                progress(len(points) + done, len(points) + CHAINS * most_steps, "" if found is None else _words(found))
            enough = found is not None and found.converged and float(found.ess.min()) > ENOUGH_ESS
            if steps >= most_steps or (steps >= least_steps and enough):
                break
            upto = min(steps + BLOCK, most_steps)
            work = [(chain, posterior, reference, surrogate, upto + 1 - len(chain)) for chain in chains]
            for number, chain in enumerate(run(_extended, work)):
                chains[number] = chain
                if keep is not None:
                    chain.save(_file(keep, number))
    assert found is not None
    return Sampled(posterior, _kept(chains, reference), done + len(points), found, seed)


def shipped_vector(posterior: Posterior) -> Array:
    """The shipped maximum of the posterior's variant, as a place to begin."""
    known = {each.name: each.value for each in load_constants(posterior.variable)}
    priors = posterior.priors
    places = [prior.to_place(known[prior.name]) for prior in priors.each]
    vector: Array = (np.array(places) - priors.middle) / priors.sd
    return vector


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
        tuple(
            f"{place} {channel}"
            for place in LABORATORIES
            for channel in ("cold", "warm")
            if f"{place} {channel}" in posterior.priors.names
        ),
    )


def draws_of(posterior: Posterior, vectors: Array, header: DrawsHeader) -> PosteriorDraws:
    """Draws in the constants' own units from vectors (draws, n) in SDs of the prior; the nominal one comes first."""
    priors = posterior.priors
    rows = [list(priors.values(priors.middle + priors.sd * vector).values()) for vector in vectors]
    nominal = in_the_middle(posterior, vectors)
    order = [nominal, *(k for k in range(len(rows)) if k != nominal)]
    return PosteriorDraws(header, priors.names, np.array([rows[k] for k in order]))


def in_the_middle(posterior: Posterior, vectors: Array) -> int:
    """Number of the vector nearest to the medians of constants and of predicted rows, in SDs of the draws.

    In as many dimensions as there are constants no draw is near the median of each.
    """
    predicted = np.array([[found[row.key] for row in posterior.rows] for found in map(posterior.predictions, vectors)])
    constants = [k for k, prior in enumerate(posterior.priors.each) if prior.mechanism != "laboratories"]
    return int((_off_centre(vectors[:, constants]) + _off_centre(predicted)).argmin())


def _off_centre(each: Array) -> Array:
    """Mean square (draws,) of how many SDs a draw lies from the median of each column."""
    spread = np.where(each.std(axis=0) > 0.0, each.std(axis=0), 1.0)
    found: Array = np.square((each - np.median(each, axis=0)) / spread).mean(axis=1)
    return found


def _extended(part: tuple[Chain, Posterior, Reference, Surrogate, int]) -> Chain:
    chain, posterior, reference, surrogate, steps = part
    if steps <= 0:
        return chain
    with quiet_blas():
        return extend(chain, posterior, reference, surrogate, steps)


def _visited(part: tuple[Chain, Posterior, Reference, Surrogate]) -> tuple[Chain, Points]:
    chain, posterior, reference, surrogate = part
    recorder = Recorder(posterior)
    with quiet_blas():
        return extend(chain, recorder, reference, surrogate, CHAIN_STEPS), recorder.points


def load_learned(keep: Path | None) -> tuple[Reference, Points, tuple[Chain, ...]] | None:
    """What was learnt in a folder: coordinates, points and warm chains; None where nothing was."""
    if keep is None or not (keep / POINTS).exists():
        return None
    with np.load(keep / POINTS) as arrays:
        reference, points = Reference(arrays["middle"], arrays["factor"]), Points(arrays["vectors"], arrays["misses"])
    return reference, points, tuple(Chain.load(keep / f"warm-{number}.npz") for number in range(CHAINS))


def _save_learned(keep: Path | None, reference: Reference, points: Points, begun: tuple[Chain, ...]) -> None:
    if keep is None:
        return
    for number, chain in enumerate(begun):
        chain.save(keep / f"warm-{number}.npz")
    with complete_or_absent(keep / POINTS) as draft:
        np.savez(
            draft,
            middle=reference.middle,
            factor=reference.factor,
            vectors=points.vectors,
            misses=points.misses,
        )


def load_vectors(keep: Path, reference: Reference) -> Array:
    """DRAWS vectors (DRAWS, n) of the chains in a folder."""
    return thinned(_kept([Chain.load(_file(keep, number)) for number in range(CHAINS)], reference))


def thinned(chains: Array) -> Array:
    """DRAWS vectors (DRAWS, n), evenly spaced along all chains (chains, steps, n)."""
    steps = chains.reshape(-1, chains.shape[2])
    chosen: Array = steps[np.linspace(0, len(steps) - 1, DRAWS).round().astype(np.int64)]
    return chosen


def _kept(chains: list[Chain], reference: Reference) -> Array:
    """Vectors (chains, steps, n) after burn-in, as many of each chain."""
    steps = min(len(chain) for chain in chains)
    first = 1 + round(BURN_IN * (steps - 1))
    return reference.vector(np.stack([chain.white[first:steps] for chain in chains]))


def _words(found: Diagnostics) -> str:
    return f"R-hat {found.r_hat.max():.3f}, ESS {found.ess.min():.0f}"


def _file(keep: Path, number: int) -> Path:
    return keep / f"chain-{number}.npz"


def _resumed(keep: Path | None, number: int, begun: Chain) -> Chain:
    return Chain.load(_file(keep, number)) if keep is not None and _file(keep, number).exists() else begun


def _check_folder(keep: Path, posterior: Posterior, seed: int) -> None:
    """Refuse a folder that holds chains of another posterior or seed; a new one takes these."""
    wanted = {
        "inputs": inputs_digest(),
        "variant": posterior.variable,
        "left out": sorted(posterior.left_out),
        "seed": seed,
    }
    about = keep / "posterior.json"
    keep.mkdir(parents=True, exist_ok=True)
    if not about.exists():
        about.write_text(json.dumps(wanted, indent=1) + "\n", encoding="utf-8")
        return
    found = json.loads(about.read_text(encoding="utf-8"))
    for name, value in wanted.items():
        if found.get(name) != value:
            raise RecordError(
                f"{keep}: the chains kept here have {name} {found.get(name)!r}, not {value!r}: "
                "give another folder, or remove this one"
            )
