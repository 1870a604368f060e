import math
from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest
from scipy.stats import norm

from tests.perception.survival import log_survival
from thermicon.perception import Observer
from thermicon.perception.arrays import Array
from thermicon.perception.kernels.reports import delayed
from thermicon.perception.sensation.detection import ResponseTimes, detect, false_alarms, response_times


def test_nothing_is_answered_as_often_as_false_alarms_say(observer: Observer) -> None:
    flat = np.zeros(501)
    survived = 2.0 * log_survival(flat, 0.01, 2.5, observer)[-1]
    assert -math.expm1(survived) == pytest.approx(false_alarms(2.5, 0.3, 5.0), rel=1e-4)
    assert log_survival(flat, 0.01, 2.5, observer)[0] == pytest.approx(math.log(NormalDist().cdf(2.5)))


def reference(psi: Array, dt_s: float, criterion: float, tau: float) -> Array:
    """The rule written out with scipy's normal distribution instead of tables."""
    change = np.abs(psi - psi[:, :1])
    gap = criterion - 0.5 * (change[:, 1:] + change[:, :-1])
    z = np.diff(change, axis=1) / dt_s * tau
    rate = (norm.pdf(z) + z * norm.cdf(z)) / tau * norm.pdf(gap) / norm.cdf(gap)
    start = np.full((len(psi), 1), norm.logcdf(criterion))
    return np.asarray(start - np.concatenate([np.zeros_like(start), np.cumsum(dt_s * rate, axis=1)], axis=1))


def test_the_compiled_rule_is_the_written_one(observer: Observer) -> None:
    t = np.arange(0.0, 3.0, 0.01)
    psi = np.stack([np.minimum(0.8 * t, 1.5), 2.5 * np.sin(t), 4.0 * t, 30.0 * np.minimum(t, 0.2)])
    survived, written = np.exp(log_survival(psi, 0.01, 3.3, observer)), np.exp(reference(psi, 0.01, 3.3, 0.3))
    assert survived == pytest.approx(written, abs=2e-4)
    assert written[2, -1] < 1e-6 < 0.8 < written[0, -1]


def test_detection_is_the_end_of_it_beyond_false_alarms(observer: Observer) -> None:
    t = np.arange(0.0, 3.0, 0.01)
    psi = np.stack([np.minimum(0.8 * t, 1.5), 2.5 * np.sin(t)])
    missed = log_survival(psi, 0.01, observer.criterion, observer)[:, -1]
    silent = log_survival(np.zeros_like(psi), 0.01, observer.criterion, observer)[:, -1]
    found = detect(psi, np.zeros_like(psi), 0.01, observer)
    assert found.probability == pytest.approx(-np.expm1(missed - silent), abs=1e-9)


def test_times_agree_with_drawn_noise(observer: Observer) -> None:
    """Quartiles of first passages of 20,000 noisy rises, by counting."""
    rng, dt, tau, criterion = np.random.default_rng(2), 0.01, 0.3, 3.34
    t = np.arange(0.0, 2.0, dt)
    rise = 4.0 * t
    lag = np.arange(-120, 121) * dt
    window = np.exp(-((lag / tau) ** 2))
    window /= math.sqrt(float((window**2).sum()))
    spectrum = np.fft.rfft(window, 512)
    times = []
    for _ in range(20):
        white = rng.normal(size=(1000, 240 + t.size))
        noise = np.fft.irfft(np.fft.rfft(white, 512) * spectrum, 512)[:, 240 : 240 + t.size]
        passed = rise + noise >= criterion
        times += [float(t[row.argmax()]) for row in passed if row.any()]
    found = response_times(rise, 0 * rise, dt, observer, conduction_s=(0.0, 0.0), decision_s=0.0)
    for share in (0.25, 0.5, 0.75):
        assert found.quantile(share)[0] == pytest.approx(np.quantile(times, share), abs=0.02)


def test_conduction_and_decision_come_on_top_and_decide_who_is_first(observer: Observer) -> None:
    t = np.arange(0.0, 2.0, 0.01)
    steep = np.minimum(200.0 * t, 40.0)
    found = response_times(
        np.stack([steep, steep, 0 * steep]),
        np.stack([0 * steep, steep, 0 * steep]),
        0.01,
        observer,
        conduction_s=(0.35, np.array([1.4, 1.4, 1.4])),
        decision_s=0.2,
    )
    middle = found.quantile()
    assert middle[0] == pytest.approx(3.34 / 200 + 0.35 + 0.2, abs=0.015)
    assert middle[1] == pytest.approx(middle[0], abs=1e-9)
    assert math.isinf(middle[2])
    assert found.cold_share[:2] == pytest.approx([1.0, 1.0], abs=1e-3)
    assert found.time_s[-1] > 2.0 + 1.4
    assert "3 rows" in repr(found)


def test_trials_differ_in_gain_and_decision(observer: Observer) -> None:
    t = np.arange(0.0, 3.0, 0.01)
    psi, plain = 4.0 * t, replace(observer, p=1.0)
    noisy = replace(plain, gain_noise=0.4, decision_noise=0.6)
    spread = []
    for person in (plain, noisy):
        found = response_times(psi, 0 * psi, 0.01, person, conduction_s=(0.1, 0.1), decision_s=0.3)
        spread.append(float(found.quantile(0.84)[0] - found.quantile(0.16)[0]))
    assert spread[1] > 1.5 * spread[0]


def test_a_persons_criterion_delays_the_answer(observer: Observer) -> None:
    psi = np.stack([4.0 * np.arange(0.0, 3.0, 0.01)] * 2)
    found = response_times(
        psi, 0 * psi, 0.01, observer, conduction_s=(0.1, 0.1), decision_s=0.2, criterion=([0.8, 1.6], 1.0)
    )
    assert found.quantile()[1] > found.quantile()[0] + 0.4


def test_messages(observer: Observer) -> None:
    found = response_times(np.zeros(9), np.zeros(9), 0.01, observer, conduction_s=(0.3, 1.0), decision_s=0.2)
    with pytest.raises(ValueError, match=r"a share of trials lies between 0 and 1, not 1"):
        found.quantile(1.0)
    with pytest.raises(ValueError, match=r"response times: \(1, 3\) probabilities for 2 times"):
        ResponseTimes(np.zeros(2), np.zeros((1, 3)), np.zeros(1))


@pytest.mark.parametrize("every", [1, 2, 5])
@pytest.mark.parametrize("delay", [0.0, 0.4, 3.0, 7.6, 39.0, 41.5, 300.0])
def test_a_delayed_course_is_that_of_the_times_before(every: int, delay: float) -> None:
    course = np.cumsum(np.random.default_rng(1).random(40))
    found = np.empty(60)
    delayed(course, every, delay, found)
    place = every * np.arange(60) - delay
    assert found == pytest.approx(np.where(place < 0, 0.0, np.interp(place, np.arange(40), course)), rel=1e-12)
