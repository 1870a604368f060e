"""Logs whose clock and current are rounded."""

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, fit, simulate, simulate_current
from thermicon.circuit.fitting.between import tells_all
from thermicon.circuit.fitting.keys import COMMON, CONTACT, value_of
from thermicon.circuit.fitting.log import Log
from thermicon.circuit.fitting.rounding import clock_step_s, level_step
from thermicon.circuit.fitting.synthetic_log import calibration_icon

LOOP_NOISE_A, NOISE_K, ROWS, LOGS = 0.015, 0.002, 6000, 12
"""What a loop puts out against the noise of a good thermistor, as boards log it."""


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig.load("thenar").with_(**{"driver.update_Hz": 100.0})


def exact_log(rig: Rig, random: np.random.Generator, quiet_rows: int = 0) -> dict[str, np.ndarray]:
    """A calibration drive from rest, in rows as long as a busy computer makes them."""
    time_s = 1e-4 + np.cumsum(0.01037 + random.uniform(-5e-4, 5e-4, ROWS))
    designed = simulate(calibration_icon(), rig)
    steady_A = np.interp(np.append(0.0, time_s), designed.time_s, designed.current_A)
    current_A = steady_A[1:] + LOOP_NOISE_A * random.normal(size=ROWS) * (np.arange(ROWS) >= quiet_rows)
    drive = Drive(np.append(0.0, time_s), np.append(steady_A[0], current_A), held=True)
    trace = simulate_current(drive, rig, rate_Hz=400.0)
    display_C = np.interp(time_s, trace.time_s, trace.display_C) + NOISE_K * random.normal(size=ROWS)
    return {"time_s": time_s, "current_A": current_A, "display_C": display_C}


def rounded(columns: dict[str, np.ndarray], clock_s: float, level_A: float) -> Log:
    """The log of a program whose clock ticks, and which writes a current in so many decimals."""
    time_s = np.floor(columns["time_s"] / clock_s) * clock_s
    current_A = np.round(columns["current_A"] / level_A) * level_A
    return Log.of("log.csv", {**columns, "time_s": time_s, "current_A": current_A})


@pytest.mark.slow
def test_intervals_hold_the_truth_whatever_a_logger_rounds(rig: Rig) -> None:
    random, held = np.random.default_rng(), []
    for k in range(LOGS):
        truth = {key: value_of(rig, key) * random.uniform(0.9, 1.1) for key in COMMON}
        log = rounded(exact_log(rig.with_(**truth), random), *((1e-3, 1e-3), (1e-3, 2e-3), (5e-3, 1e-5))[k % 3])
        found = fit([log], rig, free=COMMON, fixed_skin=True)
        held += [item.low <= truth[item.key] <= item.high for item in found.parameters]
        print({item.key: (item.value / truth[item.key], item.half_width) for item in found.parameters})
    assert np.mean(held) >= 0.75


def test_an_interval_is_as_wide_as_rounding_makes_it(rig: Rig) -> None:
    columns, steps = exact_log(rig, np.random.default_rng(), quiet_rows=100), ((1e-6, 1e-7), (1e-3, 1e-7), (1e-6, 1e-3))
    logs = [rounded(columns, *pair) for pair in steps]
    fine, clock, level = (fit([log], rig, free=COMMON, fixed_skin=True)[CONTACT].half_width for log in logs)
    assert clock > 1.5 * fine
    assert level > 10 * fine


def test_rows_that_are_even_and_levels_that_were_set_are_not_rounded() -> None:
    even_s = np.arange(3000) * 0.01
    missing_s = np.delete(even_s, [500, 501, 900])
    two_rates_s = np.append(even_s[:1000:10], even_s[1000:])
    twice_s = np.insert(even_s, 501, 5.0 + 1e-7)
    for time_s in (even_s, missing_s, two_rates_s, even_s + 1.7e9, twice_s):
        assert clock_step_s(time_s) == 0.0
    drifting_s = np.floor(np.arange(3000) * 10.37) / 1000
    assert clock_step_s(drifting_s) == pytest.approx(1e-3)
    assert clock_step_s(np.floor(drifting_s / 0.005) * 0.005) == pytest.approx(5e-3)
    assert level_step(np.repeat([0.0, 0.5, -0.5, 0.0], 100)) == 0.0
    assert level_step(np.round(0.2 * np.sin(even_s), 3)) == pytest.approx(1e-3)


@pytest.mark.parametrize("level_A", [1e-3, 4e-3])
def test_noise_that_rounding_lets_repeat_is_no_slower_driver(level_A: float) -> None:
    random = np.random.default_rng()
    time_s, noise_A = np.arange(30_000) / 100.0, np.cumsum(np.r_[0.0, 0.0, random.normal(0, 1e-3, 29_998)])
    noise_A += LOOP_NOISE_A * random.normal(size=30_000)
    assert tells_all(time_s, np.round(noise_A / level_A) * level_A, 100.0)
    fifth = np.round(noise_A[np.arange(30_000) * 4 // 5] / level_A) * level_A
    assert not tells_all(time_s, fifth, 100.0), "a loop at 80 Hz"
