"""Measured group means beside what was predicted of the same measurements, and a test of fit.

The same measurements are simulated with as many participants, each time in another laboratory. The statistic is the
sum over conditions of the squared deviation of the log group mean, in SDs of the simulated ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .measurement_likelihood import log_errors, person_covariance, shared_covariance
from .measurements import Condition, Measurements
from .simulated_measurements import Predicted

EXPERIMENTS = 1000
COVER = (50.0, 2.5, 97.5)


@dataclass(frozen=True, slots=True)
class ConditionFit:
    """One condition: geometric mean of so many participants, and the predicted one, median and 95 %."""

    condition: Condition
    participants: int
    observed: float
    predicted: tuple[float, float, float]

    @property
    def missed(self) -> bool:
        """Whether the measured mean lies outside the interval."""
        return not self.predicted[1] <= self.observed <= self.predicted[2]

    def to_dict(self) -> dict[str, object]:
        """Plain data for JSON."""
        own = self.condition
        return {
            "kind": own.kind,
            "method": own.method,
            "channel": own.channel,
            "baseline_C": own.baseline_C,
            "size_K": own.size_K,
            "rate_K_per_s": own.rate_K_per_s,
            "hold_s": own.hold_s,
            "unit": own.unit,
            "participants": self.participants,
            "observed": self.observed,
            "predicted": list(self.predicted),
            "missed": self.missed,
        }


@dataclass(frozen=True, slots=True)
class MeasurementFit:
    """All conditions, and `p`: the share of simulated laboratories that lie as far from the prediction."""

    p: float
    conditions: tuple[ConditionFit, ...]

    def to_dict(self) -> dict[str, object]:
        """Plain data for JSON."""
        return {"p": self.p, "conditions": [each.to_dict() for each in self.conditions]}


def compare_measurements(
    measured: Measurements, each: Predicted, *, seed: int = 0, experiments: int = EXPERIMENTS
) -> MeasurementFit:
    """Compare measurements with the same ones simulated in the laboratories of a prediction."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 32]))
    there, shared = measured.given, np.linalg.cholesky(shared_covariance(measured))
    means = np.empty((experiments, len(measured.conditions)))
    for row in range(experiments):
        k = row % len(each.mean)
        root = np.linalg.cholesky(person_covariance(measured, each.between[k]))
        people = rng.standard_normal(there.shape) @ root.T
        errors = log_errors(measured, each.within[k]) * rng.standard_normal(there.shape)
        logs = each.mean[k] + people + errors + shared @ rng.standard_normal(len(root))
        means[row] = np.where(there, logs, 0.0).sum(axis=0) / there.sum(axis=0)
    seen = np.log(measured.means)
    spread = means.std(axis=0)
    off = np.square((np.vstack([seen, means]) - means.mean(axis=0)) / spread).sum(axis=1)
    rows = np.exp(np.percentile(means, COVER, axis=0)).T.tolist()
    return MeasurementFit(
        float(np.mean(off >= off[0] - 1e-12)),
        tuple(
            ConditionFit(condition, int(count), float(np.exp(value)), (row[0], row[1], row[2]))
            for condition, count, value, row in zip(
                measured.conditions, there.sum(axis=0).tolist(), seen.tolist(), rows, strict=True
            )
        ),
    )
