"""Each experiment predicted by constants that never saw it: the maximum refitted without its rows.

A prediction's SD has three parts: what the constants leave open (the normal approximation around the maximum), what a
new laboratory may differ by, and the row's own error. An experiment's laboratory offsets stay at their prior when its
rows are gone, so that the second is in the first wherever the laboratory has no other rows.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..experiments.published import Predictions
from ..observer.priors import WITHIN_95
from .maximum import STEP, Maximum, maximise
from .posterior import Posterior
from .rows import Row, load_rows

Progress = Callable[[int, int, str], None]


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
    def covered(self) -> bool:
        """Whether the 95 % interval of what would be measured contains what was."""
        return abs(self.score) <= WITHIN_95

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

    def __repr__(self) -> str:
        low, high = (self.row.shown(end) for end in self.interval)
        return (
            f"LeftOut({self.row.label}: published {self.row.shown(self.row.value):.3g}, "
            f"predicted {self.row.shown(self.predicted):.3g} [{low:.3g}, {high:.3g}])"
        )


def leave_each_out(whole: Maximum, progress: Progress | None = None) -> tuple[LeftOut, ...]:
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
