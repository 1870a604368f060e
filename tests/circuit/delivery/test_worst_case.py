"""The gate on what every kind of device delivers."""

import json
import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.circuit.delivery.one_drive import icon_of, prepare, worst_case
from tests.circuit.delivery.replay import Skin
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Device, Drive, Rig, gate, simulate_current
from thermicon.circuit.delivery.controlled import _rest_s as rest_s
from thermicon.circuit.delivery.controlled import samples_of
from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.prepare import Prepared
from thermicon.circuit.delivery.temperatures import FollowingModule, follow_samples
from thermicon.circuit.delivery.ways import deliver, worst_cases
from thermicon.circuit.delivery.worstcase import ways_of
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.safety.checks import cures_of, hard_of, worst_of
from thermicon.circuit.safety.corners import corners_of
from thermicon.circuit.safety.current import CurrentPlant, CurrentPlay, single_of_lanes
from thermicon.circuit.safety.display import DisplayPlant
from thermicon.circuit.safety.ensemble import Ensemble, LaneDrives
from thermicon.circuit.safety.gate import Gate, gate_set
from thermicon.circuit.safety.plant import Single
from thermicon.circuit.safety.tally import worst_of_lanes
from thermicon.circuit.safety.verdict import judge_safety
from thermicon.circuit.safety.words import more_and_cure
from thermicon.icons import load_library

RIG, SURE = Rig.load("thenar"), sure_rig()
SIX = load_library("six-icons")
CSV = load_format("csv")


@cache
def ready(name: str = "cooling-step", device: str = "dac-16", form: str = "csv", rig: Rig = RIG) -> Prepared:
    return prepare(SIX[name], rig, Device.load(device), load_format(form))


class TestWorstCase:
    """What every kind of device meets."""

    def test_open_loop_it_is_the_gate_on_what_flows(self) -> None:
        rig = sure_rig("thenar", "gain_relative")
        found = ready(rig=rig).delivery
        assert worst_case(found) == gate(found.delivered, rig)

    @pytest.mark.slow
    def test_a_bridge_rests_and_ends_with_means(self) -> None:
        found = ready(device="pwm-h-bridge-10").delivery
        (rest, *_) = found.played.command  # type: ignore[union-attr]
        means = Drive(found.played.time_s, 1.5 * found.played.command, held=True)  # type: ignore[union-attr]
        assert found.device.most("carrier frequency") >= 100.0, "too fast for a plate to follow"
        (by_means,) = gate_set([(means, 1.5 * float(rest))], RIG, bridge_A=1.5, averaged=True)
        assert worst_case(found) == by_means

    def test_lanes_with_drives_of_their_own_are_judged_as_each_corner_by_itself(self) -> None:
        corners = [replace(corners_of(RIG)[k], gain_relative=0.0) for k in (0, 5, 40)]
        time_s = np.arange(41) * 0.1
        amps = [0.08 + 0.3 * (k + 1) * np.sin(np.pi * time_s / 4.0) for k in range(3)]
        lanes = LaneDrives(time_s, np.array(amps))
        together = worst_of_lanes(single_of_lanes(Ensemble.on(RIG, tuple(corners), None), lanes, RIG.limits).tallies)
        plants = (CurrentPlant.of(Ensemble.on(RIG, (corner,), None)) for corner in corners)
        plays = (CurrentPlay(Drive(time_s, own, held=True), float(own[0])) for own in amps)
        each = [Single.of(plant, play, RIG.limits).checks for plant, play in zip(plants, plays, strict=True)]
        for one, other in zip(together, worst_of(each), strict=True):
            assert one.value == pytest.approx(other.value, rel=1e-9)
            assert replace(one, value=0.0) == replace(other, value=0.0)

    def test_a_thermode_follows_its_set_points_in_every_corner_and_has_no_gain(self) -> None:
        found = worst_case(ready(device="qst-tcs2", form="tcs2-serial").delivery)
        assert (found.drift_C, found.scenarios) == (None, 20)
        assert {check.quantity for check in found.checks} == {rule.quantity for rule in RIG.limits.rules} - {
            "hot plate"
        }
        lowest = min(check.value for check in found.checks if check.quantity == "display" and not check.upper)
        assert lowest == pytest.approx(26.0, abs=0.06), "the set-point, in the corners too"
        coldest = next(check for check in found.checks if check.quantity == "skin surface" and not check.upper)
        given = deliver(SIX["cooling-step"], RIG, Device.load("qst-tcs2")).trace.skin_C.min()
        assert coldest.value < given - 0.1
        assert coldest.scenario.startswith("contact −30 %")

    def test_a_thermode_is_followed_until_it_has_arrived_and_no_longer(self) -> None:
        """A display cut short jumps to its last level: a rate that is none; one that is waited for delays recovery."""
        from scipy.signal import lfilter

        thermode = Device.load("qst-tcs2")
        jump = deliver(icon_of("cool by 6 °C at 3 °C/s; hold for 1 s; step by 6 °C"), RIG, thermode)
        lagged = ways_of(jump)[-1]
        assert abs(lagged.display_C[-1] - lagged.display_C[-2]) / lagged.step_s < 0.01, "a thousandth of the limit"
        delivery = deliver(icon_of("warm by 2 °C at 3 °C/s; hold for 2 s; return at 3 °C/s"), RIG, thermode)
        step, lag = 0.002, 0.21
        ends, keep = delivery.played.time_s[-1], np.exp(-step / lag)  # type: ignore[union-attr]
        times = np.arange(0.0, ends + 6.0, step)
        asked = np.interp(times, delivery.played.time_s, delivery.played.level_C) - 32.0  # type: ignore[union-attr]
        skin = Skin(json.loads(RIG.document), np.random.default_rng(0), extra=0)
        rows, _ = skin.run(32.0 + lfilter([1.0 - keep], [1.0, -keep], asked), step, skin.steady(32.0))
        away = (np.abs(rows - rows[0])[:, :, [0, 2]] > 0.1).any(axis=(1, 2))
        back = times[np.flatnonzero(away)[-1]] - ends
        assert back - 0.01 <= worst_case(delivery).repeated.recovery_s <= back + 0.11

    def test_a_thermode_is_stronger_than_the_rig(self) -> None:
        icon = icon_of("cool by 8 °C at 30 °C/s; hold for 3 s; return at 30 °C/s")
        found = deliver(icon, RIG.with_(**{"driver.current_limit_A": 0.4}), Device.load("qst-tcs2"))
        assert judge_safety(found.trace).colour == "red", "the thermode follows its set-points, whatever the rig can"
        assert str(worst_case(found).reason).startswith("rate of skin temperature reaches ")

    def test_a_set_point_that_the_module_cannot_reach_is_judged_all_the_same(self) -> None:
        rig = RIG.with_(**{"module.seebeck_V_per_K": 0.026})
        icon = icon_of("cool by 29 °C at 2 °C/s; return at 2 °C/s")
        found = worst_case(deliver(icon, rig, Device.load("qst-tcs2")))
        check = next(check for check in found.findings if check.quantity == "display")
        assert (check.value, check.scenario) == (pytest.approx(3.0), "the rig as given, followed at once")


class TestRefusals:
    """What a refusal names beside its first reason."""

    def test_every_hard_limit_and_a_cure(self) -> None:
        bang, rig = icon_of("step by 12 °C; hold for 8 s"), sure_rig("thenar", "plates_relative", "gain_relative")
        refusal = str(prepare(bang, rig, Device.load("dac-16"), CSV).refusals[0])
        assert refusal.startswith("NOT SAFE: rate of skin temperature reaches ")
        assert refusal.count("rate of skin temperature") == 1
        assert "; also beyond hard limits: " in refusal
        assert "skin surface 4" in refusal
        assert refusal.endswith("; use a slower change, a shorter hold, a smaller or shorter change")

    def test_an_unsafe_icon_is_not_told_to_use_more_current(self) -> None:
        icon = icon_of("cool by 24 °C over 0.1 s; hold for 30 s", baseline=33)
        refusals = prepare(icon, SURE, Device.load("dac-16"), CSV).refusals
        assert [refusal.kind for refusal in refusals] == ["unsafe", "unreachable"]
        assert str(refusals[1]).endswith("; use a slower or smaller change")

    def test_a_current_beyond_the_driver_names_the_driver(self) -> None:
        amp = icon_of("step by -2 A; hold for 0.5 s; step to 0 A", "current")
        narrowed = deliver(amp, RIG, Device.load("dac-16")).narrowed
        assert "driver gives −1.5 … 1.5 A (driver.current_limit_A)" in narrowed.text
        assert "transconductance" not in narrowed.text


class TestFollowedSetPoints:
    """A module that a controller takes along set-points, which it cannot follow at once where they jump."""

    GREAT = tuple(pytest.param(RIG, change, marks=pytest.mark.slow) for change in ("cool by 6", "warm by 5"))

    @pytest.mark.parametrize(("rig", "change"), [*GREAT, (SURE, "cool by 3"), (SURE, "warm by 3")])
    def test_steps_of_skin_are_not_refused_for_a_jump_that_no_module_makes(self, rig: Rig, change: str) -> None:
        shape = f"{change} °C at 3 °C/s; hold for 4 s; return at 3 °C/s"
        found = worst_case(by_controller(shape, rig, "skin"))
        assert found.safe, found.reason
        assert rate_in(found) > 3.0, "a skin that changes at 3 K/s"

    @pytest.mark.slow
    def test_a_display_warmer_than_any_first_cut_off_allows_is_refused_for_its_cut_off_alone(self) -> None:
        shape = "warm by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s"
        assert worst_case(by_controller(shape, RIG, "skin")).safe, "on the thenar the display stays below 43 °C"
        found = worst_case(by_controller(shape, Rig.load("forearm"), "skin"))
        assert not found.safe
        assert "no cut-off both lets this play pass and stops a display that gets stuck" in found.reason

    def test_a_step_that_needs_more_current_than_any_loop_may_have_is_refused_with_one_that_is_safe(self) -> None:
        shape = "step warm by 0.82 °C; hold for 0.06 s; step cool by 0.82 °C; hold for 0.1 s"
        strong = {"kp_A_per_K": 0.5, "ki_A_per_Ks": 0.125}
        rig = RIG.with_(**SMALL, controller=strong, **{"module.cold_plate_J_per_K": 1.5})
        found = worst_case(by_controller(shape, rig))
        told = re.search(
            r"under any loop of −1\.5 … 1\.5 A, as its set-points need; a driver\.current_limit_A of (\d\.\d+) A slows",
            " ".join(check.scenario for check in found.findings),
        )
        assert told, found.reason
        assert not found.safe
        assert worst_case(by_controller(shape, rig.with_(**{"driver.current_limit_A": float(told[1])}))).safe

    def test_current_limits_keep_any_return_slow_and_are_no_narrower_than_ramps_need(self) -> None:
        small = RIG.with_(**SMALL, **{"module.cold_plate_J_per_K": 2.0, "contact.resistance_m2K_per_W": 3e-4})
        delivery = by_controller("warm by 3 °C at 2 °C/s; hold for 1 s", small)
        found, used = worst_case(delivery), delivery.delivered.current_A
        assert found.safe, found.reason
        least, most = found.demands.current_limit_A
        assert -1.4 < least <= used.min() < used.max() <= most <= 1.5

    def test_a_baseline_beyond_a_limit_is_named_as_the_cause(self) -> None:
        icon = icon_of("warm by 1 °C at 1 °C/s", baseline=47)
        found = worst_case(deliver(icon, SURE, Device.load("closed-loop-controller")))
        assert more_and_cure(hard_of(found.findings), cures_of(found.findings)).endswith(
            "use a baseline nearer to resting skin, since it is beyond the limit from the start"
        )

    def test_in_a_set_what_is_refused_by_itself_is_not_played_with_the_rest(self) -> None:
        hot, *safe = (
            "warm by 11 °C at 2 °C/s; hold for 9 s",
            "cool by 1 °C at 2 °C/s; hold for 1 s",
            "warm by 1 °C at 1 °C/s",
        )
        first, *rest = worst_cases([by_controller(shape, SURE.with_(**SMALL)) for shape in (hot, *safe)], 0.0)
        assert not first.safe
        assert all(verdict.safe for verdict in rest)
        assert len({verdict.demands.current_limit_A for verdict in rest}) == 1, "one controller plays them all"

    def test_a_loop_saturates_where_its_source_does_and_not_where_its_file_says(self) -> None:
        small = RIG.with_(**SMALL, **{"module.cold_plate_J_per_K": 1.5, "driver.current_limit_A": 0.97})
        played = "step warm by 1 °C; hold for 1 s; step cool by 1 °C; hold for 1 s"
        found = worst_case(by_controller(played, small))
        assert re.match(r"rate of skin temperature reaches .* K/s .*, gain \+10 %, ", str(found.reason)), found.reason
        why = {"uncertainty.reason": "a test: its current source was measured"}
        measured = small.with_(**{"uncertainty.gain_relative": 0.0, **why})
        assert worst_case(by_controller(played, measured)).safe

    def test_a_loop_runs_to_the_limit_of_its_driver_where_a_set_point_cannot_be_reached(self) -> None:
        weak = RIG.with_(**SMALL, **{"heat_sink.temperature_C": 46.0, "module.seebeck_V_per_K": 0.03})
        samples = samples_of(by_controller("cool by 4 °C at 2 °C/s; hold for 4 s; return at 2 °C/s", weak))
        assert follow_samples(weak, samples).current_A.max() < 1.4, "a design does not pass the most cooling"
        assert FollowingModule.of(weak).drives(samples).current_A[0].max() == pytest.approx(1.5)

    def test_a_corner_that_cannot_hold_the_baseline_rests_at_the_limit(self) -> None:
        weak = RIG.with_(**SMALL, **{"heat_sink.temperature_C": 46.0, "module.seebeck_V_per_K": 0.02})
        module, samples = FollowingModule.of(weak), samples_of(by_controller("warm by 2 °C at 2 °C/s", weak))
        with pytest.raises(RigError, match="the module cools it to 3"):
            [follow_samples(rig, samples) for rig in module.rigs]
        begun = module.drives(samples).current_A[:, 0]
        display = module.ensemble.hold(begun, module.ensemble.at_rest(begun), np.array([0.0, 1.0]))[0][1, :, 0]
        assert len(display) == 33
        assert display[0] == pytest.approx(32.0, abs=1e-3), "the rig as given holds it"
        away = np.abs(display - 32.0) > 0.01
        assert away.sum() == 4
        assert begun[away] == pytest.approx(1.5)
        assert display[away].min() > 42.0


SMALL = {"skin.elements": [1] * 5, "driver.update_Hz": 20.0, "module.hot_plate_J_per_K": 1.5}


def by_controller(shape: str, rig: Rig, control: str = "display") -> DeliveredDrive:
    return deliver(icon_of(shape, control), rig, Device.load("closed-loop-controller"))


def rate_in(verdict: Gate) -> float:
    return max(abs(check.value) for check in verdict.checks if check.quantity == "rate of skin temperature")


def test_the_cut_off_has_room_for_a_display_without_power_and_the_rest_is_held() -> None:
    """A controller starts from such a display, and is there again after a stop."""
    demands: dict[str, Any] = ready("cooling-step", "closed-loop-controller", "setpoint-csv").verdict.demanded
    unpowered = simulate_current(Drive([0.0, 1.0], [0.0, 0.0]), RIG).display_C[0]
    cut = demands["cut_off_display_C"]
    assert unpowered > 38.0, "without power the heat sink of this rig warms the display"
    assert cut["low"] < unpowered < cut["high"] < 43.0
    assert 10.0 < demands["rest_before_first_play_s"] < 600.0
    assert any("without power" in fault["fault"] for fault in demands["faults"])


def test_the_rest_before_a_first_play_is_that_of_the_start_that_is_farthest_away() -> None:
    delivery = by_controller("cool by 2 °C at 2 °C/s", RIG)
    under = DisplayPlant.of(RIG, delivery.device.interval("set-point range"))
    near, far, both = (rest_s(under, delivery, ends_C) for ends_C in ((33.0, 33.0), (41.0, 41.0), (33.0, 41.0)))
    assert near is not None and far is not None
    assert near < far == both
