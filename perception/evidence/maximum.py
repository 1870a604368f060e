"""Maximum of the posterior and the normal approximation around it: seconds where a sampler needs an hour.

Each experiment is also predicted by constants that never saw it: the maximum refitted without its rows. A prediction's
SD has three parts: what the constants leave open (the normal approximation), what a new laboratory may differ by, and
the row's own error. An experiment's laboratory offsets stay at their prior when its rows are gone, so that the second
is in the first wherever the laboratory has no other rows.

Gauss–Newton on the residuals (rows and priors). The Laplace approximation of the evidence is

    ln Z ≈ −½·Σ r² − ½·ln det(JᵀJ)

for a vector in SDs of normal priors; what is left out is the same for every model of the same rows.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..experiments.published import Predictions
from ..observer.priors import WITHIN_95
from .posterior import Posterior
from .rows import Row, load_rows

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

    rounds = 0

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
    )


@dataclass(frozen=True, slots=True)
class LeftOut:
    """One row beside its prediction, on the row's scale: `sd` of the prediction, without the row's own error."""

    row: Row
    predicted: float
    sd: float

    @property
    def score(self) -> float:
        """How far the row lies from its prediction, in SDs of both together."""
        return (self.row.value - self.predicted) / math.hypot(self.sd, self.row.sd)

    @property
    def log_score(self) -> float:
        """Log density of the published value under the prediction."""
        sd = math.hypot(self.sd, self.row.sd)
        return -0.5 * self.score**2 - math.log(sd * math.sqrt(2.0 * math.pi))

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of what would be measured, on the row's scale."""
        half = WITHIN_95 * math.hypot(self.sd, self.row.sd)
        return self.predicted - half, self.predicted + half


def leave_each_out(whole: Maximum, progress: Callable[[int, int, str], None] | None = None) -> tuple[LeftOut, ...]:
    """Refit without each experiment in turn, from the maximum of all; rows in the order of the likelihood."""
    base = whole.posterior
    experiments = tuple(dict.fromkeys(row.experiment for row in load_rows()))
    results = []
    for done, experiment in enumerate(experiments):
        if progress is not None:
            progress(done, len(experiments), experiment)
        posterior = Posterior(base.variable, base.without, frozenset({experiment}))
        refitted = maximise(posterior, whole.vector)
        rows = [row for row in load_rows() if row.experiment == experiment]
        spread = prediction_sd(refitted, rows)
        results += [
            LeftOut(row, refitted.predictions[row.key], sd) for row, sd in zip(rows, spread.tolist(), strict=True)
        ]
    return tuple(results)


def prediction_sd(maximum: Maximum, rows: list[Row]) -> Array:
    """SD (rows,) of predictions by the normal approximation: their gradient through the constants' covariance."""
    columns = []
    for place in range(maximum.vector.size):
        step = np.zeros(maximum.vector.size)
        step[place] = STEP
        up, down = (_at(maximum.posterior.predictions(maximum.vector + side * step), rows) for side in (1.0, -1.0))
        columns.append((up - down) / (2.0 * STEP))
    gradient = np.stack(columns, axis=1)
    variance: Array = np.einsum("ri,ij,rj->r", gradient, maximum.covariance, gradient)
    return np.sqrt(np.maximum(variance, 0.0))


def _at(predictions: Predictions, rows: list[Row]) -> Array:
    return np.array([predictions[row.key] for row in rows])
