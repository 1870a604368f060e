from dataclasses import replace

import numpy as np
import pytest

from thermicon.perception import Observer
from thermicon.perception.observer.observer import Receptor
from thermicon.perception.sensation.receptors import receptor_drive


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


def controlled(observer: Observer, strength: float = 0.5, gain_s: float = 5.0) -> Observer:
    cold, warm = (
        replace(r, gain_strength=strength, gain_s=gain_s, gain_scale=2.0) for r in (observer.cold, observer.warm)
    )
    return replace(observer, cold=cold, warm=warm)


def test_gain_falls_with_the_drive_of_a_rest_outside_the_zone(observer: Observer) -> None:
    """2 K of residue for ever, scale 2 · 0.15 K: gain (1 + 2/0.3)^−1/2 from the first sample on."""
    drive = receptor_drive(np.full(50, 38.0), 0.01, "warm", controlled(observer))
    assert drive == pytest.approx(2.0 * (1.0 + 2.0 / 0.3) ** -0.5, rel=1e-12)


def test_gain_of_a_held_step_is_that_of_its_averaged_size(observer: Observer) -> None:
    """With adaptation all but frozen, recent drive of a unit step is 1 − e^(−t/τ)."""
    still = replace(observer, integration_s=1e-4, warm=replace(observer.warm, slow_s=1e9))
    t = np.arange(0.0, 20.0, 0.01)
    drive = receptor_drive(np.where(t > 0.0, 33.0, 32.0), 0.01, "warm", controlled(still))
    expected = (1.0 + (1.0 - np.exp(-t / 5.0)) / 0.3) ** -0.5
    assert drive[5:] == pytest.approx(expected[5:], rel=5e-3)
    assert drive[-1] == pytest.approx(expected[-1], rel=1e-4)


@pytest.mark.parametrize("gain_s", [1.0, 5.0])
def test_gain_control_has_the_stated_error(observer: Observer, gain_s: float) -> None:
    """Against steps a tenth as long; the change is piecewise linear, so all the rest is exact."""
    corners, change = [0.0, 0.5, 3.0, 4.0, 10.0], [0.0, 2.0, 2.0, -1.0, -1.0]
    found = []
    for dt in (0.01, 0.001):
        t = np.arange(round(10.0 / dt)) * dt
        drive = receptor_drive(32.0 + np.interp(t, corners, change), dt, "warm", controlled(observer, gain_s=gain_s))
        found.append(drive[:: round(0.01 / dt)])
    assert np.abs(found[0] - found[1]).max() < 1e-3 * found[1].max()


def test_what_was_just_felt_lowers_what_comes(observer: Observer) -> None:
    """The return of a warming is felt less as cold, a second dip less than the first: no linear filter does that."""
    t = np.arange(0.0, 30.0, 0.01)
    rise = 32.0 + np.interp(t, [0.0, 0.5, 6.0, 6.5], [0.0, 2.0, 2.0, 0.0])
    plain, lowered = (receptor_drive(rise, 0.01, "cold", o).max() for o in (observer, controlled(observer)))
    assert lowered < 0.5 * plain
    dips = 32.0 - np.interp(t, [0.0, 0.5, 1.0, 1.5, 3.0, 3.5, 4.0], [0.0, 2.0, 2.0, 0.0, 0.0, 2.0, 2.0])
    drive = receptor_drive(dips, 0.01, "cold", controlled(observer))
    assert drive[t > 2.5].max() < 0.9 * drive[t < 2.5].max()


def test_heat_flow_is_filtered_alike_within_its_own_zone(observer: Observer) -> None:
    flux = replace(
        observer,
        variable="heat flow",
        cold=replace(observer.cold, neutral_flux=(-140.0, 40.0), threshold_drive=70.0),
        warm=replace(observer.warm, neutral_flux=(-140.0, 40.0), threshold_drive=80.0),
    )
    t = np.arange(0.0, 300.0, 0.05)
    inside = receptor_drive(np.where(t > 1.0, -120.0, -80.0), 0.05, "cold", flux)
    outside = receptor_drive(np.where(t > 1.0, -200.0, -80.0), 0.05, "cold", flux)
    assert inside.max() > 30.0
    assert inside[-1] == pytest.approx(0.0, abs=1e-4)
    assert outside[-1] == pytest.approx(0.5 * 60.0, abs=1e-3)


def test_messages(observer: Observer) -> None:
    with pytest.raises(ValueError, match=r"at least two samples on its last axis, not shape \(3, 1\)"):
        receptor_drive(np.zeros((3, 1)), 0.01, "cold", observer)
    with pytest.raises(ValueError, match=r"fast_weight = 1.5 must lie in 0 to 1"):
        Receptor(20.0, 2.0, 1.5, 0.1, 2.0, 0.5)
    with pytest.raises(ValueError, match=r"slow_s = 0 must be above 0"):
        Receptor(0.0, 2.0, 0.5, 0.1, 2.0, 0.5)
