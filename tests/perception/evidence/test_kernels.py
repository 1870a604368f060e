"""First passage or mechanisms of the likelihood one by one, against closed forms or drawn noise."""

import math
from dataclasses import replace

import numpy as np
import pytest

from thermicon.perception import Observer
from thermicon.perception.experiments.laboratory import SHARES, Laboratory, samples_of
from thermicon.perception.experiments.tasks import psychometric
from thermicon.perception.kernels import crossing as kernels
from thermicon.perception.observer.channels import CHANNELS, Channel
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.mechanisms.summation import Summation
from thermicon.perception.observer.people import People

DT = 0.025
TRANSDUCER = replace(Observer.load(), a=11.0, p=1.2)


def passage(drive, gain, criterion, tau=0.3, time=None):
    times, risen = np.empty((gain.size, SHARES.size)), drive**TRANSDUCER.p / TRANSDUCER.b
    clock = DT * np.arange(drive.size) if time is None else time
    raised = gain**TRANSDUCER.p
    return times, kernels.passage(risen, clock, raised, TRANSDUCER.a, criterion, tau, SHARES, times)


def drawn_noise(time: np.ndarray, tau: float, *trials: int) -> np.ndarray:
    lags = np.subtract.outer(time, time) / tau
    factor = np.linalg.cholesky(np.exp(-0.5 * lags**2) + 1e-8 * np.eye(time.size))
    return np.asarray(np.random.default_rng(3).standard_normal((*trials, time.size)) @ factor.T)


def test_first_passage_agrees_with_drawn_noise() -> None:
    tau, criterion = 0.3, 3.0
    time = DT * np.arange(160)
    course = np.maximum(1.5 * time, 1e-9)
    times, _ = passage(course, np.ones(1), np.array([criterion]), tau)
    noisy = TRANSDUCER.psi(course) + drawn_noise(time, tau, 6000)
    first = np.where((noisy > criterion).any(axis=1), time[(noisy > criterion).argmax(axis=1)], np.inf)
    np.testing.assert_allclose(times[0], np.quantile(first, SHARES), atol=0.06)


def test_no_drive_gives_false_alarms_alone() -> None:
    _, passed = passage(np.full(200, 1e-13), np.ones(1), np.array([3.0]))
    rate = math.exp(-4.5) / (2.0 * math.pi * 0.3)
    below = 0.5 * math.erfc(-3.0 / math.sqrt(2.0))
    assert passed[0] == pytest.approx(1.0 - below * math.exp(-rate / below * 199 * DT), rel=0.01)


@pytest.mark.parametrize("channel", CHANNELS)
def test_noise_of_the_other_channel_decides_as_often_as_drawn_noise(channel: Channel) -> None:
    tau, criterion, trials = 0.25, 2.0, 20_000
    person = replace(TRANSDUCER, gain_noise=0.0, criterion=criterion, criterion_floor=0.0, noise_correlation_s=tau)
    asked = replace(Laboratory.of(person, {}), people=People.nominal(1, person))
    time = DT * np.arange(161)
    course, samples = np.maximum(1.5 * time, 1e-9), samples_of(((4.0, 6.0),), 4.0)
    found = asked.outrun(course, samples, channel, 1.0, site="forearm")[0]
    sooner = np.diff([person.delay_s(each, 0.55) for each in CHANNELS])[0] * (1.0 if channel == "warm" else -1.0)
    noise = drawn_noise(time, tau, 2, trials)
    own, other = person.psi(course) + noise[0], noise[1]
    first, at = (np.where((x > criterion).any(axis=1), time[(x > criterion).argmax(axis=1)], 9.0) for x in (own, other))
    decided = int((at - sooner < first).sum())
    assert found == pytest.approx(decided / trials, rel=0.1)


def test_lanes_and_steps_can_be_chosen_freely() -> None:
    time = DT * np.arange(400)
    drive = 0.8 * time
    rng = np.random.default_rng(5)
    gains, criteria = np.exp(rng.normal(0.0, 0.5, 37)), np.exp(rng.normal(1.3, 0.7, 37))
    times, passed = passage(drive, gains, criteria)
    order = rng.permutation(37)
    shuffled, passed_too = passage(drive, gains[order], criteria[order])
    np.testing.assert_allclose(shuffled, times[order], rtol=1e-6)
    np.testing.assert_allclose(passed_too, passed[order], atol=1e-6)
    few = samples_of(((10.0, 8.0),), 9.975)
    assert few.size < 0.4 * time.size
    sparse, _ = passage(drive[few], gains, criteria, time=time[few])
    np.testing.assert_allclose(sparse, times, rtol=1e-3)


def test_sizes_at_shares_are_read_between_and_beyond() -> None:
    reported = np.array([[0.0, 0.25, 0.75, 0.8], [0.5, 0.5, 0.75, 1.0]])
    logs = psychometric(reported, np.arange(4.0), np.array([0.5, 0.9]))
    np.testing.assert_allclose(logs[0], [1.5, 3.1], atol=1e-6)
    assert logs[1, 0] == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize(("a", "p"), [(12.0, 1.0), (6.0, 2.0), (30.0, 0.7)])
def test_transducer_is_one_at_threshold_a_power_below_and_a_logarithm_above(a: float, p: float) -> None:
    transducer = replace(Observer.load(), a=a, p=p)
    assert float(transducer.psi(1.0)) == pytest.approx(1.0)
    low = float(transducer.psi(2e-4) / transducer.psi(1e-4))
    assert math.log2(low) == pytest.approx(p, abs=0.01)
    high = float(transducer.psi(2e9) - transducer.psi(1e9))
    assert high == pytest.approx(a * p * math.log(2.0), rel=1e-3)
    steps = transducer.difference_threshold(np.array([3.0]))
    assert float((transducer.psi(3.0 + steps) - transducer.psi(3.0))[0]) == pytest.approx(1.0)


def test_summation_has_two_ends() -> None:
    def area_factor(area_cm2: float, reference_cm2: float, exponent: float) -> float:
        areas = {"reference_area_m2": 1e-4 * reference_cm2, "least_area_m2": 0.5e-4}
        return Summation(area_exponent=Both(exponent, exponent), **areas).of_area("cold", 1e-4 * area_cm2)

    assert area_factor(0.001, 9.0, 0.7) == area_factor(0.49, 9.0, 0.7) < area_factor(0.51, 9.0, 0.7)
    assert area_factor(400.0, 225.0, 0.9) < 1.2 < 1.4 < area_factor(225.0, 100.0, 0.9)
    assert area_factor(18000.0, 9.0, 0.9) < 20.0 < (18000.0 / 9.0) ** 0.9
    middle = math.log(area_factor(20.0, 10.0, 0.7)) / math.log(2.0)
    assert middle == pytest.approx(0.7, abs=0.12)
    with pytest.raises(ValueError, match="above 0 m²"):
        area_factor(0.0, 9.0, 0.7)


def test_the_spine_adds_to_the_nerve() -> None:
    nerves = replace(Observer.load(), velocity_m_per_s=Both(6.0, 1.0))
    assert nerves.delay_s("cold", 0.7) == pytest.approx(0.7 / 6.0 + 0.225 / 12.0)
    assert nerves.delay_s("warm", [0.7, 0.4]) == pytest.approx([0.7 + 0.225 / 2.0, 0.4 + 0.225 / 2.0])


def test_a_later_decade_raises_thresholds() -> None:
    laboratory = Laboratory.of(Observer.load(), {"E3": Both(0.0, 0.0)})
    young, old = (laboratory.gain("cold", 9.0, "E3", "hand", years) for years in (25.0, 65.0))
    assert math.log(young / old) == pytest.approx(4.0 * Observer.load().lost_per_decade.cold)
