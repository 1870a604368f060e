"""Answers and measurements as data: what is simulated of them in laboratories, and how likely they are there.

This is all in which they differ; `condition` does with both what it does with either.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from ..arrays import Array
from ..experiments.measure import Setting
from .conditioning import Step
from .likelihood import PooledLikelihood, log_likelihoods, person_log_likelihoods
from .measurement_likelihood import Emulated, Predicted, log_likelihood, predicted
from .measurements_file import Measurements
from .playing import Confusions, Stage
from .prediction import Fit, MeasurementFit, Three, compare, compare_measurements, three
from .states import Laboratories, LaboratoryPrior
from .trials import AnswerScore, Trials, score_person, score_pooled

NEAR_ANSWERS, NEAR_VALUES = 2.0, 25.0
"""Ln L by which a laboratory is less likely than those near the data if it counts half in a fit: those far from the
data keep the polynomial from bending there, and count for little else."""


@dataclass(frozen=True)
class Answered:
    """Answers to a set, which the people of every laboratory are asked to name as well."""

    trials: Trials
    stage: Stage = field(repr=False)
    stream: ClassVar[int] = 12
    rounds: ClassVar[int] = 2
    by_people: ClassVar[bool] = True

    @cached_property
    def pooled(self) -> AnswerScore:
        """Score of all participants together."""
        return score_pooled(self.trials)

    @cached_property
    def each(self) -> tuple[AnswerScore, ...]:
        """Score of each participant."""
        return tuple(score_person(self.trials, person) for person in range(len(self.trials.participants)))

    def simulate(self, some: Laboratories, step: Step | None = None) -> Confusions:
        """Confusions of the people of each laboratory."""
        return self.stage.confusions(some, step)

    def log_likelihood(self, simulated: Confusions) -> Array:
        """Ln likelihood (laboratories,) of all answers, each participant integrated over people."""
        total: Array = log_likelihoods(simulated.probability, self.trials.counts).sum(axis=1)
        return total

    def polynomial(self, place: Array, simulated: Confusions, short: Array) -> Callable[[Array], Array]:
        """Ln likelihood of the pooled answers."""
        return PooledLikelihood.fit(place, simulated, self.trials.counts, 1.0 / (1.0 + np.square(short / NEAR_ANSWERS)))

    def compare(self, simulated: Confusions, seed: int) -> Fit:
        """The answers beside those of the same experiment in these laboratories."""
        return compare(self.trials, simulated, seed=seed)

    def further(self, simulated: Confusions) -> tuple[Three, ...]:
        """Proportion correct of each participant in further trials: people of every laboratory, by their likelihood."""
        each = person_log_likelihoods(simulated.probability, self.trials.counts)
        correct, rows = simulated.each_correct, []
        rng = np.random.default_rng(np.random.SeedSequence([0, 14]))
        for person in range(len(self.trials.participants)):
            weight = np.exp(each[:, :, person] - each[:, :, person].max())
            flat = (weight / weight.sum()).ravel()
            rows.append(three(correct.ravel()[rng.choice(flat.size, size=2000, p=flat)]))
        return tuple(rows)

    def details(self, simulated: Confusions) -> Array:
        """Proportion correct (laboratories, icons) of each icon."""
        return np.diagonal(simulated.pooled, axis1=1, axis2=2)

    def provenance(self, where: str) -> tuple[str, ...]:
        """Lines on the answers, and where they were given."""
        return (
            f"conditioned on: {self.trials.source or 'answers'}, sha256 {self.trials.digest or 'unknown'}",
            f"participants: {len(self.trials.participants)}",
            f"trials: {self.trials.total}",
            f"icons: {len(self.trials.icons)}, {where}",
        )

    def to_dict(self, own: tuple[Three, ...]) -> dict[str, Any]:
        """Every number of the answers as plain data, with what participants are predicted to reach."""
        trials = self.trials
        return {
            "trials_file": trials.source,
            "trials_sha256": trials.digest,
            "participants": len(trials.participants),
            "trials": trials.total,
            "icons": list(trials.icons),
            "never_presented": list(trials.never_presented),
            "single_trial": list(trials.single_trial),
            "warnings": list(trials.warnings),
            "counts": trials.pooled.astype(int).tolist(),
            "observed": self.pooled.to_dict(),
            "each": [{**score.to_dict(), "predicted": list(each)} for score, each in zip(self.each, own, strict=True)],
        }


@dataclass(frozen=True)
class Measured:
    """Thresholds, reaction times and ratings, which every laboratory measures as well, with one and the same crowd."""

    measurements: Measurements
    prior: LaboratoryPrior = field(repr=False)
    setting: Setting = field(repr=False)
    stream: ClassVar[int] = 31
    rounds: ClassVar[int] = 3
    by_people: ClassVar[bool] = False

    def simulate(self, some: Laboratories, step: Step | None = None) -> Predicted:
        """Means, covariances and scatter of the values in each laboratory."""
        return predicted(self.prior, some, self.setting, self.measurements.conditions, step)

    def log_likelihood(self, simulated: Predicted) -> Array:
        """Ln likelihood (laboratories,) of all values."""
        return log_likelihood(self.measurements, simulated)

    def polynomial(self, place: Array, simulated: Predicted, short: Array) -> Callable[[Array], Array]:
        """Ln likelihood with polynomials for means, covariances and scatter."""
        return Emulated.fit(self.measurements, place, simulated, 1.0 / (1.0 + short / NEAR_VALUES))

    def compare(self, simulated: Predicted, seed: int) -> MeasurementFit:
        """Group means beside those of the same measurements in these laboratories."""
        return compare_measurements(self.measurements, simulated, seed=seed)

    def further(self, simulated: Predicted) -> tuple[Three, ...]:
        """Nothing: participants who were measured have not been asked to name icons."""
        return ()

    def details(self, simulated: Predicted) -> Array:
        """Log means (laboratories, conditions)."""
        return simulated.mean

    def provenance(self, where: str) -> tuple[str, ...]:
        """Lines on the values, and where they were measured."""
        values = self.measurements
        return (
            f"conditioned on: {values.source or 'measurements'}, sha256 {values.digest or 'unknown'}",
            f"participants: {len(values.participants)}",
            f"values: {values.total}",
            f"conditions: {'; '.join(each.label for each in values.conditions)}, {where}",
        )

    def to_dict(self, own: tuple[Three, ...]) -> dict[str, Any]:
        """What was measured as plain data; the values themselves are those of the fit."""
        values = self.measurements
        return {
            "measurements_file": values.source,
            "measurements_sha256": values.digest,
            "participants": len(values.participants),
            "values": values.total,
            "errors_assumed": values.assumed_errors,
        }
