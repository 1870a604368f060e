"""A quadratic model of every residual that replaces the laboratory in long moves of the chains.

Near the maximum each row's miss r is nearly quadratic in the constants: r ≈ a + b·w + wᵀ·Q·w in the coordinates w of
the normal approximation, fitted to residuals computed at some thousand points. Its posterior is not normal, since
squares of quadratics are quartic, and it has a gradient, so that Hamiltonian trajectories run along it (Neal 2011).
What it gets wrong is put right afterwards: proposals that come from it are accepted by the ratio of the true posterior
to the surrogate's, which leaves the true posterior unchanged (Liu 2001, surrogate transition).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..observer.priors import Priors
from .posterior import LIMITS

RIDGE = 0.01
"""Weight of keeping coefficients small, as a share of the number of points."""
FADING = 15.0
"""Points count e times less for so much less log posterior than the median point: the fit is for where chains go."""
NARROW, WIDE = (2.0, 1.0), (2.6, 1.12)
"""Wall and heat, for learning and for chains. Beyond a squared distance of so many times the number of constants, a
wall keeps trajectories from where nothing was fitted; heat divides the log density, which gives it longer tails than
the posterior: a chain that is where the proposals never go has to stay there."""
LEAST_WALL = 25.0
WALL_RISE = 0.1
"""The wall takes this times the square of how far the squared distance lies beyond it off the log density."""
LEAPS, LEAP = 10, 0.16
"""Steps of a trajectory and their length, in SDs of the normal approximation."""


@dataclass(frozen=True, slots=True)
class Surrogate:
    """Rows' residuals as quadratics: `offset` (rows,), `slope` (rows, n) and `curvature` (rows, n, n), symmetric.

    `weights` (rows, features) are those of the `features`; priors are linear: `middle` (n,) and `factor` (n, n).
    """

    offset: Array
    slope: Array
    curvature: Array
    middle: Array
    factor: Array
    features: LimitFeatures | None
    weights: Array
    wall: float
    heat: float

    def log_density(self, white: Array) -> tuple[float, Array]:
        """Log density of the surrogate's posterior, up to a constant, and its gradient (n,)."""
        bent = self.curvature @ white
        residuals = self.offset + (self.slope + bent) @ white
        vector = self.middle + self.factor @ white
        slopes = self.slope + 2.0 * bent
        if self.features is not None:
            residuals = residuals + self.weights @ self.features.at(vector)
            bent_slopes = self.weights @ self.features.slopes(vector)
            slopes = slopes + bent_slopes @ self.factor[list(self.features.places)]
        beyond = np.maximum(0.0, white @ white - max(self.wall * white.size, LEAST_WALL))
        gradient: Array = -slopes.T @ residuals - self.factor.T @ vector - 4.0 * WALL_RISE * beyond * white
        density = float(-0.5 * (residuals @ residuals + vector @ vector) - WALL_RISE * beyond**2)
        return density / self.heat, gradient / self.heat

    @np.errstate(over="ignore", invalid="ignore", divide="ignore")
    def walk(self, white: Array, random: np.random.RandomState, trajectories: int) -> Array:
        """Ends of some Hamiltonian trajectories, each accepted or not by the surrogate."""
        density, gradient = self.log_density(white)
        for _ in range(trajectories):
            momentum = random.standard_normal(white.size)
            # Lengths differ, so that no direction comes round to where it started.
            leap = LEAP * (0.7 + 0.6 * random.random_sample())
            moved, slope = white, gradient
            energy = density - 0.5 * float(momentum @ momentum)
            for _ in range(LEAPS):
                momentum = momentum + 0.5 * leap * slope
                moved = moved + leap * momentum
                ends, slope = self.log_density(moved)
                momentum = momentum + 0.5 * leap * slope
            gained = ends - 0.5 * float(momentum @ momentum) - energy
            # A trajectory that leaves for infinity is refused.
            if np.isfinite(gained) and np.log(random.random_sample()) < gained:
                white, density, gradient = moved, ends, slope
        return white


def fit_surrogate(
    white: Array,
    residuals: Array,
    middle: Array,
    factor: Array,
    features: LimitFeatures | None = None,
    reach: tuple[float, float] = NARROW,
) -> Surrogate:
    """Weighted least squares from residuals (points, rows) at points (points, n), coefficients kept small."""
    points, size = white.shape
    vectors = middle + white @ factor.T
    first, second = np.triu_indices(size)
    bent = np.empty((points, 0)) if features is None else features.at(vectors)
    columns = np.concatenate([np.ones((points, 1)), white, bent, white[:, first] * white[:, second]], axis=1)
    density = -0.5 * (np.square(residuals).sum(axis=1) + np.square(vectors).sum(axis=1))
    weight = np.exp(0.5 * np.minimum(0.0, (density - np.median(density)) / FADING))[:, None]
    columns *= weight
    linear = size + bent.shape[1]
    small = np.concatenate([[0.0], np.full(size, 0.01), np.full(bent.shape[1], 0.001), np.ones(first.size)])
    normal = columns.T @ columns + np.diag(RIDGE * points * small)
    fitted = np.linalg.solve(normal, columns.T @ (residuals * weight)).T
    curvature = np.zeros((residuals.shape[1], size, size))
    curvature[:, first, second] = 0.5 * fitted[:, 1 + linear :]
    curvature += curvature.transpose(0, 2, 1)
    weights = fitted[:, 1 + size : 1 + linear]
    return Surrogate(fitted[:, 0], fitted[:, 1 : 1 + size], curvature, middle, factor, features, weights, *reach)


COLD_C, WARM_C = (30.0, 31.0, 31.8, 32.0), (31.0, 32.0, 32.4, 34.0)
"""Temperatures of skin at rest in the experiments of the evidence, and near them."""
COUNT = len(COLD_C) + len(WARM_C)


@dataclass(frozen=True, slots=True)
class LimitFeatures:
    """Logarithms of σ(x) at COUNT temperatures, from vectors in SDs of the prior: `places`, `middle` and `sd` (3,)."""

    places: tuple[int, int, int]
    middle: Array
    sd: Array

    @classmethod
    def of(cls, priors: Priors) -> LimitFeatures | None:
        """The features of a posterior; None where its limits are not inferred."""
        if any(name not in priors.names for name in LIMITS):
            return None
        cold, warm, softness = chosen = [priors.names.index(name) for name in LIMITS]
        return cls((cold, warm, softness), priors.middle[chosen], priors.sd[chosen])

    def at(self, vectors: Array) -> Array:
        """Features (..., COUNT) of vectors (..., n)."""
        return -np.logaddexp(0.0, -self._x(vectors))

    def slopes(self, vector: Array) -> Array:
        """Derivatives (COUNT, 3) by the coordinates of the three constants at one vector (n,)."""
        x = self._x(vector)
        softness = float(np.exp(self.middle[2] + self.sd[2] * vector[self.places[2]]))
        slopes = np.zeros((COUNT, 3))
        cold = len(COLD_C)
        slopes[:cold, 0] = self.sd[0] / softness
        slopes[cold:, 1] = -self.sd[1] / softness
        slopes[:, 2] = -self.sd[2] * x
        return slopes * np.exp(-np.logaddexp(0.0, x))[:, None]

    def _x(self, vectors: Array) -> Array:
        cold, warm, log_softness = (
            self.middle[k] + self.sd[k] * vectors[..., place] for k, place in enumerate(self.places)
        )
        away = [cold - at for at in COLD_C] + [at - warm for at in WARM_C]
        return np.asarray(np.stack(away, axis=-1) / np.exp(log_softness)[..., None])
