"""What people of laboratories reach in measurements (`experiments.measure`): means, covariances and scatter of logs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..experiments.crowd import PEOPLE, SEED
from ..experiments.laboratory import Laboratory
from ..experiments.measure import Condition, Setting, logs_of
from ..kernels.parallel import in_order
from ..observer.draws import BETWEEN_LABORATORIES
from .states import OFFSETS, Laboratories, LaboratoryPrior


@dataclass(frozen=True, slots=True)
class Predicted:
    """Predictions of conditions in laboratories: logs of people's values.

    `mean` (laboratories, conditions) over people, `between` (laboratories, conditions, conditions) their covariance,
    `within` (laboratories, conditions) the SD of the log of one trial.
    """

    mean: Array
    between: Array
    within: Array

    def of(self, which: NDArray[np.int64]) -> Predicted:
        """Those of some laboratories."""
        return Predicted(self.mean[which], self.between[which], self.within[which])

    def joined(self, other: Predicted) -> Predicted:
        """These and those of further laboratories."""
        pairs = zip((self.mean, self.between, self.within), (other.mean, other.between, other.within), strict=True)
        return Predicted(*(np.concatenate(pair) for pair in pairs))


def measuring(
    prior: LaboratoryPrior, row: Array, setting: Setting, people: int = PEOPLE, seed: int = SEED
) -> Laboratory:
    """A laboratory by a row of `LaboratoryPrior.values`, which measures in a setting."""
    named: dict[str, float] = dict(zip(prior.names, row.tolist(), strict=True))
    offsets = [named[offset] / named[BETWEEN_LABORATORIES] for offset in OFFSETS]
    return setting.laboratory(named, offsets, prior.draws.variable, people, seed)


def predicted(
    prior: LaboratoryPrior,
    some: Laboratories,
    setting: Setting,
    conditions: Sequence[Condition],
    step: Callable[[], None] | None = None,
) -> Predicted:
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
    return Predicted(*(np.stack([parts[k] for parts in found]) for k in range(3)))
