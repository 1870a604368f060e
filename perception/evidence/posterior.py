"""The log posterior of the constants with its normal approximation at the maximum.

The maximum takes seconds where a sampler needs an hour. Gauss–Newton on the residuals; the Laplace approximation of the
evidence is

    ln Z ≈ −½·Σ r² − ½·ln det(JᵀJ)

for a vector in SDs of normal priors; what is left out is the same for every model of the same rows.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array

from ..experiments.laboratory import Laboratory
from ..experiments.published import Predictions, predict
from ..observer.channels import Variable
from ..observer.constants import names_of, offsets_in
from ..observer.observer import Observer
from ..observer.priors import LABORATORIES, WITHIN_95, Priors, load_priors, priors_of
from .rows import SAME_PEOPLE, Row, load_rows

BoolArray = NDArray[np.bool_]
FARTHEST = 30.0
"""A row that is missed by more standard deviations counts as this many, so that a wild step is not fatal."""
LIMITS = names_of(Observer, "limit_C", "softness_K")
"""Constants of the limits, which heat flow does not have; they are fixed where they do nothing."""


@dataclass(frozen=True)
class Posterior:
    """The inferred constants and their rows: vectors are in SDs of the prior, 0 at its middle.

    >>> posterior = Posterior()
    >>> len(posterior.priors), len(posterior.rows)
    (55, 67)
    """

    variable: Variable = "temperature"
    left_out: frozenset[str] = frozenset()

    @cached_property
    def fixed(self) -> Mapping[str, float]:
        """Parameters that are not inferred here, with their values."""
        middle = load_priors().values(load_priors().middle)
        return {name: middle[name] for name in LIMITS} if self.variable == "heat flow" else {}

    @cached_property
    def priors(self) -> Priors:
        """Priors of what is inferred: the constants and an offset for each laboratory and channel."""
        return priors_of(self.variable).without(tuple(self.fixed))

    @property
    def rows(self) -> tuple[Row, ...]:
        """The rows that count."""
        return tuple(compress(load_rows(), self.counted))

    @cached_property
    def counted(self) -> BoolArray:
        """Which of all rows count; people are left out with all experiments that they took part in."""
        left_out = {SAME_PEOPLE.get(each, each) for each in self.left_out}
        return np.array([row.people not in left_out for row in load_rows()])

    def values(self, vector: Array) -> dict[str, float]:
        """Constants by name from a vector in SDs of the prior."""
        return {**self.fixed, **self.priors.values(self.priors.middle + self.priors.sd * vector)}

    def predictions(self, vector: Array) -> Predictions:
        """Predictions of every row, left out or not."""
        values = self.values(vector)
        return predict(Laboratory.of(Observer.from_values(values, self.variable), offsets_in(values, LABORATORIES)))

    def residuals(self, vector: Array) -> Array:
        """Misses of rows and distances from the priors' middles, in SDs: half their squares are −log posterior."""
        return np.concatenate([self.misses(vector)[self.counted], vector])

    def misses(self, vector: Array) -> Array:
        """Misses of all rows, left out or not, in their SDs."""
        predictions = self.predictions(vector)
        missed = np.array([(predictions[row.key] - row.value) / row.sd for row in load_rows()])
        return np.asarray(np.clip(np.nan_to_num(missed, nan=FARTHEST), -FARTHEST, FARTHEST))


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
        return np.sqrt(np.diag(self.covariance))

    def interval(self, name: str, half_width: float = WITHIN_95) -> tuple[float, float]:
        """Interval of one constant in its own unit; 95 % unless another number of SDs is given."""
        place = self.posterior.priors.names.index(name)
        prior, sd = self.posterior.priors.each[place], float(self.sd[place])
        ends = (float(self.vector[place]) + side * half_width * sd for side in (-1.0, 1.0))
        low, high = (prior.to_value(prior.middle + prior.sd * end) for end in ends)
        return low, high


def maximise(
    posterior: Posterior, start: Array | None = None, progress: Callable[[int], None] | None = None
) -> Maximum:
    """Search from the middle of the priors or from `start`; `progress` is called with the rounds so far."""
    from scipy.optimize import least_squares

    rounds = 0

    def jacobian(vector: Array) -> Array:
        nonlocal rounds
        rounds += 1
        steps, at = STEP * np.eye(vector.size), posterior.residuals
        columns = [(at(vector + step) - at(vector - step)) / (2.0 * STEP) for step in steps]
        if progress is not None:
            progress(rounds)
        return np.stack(columns, axis=1)

    first = np.zeros(len(posterior.priors)) if start is None else start
    found = least_squares(
        posterior.residuals, first, jac=jacobian, xtol=CLOSE, ftol=CLOSE, max_nfev=MOST_ROUNDS, x_scale=1.0
    )
    slopes: Array = np.asarray(found.jac)
    curvature: Array = slopes.T @ slopes
    log_evidence = -float(found.cost) - 0.5 * float(np.linalg.slogdet(curvature)[1])
    covariance = np.linalg.inv(curvature).astype(np.float64)
    return Maximum(posterior, found.x, covariance, log_evidence, posterior.predictions(found.x), rounds)


@dataclass(frozen=True, slots=True)
class LeftOut:
    """One row beside its prediction, on the row's scale: `sd` is of what would be measured, with the row's error."""

    row: Row
    predicted: float
    sd: float

    @property
    def score(self) -> float:
        """Distance of the row from its prediction, in SDs."""
        return (self.row.value - self.predicted) / self.sd

    @property
    def log_score(self) -> float:
        """Log density of the published value under the prediction."""
        return -0.5 * self.score**2 - math.log(self.sd * math.sqrt(2.0 * math.pi))

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of what would be measured, on the row's scale."""
        return self.predicted - WITHIN_95 * self.sd, self.predicted + WITHIN_95 * self.sd


def leave_each_out(whole: Maximum, progress: Callable[[int, int, str], None] | None = None) -> tuple[LeftOut, ...]:
    """Refit without each group of people in turn, from the maximum of all; rows in the order of the likelihood.

    Offsets of laboratories whose rows are gone stay at their prior, so that what a new one may differ by is in it too.
    """
    experiments = tuple(dict.fromkeys(row.people for row in load_rows()))
    results = {}
    for done, experiment in enumerate(experiments):
        if progress is not None:
            progress(done, len(experiments), experiment)
        refitted = maximise(Posterior(whole.posterior.variable, frozenset({experiment})), whole.vector)
        rows = [row for row in load_rows() if row.people == experiment]
        for row, sd in zip(rows, prediction_sd(refitted, rows).tolist(), strict=True):
            results[row.key] = LeftOut(row, refitted.predictions[row.key], math.hypot(sd, row.sd))
    return tuple(results[row.key] for row in load_rows())


def prediction_sd(maximum: Maximum, rows: list[Row]) -> Array:
    """SD (rows,) of predictions by the normal approximation: their gradient through the constants' covariance."""

    def at(vector: Array) -> Array:
        predictions = maximum.posterior.predictions(vector)
        return np.array([predictions[row.key] for row in rows])

    steps = STEP * np.eye(maximum.vector.size)
    slopes = [(at(maximum.vector + step) - at(maximum.vector - step)) / (2.0 * STEP) for step in steps]
    gradient = np.stack(slopes, axis=1)
    variance: Array = np.einsum("ri,ij,rj->r", gradient, maximum.covariance, gradient)
    return np.sqrt(np.maximum(variance, 0.0))
