"""What a thermode shows: set-points at its own tick, its ramp rate, its lag; checked with a pencil."""

import numpy as np
import pytest

from thermicon.circuit import Device
from thermicon.circuit.delivery.setpoints import Setpoints, display_of, lag_of
from thermicon.circuit.solver.modes import shown

TCS = Device.load("qst-tcs2")


def test_one_tick_pulses_are_shown_at_the_tick_whatever_a_rig_does() -> None:
    points = Setpoints(0.01, 0.1, 320, ((1, 300), (1, 320), (98, 320)))
    step, display = display_of(points, TCS, lagged=False)
    assert step == 0.01 and len(display) == 101
    assert display[:4] == pytest.approx([32.0, 30.0, 32.0, 32.0])


def test_the_ramp_rate_of_the_device_holds_back_what_is_faster() -> None:
    _, display = display_of(Setpoints(0.01, 0.1, 320, ((1, 220),)), TCS, lagged=False, end_s=0.05)
    assert np.diff(display) == pytest.approx([-3.0, -3.0, -3.0, -1.0, 0.0])  # 300 K/s at 10 ms


def test_the_last_set_point_is_held_until_the_end_that_is_asked_for() -> None:
    _, display = display_of(Setpoints(0.01, 0.1, 320, ((100, 310),)), TCS, lagged=False, end_s=2.0)
    assert len(display) == 201
    assert display[100:] == pytest.approx(np.full(101, 31.0))


def test_a_long_tick_is_divided_into_equal_parts() -> None:
    step, display = display_of(Setpoints(0.25, 0.1, 320, ((1, 310),)), TCS, lagged=False)
    assert step == pytest.approx(0.01)
    assert display == pytest.approx(np.linspace(32.0, 31.0, 26))


def test_a_steady_ramp_runs_behind_its_set_points_by_the_lag() -> None:
    points = Setpoints(0.01, 0.1, 320, ((300, 170),))  # 5 K/s for 3 s
    _, display = display_of(points, TCS, lagged=True)
    assert display[-1] - 17.0 == pytest.approx(5.0 * lag_of(TCS), rel=1e-5)


def test_a_lag_answers_a_ramp_as_the_closed_form_does_on_any_grid() -> None:
    tau, rate = 0.21, 4.0
    for step in (0.01, 0.1):
        times = np.arange(0.0, 1.0 + step / 2, step)
        answer = 32.0 - rate * (times - tau * (1.0 - np.exp(-times / tau)))
        assert shown(32.0 - rate * times, step, tau) == pytest.approx(answer, abs=1e-9)
