"""Conditioning against mathematics: laboratories whose likelihood is known in one dimension."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from tests.builders import weighted_quantile
from thermicon.perception.pilot import conditioning, likelihood
from thermicon.perception.pilot.conditioning import Namings, condition, systematic
from thermicon.perception.pilot.laboratory_file import off_middle
from thermicon.perception.pilot.likelihood import PooledLikelihood, effective, log_likelihoods, normalised_weights
from thermicon.perception.pilot.playing import Confusions
from thermicon.perception.pilot.prediction import changed, compare, median_three, share_as_far, three
from thermicon.perception.pilot.states import Laboratories
from thermicon.perception.pilot.trials import Trials

ICONS, PEOPLE, DIMENSIONS = 3, 24, 6
ALIKE = np.zeros((200, ICONS, ICONS))
"""Scores of pairs in laboratories where none differs from the model."""


def correct_at(place: np.ndarray, person: np.ndarray) -> np.ndarray:
    return 1.0 / (1.0 + np.exp(-(1.2 + 0.6 * place + 0.5 * person)))


@dataclass(frozen=True)
class Toy:
    """People differ in one number, laboratories in the first coordinate; errors are spread evenly."""

    def confusions(self, some: Laboratories, step: Callable[[], None] | None = None) -> Confusions:
        person = np.stack([np.random.default_rng(int(seed)).standard_normal(PEOPLE) for seed in some.seed])
        right = correct_at(some.place[:, :1], person)[:, :, None, None]
        chance = np.where(np.eye(ICONS, dtype=bool), right, (1.0 - right) / (ICONS - 1))
        return Confusions(("a", "b", "c"), chance, np.full(chance.shape[:3], 0.9))


def laboratories(n: int, seed: int) -> Laboratories:
    rng = np.random.default_rng(seed)
    return Laboratories(rng.standard_normal((n, DIMENSIONS)), rng.integers(2**31, size=n), np.zeros(n, dtype=np.int64))


def answers(place: float, participants: int, times: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    right = correct_at(np.full(participants, place), rng.standard_normal(participants))[:, None]
    hits = rng.binomial(times, np.broadcast_to(right, (participants, ICONS)))
    counts = np.zeros((participants, ICONS, ICONS))
    for j in range(participants):
        for a in range(ICONS):
            wrong = rng.multinomial(times - hits[j, a], [1 / (ICONS - 1)] * (ICONS - 1))
            counts[j, a] = np.insert(wrong, a, hits[j, a])
    return counts


def answered(counts: np.ndarray) -> Namings:
    people = tuple(f"P{k}" for k in range(len(counts)))
    return Namings(Trials(("a", "b", "c"), people, counts), Toy())  # type: ignore[arg-type]


def exact(counts: np.ndarray) -> tuple[float, float]:
    """Mean and SD of the first coordinate by integration over laboratories and people."""
    place, person = np.linspace(-4, 4, 161), np.linspace(-4, 4, 161)
    right = correct_at(place[:, None], person[None])
    hits, total = np.trace(counts, axis1=1, axis2=2), counts.sum(axis=(1, 2))
    density = np.exp(-0.5 * person**2) / np.exp(-0.5 * person**2).sum()
    each = hits[:, None, None] * np.log(right) + (total - hits)[:, None, None] * np.log((1 - right) / (ICONS - 1))
    log = np.log(np.exp(each - each.max(axis=(1, 2), keepdims=True)) @ density).sum(axis=0) - 0.5 * place**2
    weights = normalised_weights(log)
    mean = float(weights @ place)
    return mean, float(np.sqrt(weights @ (place - mean) ** 2))


@pytest.mark.parametrize(("participants", "times", "fresh"), [(2, 5, False), (80, 40, True)])
def test_both_ways_agree_with_integration(participants: int, times: int, fresh: bool) -> None:
    counts = answers(0.8, participants, times, seed=4)
    found = condition(answered(counts), laboratories(1000, 1), seed=2)
    mean, sd = exact(counts)
    sample = found.after.place[:, 0]
    assert (found.rounds > 0) == fresh
    assert abs(sample.mean() - mean) < 0.35 * sd
    assert 0.8 < sample.std() / sd < 1.25
    assert np.abs(found.after.place[:, 1:].mean(axis=0)).max() < 0.25  # what the answers do not touch stays the prior
    assert not set(found.after.seed.tolist()) & set(found.before.seed.tolist())


@pytest.mark.parametrize(
    ("participants", "times"), [(80, 40), (80, 40_000), (80, 40_000_000), (800, 40), (800, 40_000)]
)
def test_however_many_answers_there_are_the_laboratory_is_found(participants: int, times: int) -> None:
    """More trials of the same people tell hardly more, more people do."""
    found = condition(answered(answers(0.8, participants, times, seed=4)), laboratories(300, 1), seed=2)
    sample = found.after.place[:, 0]
    assert (found.unusable, found.rounds > 0) == ("", True)
    assert found.effective_after >= conditioning.LEAST_SHARE * len(sample)
    assert abs(sample.mean() - 0.8) < 0.25
    assert 0.02 < sample.std() < (0.2 if participants == 80 else 0.12)


@pytest.mark.parametrize(("times", "near", "least"), [(1, 0.5, 0.0015), (1000, 0.447, 0.0015), (1e-3, 1.0, 0.9)])
def test_laboratories_far_from_many_answers_keep_a_weight_and_from_few_the_same(
    times: float, near: float, least: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of laboratories that are up to 50 less likely in ln L, or so many times that."""
    given: list[np.ndarray] = []
    monkeypatch.setattr(conditioning.PooledLikelihood, "fit", lambda *arguments: given.append(arguments[-1]))
    some = laboratories(101, 1)
    short, rng = times * np.linspace(0.0, 50.0, 101), np.random.default_rng(0)
    answered(answers(0.8, 4, 10, seed=4)).polynomial(some, Toy().confusions(some), -short, rng)
    assert given[0][4] == pytest.approx(near, rel=0.01)  # 2 in ln L
    assert given[0][90] >= least


@pytest.mark.parametrize("times", [1, 1000, 10_000_000])
def test_the_least_variance_of_a_cell_decides_nothing(times: int, monkeypatch: pytest.MonkeyPatch) -> None:
    some, grid = laboratories(200, 3), laboratories(50, 5)
    counts, played = times * answers(0.8, 20, 20, seed=4), Toy().confusions(some)
    rounded = replace(played, probability=played.probability.astype(np.float32))
    expected = PooledLikelihood.fit(some, played, counts, ALIKE)(grid.place, grid.form)
    assert np.ptp(expected) > 3.0
    monkeypatch.setattr(likelihood, "RIDGE", 10.0 * likelihood.RIDGE)
    for each in (played, rounded):
        found = PooledLikelihood.fit(some, each, counts, ALIKE)(grid.place, grid.form)
        np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize(
    ("ridge", "chance", "why"), [(-1.0, 1.0, "cannot be factorised"), (1e-9, np.nan, "is not a finite number")]
)
def test_a_likelihood_that_cannot_be_computed_is_said(
    ridge: float, chance: float, why: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(likelihood, "RIDGE", ridge)
    monkeypatch.setattr(conditioning, "log_likelihoods", lambda *given: chance * log_likelihoods(*given))
    found = condition(answered(answers(0.8, 80, 40, seed=4)), laboratories(300, 1), seed=2)
    assert why in found.unusable
    assert (len(found.before), len(found.after), found.effective_after) == (300, 0, 0.0)


def test_as_far_is_as_far_but_for_rounding_whatever_the_size() -> None:
    for size in (1e-9, 1.0, 1e12):
        assert share_as_far([size * 0.3, size * (0.1 + 0.2), size * (0.2 + 0.1), size * 0.2]) == 0.75
        assert share_as_far([size * (0.1 + 0.2), size * 0.3]) == 1.0
        assert share_as_far([size, size * (1.0 - 1e-9)]) == 0.5


def test_a_polynomial_that_fits_badly_still_covers() -> None:
    """Laboratories are of two kinds: no polynomial jumps, so that answers tell less than they could."""
    rng, some, grid = np.random.default_rng(6), laboratories(200, 3), laboratories(2000, 5)
    played, covered = Toy().confusions(replace(some, place=2.0 * np.sign(some.place))), []
    for seed, truth in enumerate(rng.standard_normal(24).tolist()):
        likely = PooledLikelihood.fit(some, played, answers(2.0 * np.sign(truth), 12, 20, seed), ALIKE)
        weights = normalised_weights(likely(grid.place, grid.form))
        low, high = weighted_quantile(grid.place[:, 0], weights, (0.025, 0.975))
        covered.append(low <= truth <= high)
    assert np.mean(covered) > 0.85


def test_a_participant_is_a_mixture_over_people() -> None:
    probability = np.array([[np.diag([0.8, 0.8]) + 0.1, np.diag([0.0, 0.0]) + 0.5]])
    counts = np.array([[[3.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [1.0, 0.0]]])
    found = np.exp(log_likelihoods(probability, counts))[0]
    assert found == pytest.approx([(0.9**3 + 0.5**3) / 2, (0.1 + 0.5) / 2], rel=1e-5)
    many = log_likelihoods(probability, 1000.0 * counts)[0]  # one of both people is then as good as ruled out
    assert many == pytest.approx(np.log([0.9, 0.5]) * [3000.0, 1000.0] - np.log(2.0), rel=1e-5)


def test_weights_and_resampling() -> None:
    weights = np.array([0.1, 0.2, 0.7])
    assert effective(weights) == pytest.approx(1.0 / 0.54)
    chosen = np.bincount(systematic(weights, 1000, np.random.default_rng(0)), minlength=3)
    assert np.abs(chosen - 1000 * weights).max() <= 1
    assert {*systematic(np.array([0.0, 0.5, 0.5, 0.0]), 7, np.random.default_rng(1))} == {1, 2}, "nothing of weight 0"


def test_weights_are_of_the_highest_power_that_leaves_enough() -> None:
    logs = np.linspace(-40.0, 0.0, 100)
    assert 25.0 <= effective(conditioning._tempered(logs, 25.0)) < 35.0
    assert np.allclose(conditioning._tempered(logs, 1.0), normalised_weights(logs))
    assert off_middle(np.array([[0.0], [1.0], [5.0]])).argmin() == 1


def test_intervals_are_of_95_percent_and_constants_change_by_more_than_chance() -> None:
    assert three(np.arange(1001.0)) == (500.0, 25.0, 975.0)
    assert median_three(np.arange(1001.0)) == (500.0, 25.0, 975.0)
    before = np.random.default_rng(0).standard_normal((400, 1)) @ np.ones((1, 2))
    # 6 (1/400 + 1/400) bits are the gain of a shift of 0.204 SD.
    after = before + before.std() * np.array([0.195, 0.213])
    assert [each.constant for each in changed(["a", "b"], before, after, 400.0, ["", ""])] == ["b"]


def test_fit_finds_a_pair_that_was_missed_and_nothing_where_all_is_as_predicted() -> None:
    played = Toy().confusions(laboratories(300, 8))
    fine = Trials(("a", "b", "c"), tuple("PQRST"), answers(0.1, 5, 10, seed=3))
    assert compare(fine, played).p > 0.05
    counts = np.zeros((5, 3, 3))
    counts[:, 0] = [2, 8, 0]
    counts[:, 1, 1] = counts[:, 2, 2] = 10
    fit = compare(Trials(("a", "b", "c"), tuple("PQRST"), counts), played)
    assert fit.p < 0.01
    assert (fit.missed[0].a, fit.missed[0].b) == ("a", "b")
    assert fit.missed[0].observed == pytest.approx(0.4)
    assert fit.p_people is not None and fit.p_people > 0.9  # nobody differs


@pytest.mark.parametrize(("silent", "missed"), [(8.0, True), (1.0, False)])
def test_an_icon_that_nobody_felt_is_seen_where_each_answer_was_right(silent: float, missed: bool) -> None:
    played, counts, none = (
        Toy().confusions(laboratories(300, 8)),
        10.0 * np.eye(3)[None],
        np.array([[silent, 1.0, 1.0]]),
    )
    counts[0, 0, 0] = 10.0 - silent
    fit = compare(Trials(("a", "b", "c"), ("P",), counts, unanswered=none), played)
    assert fit.p_reports is not None and (fit.p_reports < 0.01) == missed
    assert [each.a for each in fit.reports if each.missed] == ["a"] * missed
    assert (fit.reports[0].observed, fit.reports[0].predicted) == (silent / 10.0, pytest.approx(0.1, abs=0.02))
    # What is felt and named was felt and was named: nine of ten plays of what the same prediction has of names.
    assert fit.felt_and_named is not None
    assert fit.felt_and_named[0] == pytest.approx(0.9 * fit.proportion_correct[0], abs=0.05)


def test_trials_that_all_have_an_answer_say_nothing_of_what_is_felt_and_silence_moves_no_name() -> None:
    counts, played = answers(0.1, 5, 10, seed=3), Toy().confusions(laboratories(300, 8))
    forced, free = (Trials(("a", "b", "c"), tuple("PQRST"), counts, unanswered=n * np.ones((5, 3))) for n in (0.0, 2.0))
    fit, other = compare(forced, played), compare(free, played)
    assert (fit.p_reports, fit.felt_and_named, fit.reports) == (None, None, ())
    assert (fit.p, fit.proportion_correct, fit.pairs) == (other.p, other.proportion_correct, other.pairs)
    likely = [
        Namings(each, Toy()).weighed(played, np.random.default_rng(0))[0]  # type: ignore[arg-type]
        for each in (forced, free)
    ]
    assert np.array_equal(*likely)
