"""Data beside what was predicted of the same experiment: a test of fit, and the pairs or conditions that were missed.

Experiments are simulated with as many participants and the same presentations or conditions as were observed, each in
another laboratory. The posterior predictive p is the share of them that lie as far from the prediction as the observed
one; as such tests go, it is conservative where the same data have conditioned the prediction. Of answers, the statistic
is X² = Σ (O − E)²/E over all cells of the pooled matrix, E from the mean prediction; of measurements, the sum over
conditions of the squared deviation of the log group mean, in SDs of the simulated ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import combinations

import numpy as np

from ..arrays import Array
from ..experiments.measure import Condition
from .measurement_likelihood import Predicted, log_errors, person_covariance, shared_covariance
from .measurements import Measurements
from .playing import Confusions
from .prediction import COVER, Three, median_three
from .trials import Trials, plugin_information

EXPERIMENTS = 1000
LEAST_PEOPLE = 3
"""Participants that a spread between them needs to be compared."""


@dataclass(frozen=True, slots=True)
class PairFit:
    """How often two icons were taken for each other, as a share of their `trials`: observed, and 95 % as predicted."""

    a: str
    b: str
    trials: int
    observed: float
    predicted: float
    interval: tuple[float, float]

    @property
    def missed(self) -> bool:
        """Whether the observed share lies outside the interval."""
        return not self.interval[0] <= self.observed <= self.interval[1]

    def to_dict(self) -> dict[str, object]:
        """Plain data for JSON."""
        return {
            "a": self.a,
            "b": self.b,
            "trials": self.trials,
            "observed": self.observed,
            "predicted": self.predicted,
            "predicted_interval": list(self.interval),
            "missed": self.missed,
        }


@dataclass(frozen=True, slots=True)
class Fit:
    """What the same experiment would have given: `p` of the test of fit, scores as reported, and every pair.

    `proportion_correct` and `bits_plugin` are median and 95 % of the simulated experiments; `p_people` is the share of
    them whose participants differ as much as the observed
    ones (None for fewer than three participants). `icons` has the proportion correct of each icon that was presented,
    median and 95 %.
    """

    p: float
    p_people: float | None
    proportion_correct: Three
    bits_plugin: Three
    pairs: tuple[PairFit, ...]
    icons: Mapping[str, Three]

    @property
    def missed(self) -> tuple[PairFit, ...]:
        """Pairs whose confusions lie outside their interval, the farthest first."""
        found = [pair for pair in self.pairs if pair.missed]
        return tuple(sorted(found, key=lambda pair: -abs(pair.observed - pair.predicted)))

    def to_dict(self) -> dict[str, object]:
        """Plain data for JSON."""
        return {
            "p": self.p,
            "p_people": self.p_people,
            "proportion_correct": list(self.proportion_correct),
            "information_bits_plugin": list(self.bits_plugin),
            "pairs": [pair.to_dict() for pair in self.pairs],
            "icons": {name: list(each) for name, each in self.icons.items()},
        }


@dataclass(frozen=True, slots=True)
class ConditionFit:
    """One condition: geometric mean of so many participants, and the predicted one, median and 95 %."""

    condition: Condition
    participants: int
    observed: float
    predicted: Three

    @property
    def missed(self) -> bool:
        """Whether the measured mean lies outside the interval."""
        return not self.predicted[1] <= self.observed <= self.predicted[2]

    def to_dict(self) -> dict[str, object]:
        """Plain data for JSON."""
        return {
            **asdict(self.condition),
            "unit": self.condition.unit,
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


def simulated_counts(played: Confusions, presented: Array, rng: np.random.Generator) -> Array:
    """Answers (experiments, participants, icons, icons) to given presentations (participants, icons).

    Each experiment is in another laboratory, with participants drawn from its people.
    """
    laboratories, people, icons = played.probability.shape[:3]
    found = np.zeros((EXPERIMENTS, len(presented), icons, icons))
    shown = presented.astype(np.int64)
    for k in range(EXPERIMENTS):
        invited = rng.integers(people, size=len(presented))
        chances = played.probability[k % laboratories, invited].astype(np.float64)
        found[k] = rng.multinomial(shown, chances / chances.sum(axis=-1, keepdims=True))
    return found


def compare(trials: Trials, played: Confusions, *, seed: int = 0) -> Fit:
    """Compare observed answers with experiments simulated in the laboratories of a prediction."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 13]))
    each = simulated_counts(played, trials.presented, rng)
    pooled, seen = each.sum(axis=1), trials.pooled
    expected = seen.sum(axis=1)[:, None] * played.pooled.mean(axis=0)
    shown = expected > 0.0
    off = [float(((one - expected)[shown] ** 2 / expected[shown]).sum()) for one in (seen, *pooled)]
    people = None
    if len(trials.participants) >= LEAST_PEOPLE:
        spread = [_correct(one).std() for one in (trials.counts, *each)]
        people = _share(spread)
    correct = np.trace(pooled, axis1=1, axis2=2) / trials.total
    bits = np.array([plugin_information(one)[0] for one in pooled])
    return Fit(
        p=_share(off),
        p_people=people,
        proportion_correct=median_three(correct),
        bits_plugin=median_three(bits),
        pairs=tuple(_pairs(trials, seen, pooled)),
        icons={
            name: median_three(pooled[:, k, k] / times)
            for k, (name, times) in enumerate(zip(trials.icons, seen.sum(axis=1).tolist(), strict=True))
            if times
        },
    )


def _pairs(trials: Trials, seen: Array, pooled: Array) -> list[PairFit]:
    found = []
    for a, b in combinations(range(len(trials.icons)), 2):
        shown = float(seen[a].sum() + seen[b].sum())
        if not shown:
            continue
        shares = (pooled[:, a, b] + pooled[:, b, a]) / shown
        low, high = np.percentile(shares, COVER).tolist()
        observed = float(seen[a, b] + seen[b, a]) / shown
        names = trials.icons[a], trials.icons[b]
        found.append(PairFit(*names, int(shown), observed, float(shares.mean()), (low, high)))
    return found


def compare_measurements(measured: Measurements, each: Predicted, *, seed: int = 0) -> MeasurementFit:
    """Compare measurements with the same ones simulated in the laboratories of a prediction."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 32]))
    there, shared = measured.given, np.linalg.cholesky(shared_covariance(measured))
    means = np.empty((EXPERIMENTS, len(measured.conditions)))
    for row in range(EXPERIMENTS):
        k = row % len(each.mean)
        root = np.linalg.cholesky(person_covariance(measured, each.between[k]))
        people = rng.standard_normal(there.shape) @ root.T
        errors = log_errors(measured, each.within[k]) * rng.standard_normal(there.shape)
        logs = each.mean[k] + people + errors + shared @ rng.standard_normal(len(root))
        means[row] = np.where(there, logs, 0.0).sum(axis=0) / there.sum(axis=0)
    seen = np.log(measured.means)
    spread = means.std(axis=0)
    off = np.square((np.vstack([seen, means]) - means.mean(axis=0)) / spread).sum(axis=1)
    counts, predicted = there.sum(axis=0).tolist(), np.exp([median_three(column) for column in means.T]).tolist()
    columns = zip(measured.conditions, counts, measured.means.tolist(), map(tuple, predicted), strict=True)
    return MeasurementFit(_share(off.tolist()), tuple(ConditionFit(*each) for each in columns))


def _correct(counts: Array) -> Array:
    found: Array = np.trace(counts, axis1=1, axis2=2) / counts.sum(axis=(1, 2))
    return found


def _share(values: list[float]) -> float:
    """Share of all values, the first among them, that are at least the first."""
    return float(np.mean(np.array(values) >= values[0] - 1e-12))
