"""Predictions by samples of laboratories before and after data.

For the fit, experiments like the observed one are simulated, each in another laboratory. The posterior predictive p is
the share of them that lie as far from the prediction; it is conservative where the same data have conditioned it. Of
answers, the statistic is X² = Σ (O − E)²/E over all cells of the pooled matrix, E from the mean prediction; of
measurements, the sum of the squared deviations of log group means, in SDs of the simulated ones.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..experiments.measure import Condition
from ..identification.new_laboratory import COVER
from .measurement_likelihood import SimulatedMeasurements, log_errors, person_covariance, shared_covariance
from .measurements_file import Measurements
from .playing import Confusions
from .trials import Trials, plugin_information

EXPERIMENTS = 1000
LEAST_PEOPLE = 3
"""Participants that a spread between them needs to be compared."""
Three = tuple[float, float, float]
"""Mean or median, and both ends of a 95 % interval."""
ROUNDING = 1e-12
"""Share by which sums that are the same may differ."""
CHANCE = 6.0
"""Bits times draws that the largest of some fifty constants seems to gain by chance alone."""


SCORES = ("felt_and_named", "proportion_correct", "information_bits")
"""What is predicted of a set; the proportion named and bits are those of announced icons."""


@dataclass(frozen=True, slots=True)
class SetPrediction:
    """Scores of a set as means over people who did not take part, each with 95 % of the laboratories."""

    title: str
    people: int
    felt_and_named: Three
    proportion_correct: Three
    information_bits: Three

    @classmethod
    def of(cls, title: str, played: Confusions) -> SetPrediction:
        """Summarise the laboratories of a sample."""
        scores = played.felt_and_named, played.correct, played.bits
        return cls(title, int(played.probability.shape[1]), *map(three, scores))

    def row(self, data: str) -> dict[str, Any]:
        """A row of a table, for `data` of before or after."""
        row: dict[str, Any] = {"set": self.title, "data": data}
        for name in SCORES:
            row |= zip((name, f"{name}_low", f"{name}_high"), getattr(self, name), strict=True)
        return row


@dataclass(frozen=True, slots=True)
class ChangedPrediction:
    """The prediction of one set before and after data were seen; `after` is None where these have no likelihood."""

    before: SetPrediction
    after: SetPrediction | None

    @property
    def narrower(self) -> float | None:
        """By which factor the interval of the proportion named got narrower (below 1: wider)."""
        return None if self.after is None else self.narrowed("proportion_correct")

    def narrowed(self, score: str) -> float:
        """By which factor the interval of a score got narrower."""
        before, after = (high - low for _, low, high in (getattr(one, score) for one in (self.before, self.after)))
        return before / after if after > 0.0 else math.inf


def three(values: Array) -> Three:
    """Mean and 95 % of some values."""
    low, high = np.percentile(values, COVER).tolist()
    return float(values.mean()), low, high


def median_three(values: Array) -> Three:
    """Median and 95 % of some values."""
    middle, low, high = np.percentile(values, [50.0, *COVER]).tolist()
    return middle, low, high


@dataclass(frozen=True, slots=True)
class ChangedConstant:
    """One constant before and after: median and 95 %. `shift_sd` is in SDs of before, `sd_left` the SD left over it.

    `bits` gained are the divergence of two normals with these means and SDs (of logs for positive constants).
    """

    constant: str
    unit: str
    before: Three
    after: Three
    shift_sd: float
    sd_left: float
    bits: float


def changed(
    names: Sequence[str], before: Array, after: Array, effective: float, units: Sequence[str]
) -> tuple[ChangedConstant, ...]:
    """Constants that changed by more than chance, most first; `effective` independent draws stand behind `after`."""
    found = [_change(*each) for each in zip(names, units, before.T, after.T, strict=True)]
    least = CHANCE * (1.0 / effective + 1.0 / len(before))
    return tuple(sorted((each for each in found if each.bits >= least), key=lambda each: -each.bits))


def _change(name: str, unit: str, before: Array, after: Array) -> ChangedConstant:
    logs = bool((before > 0.0).all() and (after > 0.0).all())
    old, new = (np.log(each) if logs else each for each in (before, after))
    spread, left = float(old.std()), float(new.std())
    shift, ratio, bits = 0.0, 1.0, 0.0
    if spread > 0.0 and left > 0.0:
        shift, ratio = float(new.mean() - old.mean()) / spread, left / spread
        bits = (0.5 * (ratio**2 + shift**2 - 1.0) - math.log(ratio)) / math.log(2.0)
    return ChangedConstant(name, unit, median_three(before), median_three(after), shift, ratio, bits)


@dataclass(frozen=True, slots=True)
class PairFit:
    """Confusions of two icons as a share of their `trials`; `missed`: outside the interval.

    Of plays that were not felt, `b` is what was answered: none.
    """

    a: str
    b: str
    trials: int
    observed: float
    predicted: float
    predicted_interval: tuple[float, float]
    missed: bool

    @classmethod
    def of(cls, a: str, b: str, trials: float, observed: float, simulated: Array) -> PairFit:
        """What was observed beside the simulated experiments (n,), all in trials."""
        shares, seen = simulated / trials, float(observed / trials)
        low, high = np.percentile(shares, COVER).tolist()
        return cls(a, b, int(trials), seen, float(shares.mean()), (low, high), not low <= seen <= high)


@dataclass(frozen=True, slots=True)
class Fit:
    """The prediction for the same experiment: `p` of the test of fit, scores as reported, and every pair.

    `p_people` is the share whose participants differ as much as the observed ones (None for fewer than three).
    `p_reports`, `felt_and_named` and `reports` are None and empty where every trial has an answer.
    """

    p: float
    p_people: float | None
    proportion_correct: Three
    information_bits_plugin: Three
    pairs: tuple[PairFit, ...]
    p_reports: float | None = None
    felt_and_named: Three | None = None
    reports: tuple[PairFit, ...] = ()

    @property
    def missed(self) -> tuple[PairFit, ...]:
        """Pairs whose confusions lie outside their interval, the farthest first."""
        found = [pair for pair in self.pairs if pair.missed]
        return tuple(sorted(found, key=lambda pair: -abs(pair.observed - pair.predicted)))


@dataclass(frozen=True, slots=True)
class ConditionFit:
    """One condition: geometric mean of so many participants, the predicted one, and whether its 95 % were `missed`."""

    condition: Condition
    unit: str
    participants: int
    observed: float
    predicted: Three
    missed: bool


@dataclass(frozen=True, slots=True)
class MeasurementFit:
    """All conditions, and `p`: the share of simulated laboratories that lie as far from the prediction."""

    p: float
    conditions: tuple[ConditionFit, ...]


def simulated_counts(played: Confusions, presented: Array, rng: np.random.Generator) -> Array:
    """Answers (experiments, participants, icons, icons) to presentations, each time in another laboratory."""
    laboratories, people, icons = played.probability.shape[:3]
    found = np.zeros((EXPERIMENTS, len(presented), icons, icons))
    shown = presented.astype(np.int64)
    for k in range(EXPERIMENTS):
        invited = rng.integers(people, size=len(presented))
        chances = played.probability[k % laboratories, invited]
        found[k] = rng.multinomial(shown, chances / chances.sum(axis=-1, keepdims=True))
    return found


def compare(trials: Trials, played: Confusions, *, seed: int = 0) -> Fit:
    """Compare observed answers with experiments simulated in the laboratories of a prediction."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 13]))
    each = simulated_counts(played, trials.counts.sum(axis=2), rng)
    pooled, seen = each.sum(axis=1), trials.pooled
    expected = seen.sum(axis=1)[:, None] * played.pooled.mean(axis=0)
    shown = expected > 0.0
    off = [float(((counts - expected)[shown] ** 2 / expected[shown]).sum()) for counts in (seen, *pooled)]
    answered = trials.counts.sum(axis=(1, 2)).clip(1.0)
    spread = [(np.trace(counts, axis1=1, axis2=2) / answered).std() for counts in (trials.counts, *each)]
    return Fit(
        p=share_as_far(off),
        p_people=share_as_far(spread) if len(trials.participants) >= LEAST_PEOPLE else None,
        proportion_correct=median_three(np.trace(pooled, axis1=1, axis2=2) / seen.sum()),
        information_bits_plugin=median_three(np.array([plugin_information(counts)[0] for counts in pooled])),
        pairs=tuple(_pairs(trials, seen, pooled)),
        **({} if trials.forced else compare_reports(trials, played, seed=seed)),
    )


def compare_reports(trials: Trials, played: Confusions, *, seed: int = 0) -> dict[str, Any]:
    """What a `Fit` says of plays that were not felt, and of felt and named, from as many simulated experiments.

    The statistic of `p_reports` is X² over felt and not felt of every icon.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 17]))
    presented, seen = trials.presented.astype(np.int64), trials.unanswered.sum(axis=0)
    total, silent, alert = presented.sum(axis=0), np.empty((EXPERIMENTS, len(trials.icons))), np.empty(EXPERIMENTS)
    named = np.diagonal(played.probability, axis1=2, axis2=3)
    for k in range(EXPERIMENTS):
        invited = k % len(named), rng.integers(named.shape[1], size=len(presented))
        felt = rng.binomial(presented, played.reported[invited])
        silent[k] = total - felt.sum(axis=0)
        alert[k] = rng.binomial(felt, named[invited]).sum() / total.sum()
    share = 1.0 - played.reported.mean(axis=(0, 1))
    used = np.flatnonzero(total)
    expected = (total * share)[used]
    variance = expected * (1.0 - share[used])
    off = [float((np.square(one[used] - expected) / variance).sum()) for one in (seen, *silent)]
    each = tuple(PairFit.of(trials.icons[k], "none", total[k], seen[k], silent[:, k]) for k in used)
    return {"p_reports": share_as_far(off), "felt_and_named": median_three(alert), "reports": each}


def _pairs(trials: Trials, seen: Array, pooled: Array) -> list[PairFit]:
    found = []
    for a, b in combinations(range(len(trials.icons)), 2):
        shown = float(seen[a].sum() + seen[b].sum())
        if not shown:
            continue
        names, observed = (trials.icons[a], trials.icons[b]), seen[a, b] + seen[b, a]
        found.append(PairFit.of(*names, shown, observed, pooled[:, a, b] + pooled[:, b, a]))
    return found


def compare_measurements(measured: Measurements, each: SimulatedMeasurements, *, seed: int = 0) -> MeasurementFit:
    """Compare measurements with the same ones simulated in the laboratories of a prediction."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 32]))
    there, shared = measured.given, np.linalg.cholesky(shared_covariance(measured))
    means, stated = np.empty((EXPERIMENTS, len(measured.conditions))), measured.errors / measured.values
    for row in range(EXPERIMENTS):
        k = row % len(each.mean)
        root = np.linalg.cholesky(person_covariance(measured, each.between[k]))
        people = rng.standard_normal(there.shape) @ root.T
        errors = log_errors(stated, measured.trials, each.within[k]) * rng.standard_normal(there.shape)
        logs = each.mean[k] + people + errors + shared @ rng.standard_normal(len(root))
        means[row] = np.where(there, logs, 0.0).sum(axis=0) / there.sum(axis=0)
    seen = np.log(measured.means)
    spread = means.std(axis=0)
    off = np.square((np.vstack([seen, means]) - means.mean(axis=0)) / spread).sum(axis=1)
    found = []
    for k, condition in enumerate(measured.conditions):
        middle, low, high = np.exp(median_three(means[:, k])).tolist()
        seen_mean = float(measured.means[k])
        missed = not low <= seen_mean <= high
        count = int(there[:, k].sum())
        found.append(ConditionFit(condition, condition.unit, count, seen_mean, (middle, low, high), missed))
    return MeasurementFit(share_as_far(off.tolist()), tuple(found))


def share_as_far(values: list[float]) -> float:
    """Share of all values, the first among them, that are at least the first."""
    return float(np.mean(np.array(values) >= values[0] * (1.0 - ROUNDING)))
