"""Single faults: what the hardware must do is simulated, and keeps every hard limit of temperature."""

import json

import numpy as np
import pytest

from tests.circuit.delivery.replay import Held, Player, exposure
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Drive, Limits, Rig, gate
from thermicon.circuit.safety.demanded import dose_time_s, polarity_check, rest_before
from thermicon.circuit.safety.ensemble import Ensemble, between
from thermicon.circuit.safety.single_faults import Faulty
from thermicon.circuit.safety.tally import WATCHED, Tally, cem43_min
from thermicon.circuit.solver.batch_inputs import State

THENAR = Rig.load("thenar")
LIMITS = Limits.shipped()
CORNERS = [0, 1, 22, 43, 64]
REST = 0.08
COOL = Drive([0, 0.5, 3.0, 4.0], [REST, 0.8, REST, REST], held=True)
TIMES = np.arange(0.0, 60.0, 0.02)


def faulty(drive: Drive = COOL) -> Faulty:
    few = Ensemble.of(THENAR).only(CORNERS)
    return Faulty(few, drive, REST, few.at_rest(REST), LIMITS)


def temperatures_pass(ensemble: Ensemble, current_A: float, state: State, times_s: np.ndarray) -> tuple[bool, State]:
    """Whether a current that is held keeps all hard limits of temperature, and the state after it."""
    values, then = ensemble.hold(current_A, state, times_s)
    tally = Tally(LIMITS, [str(corner) for corner in ensemble.corners])
    tally.add(times_s, values, rates=False, sums=False)
    return tally.passes(), then


def test_a_current_that_hangs_until_the_watchdog_cuts_it_passes_no_limit_and_much_longer_it_does() -> None:
    one = faulty()
    watchdog, fault = one.watchdog_s()
    assert 0.1 < watchdog < 60.0
    assert (fault.colour, fault.values["watchdog_s"]) == ("red", watchdog)
    broken = False
    for instant in (0.2, 0.6, 1.5, 2.9, 3.5):
        state = one.ensemble.end_of(between(COOL, 0.0, instant), one.start)
        current = float(COOL.at(np.array([instant]))[0])
        within, then = temperatures_pass(one.ensemble, current, state, np.linspace(0.0, watchdog, 300))
        after, _ = temperatures_pass(one.ensemble, 0.0, then, TIMES)
        assert within
        assert after
        longer, _ = temperatures_pass(one.ensemble, current, state, np.linspace(0.0, 1.4 * watchdog, 300))
        broken |= not longer
    assert broken, "the watchdog is no longer than it need be"


def test_a_cut_off_that_reacts_in_time_keeps_the_limits_with_the_driver_at_its_own() -> None:
    one = faulty()
    cut, fault = one.cut_off((26.0, 38.0))
    assert (cut.low, cut.high) == (25.0, 39.0)
    assert cut.react_within_s > 0.0
    heats, cools = str(fault.to_dict()["text"]).split(" and ")
    assert heats.endswith(" °C at −1.5 A"), "both directions of the current are named"
    assert cools.startswith("skin surface reaches −")
    assert cools.endswith(" °C at 1.5 A")
    display = WATCHED.index("display_C")
    for current in (THENAR.driver.current_min_A, THENAR.driver.current_max_A):
        values, _ = one.ensemble.hold(current, one.start, TIMES)
        out = (values[display] <= cut.low) | (values[display] >= cut.high)
        assert out.any(axis=1).all()
        for lane in range(len(CORNERS)):
            until = TIMES[int(out[lane].argmax())] + cut.react_within_s
            alone, start = one.ensemble.only([lane]), one.start.take(np.array([lane]))
            within, then = temperatures_pass(alone, current, start, np.linspace(0.0, until - 0.02, 200))
            assert within
            assert temperatures_pass(alone, 0.0, then, TIMES)[0]
    assert cut.react_within_s in (2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02)


def test_limits_of_the_display_bound_the_cut_off() -> None:
    cut, _ = faulty().cut_off((5.5, 44.8))
    assert (cut.low, cut.high) == (5.0, 45.0)


def test_swapped_poles_are_found_by_a_small_current() -> None:
    check, fault = polarity_check(faulty())
    assert check.needed
    assert check.swapped_skin_C[1] > 42.0, "what cools heats"
    assert fault.colour == "red"
    few = faulty().ensemble
    times = np.array([0.0, check.test_s])
    display = WATCHED.index("display_C")
    right = few.hold(check.test_current_A, few.at_rest(0.0), times)[0][display]
    wrong = few.hold(-check.test_current_A, few.at_rest(0.0), times)[0][display]
    assert (right[:, 0] - right[:, 1] >= check.display_change_at_least_K).all()
    assert (wrong[:, 1] > wrong[:, 0]).all()
    check, fault = polarity_check(faulty(Drive([0, 1], [0.0, 0.0])))
    assert not check.needed and fault.colour in ("green", "amber"), "a gentle cue needs none"


def test_right_wiring_passes_the_check_of_poles_in_every_corner_of_a_module_that_is_hardly_known() -> None:
    unsure = {"plates_relative": 0.6, "conductance_relative": 0.4, "gain_relative": 0.3}
    rig = Rig.load("shani2021").with_(**{f"uncertainty.{key}": share for key, share in unsure.items()})
    every = Ensemble.of(rig)
    check, _ = polarity_check(Faulty(every, COOL, REST, every.at_rest(REST), LIMITS))
    shown = every.hold(check.test_current_A, every.at_rest(0.0), np.array([0.0, check.test_s]))[0]
    fall = -np.diff(shown[WATCHED.index("display_C")])[:, 0]
    assert len(fall) == 65
    assert fall.max() > 3.0 * fall.min(), "one corner is not like another"
    assert fall.min() > 1.5 * check.display_change_at_least_K > 0.3, "with room for a sensor that lags"


def test_the_rest_before_the_first_play_is_needed_and_enough() -> None:
    """A plate without power is warm: what warms from there passes a limit that it would not pass from rest."""
    warm = Drive([0, 1.0, 4.0, 5.0], [REST, -0.22, -0.22, REST])
    one = faulty(warm)
    needed, fault = rest_before(one)
    assert 0.0 < needed < 600.0
    assert str(fault.to_dict()["prevented_by"]).startswith(f"holding the rest for {needed:g} s before the first play")
    cold = one.ensemble.at_rest(0.0)

    def passes(rest_s: float) -> bool:
        state = one.ensemble.rest(REST, cold, rest_s)
        tally = Tally(LIMITS, [str(corner) for corner in one.ensemble.corners])
        for (rows, values), _ in one.ensemble.play(warm, state):
            tally.add(rows, values)
        return tally.passes()

    assert passes(needed)
    assert not passes(needed - 1.5)


def test_what_a_first_play_demands_is_that_of_all_corners() -> None:
    """On a wide contact the corners that decide on the play itself are others than those that decide on its start."""
    rig, warm = Rig.load("forearm"), Drive([0, 0.1, 1.5, 4.0, 5.0], [0.1, -0.2, -0.3, -0.2, 0.1], held=True)
    demanded = gate(warm, rig, pause_s=140.0).demands
    every = Ensemble.of(rig)
    one = Faulty(every, warm, float(warm.current_A[0]), every.at_rest(float(warm.current_A[0])), Limits.shipped())
    assert demanded.rest_before_first_play_s == rest_before(one)[0] > rest_before(one.at([0, 1, 2, 3, 22, 64]))[0]
    assert demanded.polarity_check == polarity_check(one)[0]


def test_the_dose_of_zero_current_ends_contact_in_time() -> None:
    """A warm heat sink takes skin to where the dose adds up: the time is that at which it reaches its limit."""
    warm = THENAR.with_(**{"heat_sink.temperature_C": 42.5})
    few = Ensemble.of(warm).only(CORNERS)
    start = few.at_rest(0.2)
    most = dose_time_s(few, LIMITS, start, np.zeros(5), 1800.0)
    assert 60.0 < most < 1800.0
    times = np.linspace(0.0, 1800.0, 18001)
    skin = few.hold(0.0, start, times)[0][WATCHED.index("skin_C")]
    dose = cem43_min(times, skin).max(axis=0)
    assert dose[np.searchsorted(times, most)] <= 1.0
    assert dose[np.searchsorted(times, 1.1 * most)] > 1.0
    assert dose_time_s(few, LIMITS, start, np.full(5, 0.9), 1800.0) < most


def test_ten_minutes_of_zero_current_count_towards_the_dose_of_a_play_and_no_more() -> None:
    """On the circuit written out: a limit just above that dose is kept, and one just below is passed."""
    rig = sure_rig("shani2021").with_(**{"heat_sink.temperature_C": 42.0})
    drive = Drive([0, 1, 2], [0.2, 0.3, 0.2], held=True)
    player = Player(json.loads(rig.document), np.random.default_rng(0), extra=0)
    held = Held.of(drive.time_s, drive.current_A, drive.current_A**2)
    parts = ((0.01, 100), (0.1, 90), (1.0, 590))
    left = player.follow(player.play(held, player.rest(held))[2], (0.0, 0.0), parts)
    dose = float(exposure(left, np.concatenate([np.full(count, step_s) for step_s, count in parts]))[0].max())
    for share, colours in ((1.03, ("green", "amber")), (0.97, ("red",))):
        found = gate(drive, rig, pause_s=600.0, limits=Limits.of({"thermal_dose_min_CEM43": share * dose}))
        assert found.colour in colours, found.reason
    assert "then zero current" in str(found.reason)


@pytest.mark.parametrize(("sink_C", "resistance"), [(48.0, 2.0), (45.0, 0.2)])
def test_a_heat_sink_that_burns_at_zero_current_is_red(sink_C: float, resistance: float) -> None:
    rig = THENAR.with_(**{"heat_sink.temperature_C": sink_C, "heat_sink.resistance_K_per_W": resistance})
    found = gate(Drive([0, 1], [0.35, 0.35]), rig, pause_s=0.0)
    assert found.colour == "red"
    assert found.drift_C > 39.5
    broken = [one for one in found.checks if one.severity == "hard" and not one.passed]
    assert any("zero current" in one.scenario for one in broken)


def test_everything_that_is_demanded_is_in_the_verdict() -> None:
    found = gate(COOL, THENAR, pause_s=60.0)
    demanded = found.demanded
    assert set(demanded) == {
        "watchdog_s", "cut_off_display_C", "polarity_check", "rest_before_first_play_s", "pause_at_least_s",
        "zero_current_at_most_s", "faults", "current_limit_A", "loop",
    }  # fmt: skip
    assert demanded["current_limit_A"] is None, "the drive itself is the current"
    assert demanded["loop"] is None, "there is none"
    assert demanded["pause_at_least_s"] == found.repeated.shortest_pause_s
    faults = [fault.to_dict() for fault in found.demands.faults]
    assert demanded["faults"] == faults
    assert [fault["fault"] for fault in faults] == [
        "host hangs in mid-play", "first play on a display that was without power", "poles swapped",
        "driver stuck at its limit",
    ]  # fmt: skip
