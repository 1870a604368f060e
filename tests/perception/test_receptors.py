import numpy as np
import pytest

from thermicon.perception import Observer, receptor_drive
from thermicon.perception.observer import Receptor


def low_pass_of_ramp(t: np.ndarray, slope: float, tau: float) -> np.ndarray:
    return slope * (t - tau * (1 - np.exp(-t / tau)))


def cascade_of_ramp(t: np.ndarray, slope: float, slow: float, quick: float) -> np.ndarray:
    return (slow * low_pass_of_ramp(t, slope, slow) - quick * low_pass_of_ramp(t, slope, quick)) / (slow - quick)


@pytest.mark.parametrize("dt", [0.01, 0.1, 0.5])
def test_warm_drive_of_a_ramp_is_exact_at_any_step(observer: Observer, dt: float) -> None:
    t = np.arange(0.0, 4.0 + dt / 2, dt)
    expected = low_pass_of_ramp(t, 0.7, 0.1) - cascade_of_ramp(t, 0.7, 14.0, 0.1)
    assert receptor_drive(32.0 + 0.7 * t, dt, "warm", observer) == pytest.approx(expected, abs=1e-12)


def test_cold_drive_adds_a_fast_part(observer: Observer) -> None:
    t = np.arange(0.0, 4.0, 0.02)
    integrated = low_pass_of_ramp(t, 0.4, 0.1)
    slow = integrated - cascade_of_ramp(t, 0.4, 20.0, 0.1)
    fast = integrated - cascade_of_ramp(t, 0.4, 2.0, 0.1)
    drive = receptor_drive(32.0 - 0.4 * t, 0.02, "cold", observer)
    assert drive == pytest.approx(0.5 * slow + 0.5 * fast, abs=1e-12)


def test_filters_agree_with_scipy_on_noise(observer: Observer) -> None:
    from scipy.signal import lsim

    rng = np.random.default_rng(3)
    t = np.arange(400) * 0.05
    change = np.concatenate([[0.0], np.cumsum(rng.normal(0, 0.02, t.size - 1))])
    # (14 s/(1+14 s))·1/(1+0.1 s), the high-pass times the integration
    system = ([14.0, 0.0], np.polymul([14.0, 1.0], [0.1, 1.0]))
    _, expected, _ = lsim(system, change, t)
    warm = receptor_drive(32.0 + change, 0.05, "warm", observer)
    assert warm == pytest.approx(np.maximum(expected, 0.0), abs=1e-9)


def test_adaptation_is_complete_inside_the_neutral_zone_only(observer: Observer) -> None:
    t = np.arange(0.0, 300.0, 0.05)
    inside = receptor_drive(np.where(t > 1.0, 31.0, 32.0), 0.05, "cold", observer)
    outside = receptor_drive(np.where(t > 1.0, 27.0, 32.0), 0.05, "cold", observer)
    assert inside.max() > 0.7
    assert inside[-1] == pytest.approx(0.0, abs=1e-6)
    assert outside[-1] == pytest.approx(0.5 * 3.0, abs=1e-4)


def test_a_baseline_outside_the_zone_starts_with_its_residue(observer: Observer) -> None:
    assert receptor_drive(np.full(50, 38.0), 0.01, "warm", observer) == pytest.approx(2.0, abs=1e-12)
    assert receptor_drive(np.full(50, 38.0), 0.01, "cold", observer).max() == 0.0


def test_rows_are_independent_and_keep_their_shape(observer: Observer) -> None:
    rng = np.random.default_rng(0)
    many = 32.0 + np.cumsum(rng.normal(0, 0.05, (3, 40, 2000)), axis=-1)
    together = receptor_drive(many, 0.01, "cold", observer)
    assert together.shape == many.shape
    assert np.array_equal(together[1, 7], receptor_drive(many[1, 7], 0.01, "cold", observer))


def test_messages(observer: Observer) -> None:
    with pytest.raises(ValueError, match=r"at least two samples on its last axis, not shape \(3, 1\)"):
        receptor_drive(np.zeros((3, 1)), 0.01, "cold", observer)
    with pytest.raises(ValueError, match=r"fast_weight = 1.5 must lie in 0 to 1"):
        Receptor(20.0, 2.0, 1.5, 0.1, 2.0, 0.5)
    with pytest.raises(ValueError, match=r"slow_s = 0 must be above 0"):
        Receptor(0.0, 2.0, 0.5, 0.1, 2.0, 0.5)
