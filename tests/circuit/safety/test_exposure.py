"""Exposure against closed forms: constant temperatures, ramps, and quadrature."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from thermicon.circuit.safety.tally import cem43_min, henriques

A, EA, GAS = 3.1e98, 6.28e5, 8.31446261815324


def burn_rate(celsius: float) -> float:
    return math.exp(math.log(A) - EA / (GAS * (celsius + 273.15)))


@pytest.mark.parametrize(
    ("celsius", "minutes"), [(36.999, 0.0), (37, 0.25**6), (40, 1 / 64), (42, 0.25), (43, 1.0), (44, 2.0), (46, 8.0)]
)
def test_a_minute_of_constant_temperature(celsius: float, minutes: float) -> None:
    assert cem43_min([0.0, 20.0, 60.0], [celsius] * 3)[-1] == pytest.approx(minutes, rel=1e-12)


@pytest.mark.parametrize(("low", "high"), [(30, 36), (36, 38), (38, 42), (42, 44), (43, 47), (30, 47), (47, 35)])
def test_a_ramp_of_two_rows_has_the_exact_dose(low: float, high: float) -> None:
    def rate(celsius: float) -> float:
        return 0.0 if celsius < 37 else (0.5 if celsius >= 43 else 0.25) ** (43 - celsius)

    ends = sorted((low, high))
    kinks = [kink for kink in (37.0, 43.0) if ends[0] < kink < ends[1]]
    mean = quad(rate, ends[0], ends[1], points=kinks or None, epsabs=1e-14)[0] / (ends[1] - ends[0])
    assert cem43_min([0.0, 90.0], [low, high])[-1] == pytest.approx(1.5 * mean, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("celsius", [20.0, 32.0, 43.0, 44.0, 50.0, 70.0])
def test_the_burn_integral_of_a_constant_temperature(celsius: float) -> None:
    assert henriques([0.0, 5.0, 600.0], [celsius] * 3)[-1] == pytest.approx(600 * burn_rate(celsius), rel=1e-12)


def test_a_burn_takes_hours_at_44_degrees_and_seconds_at_60() -> None:
    assert 6.0 < 0.53 / burn_rate(44.0) / 3600 < 15.0
    assert 0.2 < 0.53 / burn_rate(60.0) < 10.0


@pytest.mark.parametrize(("low", "high"), [(32, 32.01), (32, 32.04), (40, 40.06), (40, 42), (30, 55), (55, 30)])
def test_the_burn_integral_of_a_ramp_of_two_rows(low: float, high: float) -> None:
    known = quad(lambda share: burn_rate(low + share * (high - low)), 0, 1, epsrel=1e-12)[0]
    assert henriques([0.0, 3.0], [low, high])[-1] == pytest.approx(3 * known, rel=1e-8)


def test_both_take_many_traces_and_count_up_from_0() -> None:
    time = np.array([0.0, 1.0, 3.0])
    warm = np.array([[[30.0, 40.0, 44.0], [44.0, 44.0, 44.0]]])
    for measure in (cem43_min, henriques):
        found = measure(time, warm)
        assert found.shape == (1, 2, 3)
        assert (found[..., 0] == 0).all()
        assert (np.diff(found, axis=-1) >= 0).all()
        assert found[0, 0] == pytest.approx(measure(time, warm[0, 0]), rel=1e-14)
