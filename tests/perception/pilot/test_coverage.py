"""Coverage of a pilot's predictions on made-up laboratories."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import t

from tests.builders import weighted_quantile
from tests.perception.pilot.madeup import USUAL, answers_of, measurements_of, spread
from thermicon.base.numbers.cores import quiet_blas
from thermicon.circuit import Rig
from thermicon.icons import read_cue
from thermicon.perception.experiments.measure import Setting
from thermicon.perception.identification.new_laboratory import COVER
from thermicon.perception.identification.pairs import pair_scores
from thermicon.perception.observer.channels import MemoryChoice
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.pilot.conditioning import LEAST_EFFECTIVE, LEAST_SHARE, Namings, condition
from thermicon.perception.pilot.likelihood import PooledLikelihood, effective, log_likelihoods, normalised_weights
from thermicon.perception.pilot.measurement_likelihood import log_likelihood, predicted
from thermicon.perception.pilot.playing import Confusions, Stage, stage
from thermicon.perception.pilot.states import SEEDS, Laboratories, LaboratoryPrior
from thermicon.perception.pilot.trials import Trials

ENDS = (0.025, 0.975)
NAMED = "probability", "reported"
PILOTS = int(os.environ.get("THERMICON_PILOTS", "40"))
RIG = Rig.load("thenar")
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Bench:
    """Laboratories to predict with (`some`), and others to predict (`true`), each made from the draw `own`."""

    prior: LaboratoryPrior
    some: Laboratories
    true: Laboratories
    own: NDArray[np.int64]
    rng: np.random.Generator

    @classmethod
    def of(cls, laboratories: int, truths: int, seed: int, memory: MemoryChoice = "episodes") -> Bench:
        rng, prior = np.random.default_rng(seed), LaboratoryPrior(PosteriorDraws.load(), memory)
        own = rng.choice(laboratories, truths, replace=False)
        return cls(prior, prior.first(laboratories, 1), prior.first(laboratories, 77).of(own), own, rng)

    def other_people(self, some: Laboratories) -> Laboratories:
        """The same laboratories with people who did not take part."""
        return replace(some, seed=self.rng.integers(SEEDS, size=len(some)))

    def judged(
        self, weights_of: Callable[[int], tuple[Floats, float]], *predictions: tuple[Floats, Floats]
    ) -> tuple[float, list[float], list[float]]:
        """Median effective size, coverage of each prediction of a truth, and median factor of narrowing.

        `weights_of` gives log weights of the laboratories by what the k-th true one found, and the effective size.
        """
        rows = []
        for k in range(len(self.own)):
            logs, size = weights_of(k)
            row = [size]
            for guess, truth in predictions:
                low, high = weighted_quantile(guess, normalised_weights(logs), ENDS)
                first, last = np.quantile(guess, ENDS)
                row += [float(low <= truth[k] <= high), float((last - first) / (high - low))]
            rows.append(row)
        each = np.array(rows)
        covered, narrower = each[:, 1::2].mean(axis=0), np.median(each[:, 2::2], axis=0)
        return float(np.median(each[:, 0])), covered.tolist(), narrower.tolist()


@pytest.mark.slow
def test_intervals_cover_two_hundred_laboratories_and_twenty_trials_narrow_a_little() -> None:
    """People who were left out name the six icons and another set."""
    bench = Bench.of(1000, 200, 8)
    first, second = (stage(read_cue(name), RIG, bench.prior) for name in ("six-icons", "pulse-sequences"))
    people, left = bench.other_people(bench.some), bench.other_people(bench.true)
    pairs = [(each.confusions(people), each.confusions(left)) for each in (first, second)]
    predictions = [(guess.correct, truth.correct) for guess, truth in pairs]
    predictions += [(guess.felt_and_named, truth.felt_and_named) for guess, truth in pairs]
    answered, invited = first.confusions(bench.some), first.confusions(bench.true)

    def judged(participants: int) -> tuple[float, list[float], list[float]]:
        rng = np.random.default_rng(3)

        def weights_of(k: int) -> tuple[Floats, float]:
            presented = np.stack([spread(20, 6, rng) for _ in range(participants)])
            who = rng.integers(invited.probability.shape[1], size=participants)
            counts = answers_of(invited.of(np.array([k])), who, presented, rng)
            logs = log_likelihoods(answered.probability, counts).sum(axis=1)
            logs[bench.own[k]] = -np.inf  # the draw that the laboratory was made from
            size = effective(normalised_weights(logs))
            if size < min(LEAST_EFFECTIVE, LEAST_SHARE * len(logs)):  # as `condition` does, without fresh ones
                alike, some = np.zeros((len(logs), 6, 6)), bench.some
                logs = PooledLikelihood.fit(some, answered, counts, alike)(some.place, some.form)
                logs[bench.own[k]] = -np.inf
            return logs, size

        return bench.judged(weights_of, *predictions)

    with quiet_blas():
        one, four = judged(1), judged(4)
    for _, covered, _ in (one, four):
        assert all(0.90 <= each <= 0.995 for each in covered)
    assert 1.02 <= one[2][0] <= 1.2
    assert 1.12 <= four[2][0] <= 1.3
    assert four[0] > 150


@dataclass(frozen=True)
class Truth:
    """Made-up laboratories of either form of memory, whose pairs differ from the model by `spread` (SD of ln odds).

    `asked` are people from whom participants come, `mean` the confusions (laboratories, icons, icons) of many others.
    """

    asked: Confusions
    mean: Floats
    groups: ClassVar[int] = 8

    @classmethod
    def of(cls, bench: Bench, played: Stage, spread: float) -> Truth:
        scores = np.triu(bench.rng.standard_normal((len(bench.own), 6, 6)), 1)

        def people() -> Confusions:
            each = []
            for _ in range(cls.groups):
                usual = played.confusions(bench.other_people(bench.true))
                usual = replace(usual, spread=np.full(len(bench.own), spread))
                each.append(usual.with_scores(scores + scores.swapaxes(1, 2)))
            named, reported = (np.concatenate([getattr(one, name) for one in each], axis=1) for name in NAMED)
            return Confusions(played.icons, named, reported)

        return cls(people(), people().pooled)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("participants", "times", "wider", "spread"),
    [(8, 8, 1.0, 0.0), (8, 8, 1.0, 1.0), (20, 16, 1.1, 0.0), (20, 16, 1.1, 1.0), (40, 32, 1.5, 0.0),
     pytest.param(40, 32, 1.5, 1.0, marks=pytest.mark.xfail(reason="few draws are effective: 75 to 80 % covered"))],
)  # fmt: skip
def test_pilots_cover_laboratories_of_either_memory_whether_or_not_their_pairs_are_as_predicted(
    participants: int, times: int, wider: float, spread: float
) -> None:
    """Each icon is shown so many `times`; intervals are at most so many times `wider` than Student's."""
    bench = Bench.of(300, min(PILOTS, 300), 12, "both")
    six = stage(read_cue("six-icons"), RIG, bench.prior)
    truth, simulated = Truth.of(bench, six, spread), six.confusions(bench.some)
    before = simulated.with_scores(pair_scores(len(six.icons), 300, 3))

    class Known(Stage):
        """The laboratories of the bench are simulated once for all pilots."""

        def confusions(self, some: Laboratories, step: Callable[[], None] | None = None) -> Confusions:
            return simulated if some is bench.some else six.confusions(some, step)

    rows, upper = [], np.triu_indices(6, 1)
    for k in range(len(bench.own)):
        who = bench.rng.integers(truth.asked.probability.shape[1], size=participants)
        shown = np.full((participants, 6), float(times))
        counts = answers_of(truth.asked.of(np.array([k])), who, shown, bench.rng)
        trials = Trials(six.icons, tuple(f"P{number}" for number in range(participants)), counts)
        known = Known(six.icons, six.played, six.prior, six.skins)
        found = condition(Namings(trials, known), bench.some, seed=k)
        assert not found.unusable
        mean, pairs = truth.mean[k].trace() / 6, (truth.mean[k] + truth.mean[k].T)[upper]
        low, high = np.percentile(found.simulated_after.correct, COVER)
        after = found.simulated_after.pooled
        least, most = np.percentile((after + after.swapaxes(1, 2))[:, upper[0], upper[1]], COVER, axis=0)
        each = np.trace(counts, axis1=1, axis2=2) / counts.sum(axis=(1, 2))
        student = 2.0 * t.ppf(0.975, participants - 1) * each.std(ddof=1) / np.sqrt(participants)
        rows.append([low <= mean <= high, ((least <= pairs) & (pairs <= most)).mean(), high - low, student])
    covered, of_pairs, width, alone = np.mean(rows, axis=0).tolist()
    chance = 1.6 * np.sqrt(0.1 / len(rows))
    assert covered >= 0.9 - chance and of_pairs >= 0.88 - 0.05
    assert width <= 1.05 * wider * alone
    assert np.ptp(np.percentile(before.correct, COVER)) >= 1.15 * width


@pytest.mark.slow
def test_intervals_cover_two_hundred_laboratories_of_measurements() -> None:
    """Four participants each: the set, and the mean limits."""
    bench = Bench.of(1000, 200, 9)
    true, setting, values = bench.other_people(bench.true), Setting.of(RIG), bench.prior.values(bench.true)
    each, other = (predicted(bench.prior, which, setting, USUAL) for which in (bench.some, true))
    icons = stage(read_cue("six-icons"), RIG, bench.prior)
    guess, truth = (icons.confusions(which).correct for which in (bench.other_people(bench.some), true))

    def weights_of(k: int) -> tuple[Floats, float]:
        found = measurements_of(bench.prior, values[k], setting, USUAL, 4, 10, bench.rng)
        logs = log_likelihood(found, each)
        logs[bench.own[k]] = -np.inf
        return logs, effective(normalised_weights(logs))

    with quiet_blas():
        size, covered, narrower = bench.judged(weights_of, (guess, truth), (each.mean[:, 0], other.mean[:, 0]))
    assert size > 40.0
    assert all(0.90 <= share <= 0.995 for share in covered)
    assert 1.2 <= narrower[1] <= 1.45  # docs/how-to/your-pilot.md says 1.33
    assert 0.98 <= narrower[0] <= 1.1  # and 1.01
