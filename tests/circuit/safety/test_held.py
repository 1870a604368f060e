"""Cut-offs by time and temperature: how long skin endures a display that a fault holds."""

import numpy as np
import pytest

from tests.circuit.surerig import sure_rig
from thermicon.circuit import Drive, Limits, Rig, gate
from thermicon.circuit.safety.display import DisplayPlant
from thermicon.circuit.safety.exposure import cem43_min
from thermicon.circuit.safety.fault_limits import FaultLimits
from thermicon.circuit.safety.gate import Gate
from thermicon.circuit.safety.held import SENSOR_K, HeldSkin, one_stage, two_stages
from thermicon.circuit.safety.tally import WATCHED

THENAR = Rig.load("thenar")
LIMITS = Limits.shipped()
MAY = FaultLimits.of(LIMITS)
REST = 0.08


def shown_under(plant: DisplayPlant, level_C: float, before_C: float, times_s: np.ndarray) -> tuple[float, float]:
    """Warmest skin and largest dose in all corners under a display that is held, where skin was steady before."""
    skin = plant.held(level_C, plant.steady(before_C), times_s)[WATCHED.index("skin_C")]
    return float(skin.max()), float(cem43_min(times_s, skin).max())


def test_a_display_just_inside_the_second_cut_off_may_stay_for_half_an_hour_and_farther_out_it_may_not() -> None:
    skin, plant = HeldSkin.of(THENAR, MAY), DisplayPlant.of(THENAR, (0.0, 60.0))
    low, high = skin.lasting_C()
    times = np.linspace(0.0, 1800.0, 3601)
    warmest, dose = shown_under(plant, high + SENSOR_K, high + SENSOR_K, times)
    assert warmest < 42.0 and 0.3 < dose <= 0.4 < 0.5
    assert shown_under(plant, high + SENSOR_K + 0.4, high, times)[1] > 0.5, "the dose is what decides"
    cold = plant.held(low - SENSOR_K, plant.steady(low - SENSOR_K), times)[WATCHED.index("cold_receptor_C")].min()
    colder = plant.held(low - SENSOR_K - 0.3, plant.steady(low), times)[WATCHED.index("skin_C")].min()
    assert colder < 14.0 <= cold, "a kelvin below the limit of 15 degrees"


@pytest.mark.parametrize("for_s", [6.0, 60.0])
def test_a_display_just_inside_the_first_cut_off_may_stay_until_the_second_acts(for_s: float) -> None:
    skin, plant = HeldSkin.of(THENAR, MAY), DisplayPlant.of(THENAR, (0.0, 60.0))
    lasting = skin.lasting_C()
    high, times = skin.brief_C(lasting, for_s)[1], np.linspace(0.0, for_s, 601)
    warmest, dose = shown_under(plant, high + SENSOR_K, lasting[1] + SENSOR_K, times)
    assert warmest <= 43.0 and dose <= 0.5
    beyond = shown_under(plant, high + SENSOR_K + 0.25, lasting[1], times)
    assert beyond[0] > 42.9 or beyond[1] > 0.45, "no nearer than it must be"
    assert high > lasting[1] + 1.0


@pytest.mark.parametrize("healthy_s", [0.3, 4.0, 9.1])
def test_the_second_cut_off_waits_longer_than_any_healthy_stay_and_at_least_five_seconds(healthy_s: float) -> None:
    skin = HeldSkin.of(THENAR, MAY)
    lasting = skin.lasting_C()
    stages = two_stages(LIMITS, skin, (30.0, 41.0), lasting, healthy_s, 1.0)
    assert stages.held is not None and stages.held.high == lasting[1]
    assert stages.held.longer_than_s == pytest.approx(max(5.0, 1.25 * healthy_s), abs=0.1)
    assert not stages.failed and stages.ends_C[1] == 42.0
    assert one_stage(LIMITS, (30.0, 41.0), lasting, 1.0).failed, "a single one would have to act on the play"
    assert not one_stage(LIMITS, (30.0, lasting[1] - 0.2), lasting, 1.0).failed
    assert one_stage(LIMITS, (30.0, lasting[1] - 0.15), lasting, 1.0).failed
    assert two_stages(LIMITS, skin, (30.0, 41.0), lasting, 1500.0, 1.0).failed, "such a stay is no play"


def test_a_play_that_goes_where_no_display_may_be_held_is_refused_with_its_way_out() -> None:
    """A short peak warms the skin less: with a cut-off that lets it pass, nobody stops a driver that stays there."""
    rig = sure_rig("thenar").with_(**{"driver.current_limit_A": 3.0})

    def peak(current_A: float) -> Gate:
        short = Drive([0, 0.2, 1.4, 2.0, 6.0], [REST, -current_A, 0.6, REST, REST], held=True)
        return gate(short, rig, pause_s=300.0)

    reached = [check.value for check in peak(0.9).once if check.quantity == "display" and check.upper]
    assert reached[0] < 42.0 and peak(0.9).safe
    refused = peak(1.25)
    assert refused.colour == "red" and not refused.mended_by_pause
    assert str(refused.reason).startswith("display without a fault reaches 4"), refused.reason
    assert "no cut-off both lets this play pass" in str(refused.reason)
    (failed,) = (check for check in refused.checks if check.severity == "hard" and not check.passed)
    assert failed.quantity == "display without a fault", "the play itself is safe"
    assert failed.value > failed.limit, "what it reaches lies beyond the limit that is told"


def test_a_pause_grows_where_a_single_cut_off_then_lets_plays_pass_and_a_second_one_is_asked_for_where_none_does() -> (
    None
):
    rig = sure_rig("thenar")
    warm = Drive([0, 0.1, 2.6, 3.6, 4.6], [REST, -0.35, 0.2, REST, REST], held=True)
    alone, longer = gate(warm, rig, pause_s=600.0), Drive([0, 0.1, 6.6, 7.6], [REST, -0.3, REST, REST], held=True)
    assert alone.demands.held_cut_off_display_C is None
    assert alone.repeated.shortest_pause_s > 1.5 * alone.repeated.faultless_pause_s
    held = gate(longer, rig, pause_s=600.0).demands.held_cut_off_display_C
    assert held is not None and held.longer_than_s > 5.0, "no pause keeps a long hold where a display may stay"
