"""From receptors to sensation: drives against closed forms or scipy, the transducer's two ranges."""

import math
from dataclasses import replace

import numpy as np
import pytest

from thermicon.perception import Observer
from thermicon.perception.observer.channels import CHANNELS, Channel, Variable
from thermicon.perception.observer.constants import Both


def low_pass_of_ramp(t: np.ndarray, slope: float, tau: float) -> np.ndarray:
    return slope * (t - tau * (1 - np.exp(-t / tau)))


@pytest.mark.parametrize("dt", [0.01, 0.1, 0.5])
def test_drive_of_a_ramp_is_exact_at_any_step(observer: Observer, dt: float) -> None:
    t = np.arange(0.0, 4.0 + dt / 2, dt)
    warm = low_pass_of_ramp(t, 0.7, 0.1) - low_pass_of_ramp(t, 0.7, 20.0)
    assert observer.drive(32.0 + 0.7 * t, dt, "warm") == pytest.approx(np.maximum(warm, 0.0), abs=1e-12)
    cold = low_pass_of_ramp(t, 0.4, 0.1) - low_pass_of_ramp(t, 0.4, 20.0)
    assert observer.drive(32.0 - 0.4 * t, dt, "cold") == pytest.approx(np.maximum(cold, 0.0), abs=1e-12)


def test_filters_agree_with_scipy_on_noise(observer: Observer) -> None:
    from scipy.signal import lsim

    rng = np.random.default_rng(3)
    t = np.arange(400) * 0.05
    change = np.concatenate([[0.0], np.cumsum(rng.normal(0, 0.02, t.size - 1))])
    # 1/(1 + 0.1 s) − 1/(1 + 20 s): integration less adaptation.
    system = ([20.0 - 0.1, 0.0], np.polymul([20.0, 1.0], [0.1, 1.0]))
    _, expected, _ = lsim(system, change, t)
    warm = observer.drive(32.0 + change, 0.05, "warm")
    assert warm == pytest.approx(np.maximum(expected, 0.0), abs=1e-9)


@pytest.mark.parametrize(
    ("variable", "before", "inside", "outside", "left"),
    [("temperature", 32.0, 31.0, 27.0, 3.0), ("heat flow", -80.0, -120.0, -200.0, 60.0)],
)
def test_adaptation_is_complete_inside_the_neutral_zone_only(
    observer: Observer, variable: Variable, before: float, inside: float, outside: float, left: float
) -> None:
    flux = Both((-140.0, 40.0), (-140.0, 40.0))
    person, t = replace(observer, variable=variable, neutral_flux=flux), np.arange(0.0, 300.0, 0.05)
    near, far = (person.drive(np.where(t > 1.0, x, before), 0.05, "cold") for x in (inside, outside))
    assert near.max() > 0.7 * (before - inside)
    assert near[-1] == pytest.approx(0.0, abs=1e-5 * left)
    assert far[-1] == pytest.approx(left, abs=4e-5 * left)


@pytest.mark.parametrize(("rest", "end"), [(22.0, 30.0), (29.9, 30.0), (34.35, 34.25), (41.0, 34.25)])
def test_who_rests_as_nobody_in_an_experiment_feels_what_is_felt_at_the_nearer_end(
    observer: Observer, rest: float, end: float
) -> None:
    """Nothing at rest, and a change from there as the same change from the end."""
    change, person = np.interp(np.arange(0.0, 8.0, 0.01), [1.0, 2.0, 5.0, 6.0], [0.0, 3.0, 3.0, 0.0]), limited(observer)
    for channel, sign in zip(CHANNELS, (-1.0, 1.0), strict=True):
        assert person.drive(np.full(50, rest), 0.01, channel).max() == 0.0
        from_rest, from_end = (person.drive(level + sign * change, 0.01, channel) for level in (rest, end))
        assert from_rest == pytest.approx(from_end, abs=1e-9)
    assert person.drive(rest + change, 0.01, "cold")[:500].max() == 0.0, "warming is not felt by cold"
    assert person.drive(rest - change, 0.01, "warm")[:500].max() == 0.0, "cooling is not felt by warmth"


def limited(observer: Observer, softness_K: float = 0.1) -> Observer:
    return replace(observer, limit_C=Both(33.0, 31.0), softness_K=softness_K)


def test_there_is_no_cold_above_its_limit_and_no_warmth_below(observer: Observer) -> None:
    t = np.arange(0.0, 6.0, 0.01)
    fall = np.interp(t, [0.0, 2.0], [34.2, 33.5])
    assert observer.drive(fall, 0.01, "cold").max() > 0.6
    assert limited(observer).drive(fall, 0.01, "cold").max() < 0.01
    rise = np.interp(t, [0.0, 2.0], [30.0, 30.5])
    assert limited(observer).drive(rise, 0.01, "warm").max() < 0.01
    assert limited(observer).drive(rise + 4.0, 0.01, "warm").max() > 0.4
    far = np.interp(t, [0.0, 2.0], [30.0, 27.0])  # far beyond its limit a channel is as without
    near = np.interp(t, [0.0, 0.5], [33.4, 33.0])
    hard, soft = (limited(observer, s).drive(near, 0.01, "cold").max() for s in (0.01, 1.0))
    assert soft > 5.0 * hard, "softness lets a channel set in gradually"
    with_limit = limited(observer, 0.05).drive(far, 0.01, "cold")
    assert with_limit == pytest.approx(observer.drive(far, 0.01, "cold"), abs=1e-9)


def test_rows_are_independent_and_keep_their_shape(observer: Observer) -> None:
    many = 32.0 + np.cumsum(np.random.default_rng(0).normal(0, 0.05, (3, 40, 2000)), axis=-1)
    together = observer.drive(many, 0.01, "cold")
    assert together.shape == many.shape
    assert np.array_equal(together[1, 7], observer.drive(many[1, 7], 0.01, "cold"))
    with pytest.raises(ValueError, match=r"at least two samples on its last axis, not shape \(3, 1\)"):
        observer.drive(np.zeros((3, 1)), 0.01, "cold")
    assert observer.drive(many[:, 0, :2], 0.01, "cold").shape == (3, 2)


@pytest.mark.parametrize(("channel", "unit"), [("cold", 0.08), ("warm", 0.15)])
def test_sensation_is_a_power_then_logarithmic(observer: Observer, channel: Channel, unit: float) -> None:
    u = np.array([0.0, 0.01, 0.02, 1.0, 100.0, 200.0])
    psi = observer.sensation(unit * u, channel)
    assert psi[0] == 0.0
    assert psi[3] == pytest.approx(1.0, rel=1e-12)
    assert psi[2] / psi[1] == pytest.approx(4.0, rel=1e-3)
    assert psi[5] - psi[4] == pytest.approx(2 * 12.0 * math.log(2.0), rel=1e-2)
    assert psi == pytest.approx(observer.psi(u), rel=1e-12)


def test_area_and_person_scale_the_drive(observer: Observer) -> None:
    drive = np.array([0.0, 0.16])
    quarter = observer.sensation(drive, "cold", area_m2=9e-4 / 4)
    smaller = observer.sensitivity("cold", 9e-4 / 4, None)
    assert quarter[1] == pytest.approx(observer.sensation(drive * smaller, "cold")[1], rel=1e-12)
    rows = observer.sensation(np.stack([drive, drive]), "cold", threshold=[1.0, 2.0])
    assert rows[1, 1] == pytest.approx(1.0, rel=1e-12)
    with pytest.raises(ValueError, match=r"area of contact must be above 0 m², not 0 m²"):
        observer.sensation(drive, "cold", area_m2=0.0)
