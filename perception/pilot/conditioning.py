"""Laboratories conditioned on data.

1. What was answered or measured is simulated in every draw of the prior; its likelihood weighs the draw. Pairs are
   drawn from what the answers make likely in each, and their weight says how likely they were before.
2. With at least `LEAST_EFFECTIVE` draws behind the data, laboratories are resampled by these weights.
3. Otherwise fresh laboratories are sampled from the prior times a likelihood that is a polynomial of the coordinates,
   one for each form of memory, fitted to those simulated so far. They are simulated, and weighed by what the polynomial
   missed: answers by the likelihood of all together, which depends least on who the simulated people are.
4. Where a likelihood cannot be computed, nothing is sampled, and the data stand alone.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.cores import quiet_blas
from thermicon.base.words.number_text import percent, percent_span

from ..experiments.measure import Setting
from ..identification.pairs import pair_scores
from .evened import evened, smoothed
from .likelihood import PooledLikelihood, Target, effective, log_likelihoods, normalised_weights, systematic, walk
from .measurement_likelihood import Emulator, SimulatedMeasurements, log_likelihood, predicted
from .measurements_file import Measurements
from .pair_posterior import PairPosterior
from .playing import Confusions, Stage
from .prediction import Fit, MeasurementFit, compare, compare_measurements
from .states import SEEDS, Laboratories, LaboratoryPrior
from .trials import AnswerScore, Trials, score

LEAST_EFFECTIVE, LEAST_SHARE = 60.0, 0.25
"""Effective sample size from which weights are used as they are, or share of the draws where there are fewer.

With few participants, of whom one is unusual, weights of little effect still err less than the pooled likelihood.
"""
NEAR_ANSWERS, NEAR_VALUES = 2.0, 25.0
"""Ln L by which a laboratory is less likely than those near the data if it counts half in a fit: those far from the
data keep the polynomial from bending there, and count for little else."""
FARTHEST = 25.0
"""Nine in ten laboratories are less likely by at most so many times that ln L of answers, which else grows: it is
squared, and with thousands of answers those far away would not count at all."""
PAIR_DRAWS = 4
"""Draws of the pairs of each laboratory that answers weigh: with one, chance decides which laboratories count."""
Step = Callable[[], None]
Data: TypeAlias = "Namings | MeasuredValues"


@dataclass(frozen=True, slots=True)
class Conditioned:
    """The weighed laboratories `before` data, and `after`, a sample of equal weights.

    `effective` is the effective sample size of the weights, `effective_after` how many independent draws stand behind
    `after`, `rounds` how often fresh laboratories were simulated (0: the weights sufficed). `scores` (kept, icons,
    icons) are those of the pairs after answers; of measurements, which say nothing of pairs, there are no icons.
    `simulated` has pairs by chance, `simulated_after` these. `unusable` says why there is no likelihood, and then
    `after` is empty; otherwise it is empty itself.
    """

    before: Laboratories
    simulated: Any
    effective: float
    after: Laboratories
    simulated_after: Any
    scores: Array
    effective_after: float
    rounds: int
    unusable: str = ""


@quiet_blas()
def condition(
    data: Data, before: Laboratories, *, seed: int = 0, kept: int | None = None, step: Step | None = None
) -> Conditioned:
    """Condition laboratories on data; `kept` is how many are sampled (None: half)."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, data.stream]))
    kept = max(2, len(before) // 2) if kept is None else kept
    simulated: Any = data.simulate(before, step)
    shown = data.by_chance(simulated, seed)
    try:
        found = _sampled(data, before, simulated, kept, rng, step)
        return replace(found, simulated=shown)
    except np.linalg.LinAlgError:
        why = "the covariance matrix of the data cannot be factorised"
    except FloatingPointError:
        why = "it is not a finite number"
    nobody = np.zeros(0, dtype=np.int64)
    none = np.zeros((0, 0, 0))
    return Conditioned(before, shown, 0.0, before.of(nobody), shown.of(nobody), none, 0.0, 0, why)


def _sampled(
    data: Data, before: Laboratories, simulated: Any, kept: int, rng: np.random.Generator, step: Step | None
) -> Conditioned:
    """Laboratories after the data; a LinAlgError or a FloatingPointError where their likelihood cannot be computed."""
    logs, scores = data.weighed(simulated, rng)
    each = normalised_weights(logs)
    size = effective(each.sum(axis=1))
    if size < min(LEAST_EFFECTIVE, LEAST_SHARE * len(before)):
        return Conditioned(before, simulated, size, *_refreshed(data, before, simulated, kept, rng, step))
    chosen, which = np.divmod(systematic(each.ravel(), kept, rng), each.shape[1])
    after, scores = _other_people(before.of(chosen), rng), scores[chosen, which]
    answered: Any = data.simulate(after, step) if data.by_people else simulated.of(chosen)
    found = data.with_scores(answered, scores)
    return Conditioned(before, simulated, size, after, found, scores, size, 0)


def _refreshed(
    data: Data, some: Laboratories, simulated: Any, kept: int, rng: np.random.Generator, step: Step | None
) -> tuple[Laboratories, Any, Array, float, int]:
    """Fresh laboratories, what is simulated there, scores, how many are effective, and the rounds that it took."""
    before, (logs, *_) = some, data.likelihood(some, simulated, rng)
    for rounds in range(1, data.rounds + 1):
        target = data.polynomial(some, simulated, logs, rng)
        start = before.of(rng.integers(len(before), size=kept))
        start = start.of(np.argsort(start.form, kind="stable"))
        fresh = _other_people(Laboratories(*_walked(start, target, rng)), rng)
        found: Any = data.simulate(fresh, step)
        own, scores, answered = data.likelihood(fresh, found, rng)
        missed = own - target(fresh.place, fresh.form)
        if rounds == data.rounds or effective(normalised_weights(missed)) >= LEAST_SHARE * kept:
            break
        some, simulated, logs = some.joined(fresh), simulated.joined(found), np.concatenate([logs, own])
    share = _tempered(missed, LEAST_SHARE * kept)
    chosen = systematic(share, kept, rng)
    return fresh.of(chosen), answered.of(chosen), scores[chosen], effective(share), rounds


def _walked(
    start: Laboratories, target: Target, rng: np.random.Generator
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
    place, form = walk(start.place, start.form, target, rng)
    return place, start.seed, form


def _other_people(some: Laboratories, rng: np.random.Generator) -> Laboratories:
    """The same laboratories with people who did not take part."""
    return replace(some, seed=rng.integers(SEEDS, size=len(some)))


def _tempered(logs: Array, least: float) -> Array:
    """Weights, of the highest power up to 1 of which so many are effective."""
    for power in np.linspace(1.0, 0.0, 21).tolist():
        weights = normalised_weights(power * logs)
        if effective(weights) >= least:
            break
    return weights


@dataclass(frozen=True)
class Namings:
    """Answers to a set, which the people of every laboratory are asked to name as well.

    `by_people`: they depend on who the people are. Those who are kept must then be others, and the likelihood of
    fresh laboratories is too much a matter of chance to weigh them. `stream` keeps chance apart from other data's.
    """

    trials: Trials
    stage: Stage = field(repr=False)
    stream: ClassVar[int] = 12
    noun: ClassVar[str] = "answers"
    rounds: ClassVar[int] = 2
    by_people: ClassVar[bool] = True

    @property
    def pooled(self) -> AnswerScore:
        """Score of all participants together."""
        return score("all", self.trials.counts, self.trials.unanswered.sum(axis=1))

    @property
    def each(self) -> tuple[AnswerScore, ...]:
        """Score of each participant."""
        rows = zip(self.trials.participants, self.trials.counts, self.trials.unanswered, strict=True)
        return tuple(score(name, counts[None], float(missing.sum())) for name, counts, missing in rows)

    @property
    def alone(self) -> str:
        """What the answers say without a model, in words."""
        named, ends = self.pooled.named, self.pooled.named_interval
        assert named is not None and ends is not None  # somebody answered
        return f"{percent(named)} named, 95 % interval {percent_span(*ends)}"

    def simulate(self, some: Laboratories, step: Step | None = None) -> Confusions:
        """Confusions of the people of each laboratory by its constants, with means as of many people."""
        return evened(some, self.stage.confusions(some, step))

    def by_chance(self, simulated: Confusions, seed: int) -> Confusions:
        """Confusions with pairs as they may be before any answer."""
        return simulated.with_scores(pair_scores(len(simulated.icons), len(simulated.probability), seed))

    def with_scores(self, simulated: Confusions, scores: Array) -> Confusions:
        """Confusions with these pairs."""
        return simulated.with_scores(scores)

    def weighed(self, simulated: Confusions, rng: np.random.Generator) -> tuple[Array, Array]:
        """Ln weights (laboratories, draws) with pairs that the answers make likely, and their scores.

        These are (laboratories, draws, icons, icons). Each participant is integrated over people.
        """
        found, logs, scores = PairPosterior.of(simulated, None, self.trials.counts), [], []
        for _ in range(PAIR_DRAWS):
            drawn, answered, likelier = found.drawn(rng)
            logs.append(log_likelihoods(answered.probability, self.trials.counts).sum(axis=1) + likelier)
            scores.append(drawn)
        return np.stack(logs, axis=1), np.stack(scores, axis=1)

    def likelihood(
        self, some: Laboratories, simulated: Confusions, rng: np.random.Generator
    ) -> tuple[Array, Array, Confusions]:
        """Ln likelihood (laboratories,) of all answers together, scores that they make likely, confusions with them."""
        found = PairPosterior.of(*smoothed(some, simulated), self.trials.counts)
        return found.log_likelihood, *found.drawn(rng)[:2]

    def polynomial(self, some: Laboratories, simulated: Confusions, logs: Array, rng: np.random.Generator) -> Target:
        """Ln likelihood of the pooled answers."""
        best = np.array([logs[some.form == form].max() for form in some.form.tolist()])
        short = best - logs
        near = max(NEAR_ANSWERS, float(np.quantile(short, 0.9)) / FARTHEST)
        weight = 1.0 / (1.0 + np.square(short / near))
        scores = pair_scores(len(simulated.icons), len(some), int(rng.integers(SEEDS)))
        return PooledLikelihood.fit(some, simulated, self.trials.counts, scores, weight)

    def compare(self, simulated: Confusions, seed: int) -> Fit:
        """The answers beside those of the same experiment in these laboratories."""
        return compare(self.trials, simulated, seed=seed)

    def details(self, simulated: Confusions, scores: Array) -> Array:
        """Proportion named (laboratories, icons) of each icon, without the pairs of these scores."""
        return np.diagonal(simulated.without_scores(scores).pooled, axis1=1, axis2=2)

    def provenance(self, where: str) -> tuple[str, ...]:
        """Lines on the answers, and where they were given."""
        return (
            f"conditioned on: {self.trials.source or 'answers'}, sha256 {self.trials.digest or 'unknown'}",
            f"participants: {len(self.trials.participants)}",
            f"trials: {self.trials.total}",
            f"icons: {len(self.trials.icons)}, {where}",
        )

    def to_dict(self) -> dict[str, Any]:
        """Every number of the answers as plain data."""
        trials = self.trials
        return {
            "trials_file": trials.source,
            "trials_sha256": trials.digest,
            "participants": len(trials.participants),
            "trials": trials.total,
            "icons": list(trials.icons),
            "never_presented": list(trials.never_presented),
            "counts": trials.pooled.astype(int).tolist(),
            "unanswered": trials.unanswered.sum(axis=0).astype(int).tolist(),
            "rows_passed_over": trials.passed,
            "rows_missing": trials.missing,
            "forced": trials.forced,
            "one_group": trials.grouped,
            "observed": asdict(self.pooled),
            "each": [asdict(each) for each in self.each],
        }


@dataclass(frozen=True)
class MeasuredValues:
    """Thresholds, reaction times and ratings, which every laboratory measures as well, with one and the same crowd."""

    measurements: Measurements
    prior: LaboratoryPrior = field(repr=False)
    setting: Setting = field(repr=False)
    stream: ClassVar[int] = 31
    noun: ClassVar[str] = "values"
    rounds: ClassVar[int] = 3
    by_people: ClassVar[bool] = False

    @property
    def alone(self) -> str:
        """What the values say without a model, in words."""
        rows = zip(self.measurements.conditions, self.measurements.means.tolist(), strict=True)
        return "; ".join(f"{condition.label}: {mean:.3g} {condition.unit}" for condition, mean in rows)

    def simulate(self, some: Laboratories, step: Step | None = None) -> SimulatedMeasurements:
        """Means, covariances and scatter of the values in each laboratory."""
        return predicted(self.prior, some, self.setting, self.measurements.conditions, step)

    def by_chance(self, simulated: SimulatedMeasurements, seed: int) -> SimulatedMeasurements:
        """The values, in which pairs have no part."""
        return simulated

    def with_scores(self, simulated: SimulatedMeasurements, scores: Array) -> SimulatedMeasurements:
        """The same."""
        return simulated

    def weighed(self, simulated: SimulatedMeasurements, rng: np.random.Generator) -> tuple[Array, Array]:
        """Ln likelihood (laboratories, 1) of all values, and scores of no icons."""
        return log_likelihood(self.measurements, simulated)[:, None], np.zeros((len(simulated.mean), 1, 0, 0))

    def likelihood(
        self, some: Laboratories, simulated: SimulatedMeasurements, rng: np.random.Generator
    ) -> tuple[Array, Array, SimulatedMeasurements]:
        """Ln likelihood (laboratories,), and the values as they are."""
        logs, scores = self.weighed(simulated, rng)
        return logs[:, 0], scores[:, 0], simulated

    def polynomial(
        self, some: Laboratories, simulated: SimulatedMeasurements, logs: Array, rng: np.random.Generator
    ) -> Target:
        """Ln likelihood with polynomials for means, covariances and scatter, the same for both forms of memory."""
        weight = 1.0 / (1.0 + (logs.max() - logs) / NEAR_VALUES)
        emulator = Emulator.fit(self.measurements, some.place, simulated, weight)
        return lambda place, _: emulator(place)

    def compare(self, simulated: SimulatedMeasurements, seed: int) -> MeasurementFit:
        """Group means beside those of the same measurements in these laboratories."""
        return compare_measurements(self.measurements, simulated, seed=seed)

    def details(self, simulated: SimulatedMeasurements, scores: Array) -> Array:
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

    def to_dict(self) -> dict[str, Any]:
        """What was measured as plain data; the values themselves are those of the fit."""
        values = self.measurements
        return {
            "measurements_file": values.source,
            "measurements_sha256": values.digest,
            "participants": len(values.participants),
            "values": values.total,
            "errors_assumed": values.assumed_errors,
        }
