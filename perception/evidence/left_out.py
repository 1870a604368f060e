"""Each experiment predicted by a posterior that never saw it, from draws: distributions, not normal approximations.

Draws of the whole posterior are weighted by one over the likelihood of the experiment's rows, with Pareto-smoothed
tails. Where their shape k-hat says that the weights are not to be trusted, the posterior without the rows is fitted
anew: its surrogate proposes draws, and weights of the true posterior over the surrogate, smoothed likewise, put them
right. Points that were weighted badly teach the next surrogate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .chains import K_HAT, Reference, smoothed_weights
from .learning import Evaluate, Points, fitted, walked
from .posterior import Posterior
from .rows import Row, load_rows
from .surrogate import WIDE, Surrogate

ROUNDS, PROPOSED = 5, 600
"""Most refits of a posterior without an experiment, and draws of each."""
NEWTON_STEPS = 12
FROM_WEIGHTS, REFITTED = "weights", "refit"


@dataclass(frozen=True, slots=True)
class Predictive:
    """Predictions (draws,) of one row on its own scale with `weights` that sum to 1, by a posterior without it.

    What would be measured differs from a prediction by the row's own error, which is normal.
    """

    row: Row
    predicted: Array
    weights: Array
    k_hat: float
    method: str

    @property
    def probability(self) -> float:
        """Probability of a smaller number than the published one: uniform where predictions are calibrated."""
        return self.below(self.row.value)

    def below(self, value: float) -> float:
        """Probability that less than a value would be measured."""
        from scipy.special import ndtr

        return float(self.weights @ ndtr((value - self.predicted) / self.row.sd))

    def quantile(self, share: float) -> float:
        """What would be measured with this probability of less."""
        from scipy.optimize import brentq

        far = 12.0 * self.row.sd
        low, high = float(self.predicted.min()) - far, float(self.predicted.max()) + far
        return float(brentq(lambda value: self.below(value) - share, low, high, xtol=1e-6 * (high - low)))

    @property
    def log_score(self) -> float:
        """Log density of the published number."""
        z = (self.row.value - self.predicted) / self.row.sd
        logs = -0.5 * z * z + np.log(np.maximum(self.weights, 1e-300))
        top = float(logs.max())
        return top + float(np.log(np.exp(logs - top).sum())) - float(np.log(self.row.sd * np.sqrt(2.0 * np.pi)))


def leave_out(
    experiment: str,
    whole: Posterior,
    draws: Points,
    reference: Reference,
    points: Points,
    seed: int,
    evaluate: Evaluate,
) -> list[Predictive]:
    """Predict an experiment without it.

    `draws` are those of the whole posterior with the misses of all rows, `points` what its surrogate was fitted to.
    """
    posterior = Posterior(whole.variable, whole.without, frozenset({experiment}))
    weights, k_hat = smoothed_weights(0.5 * np.square(draws.misses[:, ~posterior.counted]).sum(axis=1))
    if k_hat <= K_HAT:
        return _predictives(posterior, draws, weights, k_hat, FROM_WEIGHTS)
    random = np.random.RandomState(np.random.MT19937(np.random.SeedSequence([seed, 2 << 20])))
    best: tuple[float, Points, Array] | None = None
    known = points.joined(draws)
    for _ in range(ROUNDS):
        surrogate, wide = _fit(posterior, reference, known)
        white = walked(surrogate, random, PROPOSED)
        vectors = wide.vector(white)
        proposed = Points(vectors, evaluate(vectors))
        weights, k_hat = smoothed_weights(_log_density(posterior, proposed) - _log_densities(surrogate, white))
        if best is None or k_hat < best[0]:
            best = k_hat, proposed, weights
        if k_hat <= K_HAT:
            break
        known = known.joined(proposed)
    assert best is not None
    return _predictives(posterior, best[1], best[2], best[0], REFITTED)


def _fit(posterior: Posterior, reference: Reference, points: Points) -> tuple[Surrogate, Reference]:
    """A surrogate in coordinates of its own normal approximation, which is wider than that of all rows."""
    surrogate = fitted(posterior, reference, points)
    white = np.zeros(reference.middle.size)
    for _ in range(NEWTON_STEPS):
        _, gradient = surrogate.log_density(white)
        step = np.linalg.solve(surrogate.precision(white), gradient)
        white = white + step * min(1.0, 0.5 / float(np.abs(step).max()))
    wide = Reference.at(
        reference.vector(white), reference.factor @ np.linalg.inv(surrogate.precision(white)) @ reference.factor.T
    )
    return fitted(posterior, wide, points, WIDE), wide


def _log_density(posterior: Posterior, points: Points) -> Array:
    squares: Array = np.square(points.misses[:, posterior.counted]).sum(axis=1) + np.square(points.vectors).sum(axis=1)
    return -0.5 * squares


def _log_densities(surrogate: Surrogate, white: Array) -> Array:
    return np.array([surrogate.log_density(each)[0] for each in white])


def _predictives(posterior: Posterior, draws: Points, weights: Array, k_hat: float, method: str) -> list[Predictive]:
    return [
        Predictive(row, row.value + row.sd * draws.misses[:, place], weights, k_hat, method)
        for place, row in enumerate(load_rows())
        if row.experiment in posterior.left_out
    ]
