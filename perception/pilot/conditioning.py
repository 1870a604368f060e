"""Laboratories conditioned on answers: weights where enough draws carry them, fresh laboratories where too few do.

1. Every draw is given memory, an offset and people; its answers are scored (see `likelihood`) and weigh it.
2. With at least `LEAST_EFFECTIVE` draws behind the answers, laboratories are resampled by these weights.
3. Otherwise fresh laboratories are sampled from the prior times the likelihood of the pooled answers
   (`pooled_answers`), simulated, and sampled once more with the likelihood fitted to them.

Either way the result is a sample of laboratories with people who did not take part.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermicon.circuit.cores import quiet_blas

from ..arrays import Array
from .likelihood import effective, log_likelihoods, normalised_weights
from .playing import Confusions, Stage
from .pooled_answers import PooledLikelihood, walk
from .states import SEEDS, Laboratories

LEAST_EFFECTIVE, LEAST_SHARE = 60.0, 0.25
"""Effective sample size from which weights are used as they are, or share of the draws where there are fewer.

With few participants, of whom one is unusual, weights of little effect still err less than the pooled likelihood.
"""
ROUNDS = 2
"""Rounds of fresh laboratories: the second is fitted to those of the first as well, which are near the answers."""
NEAR = 2.0
"""A laboratory whose ln L is so much lower than usual near the answers counts half in the second fit."""


@dataclass(frozen=True, slots=True)
class Conditioned:
    """What answers make of the laboratories.

    `before` are the laboratories that were weighed and `confusions_before` theirs; `after` is a sample of equal
    weights, with `confusions_after`. `effective` is the effective sample size of the weights of `before`, `rounds` how
    often fresh laboratories were simulated (0: the weights sufficed).
    """

    before: Laboratories
    confusions_before: Confusions
    log_likelihood: Array
    effective: float
    after: Laboratories
    confusions_after: Confusions
    rounds: int

    @property
    def effective_after(self) -> float:
        """How many independent draws stand behind `after`."""
        return float(len(self.after)) if self.rounds else self.effective

    def __repr__(self) -> str:
        how = "reweighted" if not self.rounds else f"refreshed in {self.rounds} rounds"
        return f"Conditioned({len(self.before)} laboratories, ESS {self.effective:.0f}; {len(self.after)} {how})"


def condition(
    stage: Stage,
    counts: Array,
    before: Laboratories,
    *,
    seed: int = 0,
    sample: int | None = None,
    step: Callable[[], None] | None = None,
) -> Conditioned:
    """Condition laboratories on answers (participants, icons, icons); `sample` is how many are kept (None: half)."""
    played = stage.confusions(before, step)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 12]))
    kept = max(2, len(before) // 2) if sample is None else sample
    each = log_likelihoods(played.probability, counts)
    total = each.sum(axis=1)
    weights = normalised_weights(total)
    size = effective(weights)
    if size >= min(LEAST_EFFECTIVE, LEAST_SHARE * len(before)):
        chosen = systematic(weights, kept, rng)
        after = Laboratories(before.place[chosen], rng.integers(SEEDS, size=kept))
        return Conditioned(before, played, total, size, after, stage.confusions(after, step), 0)
    places, simulated = before.place, played
    weight, start = np.ones(len(before)), before.place
    for rounds in range(1, ROUNDS + 1):
        with quiet_blas():
            fitted = PooledLikelihood.fit(places, simulated, counts, weight)
            some = walk(start[rng.integers(len(start), size=kept)], fitted, rng)
        after = Laboratories(some, rng.integers(SEEDS, size=kept))
        found = stage.confusions(after, step)
        if rounds < ROUNDS:
            places, simulated, start = np.vstack([places, some]), simulated.joined(found), some
            short = np.maximum(np.median(fitted(some)) - fitted(places), 0.0)
            # Laboratories far from the answers keep the polynomial from bending there, and count for little else.
            weight = 1.0 / (1.0 + np.square(short / NEAR))
    return Conditioned(before, played, total, size, after, found, ROUNDS)


def systematic(weights: Array, n: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Numbers of n resampled items, by one random start: each as often as its weight says, up to rounding.

    >>> systematic(np.array([0.5, 0.0, 0.5]), 4, np.random.default_rng(0)).tolist()
    [0, 0, 2, 2]
    """
    ends = np.cumsum(weights)
    found: NDArray[np.int64] = np.searchsorted(ends / ends[-1], (np.arange(n) + rng.random()) / n, side="right")
    return np.minimum(found, len(weights) - 1)
