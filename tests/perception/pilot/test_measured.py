"""The prediction conditioned on thresholds, reaction times or ratings."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from tests.perception.pilot.madeup import USUAL, measurements_of, synthetic_measurements
from thermicon.circuit import Rig
from thermicon.icons import read_cue
from thermicon.perception.experiments.laboratory import Laboratory
from thermicon.perception.experiments.measure import Condition, Setting, logs_of
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.pilot.conditioning import MeasuredValues, condition
from thermicon.perception.pilot.likelihood import effective, normalised_weights
from thermicon.perception.pilot.measurement_likelihood import (
    Emulator,
    SimulatedMeasurements,
    log_likelihood,
    person_covariance,
    predicted,
    shared_covariance,
)
from thermicon.perception.pilot.measurements_file import Measurements
from thermicon.perception.pilot.observed import observed
from thermicon.perception.pilot.states import LaboratoryPrior

RIG = Rig.load("thenar")
CHOICE = Condition("threshold", "forced_choice", "cold", 32.0, None, 1.0, 3.0)
SHARP = (CHOICE, *USUAL[:2])
RATING = Condition("rating", "magnitude", "warm", 32.0, 6.0, 5.0, 0.7)


@pytest.fixture(scope="module")
def prior() -> LaboratoryPrior:
    return LaboratoryPrior(PosteriorDraws.load(), "episodes")


def test_a_mean_of_trials_is_as_likely_as_the_trials_one_by_one() -> None:
    """Trials that all came out at their mean; one value has an error of its own, one is missing."""
    trials, errors = np.array([[1.0, 4.0, 16.0], [16.0, np.nan, np.nan]]), np.full((2, 3), np.nan)
    values, errors[1, 2] = np.array([[1.1, 1.9, 40.0], [0.6, np.nan, 55.0]]), 11.0
    some = Measurements((*USUAL[:2], RATING), ("P1", "P2"), values, errors, trials)
    root, times = np.random.default_rng(1).normal(0.0, 0.4, (3, 3, 3)), np.nan_to_num(trials, nan=1.0)
    means, within = np.log([[1.0, 1.6, 50.0], [0.7, 2.5, 30.0], [1.3, 1.3, 20.0]]), np.linspace(0.1, 0.8, 9)
    each = SimulatedMeasurements(means, root @ root.swapaxes(1, 2), within.reshape(3, 3))
    people, which = (np.repeat(place, times[some.given].astype(int)) for place in np.nonzero(some.given))
    expected = np.zeros(3)
    for k in range(3):
        error = np.where(np.isnan(trials), errors / values, each.within[k])
        whole = person_covariance(some, each.between[k])[np.ix_(which, which)] * (people[:, None] == people)
        whole += shared_covariance(some)[np.ix_(which, which)] + np.diag(error[people, which] ** 2)
        expected[k] = multivariate_normal(means[k, which], whole).logpdf(np.log(values[people, which]))
        expected[k] -= ((times - 1.0) * norm.logpdf(0.0, scale=error))[some.given].sum()  # their scatter
    np.testing.assert_allclose(np.diff(log_likelihood(some, each)), np.diff(expected), rtol=1e-6)


def test_a_polynomial_is_as_likely_as_what_it_was_fitted_to_where_that_is_straight() -> None:
    """Means and logs of scatter, of people and of trials, change evenly with coordinates."""
    chance, unknown = np.random.default_rng(3), np.full((4, 2), np.nan)
    place, slopes = chance.standard_normal((400, 3)), chance.normal(0.0, 0.2, (3, 6))
    mean, people, within = np.split(np.log([1.2, 2.2, 0.1, 0.1, 0.05, 0.05]) + place @ slopes, 3, axis=1)
    values = np.exp(chance.normal(0.5, 0.3, (4, 2)))
    some = Measurements(USUAL[:2], ("P1", "P2", "P3", "P4"), values, unknown, np.ones((4, 2)))
    each = SimulatedMeasurements(mean, np.exp(2.0 * people)[:, :, None] * np.eye(2), np.exp(within))
    found = log_likelihood(some, each)
    assert (Emulator.fit(some, place, each, np.ones(400))(place) - found).std() < 0.02 * found.std()


@pytest.mark.parametrize("participants", [10, 10_000])
def test_trials_of_which_none_is_felt_leave_the_rest_as_it_is(participants: int) -> None:
    """They do not scatter: their SD is 0, of which there is no logarithm."""
    chance = np.random.default_rng(3)
    place, ones = chance.standard_normal((200, 3)), np.ones((participants, 2))
    mean, between = place[:, :2], np.tile(0.04 * np.eye(2), (200, 1, 1))
    some = Measurements(USUAL[:2], tuple(f"P{k}" for k in range(participants)), 1.5 * ones, np.nan * ones, 9.0 * ones)
    silent, loud = (
        Emulator.fit(some, place, SimulatedMeasurements(mean, between, np.tile([0.1, within], (200, 1))), np.ones(200))(
            place
        )
        for within in (0.0, 1e-3)
    )
    np.testing.assert_allclose(silent - silent.max(), loud - loud.max(), rtol=1e-3)


def test_forced_choice_agrees_with_the_rows_of_the_evidence(prior: LaboratoryPrior) -> None:
    person = prior.draws.observer(0)
    setting = Setting("thenar", person.contact_m2K_per_W, 9.0)
    logs, _ = logs_of(setting.laboratory(person, (0.0, 0.0)), setting, CHOICE)
    plain = Laboratory.of(person, {"thenar": Both(0.0, 0.0)})
    size = float(np.exp(logs.mean()))
    drive = plain.drive("thenar", "cold", 32.0, [(size, -size)], size + 3.0).max()
    assert drive * plain.gain("cold", 9.0, "thenar", "hand", 25.0) == pytest.approx(1.0, rel=0.03)


def test_limits_and_times_lie_where_the_evidence_has_them(prior: LaboratoryPrior) -> None:
    limits = Condition("threshold", "limits", "warm", 32.0, 12.0, 1.0, 0.0)
    time = Condition("reaction_time", "choice", "cold", 31.0, 26.0, 5.0, 0.0)
    each = predicted(prior, prior.first(40, 0), Setting("forearm", 2.5e-4, 9.8), (limits, time))
    middle = np.exp(np.median(each.mean, axis=0))
    assert 1.4 < middle[0] < 2.5  # E3: 1.86 K
    assert 0.5 < middle[1] < 1.2  # E1, five strips


def test_people_of_a_laboratory_scatter_as_predicted(prior: LaboratoryPrior) -> None:
    some, setting, chance = prior.first(1, 0), Setting.of(RIG), np.random.default_rng(0)
    made = measurements_of(prior, prior.values(some)[0], setting, USUAL[:3], 400, 10_000, chance)
    found = np.sqrt(np.diagonal(predicted(prior, some, setting, USUAL[:3]).between[0]))
    assert np.log(made.values).std(axis=0) == pytest.approx(found, rel=0.2)


@pytest.mark.slow
def test_too_few_draws_are_refreshed_and_agree_with_many_weighed_draws(prior: LaboratoryPrior) -> None:
    some = synthetic_measurements(RIG, participants=12, trials=60, seed=1, conditions=SHARP)
    found = condition(MeasuredValues(some, prior, Setting.of(RIG)), prior.first(200, 2), kept=150)
    assert 1 <= found.rounds <= 3 and found.effective < 50.0 and found.effective_after >= 37.5
    assert len(found.after) == len(found.simulated_after.mean) == 150
    many = predicted(prior, prior.first(6000, 5), Setting.of(RIG), SHARP)
    weights = normalised_weights(log_likelihood(some, many))
    assert effective(weights) > 20.0
    expected = weights @ many.mean
    spread = np.sqrt(weights @ np.square(many.mean - expected))
    np.testing.assert_array_less(np.abs(found.simulated_after.mean.mean(axis=0) - expected), 0.5 * spread)
    ratio = found.simulated_after.mean.std(axis=0) / spread
    assert ((ratio > 0.7) & (ratio < 1.4)).all()


def test_ratings_count_by_their_ratios_alone(prior: LaboratoryPrior) -> None:
    small = Condition("rating", "magnitude", "warm", 32.0, 3.0, 5.0, 0.7)
    made = synthetic_measurements(RIG, participants=5, seed=2, conditions=(small, RATING))
    each = predicted(prior, prior.first(60, 0), Setting.of(RIG), (small, RATING))
    halved, steep = (replace(made, values=values) for values in (0.9 * made.values, made.values * [0.6, 1.5]))
    first, second, third = (normalised_weights(log_likelihood(some, each)) for some in (made, halved, steep))
    assert float(np.abs(first - second).sum()) < 0.35
    assert float(np.abs(first - third).sum()) > 0.35


@pytest.mark.slow
def test_what_was_measured_is_kept_as_an_observer() -> None:
    some = synthetic_measurements(RIG, participants=4, seed=2)
    calls: list[tuple[int, int]] = []
    found = observed(some, read_cue("six-icons"), RIG, draws=40, progress=lambda *steps: calls.append(steps))
    assert "# values: 16" in found.files()[1]
    assert calls[-1][0] <= calls[-1][1]
    assert [each["unit"] for each in found.to_dict()["fit_before"]["conditions"]] == ["K", "K", "s", "s"]


def test_a_site_without_skin_is_refused() -> None:
    with pytest.raises(ValueError, match=r"thenar, forearm, hand-dorsum, fingertip; thenar is at 'lip'"):
        Setting.of(RIG.with_(**{"skin.site": "lip"}))
