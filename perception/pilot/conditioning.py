"""Laboratories conditioned on data: weights where enough draws carry them, fresh laboratories where too few do.

1. What was answered or measured is simulated in every draw of the prior; its likelihood weighs the draw.
2. With at least `LEAST_EFFECTIVE` draws behind the data, laboratories are resampled by these weights.
3. Otherwise fresh laboratories are sampled from the prior times a likelihood that is a polynomial of the coordinates,
   fitted to those simulated so far, and simulated. Those of measurements are weighed by what the polynomial missed.

Either way the result is a sample of laboratories with people who did not take part.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from thermicon.circuit.cores import quiet_blas

from ..arrays import Array
from .likelihood import effective, normalised_weights, walk
from .states import SEEDS, Laboratories

LEAST_EFFECTIVE, LEAST_SHARE = 60.0, 0.25
"""Effective sample size from which weights are used as they are, or share of the draws where there are fewer.

With few participants, of whom one is unusual, weights of little effect still err less than the pooled likelihood.
"""
Step = Callable[[], None]


class Data(Protocol):
    """What a laboratory found out of its people, and how likely that is in others.

    What is simulated of it has `of` and `joined`. `by_people` says that it depends on who the people of a laboratory
    are: people who are kept must then be others, and the likelihood of fresh laboratories is too much a matter of
    chance to weigh them. `rounds` of fresh laboratories are simulated at most; `stream` keeps their chance apart from
    that of other data.
    """

    stream: ClassVar[int]
    rounds: ClassVar[int]
    by_people: ClassVar[bool]

    def simulate(self, some: Laboratories, step: Step | None = None) -> Any:
        """Simulate the data in laboratories; `step` is called after each."""

    def log_likelihood(self, simulated: Any) -> Array:
        """Ln likelihood (laboratories,) of the data, up to a constant."""

    def polynomial(self, place: Array, simulated: Any, short: Array) -> Callable[[Array], Array]:
        """Ln likelihood of coordinates, fitted to laboratories whose own is so much lower than near the data."""


@dataclass(frozen=True, slots=True)
class Conditioned:
    """What data make of the laboratories.

    `before` are the laboratories that were weighed, with what was `simulated` in them; `after` is a sample of equal
    weights, with `simulated_after`. `effective` is the effective sample size of the weights of `before`,
    `effective_after` how many independent draws stand behind `after`, `rounds` how often fresh laboratories were
    simulated (0: the weights sufficed).
    """

    before: Laboratories
    simulated: Any
    effective: float
    after: Laboratories
    simulated_after: Any
    effective_after: float
    rounds: int


@quiet_blas()
def condition(
    data: Data, before: Laboratories, *, seed: int = 0, kept: int | None = None, step: Step | None = None
) -> Conditioned:
    """Condition laboratories on data; `kept` is how many are sampled (None: half)."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, data.stream]))
    kept = max(2, len(before) // 2) if kept is None else kept
    simulated = data.simulate(before, step)
    logs = data.log_likelihood(simulated)
    weights = normalised_weights(logs)
    size = effective(weights)
    if size >= min(LEAST_EFFECTIVE, LEAST_SHARE * len(before)):
        after, found = _resampled(data, before.place, simulated, weights, kept, rng, step)
        return Conditioned(before, simulated, size, after, found, size, 0)
    after, found, left, rounds = _refreshed(data, before.place, simulated, logs, kept, rng, step)
    return Conditioned(before, simulated, size, after, found, left, rounds)


def _refreshed(
    data: Data, place: Array, simulated: Any, logs: Array, kept: int, rng: np.random.Generator, step: Step | None
) -> tuple[Laboratories, Any, float, int]:
    """Fresh laboratories, what is simulated there, how many are effective, and the rounds that it took."""
    start, short = place, np.zeros(len(place)) if data.by_people else logs.max() - logs
    for rounds in range(1, data.rounds + 1):
        target = data.polynomial(place, simulated, short)
        moved = walk(start[rng.integers(len(start), size=kept)], target, rng)
        people = rng.integers(SEEDS, size=kept) if data.by_people else np.zeros(kept, np.int64)
        fresh = Laboratories(moved, people)
        found = data.simulate(fresh, step)
        if not data.by_people:
            own = data.log_likelihood(found)
            missed = own - target(moved)
            if effective(normalised_weights(missed)) >= LEAST_SHARE * kept:
                break
        if rounds == data.rounds:
            break
        place, simulated, start = np.vstack([place, moved]), simulated.joined(found), moved
        if data.by_people:
            likely = target(place)
            short = np.maximum(np.median(likely[-kept:]) - likely, 0.0)
        else:
            logs = np.concatenate([logs, own])
            short = logs.max() - logs
    if data.by_people:
        return fresh, found, float(kept), rounds
    share = _tempered(missed, LEAST_SHARE * kept)
    after, found = _resampled(data, moved, found, share, kept, rng, step)
    return after, found, effective(share), rounds


def _resampled(
    data: Data, place: Array, simulated: Any, weights: Array, kept: int, rng: np.random.Generator, step: Step | None
) -> tuple[Laboratories, Any]:
    """A sample of equal weights, with people who did not take part, and what is simulated there."""
    chosen = systematic(weights, kept, rng)
    after = Laboratories(place[chosen], rng.integers(SEEDS, size=kept))
    return after, data.simulate(after, step) if data.by_people else simulated.of(chosen)


def _tempered(logs: Array, least: float) -> Array:
    """Weights, of the highest power up to 1 of which so many are effective."""
    for power in np.linspace(1.0, 0.0, 21).tolist():
        weights = normalised_weights(power * logs)
        if effective(weights) >= least:
            break
    return weights


def systematic(weights: Array, n: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Numbers of n resampled items, by one random start: each as often as its weight says, up to rounding."""
    ends = np.cumsum(weights)
    found: NDArray[np.int64] = np.searchsorted(ends / ends[-1], (np.arange(n) + rng.random()) / n, side="right")
    return np.minimum(found, len(weights) - 1)
