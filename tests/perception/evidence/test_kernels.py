"""The compiled receptor stage and first passage, against closed forms, courses and drawn noise."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.perception.survival import log_survival
from thermicon.perception import Observer
from thermicon.perception.experiments.laboratory import SHARES, samples_of
from thermicon.perception.kernels import passage as kernels
from thermicon.perception.kernels.kernels import adapted_drive
from thermicon.perception.kernels.passage import psychometric
from thermicon.perception.observer.parts import Transducer

DT = 0.025
TRANSDUCER = Transducer(11.0, 1.2)
TABLE = TRANSDUCER.psi(np.exp(kernels.LOG_U_FROM + kernels.LOG_U_STEP * np.arange(kernels.LOG_U_POINTS)))


def drive(temperature, sign, limit=None, integration_s=0.05):
    course = np.asarray(temperature, dtype=np.float64)[None]
    out = np.empty_like(course)
    far = -sign * 1e6 if limit is None else limit
    adapted_drive(course, DT, sign, far, 0.4, 30.0, 36.0, integration_s, 17.0, out)
    return out[0]


def passage(log_drive, log_gain, criterion, tau=0.3):
    times = np.empty((log_gain.size, SHARES.size))
    passed = kernels.passage(log_drive, DT * np.arange(log_drive.size), log_gain, criterion, tau, TABLE, SHARES, times)
    return times, passed


def test_step_decays_with_slow_adaptation() -> None:
    step = np.concatenate([[32.0], np.full(800, 30.5)])
    felt = drive(step, -1.0, integration_s=1e-3)
    time = DT * np.arange(felt.size)
    expected = 1.5 * np.exp(-(time[10:] - 0.5 * DT) / 17.0)
    np.testing.assert_allclose(felt[10:], expected, rtol=2e-3)


def test_cold_is_limited_from_above() -> None:
    course = np.concatenate([np.linspace(35.9, 33.0, 80), np.full(80, 33.0)])
    assert drive(course, -1.0).max() > 2.0
    assert drive(course, -1.0, limit=30.0).max() < 1e-2
    assert drive(course - 5.0, -1.0, limit=33.0).max() > 2.0


def test_a_rise_of_cool_skin_is_not_warm() -> None:
    course = np.linspace(22.0, 28.0, 200)
    assert drive(course, 1.0, limit=31.0).max() < 1e-2
    assert drive(course + 10.0, 1.0, limit=31.0).max() > 3.0


def test_first_passage_of_a_lane_agrees_with_that_of_a_course() -> None:
    time = DT * np.arange(200)
    course = 0.02 + 2.0 * np.clip(time - 0.5, 0.0, 2.0)
    observer = replace(Observer.load(), noise_correlation_s=0.3)
    gains, criteria = np.array([0.5, 1.0, 2.0, 4.0]), np.array([2.5, 2.5, 3.5, 2.0])
    times, passed = passage(np.log(course), np.log(gains), criteria)
    for lane, (gain, criterion) in enumerate(zip(gains.tolist(), criteria.tolist(), strict=True)):
        psi = TRANSDUCER.psi(gain * course)
        # A course counts the change from its first sample; here that is as good as none.
        change = np.concatenate([[0.0], psi - psi[0]])[None, 1:]
        logs = log_survival(change, DT, criterion - float(psi[0]), observer)[0]
        answered = 1.0 - np.exp(logs)
        assert passed[lane] == pytest.approx(answered[-1], abs=0.01)
        for share, when in zip(SHARES.tolist(), times[lane].tolist(), strict=True):
            if answered[-1] > share + 0.02:
                assert when == pytest.approx(float(np.interp(share, answered, time)), abs=0.03)


def test_first_passage_agrees_with_drawn_noise() -> None:
    tau, criterion = 0.3, 3.0
    time = DT * np.arange(160)
    course = np.maximum(1.5 * time, 1e-9)
    times, _ = passage(np.log(course), np.zeros(1), np.array([criterion]), tau)
    rng = np.random.default_rng(3)
    lags = np.abs(time[:, None] - time[None, :])
    factor = np.linalg.cholesky(np.exp(-(lags**2) / (2.0 * tau**2)) + 1e-8 * np.eye(time.size))
    noisy = TRANSDUCER.psi(course) + rng.standard_normal((6000, time.size)) @ factor.T
    first = np.where((noisy > criterion).any(axis=1), time[(noisy > criterion).argmax(axis=1)], np.inf)
    np.testing.assert_allclose(times[0], np.quantile(first, SHARES), atol=0.06)


def test_no_drive_gives_false_alarms_alone() -> None:
    _, passed = passage(np.full(200, -30.0), np.zeros(1), np.array([3.0]))
    rate = math.exp(-4.5) / (2.0 * math.pi * 0.3)
    below = 0.5 * math.erfc(-3.0 / math.sqrt(2.0))
    assert passed[0] == pytest.approx(1.0 - below * math.exp(-rate / below * 199 * DT), rel=0.01)


def test_lanes_and_steps_can_be_chosen_freely() -> None:
    time = DT * np.arange(400)
    log_drive = np.log(np.maximum(0.8 * time, 1e-9))
    rng = np.random.default_rng(5)
    gains, criteria = rng.normal(0.0, 0.5, 37), np.exp(rng.normal(1.3, 0.7, 37))
    times, passed = passage(log_drive, gains, criteria)
    order = rng.permutation(37)
    shuffled, passed_too = passage(log_drive, gains[order], criteria[order])
    np.testing.assert_allclose(shuffled, times[order], rtol=1e-6)
    np.testing.assert_allclose(passed_too, passed[order], atol=1e-6)
    few = samples_of(((10.0, 8.0),), 9.975)
    assert few.size < 0.4 * time.size
    sparse = np.empty_like(times)
    kernels.passage(log_drive[few], time[few], gains, criteria, 0.3, TABLE, SHARES, sparse)
    np.testing.assert_allclose(sparse, times, rtol=1e-3)


def test_sizes_at_shares_are_read_between_and_beyond() -> None:
    reported, logs = np.array([[0.0, 0.25, 0.75, 0.8], [0.5, 0.5, 0.75, 1.0]]), np.empty((2, 2))
    psychometric(reported, np.arange(4.0), np.array([0.5, 0.9]), logs)
    np.testing.assert_allclose(logs[0], [1.5, 3.1], atol=1e-6)
    assert logs[1, 0] == pytest.approx(2.0, abs=0.01)
