"""How good left-out predictions are: quantiles, log score against a naive baseline, and weights of the variants.

The naive baseline knows no model: it predicts a row by the mean and spread of the same kind of number in the other
experiments. Rows of a kind that no two other experiments have are not compared with it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..observer.observer import load_thresholds
from .left_out import Predictive
from .rows import Row, load_rows

LN10 = math.log(10.0)
KINDS: Mapping[str, tuple[str, float]] = {
    "threshold_gm": ("threshold", 1.0),
    "threshold50_gm_age30": ("threshold", 1.0),
    "cold_change_at_report_peak1_age_lt36": ("threshold", 1.0),
    "detection threshold": ("threshold", 1.0),
    "rt_between_sd_ln_5strip_onset_clock": ("between people", 1.0),
    "between_sd_log10_noise_removed": ("between people", LN10),
    "threshold_between_sd_log10_noise_removed": ("between people", LN10),
    "between_people_sd_peak1_age_lt36": ("between people", 1.0),
    "spread of detection thresholds": ("between people", 1.0),
    "rt_within_sd_ln_5strip_onset_clock": ("within people", 1.0),
    "within_sd_log10_median_person": ("within people", LN10),
    "within_sd_ln_peak1": ("within people", 1.0),
    "rt_cold_warm_correlation_5strip_onset_clock": ("correlation", 1.0),
    "cold_warm_correlation_log": ("correlation", 1.0),
    "cold_warm_threshold_correlation_person_fits": ("correlation", 1.0),
}
"""Kind of each statistic that several experiments have, and what its value is multiplied by to compare them."""
FEWEST = 2
"""Other experiments that a baseline needs: one has no spread."""


@dataclass(frozen=True, slots=True)
class Score:
    """One left-out row on its own scale: quantiles of what would be measured, and log scores.

    `probability` is that of a smaller number than the published one, `baseline` the log score of the naive baseline
    (NaN where there is none).
    """

    row: Row
    quantiles: tuple[float, float, float, float, float]
    probability: float
    log_score: float
    baseline: float
    k_hat: float
    method: str


SHARES = (0.025, 0.25, 0.5, 0.75, 0.975)
"""Shares of the quantiles: both ends of the 95 % interval, of the 50 % interval, and the median."""


def score(predictive: Predictive) -> Score:
    """The scores of one row."""
    low, lower, middle, upper, high = (predictive.quantile(share) for share in SHARES)
    return Score(
        predictive.row,
        (low, lower, middle, upper, high),
        predictive.probability,
        predictive.log_score,
        naive_log_score(predictive.row),
        predictive.k_hat,
        predictive.method,
    )


def naive_log_score(row: Row) -> float:
    """Log density of a row under the mean and spread of its kind in the other experiments; NaN where there are few."""
    kind = KINDS.get(row.key[1])
    if kind is None:
        return math.nan
    others = [
        _comparable(other)
        for other in load_rows()
        if other.experiment != row.experiment
        and other.key[2] == row.key[2]
        and KINDS.get(other.key[1], ("", 1.0))[0] == kind[0]
    ]
    if len(others) < FEWEST:
        return math.nan
    spread = float(np.std(others, ddof=1)) * math.sqrt(1.0 + 1.0 / len(others))
    sd = math.hypot(spread, kind[1] * row.sd)
    miss = (_comparable(row) - float(np.mean(others))) / sd
    # A density on the comparable scale is the factor times smaller than on the row's own.
    return -0.5 * miss**2 - math.log(sd * math.sqrt(2.0 * math.pi)) + math.log(kind[1])


def _comparable(row: Row) -> float:
    """The published number where it can be compared with others of its kind."""
    value = KINDS[row.key[1]][1] * row.value
    if row.key[1] == "detection threshold":
        # The row holds a multiple of the published threshold, 1; the kind compares thresholds in K.
        value += math.log(load_thresholds().one("detection threshold", channel=row.key[2], site=row.key[0]).central)
    return value


def stacking_weights(log_scores: Array, rounds: int = 2000) -> Array:
    """Weights (variants,) that sum to 1 and maximise the log score of the mixture, from log scores (variants, rows).

    Expectation–maximisation, which rises with every round (Yao, Vehtari, Simpson & Gelman 2018).

    >>> stacking_weights(np.array([[0.0, 0.0], [-9.0, -9.0]])).round(2)
    array([1., 0.])
    """
    densities = np.exp(log_scores - log_scores.max(axis=0))
    weights = np.full(len(densities), 1.0 / len(densities))
    for _ in range(rounds):
        shares = weights[:, None] * densities
        weights = (shares / shares.sum(axis=0)).mean(axis=1)
    return weights
