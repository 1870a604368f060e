"""Detection or response times: false alarms, one look, drawn noise, the rule written out."""

import math
from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest

from tests.perception.survival import answered, log_survival
from thermicon.base.numbers.arrays import Array
from thermicon.perception import Observer
from thermicon.perception.observer.observer import CHANNELS
from thermicon.perception.sensation.detection import (
    Detection,
    channel_name,
    criterion_of,
    detect,
    false_alarms,
    pooled,
    quarters,
    time_of,
)


def drawn_noise(rng: np.random.Generator, trials: int, samples: int, dt_s: float, tau_s: float) -> Array:
    """White noise through a Gaussian of SD τ/√2, which has the autocorrelation e^(−t²/2τ²)."""
    lag = round(4 * tau_s / dt_s)
    window = np.exp(-((np.arange(-lag, lag + 1) * dt_s / tau_s) ** 2))
    window /= math.sqrt(float((window**2).sum()))
    spectrum = np.fft.rfft(rng.normal(size=(trials, samples + 2 * lag)), 512) * np.fft.rfft(window, 512)
    return np.asarray(np.fft.irfft(spectrum, 512)[:, 2 * lag : 2 * lag + samples])


def test_criterion_keeps_its_false_alarms(observer: Observer) -> None:
    for rate in (0.01, 0.02, 0.05):
        assert false_alarms(criterion_of(rate, 0.3, 5.0), 0.3, 5.0) == pytest.approx(rate, rel=1e-9)
    assert criterion_of(0.02, 0.3, 5.0) == pytest.approx(3.35, abs=0.01)
    with pytest.raises(ValueError, match=r"false-alarm rate must lie between 0 and 1, not 2"):
        criterion_of(2.0, 0.3, 5.0)
    nothing = log_survival(np.zeros(501), 0.01, 2.5, observer)
    assert -math.expm1(2.0 * nothing[-1]) == pytest.approx(false_alarms(2.5, 0.3, 5.0), rel=1e-4)


def test_false_alarms_agree_with_simulated_noise() -> None:
    rng, trials, passed = np.random.default_rng(5), 20_000, 0
    for _ in range(20):
        noise = drawn_noise(rng, 2 * trials // 20, 250, 0.02, 0.3)
        passed += int((noise.max(axis=1) > 2.5).reshape(2, -1).any(axis=0).sum())
    assert false_alarms(2.5, 0.3, 5.0) == pytest.approx(passed / trials, rel=0.06)


def test_nothing_is_not_detected_and_much_is(observer: Observer) -> None:
    flat, strong = np.zeros(1000), np.minimum(np.arange(1000) * 0.1, 20.0)
    found = detect(np.stack([flat, strong, flat + 30.0]), np.zeros((3, 1000)), 0.01, observer)
    # Only change from the start is detected.
    assert found.probability == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)
    assert [channel_name(int(each)) for each in found.channel] == [None, "cold", None]
    assert channel_name(1) == "warm"
    assert math.isnan(found.onset_s[0])
    untimed = detect(flat, flat, 0.01, observer, times=False)
    for name in ("onset_s", "channel"):
        with pytest.raises(ValueError, match="there are no response times: call detect with times=True"):
            getattr(untimed, name)
    with pytest.raises(ValueError, match=r"cold and warm sensation differ in shape: \(5,\) and \(6,\)"):
        detect(np.zeros(5), np.zeros(6), 0.01, observer)


def test_detection_is_the_end_of_it_beyond_false_alarms(observer: Observer) -> None:
    t = np.arange(0.0, 3.0, 0.01)
    psi = np.stack([np.minimum(0.8 * t, 1.5), 2.5 * np.sin(t)])
    missed, silent = (log_survival(each, 0.01, observer.criterion, observer)[:, -1] for each in (psi, 0 * psi))
    found = detect(psi, 0 * psi, 0.01, observer)
    assert found.probability == pytest.approx(-np.expm1(missed - silent), abs=2e-4)


def test_probability_of_a_brief_step_is_that_of_one_look(observer: Observer) -> None:
    """A rise within far less than the noise correlation time is one look: 1 − Φ(criterion − ψ)."""
    psi = np.concatenate([[0.0, 0.0], np.linspace(0.0, 3.0, 2000)])
    found = detect(psi, np.zeros_like(psi), 1e-6, observer)
    looked = NormalDist().cdf(3.0 - observer.criterion)
    assert float(found.probability) == pytest.approx(looked, rel=0.01)


def test_onset_is_crossing_conduction_and_decision(observer: Observer) -> None:
    t = np.arange(500) * 0.01
    cold, warm = 10.0 * t, 40.0 * t
    found = detect(np.stack([cold, 0 * cold]), np.stack([warm, warm]), 0.01, observer, path_m=[0.7, 0.7])
    # Noise of a fast rise passes about when its mean does; 0.225 m of spine at 12 and 2 m/s follow the nerve.
    assert found.onset_s[0] == pytest.approx(3.34 / 10 + 0.7 / 2.0 + 0.225 / 12.0 + 0.2, abs=0.03)
    assert found.onset_s[1] == pytest.approx(3.34 / 40 + 0.7 / 0.5 + 0.225 / 2.0 + 0.2, abs=0.01)
    assert list(found.channel) == [0, 1]


def test_onset_is_the_median_of_the_response_times_of_reports(observer: Observer) -> None:
    """Against the answers of a task, early false alarms and all, for an icon that nobody misses."""
    noisy, t = replace(observer, gain_noise=0.3, decision_noise=0.4), np.arange(500) * 0.01
    psi = 6.0 * t
    found = detect(psi, 0 * psi, 0.01, noisy)
    late = tuple(float(noisy.delay_s(channel, noisy.path_hand_m)) for channel in CHANNELS)
    time, given = answered(psi, 0 * psi, 0.01, noisy, late, noisy.decision_s)
    assert float(found.probability) == pytest.approx(1.0, abs=1e-4)
    assert float(found.onset_s) == pytest.approx(time_of(given, time, 0.5), abs=5e-3)


@pytest.mark.parametrize(("peak", "felt"), [(2.6, False), (4.2, True)])
def test_felt_is_a_report_in_half_of_the_trials_however_long_one_waits(
    observer: Observer, peak: float, felt: bool
) -> None:
    psi = np.minimum(np.arange(300) * 0.05, peak) * (np.arange(300) < 90)
    longer = np.concatenate([psi, np.zeros(1500)])
    found, later = (detect(each, 0 * each, 0.01, observer) for each in (psi, longer))
    assert bool(found.felt) is felt
    assert (float(found.probability) >= 0.5) is felt
    assert math.isnan(float(found.onset_s)) is not felt
    assert int(found.channel) == (0 if felt else -1)
    assert float(later.probability) == pytest.approx(float(found.probability), abs=1e-9)
    assert float(later.onset_s) == pytest.approx(float(found.onset_s), abs=1e-9, nan_ok=True)


def test_pooled_is_a_person_drawn_at_random(observer: Observer) -> None:
    psi = np.minimum(np.arange(400) * 0.05, 12.0)
    criterion = np.array([[0.6], [1.0], [8.0]])
    each = detect(np.stack([psi[None]] * 3), np.zeros((3, 1, 400)), 0.01, observer, criterion_cold=criterion)
    found = pooled(each.probability, each.cold_share, each.reported_sum()[0], each.dt_s)
    assert float(found.probability[0]) == pytest.approx(float(each.probability.mean()))
    assert each.probability[2, 0] < 0.01
    # The median of two thirds of the trials lies between the medians of the two persons who report.
    first, second = (float(each.onset_s[k, 0]) for k in (0, 1))
    assert first < float(found.onset_s[0]) < second
    assert list(found.channel) == [0]


def test_nobody_has_a_criterion_below_the_floor(observer: Observer) -> None:
    psi, flat, own = np.minimum(np.arange(400) * 0.02, 2.0), np.zeros((3, 400)), [0.4, 0.8, 1.2]
    free, floored = (
        detect(np.stack([psi] * 3), flat, 0.01, each, criterion_cold=own, criterion_warm=own).probability
        for each in (observer, replace(observer, criterion_floor=observer.criterion))
    )
    assert floored[0] == floored[1] < free[1] < free[0]
    assert floored[2] == free[2]


def test_gain_noise_spreads_what_is_detected(observer: Observer) -> None:
    """Averaged over gains by hand: a quarter of presentations at each of four sizes of drive."""
    psi = np.minimum(np.arange(400) * 0.02, 3.0)
    noisy = replace(observer, gain_noise=0.4)
    louder = [observer.psi(np.exp(g) * observer.multiple(psi)) for g in quarters(0.4)]
    each = detect(np.stack(louder), np.zeros((4, 400)), 0.01, observer).probability
    found = detect(psi, np.zeros(400), 0.01, noisy)
    assert float(found.probability) == pytest.approx(float(each.mean()), abs=1e-6)
    assert each.max() - each.min() > 0.3


def test_times_agree_with_drawn_noise(observer: Observer) -> None:
    """Quartiles of first passages of 20,000 noisy rises, by counting."""
    rng, dt, times = np.random.default_rng(2), 0.01, list[float]()
    t = np.arange(0.0, 2.0, dt)
    for _ in range(20):
        passed = 4.0 * t + drawn_noise(rng, 1000, t.size, dt, 0.3) >= 3.34
        times += [float(t[row.argmax()]) for row in passed if row.any()]
    found = detect(4.0 * t, 0 * t, dt, observer, path_m=0.0, decision_s=0.0)
    for share in (0.25, 0.5, 0.75):
        assert reported_by(found, share) - 0.225 / 12.0 == pytest.approx(np.quantile(times, share), abs=0.02)


def reported_by(found: Detection, share: float) -> float:
    """Time by which a share of the trials was reported, s."""
    given = np.asarray(found.reported)
    return time_of(given, found.dt_s * np.arange(given.shape[-1]), share)


def test_trials_differ_in_gain_and_decision(observer: Observer) -> None:
    psi, plain = 4.0 * np.arange(0.0, 3.0, 0.01), replace(observer, p=1.0)
    spread = []
    for person in (plain, replace(plain, gain_noise=0.4), replace(plain, decision_noise=0.6)):
        found = detect(psi, 0 * psi, 0.01, person, decision_s=0.3)
        spread.append(reported_by(found, 0.84) - reported_by(found, 0.16))
    assert min(spread[1:]) > 1.2 * spread[0]


def test_trials_differ_in_what_follows_conduction_and_not_in_conduction(observer: Observer) -> None:
    """A path that is 0.5 s longer makes the quick and the slow answers later by 0.5 s alike."""
    psi, varied = 8.0 * np.arange(0.0, 3.0, 0.01), replace(observer, decision_noise=0.6)
    near, far = (detect(psi, 0 * psi, 0.01, varied, path_m=path_m, decision_s=0.3) for path_m in (0.2, 1.2))
    later = [reported_by(far, share) - reported_by(near, share) for share in (0.16, 0.5, 0.84)]
    assert later == pytest.approx([1.0 / observer.velocity_m_per_s.cold] * 3, abs=0.01)
    slow = detect(psi, 0 * psi, 0.01, varied, path_m=0.2, decision_s=0.8)
    assert reported_by(slow, 0.84) - reported_by(slow, 0.16) > 1.5 * (reported_by(near, 0.84) - reported_by(near, 0.16))
