r"""The likelihood of measurements in a laboratory.

Logs of the values of participant j are normal, and participants share what the model misses and the scale of ratings:

    y_j = μ(ℓ) + b_j + e_j + δ,   b_j ~ N(0, Σ(ℓ)),   e_j ~ N(0, errors²),   δ ~ N(0, D)

μ and Σ are means and covariances of people who are simulated by `experiments.measure`. Participants measured under the
same conditions with the same errors enter by their mean and scatter. Where no people were simulated, polynomials of the
coordinates take the place of μ and Σ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array

from ..experiments.laboratory import PEOPLE, SEED, Laboratory
from ..experiments.measure import Condition, Setting, logs_of
from ..experiments.tasks import DISCREPANCY, UNSTATED
from ..kernels.parallel import in_order
from .likelihood import features_of, ridge, smooth_features
from .measurements_file import Measurements
from .states import Laboratories, LaboratoryPrior

RATING_SCALE = 0.7
"""SD (ln) by which another laboratory's scale of ratings may differ from the published one: a factor of 2; assumed."""
RATING_PEOPLE = 0.4
"""SD (ln) by which people differ in their use of a scale; E2 has an SD of 23 points at a mean of 51."""
NUGGET = 1e-6
"""Least variance (ln²) between people: of people, however many take part, and above the rounding of any conditions."""
LEAST_LOG, MOST_LOG = -8.0, 3.0
"""Logs of SDs (ln) that polynomials may give; trials of which none is felt do not scatter at all."""


@dataclass(frozen=True, slots=True)
class Group:
    """Participants with values under the same `conditions` (numbers), with the same errors; of their logs.

    `stated` (conditions,) are errors as given (NaN: by `trials`, and where these are NaN too, as assumed).
    """

    conditions: NDArray[np.int64]
    count: int
    mean: Array
    scatter: Array
    stated: Array
    trials: Array


def groups_of(measured: Measurements, *, alike: bool = False) -> tuple[Group, ...]:
    """Participants by what is known of them; `alike` takes the mean square of errors that differ, which is faster."""
    stated, trials = measured.errors / measured.values, measured.trials
    by: dict[tuple[float, ...], list[int]] = {}
    for person, there in enumerate(measured.given):
        known = np.where(np.isnan(stated[person]), np.where(np.isnan(trials[person]), 2.0, 1.0), 0.0)
        own = known if alike else np.nan_to_num(np.concatenate([known, stated[person], trials[person]]), nan=-1.0)
        by.setdefault(tuple(np.concatenate([there, own]).tolist()), []).append(person)
    found = []
    for members in by.values():
        people = np.array(members, dtype=np.int64)
        used = np.flatnonzero(measured.given[people[0]])
        logs = np.log(measured.values[np.ix_(people, used)])
        off = logs - logs.mean(axis=0)
        error = np.sqrt(np.square(stated[np.ix_(people, used)]).mean(axis=0))
        number = 1.0 / (1.0 / trials[np.ix_(people, used)]).mean(axis=0)
        found.append(Group(used, len(people), logs.mean(axis=0), off.T @ off, error, number))
    return tuple(found)


def shared_covariance(measured: Measurements) -> Array:
    """D (conditions, conditions): what the model may miss, and the laboratory's scale of ratings."""
    rated = _rated(measured)
    return DISCREPANCY**2 * np.eye(len(rated)) + RATING_SCALE**2 * np.outer(rated, rated)


def person_covariance(measured: Measurements, between: Array) -> Array:
    """Σ (..., conditions, conditions): people as simulated, and their use of the scale of ratings."""
    rated = _rated(measured)
    return between + RATING_PEOPLE**2 * np.outer(rated, rated) + NUGGET * np.eye(len(rated))


def log_likelihood(measured: Measurements, each: SimulatedMeasurements, groups: tuple[Group, ...] = ()) -> Array:
    """Ln likelihood (laboratories,) of all values, up to a constant."""
    shared, spread = shared_covariance(measured), person_covariance(measured, each.between)
    count = len(shared)
    precision, weighted = np.zeros((len(each.mean), count, count)), np.zeros((len(each.mean), count))
    total = np.zeros(len(each.mean))
    for group in groups or groups_of(measured):
        used = group.conditions
        error = log_errors(group.stated, group.trials, each.within[:, used])
        own = spread[:, used[:, None], used] + np.square(error)[:, :, None] * np.eye(len(used))
        inverse = np.linalg.inv(own)
        off = group.mean - each.mean[:, used]
        along = np.einsum("nkl,nl->nk", inverse, off)
        total -= 0.5 * group.count * (np.linalg.slogdet(own)[1] + (along * off).sum(axis=1))
        total -= 0.5 * np.einsum("nkl,kl->n", inverse, group.scatter)
        precision[:, used[:, None], used] += group.count * inverse
        weighted[:, used] += group.count * along
    inner = np.linalg.inv(shared) + precision
    total += 0.5 * (weighted * np.linalg.solve(inner, weighted[:, :, None])[:, :, 0]).sum(axis=1)
    return np.asarray(total - 0.5 * np.linalg.slogdet(inner)[1])


def log_errors(stated: Array, trials: Array, within: Array) -> Array:
    """Standard errors (..., conditions) of logs: as stated, else by trials, else `UNSTATED`."""
    by_trials = within / np.sqrt(trials)
    return np.where(np.isnan(stated), np.where(np.isnan(by_trials), UNSTATED, by_trials), stated)


def _rated(measured: Measurements) -> Array:
    return np.array([float(each.kind == "rating") for each in measured.conditions])


@dataclass(frozen=True, slots=True)
class Emulator:
    """Ln likelihood at coordinates (n, d), from polynomials for mean, covariance and scatter of trials."""

    measured: Measurements
    groups: tuple[Group, ...]
    coefficients: Array
    pairs: tuple[tuple[int, int], ...]

    @classmethod
    def fit(cls, measured: Measurements, place: Array, each: SimulatedMeasurements, weight: Array) -> Emulator:
        """Fit to simulated laboratories, each of which counts by its `weight` (n,)."""
        targets, own = _flat(each), weight / weight.mean()
        features, pairs = smooth_features(place, targets / targets.std(axis=0).clip(1e-9), own)
        return cls(measured, groups_of(measured, alike=True), ridge(features, targets, own)[0], pairs)

    def __call__(self, place: Array) -> Array:
        """Ln likelihood (n,), up to a constant."""
        each = _predicted(features_of(place, self.pairs) @ self.coefficients, len(self.measured.conditions))
        return log_likelihood(self.measured, each, self.groups)


def _flat(each: SimulatedMeasurements) -> Array:
    """Means, logs of scatter, and the logarithmic Cholesky factor of Σ: numbers without bounds."""
    root = np.linalg.cholesky(each.between + NUGGET * np.eye(each.mean.shape[1]))
    rows, columns = np.tril_indices(each.mean.shape[1], -1)
    diagonal = np.log(np.diagonal(root, axis1=1, axis2=2))
    within = np.log(np.maximum(each.within, np.exp(LEAST_LOG)))
    return np.hstack([each.mean, within, diagonal, root[:, rows, columns]])


def _predicted(flat: Array, count: int) -> SimulatedMeasurements:
    rows, columns = np.tril_indices(count, -1)
    mean, within, diagonal, below = (flat[:, a:b] for a, b in pairwise((0, count, 2 * count, 3 * count, flat.shape[1])))
    root = np.zeros((len(flat), count, count))
    root[:, range(count), range(count)] = np.exp(np.clip(diagonal, LEAST_LOG, MOST_LOG))
    root[:, rows, columns] = below
    return SimulatedMeasurements(mean, root @ np.swapaxes(root, 1, 2), np.exp(np.clip(within, LEAST_LOG, MOST_LOG)))


@dataclass(frozen=True, slots=True)
class SimulatedMeasurements:
    """Logs of people's values in laboratories: `mean` (laboratories, conditions), `between`, the covariance of people
    (laboratories, conditions, conditions), and `within` (laboratories, conditions), the SD of one trial.
    """

    mean: Array
    between: Array
    within: Array

    def of(self, which: NDArray[np.int64]) -> SimulatedMeasurements:
        """Those of some laboratories."""
        return SimulatedMeasurements(self.mean[which], self.between[which], self.within[which])

    def joined(self, other: SimulatedMeasurements) -> SimulatedMeasurements:
        """These and those of further laboratories."""
        pairs = zip((self.mean, self.between, self.within), (other.mean, other.between, other.within), strict=True)
        return SimulatedMeasurements(*(np.concatenate(pair) for pair in pairs))


def measuring(
    prior: LaboratoryPrior, row: Array, setting: Setting, people: int = PEOPLE, seed: int = SEED
) -> Laboratory:
    """A laboratory by a row of `LaboratoryPrior.values`, which measures in a setting."""
    return setting.laboratory(*prior.observer_of(row), people, seed)


def predicted(
    prior: LaboratoryPrior,
    some: Laboratories,
    setting: Setting,
    conditions: Sequence[Condition],
    step: Callable[[], None] | None = None,
) -> SimulatedMeasurements:
    """Predict conditions in laboratories, with the same crowd in each; `step` is called after each."""
    values = prior.values(some)

    def one(k: int) -> tuple[Array, Array, Array]:
        place = measuring(prior, values[k], setting)
        each = [logs_of(place, setting, condition) for condition in conditions]
        logs = np.stack([log for log, _ in each], axis=1)
        return logs.mean(axis=0), np.atleast_2d(np.cov(logs.T)), np.array([within for _, within in each])

    found = []
    for each in in_order(one, range(len(some))):
        found.append(each)
        if step is not None:
            step()
    return SimulatedMeasurements(*(np.stack([parts[k] for parts in found]) for k in range(3)))
