"""Which constant carries the doubt about a prediction, read from the draws that its intervals are made of.

For each constant, the share of the variance between draws that would go if it were measured: the variance explained by
a parabola in its normal scores, without what chance alone explains. Constants of one draw belong together, so that the
shares of constants that trade off overlap and need not add up to 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from ..arrays import Array
from .laboratory_draws import LaboratoryDraws

TERMS = 2
LEAST_SHARE = 0.02
"""Smaller shares are within what chance makes of 128 draws."""


@dataclass(frozen=True, slots=True)
class Doubt:
    """One constant, and the share (0–1) of the variance of the proportion correct that a measurement would remove."""

    name: str
    share: float

    def to_dict(self) -> dict[str, str | float]:
        """The keys of the ranking file."""
        return {"constant": self.name, "share_of_variance": self.share}


def doubts(each: LaboratoryDraws) -> tuple[Doubt, ...]:
    """Constants that act on the set and carry at least 2 % of the variance of the proportion correct, largest first."""
    shares = explained(each.values, each.proportion_correct)
    found = [
        Doubt(name, float(share))
        for name, share, acts in zip(each.names, shares, each.acts, strict=True)
        if acts and share >= LEAST_SHARE
    ]
    return tuple(sorted(found, key=lambda doubt: (-doubt.share, doubt.name)))


def explained(values: Array, predicted: Array) -> Array:
    """Adjusted shares (constants,) of the variance of `predicted` (draws,) that each column of `values` explains."""
    return np.array([explained_together(values[:, [place]], predicted) for place in range(values.shape[1])])


def explained_together(values: Array, predicted: Array) -> float:
    """Adjusted share of the variance of `predicted` (draws,) that some columns of `values` explain together.

    Parabolas in the normal scores of each; interactions are left out.
    """
    varied = [column for column in values.T if np.ptp(column) > 0.0]
    draws, terms = predicted.size, TERMS * len(varied)
    off = predicted - predicted.mean()
    total = float(off @ off)
    if total <= 0.0 or not varied or draws <= terms + 2:
        return 0.0
    scores = np.stack([scores_of(column) for column in varied], axis=1)
    design = np.hstack([scores, scores**2 - (scores**2).mean(axis=0)])
    left = off - design @ np.linalg.lstsq(design, off, rcond=None)[0]
    return max(1.0 - float(left @ left) / total * (draws - 1) / (draws - terms - 1), 0.0)


def scores_of(values: Array) -> Array:
    """Normal scores (draws,) of the ranks of some values."""
    scores = np.empty(values.size)
    scores[np.argsort(values, kind="stable")] = [
        NormalDist().inv_cdf((k + 0.5) / values.size) for k in range(values.size)
    ]
    return scores
