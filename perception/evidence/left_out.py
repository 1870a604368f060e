"""Each experiment predicted by a posterior that never saw it, from draws: distributions, not normal approximations.

Draws of the whole posterior are weighted by one over the likelihood of the experiment's rows, with Pareto-smoothed
tails. Where their shape k-hat says that the weights are not to be trusted, the posterior without the rows is fitted
anew: its surrogate proposes draws, and weights of the true posterior over the surrogate, smoothed likewise, put them
right. Points that were weighted badly teach the next surrogate.

A naive baseline knows no model: it predicts a row by the mean and spread of the same kind of number in the other
experiments. Rows of a kind that no two other experiments have are not compared with it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..observer.observer import load_thresholds
from .chains import K_HAT, Evaluate, Points, Reference, fitted, smoothed_weights, walked
from .posterior import Posterior
from .results import LeftOutRow
from .rows import Row, load_rows
from .sampling import evaluation, load_sampled, workers_of
from .surrogate import WIDE, Surrogate

ROUNDS, PROPOSED = 5, 600
"""Most refits of a posterior without an experiment, and draws of each."""
NEWTON_STEPS = 12
PART = 25
FROM_WEIGHTS, REFITTED = "weights", "refit"
SHARES = (0.025, 0.25, 0.5, 0.75, 0.975)
"""Shares of the quantiles: both ends of the 95 % interval, of the 50 % interval, and the median."""


def row_predicted(row: Row, predicted: Array, weights: Array, k_hat: float, method: str) -> LeftOutRow:
    """A row by draws (draws,) of its prediction on its own scale, whose weights (draws,) sum to 1.

    What would be measured differs from a prediction by the row's own error, which is normal.
    """
    from scipy.optimize import brentq
    from scipy.special import ndtr

    def below(value: float) -> float:
        return float(weights @ ndtr((value - predicted) / row.sd))

    far = 12.0 * row.sd
    least, most = float(predicted.min()) - far, float(predicted.max()) + far

    def quantile(share: float) -> float:
        return row.shown(float(brentq(lambda value: below(value) - share, least, most, xtol=1e-6 * (most - least))))

    z = (row.value - predicted) / row.sd
    logs = -0.5 * z * z + np.log(np.maximum(weights, 1e-300))
    top = float(logs.max())
    score = top + float(np.log(np.exp(logs - top).sum())) - float(np.log(row.sd * np.sqrt(2.0 * np.pi)))
    low, lower, median, upper, high = map(quantile, SHARES)
    scores = below(row.value), score, naive_log_score(row), k_hat
    published = row.shown(row.value)
    return LeftOutRow(*row.key, row.label, row.unit, published, low, lower, median, upper, high, *scores, method)


def leave_out(
    experiment: str, draws: Points, reference: Reference, points: Points, seed: int, evaluate: Evaluate
) -> list[LeftOutRow]:
    """Predict an experiment without it.

    `draws` are those of the whole posterior with the misses of all rows, `points` what its surrogate was fitted to.
    """
    posterior = Posterior(left_out=frozenset({experiment}))
    weights, k_hat = smoothed_weights(0.5 * np.square(draws.misses[:, ~posterior.counted]).sum(axis=1))
    best, method = (k_hat, draws, weights), FROM_WEIGHTS
    if k_hat > K_HAT:
        best, method = _refitted(posterior, reference, points.joined(draws), seed, evaluate), REFITTED
    k_hat, chosen, weights = best
    return [
        row_predicted(row, row.value + row.sd * chosen.misses[:, place], weights, k_hat, method)
        for place, row in enumerate(load_rows())
        if row.experiment == experiment
    ]


def _refitted(
    posterior: Posterior, reference: Reference, known: Points, seed: int, evaluate: Evaluate
) -> tuple[float, Points, Array]:
    """The refit whose weights have the best k-hat: k-hat, its proposals, and their weights."""
    random = np.random.RandomState(np.random.MT19937(np.random.SeedSequence([seed, 2 << 20])))
    tried: list[tuple[float, Points, Array]] = []
    for _ in range(ROUNDS):
        surrogate, wide = _fit(posterior, reference, known)
        white = walked(surrogate, random, PROPOSED)
        vectors = wide.vector(white)
        proposed = Points(vectors, evaluate(vectors))
        along = np.array([surrogate.log_density(each)[0] for each in white])
        weights, k_hat = smoothed_weights(_log_density(posterior, proposed) - along)
        tried.append((k_hat, proposed, weights))
        if k_hat <= K_HAT:
            break
        known = known.joined(proposed)
    return min(tried, key=lambda each: each[0])


def _fit(posterior: Posterior, reference: Reference, points: Points) -> tuple[Surrogate, Reference]:
    """A surrogate in coordinates of its own normal approximation, which is wider than that of all rows."""
    surrogate = fitted(posterior, reference, points)
    white = np.zeros(reference.middle.size)
    for _ in range(NEWTON_STEPS):
        _, gradient = surrogate.log_density(white)
        step = np.linalg.solve(surrogate.precision(white), gradient)
        white = white + step * min(1.0, 0.5 / float(np.abs(step).max()))
    wide = Reference.at(
        reference.vector(white), reference.factor @ np.linalg.inv(surrogate.precision(white)) @ reference.factor.T
    )
    return fitted(posterior, wide, points, WIDE), wide


def _log_density(posterior: Posterior, points: Points) -> Array:
    squares: Array = np.square(points.misses[:, posterior.counted]).sum(axis=1) + np.square(points.vectors).sum(axis=1)
    return -0.5 * squares


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


def naive_log_score(row: Row) -> float:
    """Log density of a row under the mean and spread of its kind in the other experiments; NaN where there are few."""
    kind, factor = KINDS.get(row.key[1], ("", 1.0))
    others = [
        _comparable(other)
        for other in load_rows()
        if other.experiment != row.experiment
        and other.key[2] == row.key[2]
        and KINDS.get(other.key[1], ("none", 1.0))[0] == kind
    ]
    if len(others) < FEWEST:
        return math.nan
    spread = float(np.std(others, ddof=1)) * math.sqrt(1.0 + 1.0 / len(others))
    sd = math.hypot(spread, factor * row.sd)
    miss = (_comparable(row) - float(np.mean(others))) / sd
    # A density on the comparable scale is the factor times smaller than on the row's own.
    return -0.5 * miss**2 - math.log(sd * math.sqrt(2.0 * math.pi)) + math.log(factor)


def _comparable(row: Row) -> float:
    """The published number where it can be compared with others of its kind."""
    value = KINDS[row.key[1]][1] * row.value
    if row.key[1] == "detection threshold":
        # The row holds a multiple of the published threshold, 1; the kind compares thresholds in K.
        value += math.log(load_thresholds().one("detection threshold", channel=row.key[2], site=row.key[0]).central)
    return value


def leave_each_out(
    sampled: Path, seed: int = 0, workers: int = 1, progress: Callable[[int, int, str], None] | None = None
) -> tuple[LeftOutRow, ...]:
    """Every experiment left out in turn, from a kept run; what is done already is read from beside it."""
    experiments = tuple(dict.fromkeys(row.experiment for row in load_rows()))
    reference, points, vectors = load_sampled(sampled, seed)
    rows: list[LeftOutRow] = []
    with workers_of(workers) as run:
        evaluate, draws = evaluation(Posterior(), run, PART), None
        for done, experiment in enumerate(experiments):
            if progress is not None:
                progress(done, len(experiments), experiment)
            part = sampled.with_name(f"left-out-{experiment}.json")
            if not part.exists():
                draws = draws or Points(vectors, evaluate(vectors))
                found = leave_out(experiment, draws, reference, points, seed, evaluate)
                part.write_text(json.dumps([asdict(each) for each in found], indent=1), encoding="utf-8")
            rows += [LeftOutRow(**each) for each in json.loads(part.read_text(encoding="utf-8"))]
    return tuple(rows)
