"""Laboratories conditioned on measurements: by weights, or where too few draws carry them, by fresh laboratories.

Fresh laboratories are sampled with polynomials of the coordinates in place of simulated people (means, covariances and
scatter of trials), and weighed by what the polynomials missed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from thermicon.circuit.cores import quiet_blas

from ..arrays import Array
from .conditioning import LEAST_EFFECTIVE, LEAST_SHARE, systematic
from .likelihood import effective, normalised_weights
from .measurement_likelihood import NUGGET, Group, groups_of, log_likelihood
from .measurements import Measurements
from .pooled_answers import features_of, ridge, smooth_features, walk
from .simulated_measurements import Predicted
from .states import SEEDS, Laboratories

ROUNDS = 3
"""At most so many rounds of fresh laboratories."""
NEAR = 5.0
"""A laboratory whose ln L is 25 lower than the best counts half in a fit."""

Simulate = Callable[[Laboratories], Predicted]


@dataclass(frozen=True, slots=True)
class Reweighted:
    """Laboratories before and after: `weights` of those before, their `effective` size, and a sample of equal weights.

    `rounds` of fresh laboratories were simulated (0: the weights sufficed); `effective_after` stands behind `after`.
    """

    before: Laboratories
    predicted: Predicted
    weights: Array
    effective: float
    after: Laboratories
    predicted_after: Predicted
    effective_after: float
    rounds: int


def reweight(measured: Measurements, before: Laboratories, simulate: Simulate, *, seed: int, kept: int) -> Reweighted:
    """Condition laboratories on measurements; `kept` is how many are sampled."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 31]))
    found = simulate(before)
    with quiet_blas():
        logs = log_likelihood(measured, found)
    weights = normalised_weights(logs)
    size = effective(weights)
    if size >= min(LEAST_EFFECTIVE, LEAST_SHARE * len(before)):
        chosen = systematic(weights, kept, rng)
        after = Laboratories(before.place[chosen], rng.integers(SEEDS, size=kept))
        return Reweighted(before, found, weights, size, after, found.of(chosen), size, 0)
    places, simulated, start, groups = before.place, found, before.place, groups_of(measured, alike=True)
    rounds = 0
    while True:
        with quiet_blas():
            target = Emulated.fit(measured, groups, places, simulated, logs)
            moved = walk(start[rng.integers(len(start), size=kept)], target, rng)
        fresh, rounds = Laboratories(moved, np.zeros(kept, np.int64)), rounds + 1
        own = simulate(fresh)
        own_logs = log_likelihood(measured, own)
        share = normalised_weights(own_logs - target(fresh.place))
        if effective(share) >= LEAST_SHARE * kept or rounds == ROUNDS:
            break
        places, simulated, start = np.vstack([places, fresh.place]), simulated.joined(own), fresh.place
        logs = np.concatenate([logs, own_logs])
    share = _tempered(own_logs - target(fresh.place), LEAST_SHARE * kept)
    chosen = systematic(share, kept, rng)
    after = Laboratories(fresh.place[chosen], rng.integers(SEEDS, size=kept))
    return Reweighted(before, found, weights, size, after, own.of(chosen), effective(share), rounds)


@dataclass(frozen=True, slots=True)
class Emulated:
    """Ln likelihood at coordinates (n, d), from polynomials for mean, covariance and scatter of trials."""

    measured: Measurements
    groups: tuple[Group, ...]
    coefficients: Array
    pairs: tuple[tuple[int, int], ...]

    @classmethod
    def fit(
        cls, measured: Measurements, groups: tuple[Group, ...], place: Array, each: Predicted, logs: Array
    ) -> Emulated:
        """Fit to simulated laboratories with ln likelihoods; the less likely they are, the less they count."""
        weight = 1.0 / (1.0 + np.maximum(logs.max() - logs, 0.0) / NEAR**2)
        targets, own = _flat(each), weight / weight.mean()
        features, pairs, _ = smooth_features(place, targets / targets.std(axis=0).clip(1e-9), own)
        return cls(measured, groups, ridge(features, targets, own)[0], pairs)

    def __call__(self, place: Array) -> Array:
        """Ln likelihood (n,), up to a constant."""
        each = _predicted(features_of(place, self.pairs) @ self.coefficients, len(self.measured.conditions))
        return log_likelihood(self.measured, each, self.groups)


def _flat(each: Predicted) -> Array:
    """Means, logs of scatter, and the logarithmic Cholesky factor of Σ: numbers without bounds."""
    root = np.linalg.cholesky(each.between + NUGGET * np.eye(each.mean.shape[1]))
    rows, columns = np.tril_indices(each.mean.shape[1], -1)
    diagonal = np.log(np.diagonal(root, axis1=1, axis2=2))
    return np.hstack([each.mean, np.log(each.within), diagonal, root[:, rows, columns]])


def _predicted(flat: Array, count: int) -> Predicted:
    rows, columns = np.tril_indices(count, -1)
    mean, within, diagonal, below = (flat[:, a:b] for a, b in pairwise((0, count, 2 * count, 3 * count, flat.shape[1])))
    root = np.zeros((len(flat), count, count))
    root[:, range(count), range(count)] = np.exp(np.clip(diagonal, -8.0, 3.0))
    root[:, rows, columns] = below
    return Predicted(mean, root @ np.swapaxes(root, 1, 2), np.exp(np.clip(within, -8.0, 3.0)))


def _tempered(logs: Array, least: float) -> Array:
    """Weights, of the highest power up to 1 of which so many are effective."""
    for power in np.linspace(1.0, 0.0, 21).tolist():
        weights = normalised_weights(power * logs)
        if effective(weights) >= least:
            break
    return weights
