"""Published experiments run as described.

A test that demanded a published result would be a reason to tune for it: misses are results.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer
from thermicon.perception.evidence.experiments import (
    first_and_return,
    limits,
    measured,
    peak_lead,
    rate_curve,
    reaction_times,
)
from thermicon.perception.evidence.predicted import Predicted, laboratory_of
from thermicon.perception.evidence.radiant import radiant_warming, whole_body_warmth
from thermicon.perception.experiments.measure import Condition, Setting, logs_of
from thermicon.perception.observer.channels import CHANNELS, VARIABLES, Variable
from thermicon.perception.observer.constants import Both


def by(found: tuple[Predicted, ...], quantity: str, channel: str) -> Predicted:
    (one,) = [p for p in found if p.quantity == quantity and p.channel == channel]
    return one


def value(found: tuple[Predicted, ...], quantity: str, channel: str) -> float:
    felt = by(found, quantity, channel).value
    assert felt is not None
    return felt


def test_a_rate_curve_is_thresholds_and_their_ratios() -> None:
    found = rate_curve(draws=0)
    assert len(found) == 2 * (7 + 1 + 4)
    for channel, threshold in (("cold", 0.15), ("warm", 0.2)):
        flat = [value(found, f"threshold at {rate:g} K/s", channel) for rate in (0.1, 0.2, 0.3)]
        slow = value(found, "threshold at 0.03 K/s", channel)
        assert flat[2] == pytest.approx(threshold, rel=0.4)
        assert slow == pytest.approx(flat[2], rel=0.2)
        assert value(found, "threshold at 0.03 K/s over that at 0.1", channel) == pytest.approx(slow / flat[0])
        assert by(found, "threshold at 0.03 K/s over that at 0.1", channel).baseline == 1.0
        change = value(found, "largest change over 0.1 to 0.3 K/s", channel)
        assert change == pytest.approx(max(flat) / min(flat) - 1.0)


RIGS = {"hand": Setting("hand-dorsum", 5.4e-4, 9.0), "forearm": Setting("forearm", 5.4e-4, 10.0)}


@pytest.mark.parametrize("site", RIGS)
def test_limits_have_people_and_parameters_and_rise_with_age(site: str) -> None:
    cold, warm = limits(site, people=30, draws=4)
    crowd = laboratory_of(Observer.load(), RIGS[site], people=30, seed=0)
    assert [(one.channel, one.experiment) for one in (cold, warm)] == [(c, f"limits on the {site}") for c in CHANNELS]
    for one, skin in ((cold, 0.11), (warm, 0.20)):
        assert one.value is not None and one.low is not None and one.high is not None
        asked = Condition("threshold", "limits", one.channel, 32.0, 12.0, 1.0, 3.0)  # type: ignore[arg-type]
        each = np.exp(logs_of(crowd, RIGS[site], asked)[0])
        assert one.value == pytest.approx(np.percentile(each, 50.0))
        assert one.low < one.high
        assert one.baseline == skin
    old = limits(site, people=30, age_years=70.0, draws=0)[0]
    assert (old.value or 0.0) > (cold.value or 0.0)
    assert "70 years" in old.conditions


def test_reaction_times_fall_with_area() -> None:
    found = reaction_times(draws=0)
    for channel in CHANNELS:
        times = [value(found, f"reaction time at {area:g} cm²", channel) for area in (2.5, 5.0, 10.0)]
        assert times == sorted(times, reverse=True)
        # Areas are equally spaced in logarithm, so that a fitted slope is that of the ends.
        slope = math.log(times[2] / times[0]) / math.log(4.0)
        assert value(found, "exponent of area", channel) == pytest.approx(slope, rel=1e-9)
    warm, cold = (value(found, "reaction time at 10 cm²", channel) for channel in ("warm", "cold"))
    assert value(found, "warm over cold", "both") == pytest.approx(warm / cold)
    assert warm > cold
    assert {one.baseline for one in found} == {None}


def test_who_does_not_feel_the_largest_change_has_no_threshold() -> None:
    deaf = replace(Observer.load(), threshold_drive=Both(0.1, 1e4))
    for method in ("forced_choice", "yes_no"):
        asked = Condition("threshold", method, "warm", 32.0, None, 1.0, 3.0)
        assert np.isinf(measured(Setting.of(Rig.load("thenar")), asked, deaf))


@pytest.mark.parametrize("variable", VARIABLES)
def test_timing_and_warmth_run_on_every_variant(variable: Variable) -> None:
    found = (*peak_lead(variable, draws=2), *first_and_return(variable, draws=2), *whole_body_warmth(variable, draws=2))
    for one in found:
        assert one.variable == variable
        assert one.value is not None and one.low is not None and one.high is not None
        assert one.low <= one.high
    display, skin = (f"felt peak minus the {place}'s" for place in ("display", "skin"))
    assert value(found, display, "cold") < value(found, display, "warm")
    assert 0.0 < value(found, display, "cold") - value(found, skin, "cold") < 0.5
    whole, none = (value(found, f"flux just felt, {how} summation", "warm") for how in ("full", "no"))
    assert whole < none
    rise = value(found, "rise of the surface per W/m²", "warm")
    assert by(found, "flux just felt, full summation", "warm").baseline == pytest.approx(0.20 / rise)
    assert rise == pytest.approx(0.0016, rel=0.1)


@pytest.mark.slow
def test_the_same_draws_stand_behind_every_experiment() -> None:
    """An observer with slower warm conduction is late in both."""
    lag = by(peak_lead(draws=64), "felt peak minus the skin's", "warm")
    time = by(reaction_times(draws=64), "reaction time at 10 cm²", "warm")
    assert len(lag.draws) == len(time.draws) == 64
    assert np.corrcoef(lag.draws, time.draws)[0, 1] > 0.25
    assert lag.low is not None
    assert min(lag.draws) <= lag.low <= float(np.median(lag.draws))


LAYER = {
    "name": "dermis",
    "thickness_mm": 30.0,
    "conductivity_W_per_mK": 0.4,
    "density_kg_per_m3": 1000.0,
    "heat_capacity_J_per_kgK": 3600.0,
    "perfusion_per_s": 0.0,
}


def test_radiant_heat_follows_the_closed_forms() -> None:
    """Half space under a flux q: 2q√(t/π)/√(kρc) at the surface, q·erfc(x/2√(αt)) in depth; x = 0.30 mm, 3 s."""
    slab = Rig.load("thenar").with_(
        **{
            "skin.layer": [LAYER],
            "ambient.film_W_per_m2K": 1e-3,
            "skin.deep_C": 33.0,
        }
    )
    warmed, alpha, x, effusivity = radiant_warming(slab, 0.3e-3), 0.4 / 3.6e6, 0.3e-3, math.sqrt(0.4 * 3.6e6)
    expected = 2.0 * np.sqrt(np.arange(301) * 0.01 / math.pi) / effusivity
    assert warmed.surface_K[50:] == pytest.approx(expected[50:], rel=0.01)
    near = x / (2.0 * math.sqrt(alpha * 3.0))
    deep = 2.0 * math.sqrt(3.0 / math.pi) / effusivity * math.exp(-near * near) - x / 0.4 * math.erfc(near)
    assert warmed.warm_receptor_K[-1] == pytest.approx(deep, rel=0.01)
    assert warmed.warm_receptor_W_per_m2[-1] == pytest.approx(math.erfc(near), rel=0.02)
    assert warmed.surface_K[-1] > warmed.warm_receptor_K[-1]
