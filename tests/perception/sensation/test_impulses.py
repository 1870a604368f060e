from dataclasses import replace

import numpy as np
import pytest

from thermicon.perception import Observer
from thermicon.perception.sensation.impulses import mean_positive_part
from thermicon.perception.sensation.receptors import receptor_drive


@pytest.fixture
def counting(observer: Observer) -> Observer:
    """Round numbers: 2 Hz/K and 60 Hz·s/K in both channels, counted over 20 s, static from 33 °C."""
    return replace(observer, model="ring-de-dear")


@pytest.mark.parametrize("rate", [0.1, 1.0, 10.0])
def test_a_change_gives_its_dynamic_impulses_at_any_rate(counting: Observer, rate: float) -> None:
    """Below 33 °C warm fibres have no static discharge: 60 Hz·s/K alone, whatever the rate."""
    t = np.arange(0.0, 12.0, 0.01)
    counted = receptor_drive(31.0 + np.minimum(rate * t, 1.0), 0.01, "warm", counting)
    assert counted[-1] == pytest.approx(60.0, rel=1e-9)


def test_static_discharge_is_counted_above_its_start(counting: Observer) -> None:
    """From 34 to 35 °C at once: 60 impulses, then 2 Hz above the rest (2 Hz at 34 °C is not counted)."""
    t = np.arange(0.0, 10.005, 0.01)
    counted = receptor_drive(np.where(t > 0.0, 35.0, 34.0), 0.01, "warm", counting)
    assert counted[-1] == pytest.approx(60.0 + 2.0 * 10.0 - 0.01, abs=1e-9)
    assert receptor_drive(np.full(100, 36.0), 0.01, "warm", counting).max() == 0.0


def test_impulses_leave_with_the_window(counting: Observer) -> None:
    t = np.arange(0.0, 30.0, 0.05)
    counted = receptor_drive(31.0 + np.minimum(t, 1.0), 0.05, "warm", counting)
    assert counted[t < 19.9].max() == pytest.approx(60.0)
    assert counted[-1] == pytest.approx(0.0, abs=1e-9)
    middle = counted[np.isclose(t, 20.5)][0]
    assert middle == pytest.approx(30.0, abs=1e-6)


def test_the_return_is_counted_in_the_other_channel_in_full(counting: Observer) -> None:
    t = np.arange(0.0, 8.0, 0.01)
    dip = 32.0 - np.interp(t, [0.0, 1.0, 4.0, 5.0], [0.0, 1.0, 1.0, 0.0])
    cold, warm = (receptor_drive(dip, 0.01, channel, counting)[-1] for channel in ("cold", "warm"))  # type: ignore[arg-type]
    assert warm == pytest.approx(60.0)
    assert cold == pytest.approx(60.0 + 2.0 * (0.5 + 3.0), rel=5e-3)


def test_the_step_that_starts_static_discharge_has_the_stated_error(counting: Observer) -> None:
    for dt in (0.5, 0.05):
        t = np.arange(0.0, 4.0 + dt / 2, dt)
        counted = receptor_drive(32.6 + 0.5 * t, dt, "warm", counting)
        above = np.maximum(0.0, 0.5 * t - 0.4)
        exact = 60.0 * 0.5 * t + 2.0 * above**2
        assert np.abs(counted - exact).max() <= 2.0 * (0.5 * dt) * dt / 8.0 + 1e-9


def test_mean_of_a_positive_part() -> None:
    start, end = np.array([-1.0, 1.0, -2.0, 1.0, 0.0]), np.array([3.0, -3.0, -1.0, 2.0, 0.0])
    assert mean_positive_part(start, end) == pytest.approx([9 / 8, 1 / 8, 0.0, 1.5, 0.0])
