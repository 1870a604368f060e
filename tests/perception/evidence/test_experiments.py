"""That published experiments run as they are described; whether they come out right is not tested here.

A test that demanded a published result would be a reason to tune for it: misses are results.
"""

import numpy as np
import pytest

from thermicon.perception.evidence.experiments import limits, methods, rate_curve, reaction_times
from thermicon.perception.evidence.experiments_timing import first_and_return, peak_lead
from thermicon.perception.evidence.predicted import Asked, Predicted, predict
from thermicon.perception.evidence.radiant import whole_body_warmth
from thermicon.perception.observer.channels import VARIABLES, Variable


def by(found: tuple[Predicted, ...], quantity: str, channel: str) -> Predicted:
    (one,) = [p for p in found if p.quantity == quantity and p.channel == channel]
    return one


def test_rate_curve_of_few_rates() -> None:
    found = rate_curve(rates_K_per_s=(0.03, 0.1, 0.3), draws=2)
    assert len(found) == 2 * (3 + 1 + 1)
    fast, slow = by(found, "threshold at 0.3 K/s", "cold"), by(found, "threshold at 0.03 K/s", "cold")
    assert fast.value is not None
    assert slow.value is not None
    assert slow.value == pytest.approx(fast.value, rel=0.12)
    assert fast.value == pytest.approx(0.15, rel=0.15)
    raised = by(found, "threshold at 0.03 K/s over that at 0.1", "cold")
    assert raised.value == pytest.approx(slow.value / (by(found, "threshold at 0.1 K/s", "cold").value or 1.0))


@pytest.mark.parametrize("site", ["hand", "forearm"])
def test_limits_have_people_and_parameters(site: str) -> None:
    cold, warm = limits(site, people=30, draws=4)
    assert (cold.channel, warm.channel) == ("cold", "warm")
    for one in (cold, warm):
        assert one.value is not None
        assert one.people is not None
        assert one.low is not None
        assert one.high is not None
        assert one.people[0] < one.value < one.people[1]
        assert one.low < one.high
    assert cold.experiment == f"limits on the {site}"


def test_old_people_have_higher_limits_and_wider_ones() -> None:
    young, old = limits(people=40, draws=0)[0], limits(people=40, age_years=70.0, draws=0)[0]
    assert young.value is not None
    assert old.value is not None
    assert old.value > young.value
    assert "70 years" in old.conditions


def test_reaction_times_fall_with_area() -> None:
    found = reaction_times(areas_cm2=(4.0, 10.0), draws=2)
    for channel in ("cold", "warm"):
        small, large = (by(found, f"reaction time at {area} cm²", channel).value or 0.0 for area in (4, 10))
        exponent = by(found, "exponent of area", channel).value
        assert exponent == pytest.approx(np.log(large / small) / np.log(2.5), rel=1e-9)
        assert exponent < 0.0
    assert (by(found, "warm over cold", "both").value or 0.0) > 1.0
    with pytest.raises(ValueError, match=r"an exponent of area needs at least two areas"):
        reaction_times(areas_cm2=(4.0,))


def test_methods_are_three_of_one_observer() -> None:
    cold = [p.value or 0.0 for p in methods() if p.channel == "cold"]
    assert cold == sorted(cold)
    assert len(cold) == 3


@pytest.mark.parametrize("variable", VARIABLES)
def test_timing_runs_on_every_variant(variable: Variable) -> None:
    found = [*peak_lead(variable, draws=2), *first_and_return(variable, draws=2)]
    found += whole_body_warmth(variable, draws=2)
    for one in found:
        assert one.variable == variable
        assert one.value is not None
        assert one.low is not None
        assert one.high is not None
        assert one.low <= one.high
    lead = {p.channel: p.value or 0.0 for p in found if p.quantity == "felt peak minus the display's"}
    assert lead["cold"] < lead["warm"]


def test_peaks_are_counted_from_skin_or_display() -> None:
    found = peak_lead(draws=0)
    display, skin = (by(found, f"felt peak minus the {place}'s", "cold").value or 0.0 for place in ("display", "skin"))
    assert 0.0 < display - skin < 0.5


def test_summation_lowers_the_flux_that_is_felt() -> None:
    found = whole_body_warmth(draws=0)
    whole, none = (by(found, f"flux just felt, {how} summation", "warm").value or 0.0 for how in ("full", "no"))
    assert whole < none
    rise = by(found, "rise of the surface per W/m²", "warm").value
    assert rise == pytest.approx(0.0016, rel=0.1)


def test_the_same_draws_stand_behind_every_experiment() -> None:
    """An observer with slower warm conduction is late in both: trade-offs can be read off pairs of draws."""
    lag = by(peak_lead(draws=64), "felt peak minus the skin's", "warm")
    time = by(reaction_times(areas_cm2=(5.0, 10.0), draws=64), "reaction time at 10 cm²", "warm")
    assert len(lag.draws) == len(time.draws) == 64
    assert np.corrcoef(lag.draws, time.draws)[0, 1] > 0.5
    assert lag.low is not None
    assert min(lag.draws) <= lag.low <= float(np.median(lag.draws))


def test_what_is_not_felt_is_none() -> None:
    found = predict("x", [Asked("y", "cold", "K", "z", lambda _: float(np.inf))], "temperature", draws=2)
    assert (found[0].value, found[0].low, found[0].high) == (None, None, None)
    assert repr(found[0]).startswith("Predicted(x, y, cold: nothing felt from temperature")


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"limits are run on hand or forearm, not on 'foot'"):
        limits("foot")
