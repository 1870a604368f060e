"""Maximum of the posterior and the normal approximation around it: seconds where a sampler needs an hour.

Gauss–Newton on the residuals (rows and priors). The Laplace approximation of the evidence is

    ln Z ≈ −½·Σ r² − ½·ln det(JᵀJ)

for a vector in SDs of normal priors; what is left out is the same for every model of the same rows.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..experiments.published import Predictions
from ..observer.priors import WITHIN_95
from .posterior import Posterior

STEP = 0.04
"""Half the width of a central difference, in SDs of the prior: wide enough to see over the grain of few people."""
CLOSE = 1e-3
MOST_ROUNDS = 25


@dataclass(frozen=True, slots=True)
class Maximum:
    """The most probable constants of a posterior: `vector` (n,) and its covariance (n, n), in SDs of the prior."""

    posterior: Posterior
    vector: Array
    covariance: Array
    log_evidence: float
    predictions: Predictions
    rounds: int
    seconds: float

    @property
    def values(self) -> dict[str, float]:
        """Constants by name."""
        return self.posterior.values(self.vector)

    @property
    def sd(self) -> Array:
        """SD (n,) of each constant, in SDs of its prior: 1 where the rows say nothing."""
        spread: Array = np.sqrt(np.diag(self.covariance))
        return spread

    def interval(self, name: str, half_width: float = WITHIN_95) -> tuple[float, float]:
        """Interval of one constant in its own unit; 95 % unless another number of SDs is given."""
        place = self.posterior.priors.names.index(name)
        prior, sd = self.posterior.priors.each[place], float(self.sd[place])
        ends = (float(self.vector[place]) + side * half_width * sd for side in (-1.0, 1.0))
        low, high = (prior.to_value(prior.middle + prior.sd * end) for end in ends)
        return low, high

    def missed(self) -> dict[tuple[str, str, str], float]:
        """How far each row that counts is missed, in its own SDs."""
        return {row.key: (self.predictions[row.key] - row.value) / row.sd for row in self.posterior.rows}

    def __repr__(self) -> str:
        worst = max((abs(each) for each in self.missed().values()), default=0.0)
        return (
            f"Maximum({len(self.posterior.rows)} rows, {len(self.posterior.priors)} constants: "
            f"log evidence {self.log_evidence:.1f}, worst row {worst:.1f} SD)"
        )


def maximise(
    posterior: Posterior, start: Array | None = None, progress: Callable[[int, float], None] | None = None
) -> Maximum:
    """Search from the middle of the priors or from `start`; `progress` is called with (round, sum of squares).

    Central differences in every direction and a trust region: scipy's least squares.
    """
    from scipy.optimize import least_squares

    begun, rounds = time.perf_counter(), 0

    def jacobian(vector: Array) -> Array:
        nonlocal rounds
        rounds += 1
        columns = []
        for place in range(vector.size):
            step = np.zeros(vector.size)
            step[place] = STEP
            columns.append((posterior.residuals(vector + step) - posterior.residuals(vector - step)) / (2.0 * STEP))
        if progress is not None:
            progress(rounds, float(np.square(posterior.residuals(vector)).sum()))
        return np.stack(columns, axis=1)

    first = np.zeros(len(posterior.priors)) if start is None else start
    found = least_squares(
        posterior.residuals, first, jac=jacobian, xtol=CLOSE, ftol=CLOSE, max_nfev=MOST_ROUNDS, x_scale=1.0
    )
    slopes: Array = np.asarray(found.jac)
    curvature: Array = slopes.T @ slopes
    log_evidence = -float(found.cost) - 0.5 * float(np.linalg.slogdet(curvature)[1])
    return Maximum(
        posterior,
        found.x,
        np.linalg.inv(curvature).astype(np.float64),
        log_evidence,
        posterior.predictions(found.x),
        rounds,
        time.perf_counter() - begun,
    )
