"""Simulated single faults: demands on the hardware that keep every hard limit of temperature."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.circuit.delivery.replay import Held, Player, exposure
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Drive, Limits, Rig, gate
from thermicon.circuit.safety.current import CurrentPlant, CurrentPlay
from thermicon.circuit.safety.demanded import zero_current_s
from thermicon.circuit.safety.demands import CutOff, SingleFault
from thermicon.circuit.safety.ensemble import Ensemble, between
from thermicon.circuit.safety.exposure import cem43_min
from thermicon.circuit.safety.fault_limits import FaultLimits
from thermicon.circuit.safety.gate import Gate, gate_set
from thermicon.circuit.safety.held import around_C
from thermicon.circuit.safety.polarity import TEST_A, TEST_S
from thermicon.circuit.safety.repeated import Repeating
from thermicon.circuit.safety.single_faults import Faulty, Moments
from thermicon.circuit.safety.starts import Beginning, Starts
from thermicon.circuit.safety.tally import WATCHED, Tally
from thermicon.circuit.solver.batch_inputs import State

THENAR = Rig.load("thenar")
UNSURE = sure_rig("thenar", "contact_resistance_relative", "ambient_K", "heat_sink_K", "gain_relative")
LIMITS = Limits.shipped()
MAY = FaultLimits.of(LIMITS)
CORNERS = [0, 1, 22, 43, 64]
REST = 0.08
COOL = Drive([0, 0.5, 3.0, 4.0], [REST, 0.8, REST, REST], held=True)
TIMES = np.arange(0.0, 60.0, 0.02)


def faulty(drive: Drive = COOL, rig: Rig = THENAR) -> Faulty:
    few = Ensemble.of(rig).only(CORNERS)
    return Faulty(few, drive, REST, few.at_rest(REST), LIMITS, MAY)


def temperatures_pass(ensemble: Ensemble, current_A: float, state: State, times_s: np.ndarray) -> tuple[bool, State]:
    """Whether a current that is held keeps all limits of temperature in a fault, and the state after it."""
    values, then = ensemble.hold(current_A, state, times_s)
    tally = Tally(MAY.limits, [str(corner) for corner in ensemble.corners])
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
    assert broken, "the watchdog could be longer"


def test_a_cut_off_that_reacts_in_time_keeps_the_limits_with_the_driver_at_its_own() -> None:
    one = faulty()
    cut, fault = one.cut_off((25.0, 39.0))
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


def test_where_no_cut_off_is_quick_enough_a_current_limit_is_told_for_which_one_is() -> None:
    def stuck(limit_A: float) -> tuple[CutOff, SingleFault]:
        rig = THENAR.with_(**{"driver.current_limit_A": limit_A, "driver.voltage_limit_V": 60.0})
        return faulty(rig=rig).cut_off((25.0, 39.0))

    cut, fault = stuck(4.0)
    limit_A = fault.values["limit_A"]
    assert (cut.react_within_s, stuck(limit_A + 0.6)[0].react_within_s) == (0.0, 0.0), "no narrower than it need be"
    assert stuck(limit_A)[0].react_within_s > 0.0


def test_limits_of_the_display_bound_the_cut_off() -> None:
    assert around_C(LIMITS, (5.5, 44.8)) == (5.0, 45.0)
    assert around_C(LIMITS, (24.43, 36.77)) == (23.5, 37.7), "rounded inwards"


WARM = Drive([0, 1.0, 4.0, 5.0], [REST, -0.22, -0.22, REST])
PAUSE = 60.0
BEGINNINGS = ("rest", "no power", "polarity check", "stop", "later play")
"""Where plays begin, as the page on safety names them."""


@cache
def beginning() -> tuple[CurrentPlant, Beginning[CurrentPlay, State], Starts[State]]:
    """A warming and a cooling drive in a few corners, and where their plays may begin."""
    plant = CurrentPlant.of(Ensemble.of(THENAR).only(CORNERS))
    drives = [[CurrentPlay(drive, REST)] for drive in (WARM, COOL)]
    known = Beginning.of(Repeating(plant, drives, LIMITS), PAUSE, 300.0)
    return plant, known, known.after(PAUSE)


def begun(how: str, rng: np.random.Generator, rest_s: float) -> State:
    """A state before a play that begins in one of the ways of BEGINNINGS, drawn by chance."""
    ensemble = beginning()[0].ensemble
    state = ensemble.at_rest(REST)
    if how in ("later play", "stop"):
        for _ in range(rng.integers(1, 6)):
            state = ensemble.rest(REST, ensemble.end_of((WARM, COOL)[rng.integers(2)], state), PAUSE)
    if how == "later play":
        return state
    if how == "stop":
        drive = (WARM, COOL)[rng.integers(2)]
        state = ensemble.end_of(between(drive, 0.0, rng.uniform(0.1, float(drive.time_s[-1]))), state)
        state = ensemble.rest(0.0, state, rng.choice([0.1, 1.0, 10.0, 100.0]))
    if how in ("no power", "polarity check"):
        state = ensemble.at_rest(0.0)
    if how == "polarity check" or (how == "stop" and rng.integers(2)):
        state = ensemble.rest(TEST_A, state, TEST_S)
    return state if how == "rest" else ensemble.rest(REST, state, rest_s * rng.choice([1.0, 1.3, 3.0]))


@pytest.mark.parametrize("how", BEGINNINGS)
def test_every_play_that_is_allowed_begins_between_the_bounds_from_which_faults_start(how: str) -> None:
    """And not after a fifth of the rest: it is not longer than necessary, within what display and skin show."""
    rng, (_, _, starts) = np.random.default_rng(BEGINNINGS.index(how)), beginning()
    warm, cold = (bound.nodes_C for bound in starts.bounds)
    assert 5.0 < starts.rest_s < 300.0
    for _ in range(20):
        nodes = begun(how, rng, starts.rest_s).nodes_C
        assert (nodes <= warm + 1e-3).all() and (nodes >= cold - 1e-3).all()
    if how in ("no power", "polarity check", "stop"):
        early = np.array([begun(how, rng, 0.2 * starts.rest_s / 3.0).nodes_C for _ in range(20)])
        assert ((early > warm + 0.05) | (early < cold - 0.05)).any()


@cache
def warmed() -> Gate:
    """A warming drive on a rig with an unknown contact, air, sink and gain, judged for a pause of a minute."""
    return gate(WARM, UNSURE, pause_s=60.0)


def test_what_a_first_play_does_on_a_display_without_power_is_told_for_a_play_at_once() -> None:
    """A second of rest before it takes 0.2 K off what the skin reaches."""
    rig = sure_rig("thenar")
    told = next(fault.values["finding"] for fault in gate(WARM, rig).demands.faults if fault.kind == "unpowered")
    every = Ensemble.of(rig)
    played = every.play(WARM, every.at_rest(0.0))
    hottest = max(float(values[WATCHED.index("skin_C")].max()) for (_, values), _ in played)
    assert (told.quantity, told.severity) == ("skin surface", "soft")
    assert told.value == pytest.approx(hottest, abs=1e-3)


def test_a_first_play_after_no_power_survives_a_hang_until_the_watchdog_and_a_driver_stuck_at_any_current() -> None:
    """In all corners: what is demanded suffices, and without the rest it does not."""
    demands, every = warmed().demands, Ensemble.of(UNSURE)
    assert demands.rest_before_first_play_s is not None
    off, cut = every.at_rest(0.0), demands.cut_off_display_C

    def harmed(rest_s: float) -> bool:
        before = every.rest(REST, off, rest_s)
        instants = [every.end_of(between(WARM, 0.0, at_s), before) for at_s in (1.0, 4.0)]
        hung = [every.rest(-0.22, state, demands.watchdog_s) for state in instants]
        return not all(temperatures_pass(every, 0.0, state, TIMES[:1000])[0] for state in hung)

    assert not harmed(demands.rest_before_first_play_s)
    assert harmed(1.0), "the rest is needed"
    display = WATCHED.index("display_C")
    for current in (-1.5, -0.5, -0.33, -0.3):
        shown, _ = every.hold(current, off, TIMES)
        over = (shown[display] >= cut.high) | (shown[display] <= cut.low)
        for lane in np.flatnonzero(over.any(axis=1)).tolist():
            alone, start = every.only([lane]), off.take(np.array([lane]))
            until = TIMES[int(over[lane].argmax())] + cut.react_within_s
            within, then = temperatures_pass(alone, current, start, np.linspace(0.0, until, 200))
            assert within and temperatures_pass(alone, 0.0, then, TIMES[:1000])[0], (current, lane)
        stays = np.flatnonzero(~over.any(axis=1))
        if len(stays):
            kept = every.only(stays.tolist())
            assert temperatures_pass(kept, current, off.take(stays), np.linspace(0.0, 600.0, 601))[0], current


def test_the_cut_off_lets_a_second_play_after_no_power_pass_in_every_corner() -> None:
    demands, every = warmed().demands, Ensemble.of(UNSURE)
    cut, pause_s = demands.cut_off_display_C, demands.pause_at_least_s
    assert demands.rest_before_first_play_s is not None and pause_s is not None
    state = every.rest(REST, every.at_rest(0.0), demands.rest_before_first_play_s)
    for _ in range(3):
        for (_, values), then in every.play(WARM, state):
            shown, state = values[WATCHED.index("display_C")], then
            assert shown.max() < cut.high and shown.min() > cut.low
        state = every.rest(REST, state, pause_s)


def test_the_dose_of_zero_current_ends_contact_in_time() -> None:
    """A warm heat sink takes skin to where the dose adds up: the time is that at which it reaches its limit."""
    warm = THENAR.with_(**{"heat_sink.temperature_C": 42.5})
    few = Ensemble.of(warm).only(CORNERS)
    start = few.at_rest(0.2)
    most = zero_current_s(few, LIMITS, start, 0.0)
    assert most is not None and 60.0 < most < 1800.0
    times = np.linspace(0.0, 1800.0, 18001)
    skin = few.hold(0.0, start, times)[0][WATCHED.index("skin_C")]
    dose = cem43_min(times, skin).max(axis=0)
    assert dose[np.searchsorted(times, most)] <= 1.0
    assert dose[np.searchsorted(times, 1.1 * most)] > 1.0
    sooner = zero_current_s(few, LIMITS, start, 0.9)
    assert sooner is not None and sooner < most, "what a fault added before counts"
    assert zero_current_s(Ensemble.of(THENAR).only([0]), LIMITS, start.take(np.array([0])), 0.0) is None


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
    rig = sure_rig().with_(**{"heat_sink.temperature_C": sink_C, "heat_sink.resistance_K_per_W": resistance})
    found = gate(Drive([0, 1], [0.35, 0.35]), rig, pause_s=0.0)
    assert found.colour == "red"
    assert found.drift_C > 39.5
    broken = [one for one in found.checks if one.severity == "hard" and not one.passed]
    assert any("zero current" in one.scenario for one in broken)


def test_everything_that_is_demanded_is_in_the_verdict() -> None:
    found = gate(COOL, sure_rig(), pause_s=60.0)
    demanded = found.demanded
    assert set(demanded) == {
        "watchdog_s", "cut_off_display_C", "polarity_check", "rest_before_first_play_s", "pause_at_least_s",
        "zero_current_at_most_s", "faults", "held_cut_off_display_C", "current_limit_A", "loop",
    }  # fmt: skip
    assert demanded["current_limit_A"] is None, "its own limit moves the skin slowly enough"
    assert demanded["loop"] is None, "there is none"
    assert demanded["pause_at_least_s"] == found.repeated.shortest_pause_s
    faults = [fault.to_dict() for fault in found.demands.faults]
    assert demanded["faults"] == faults
    assert [fault["fault"] for fault in faults] == [
        "host hangs in mid-play", "first play on a display that was without power", "poles swapped",
        "driver stuck at its limit",
    ]  # fmt: skip


def hottest_C(one: Faulty, moments: Moments, cut: CutOff, late_s: float) -> float:
    """The warmest skin where a driver at its lower limit is cut so long after the display has left the cut-off."""
    ensemble, full_A, hottest = one.ensemble, THENAR.driver.current_min_A, 0.0
    skin, display = WATCHED.index("skin_C"), WATCHED.index("display_C")
    fine = np.arange(0.0, 10.0, 0.01)
    shown = ensemble.watch(full_A, moments.state, fine, moments.rigs)[display]
    for lane in range(len(shown)):
        alone, state = ensemble.only([int(moments.rigs[lane])]), moments.state.take(np.array([lane]))
        until = fine[int((shown[lane] >= cut.high).argmax())] + late_s
        values, then = alone.hold(full_A, state, np.linspace(0.0, until, 50))
        after, _ = alone.hold(0.0, then, np.arange(0.0, 5.0, 0.02))
        hottest = max(hottest, float(values[skin].max()), float(after[skin].max()))
    return hottest


def test_a_cut_off_that_acts_a_fifth_too_late_keeps_the_limit_and_half_as_late_again_does_not() -> None:
    """With the limit moved to where the stated reaction has just become long enough."""
    plain = replace(faulty(), instants=(2, 5, 8))
    moments = plain.moments()

    def stated(highest_C: float) -> CutOff:
        limits = Limits.of({"skin_highest_C": highest_C - 1.0, "skin_highest_soft_C": 35.0})
        return replace(plain, may=FaultLimits.of(limits)).cut_off((25.0, 39.0), moments)[0]

    low, high = 38.5, 42.0
    assert stated(low).react_within_s < 0.1 <= stated(high).react_within_s
    while high - low > 0.005:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if stated(middle).react_within_s >= 0.1 else (middle, high)
    cut = stated(high)
    assert cut.react_within_s == 0.1
    assert hottest_C(plain, moments, cut, 0.12) <= high
    assert hottest_C(plain, moments, cut, 0.15) > high + 0.01


def test_a_watchdog_a_fifth_too_slow_keeps_every_limit_and_half_as_slow_again_does_not() -> None:
    one = faulty()
    moments, (watchdog_s, _) = one.moments(), one.watchdog_s()

    def passes(hangs_s: float) -> bool:
        alone = np.arange(len(moments.rigs))
        for lane in alone.tolist():
            few, state = one.ensemble.only([int(moments.rigs[lane])]), moments.state.take(np.array([lane]))
            within, then = temperatures_pass(few, float(moments.command_A[lane]), state, np.linspace(0.0, hangs_s, 60))
            if not within or not temperatures_pass(few, 0.0, then, TIMES[:500])[0]:
                return False
        return True

    assert passes(1.2 * watchdog_s)
    assert not passes(1.5 * watchdog_s)


SLOW = {
    "contact.resistance_m2K_per_W": 1.5e-3, "driver.current_limit_A": 3.0, "driver.voltage_limit_V": 60.0,
    "safety.skin_highest_C": 39.5, "safety.skin_highest_soft_C": 36.0,
    "safety.display_highest_C": 42.0, "safety.display_highest_soft_C": 40.0,
}  # fmt: skip
"""A contact through which skin moves slowly enough for a strong driver, and near limits."""


def test_a_pause_grows_until_a_cut_off_of_a_tenth_of_a_second_suffices_in_plays_of_a_set() -> None:
    rig = sure_rig("thenar").with_(**SLOW)
    warm = Drive([0, 0.1, 2.6, 3.6, 4.6], [REST, -0.3, 0.2, REST, REST], held=True)
    found = gate(warm, rig, pause_s=600.0).repeated
    assert found.shortest_pause_s is not None and found.faultless_pause_s is not None
    assert found.shortest_pause_s > 2.0 * found.faultless_pause_s
    mild = Drive([0, 0.1, 2.6], [REST, 0.9 * REST, REST], held=True)
    for one in gate_set([(mild, REST), (warm, REST)], rig, pause_s=600.0):
        assert one.repeated.shortest_pause_s > 0.9 * found.shortest_pause_s, "a set waits for the icon that needs most"
