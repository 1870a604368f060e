"""Delivery of cues by devices."""

import re
from dataclasses import replace

import numpy as np
import pytest

from tests.circuit.delivery.one_drive import changed, icon_of, worst_case
from thermicon.circuit import Device, Rig, simulate
from thermicon.circuit.delivery.deliver import flow_of, traces_until
from thermicon.circuit.delivery.delivered_drive import DeliveredDrive, DeliveryDeviation, Deviation
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.formats.form import events_of
from thermicon.circuit.delivery.prepare import lost_text
from thermicon.circuit.delivery.samples import rate_of, within
from thermicon.circuit.delivery.setpoints import Setpoints, closed, setpoints_of
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.solver.drive import duty_of, switched
from thermicon.circuit.solver.inverse import design
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current, steady_of
from thermicon.icons import load_library
from thermicon.icons.model.corners import Corners

RIG = Rig.load("thenar")
SIX = load_library("six-icons")
STEP = SIX["warming-step"]
DAC = Device.load("dac-16")
RAMP_A = icon_of("to 0.6 A at 1 A/s; return at 1 A/s", "current", name="ramp")
WIDE = RIG.with_(**{"driver.transconductance_A_per_V": 0.2})
GENERATOR = replace(DAC, codes="symmetric", levels="waveform", streams=False)
"""A device file as waveform generators need it."""


def rms_K(delivery: DeliveredDrive) -> float:
    return max(place.rms_K for place in delivery.deviation.places)


@pytest.mark.parametrize(
    "device",
    [DAC, Device.load("ni-analogue-output"), GENERATOR, replace(GENERATOR, codes="from zero")],
)
def test_a_drive_begins_and_ends_at_rest_and_lies_within_half_a_step_of_the_design(device: Device) -> None:
    found = deliver(STEP, RIG, device)
    plan = design(STEP, RIG, 8.0)
    played = found.played
    current = played.command * RIG.driver.transconductance_A_per_V
    half = 0.5 * played.scale.step * RIG.driver.transconductance_A_per_V + 1e-12
    assert played.codes[0] == played.codes[-1]
    assert abs(current[0] - plan.rest_A) <= half
    assert np.abs(current[1:-1] - plan.drive.current_A[:-1]).max() <= half
    assert (found.lead_s, found.end_s, found.rate_Hz) == (0.01, 8.01, 100.0)
    assert found.device_warnings == ()


def test_the_design_on_the_clock_of_the_file_is_the_design() -> None:
    found, plain = deliver(STEP, RIG, DAC), simulate(STEP, RIG)
    assert found.designed_trace.skin_C == pytest.approx([plain.skin_C[0], *plain.skin_C], abs=1e-9)


def test_finer_steps_lose_less() -> None:
    # half a step of rest, and what an ampere does to the resting skin: rounding may be lucky, never worse
    for bits in (12, 14, 16):
        step_A = 20.0 / 2**bits * RIG.driver.transconductance_A_per_V
        assert rms_K(deliver(STEP, RIG, Device.load(f"dac-{bits}"))) < 0.5 * step_A * 85.0
    assert rms_K(deliver(STEP, RIG, GENERATOR)) < 1e-3


def test_a_range_too_small_is_told_with_the_cure_and_used_as_well_as_it_can_be() -> None:
    step, weak = SIX["cooling-step"], RIG.with_(**{"driver.transconductance_A_per_V": 0.1})
    found = deliver(step, weak, DAC)
    assert found.device_warnings == (
        "dac-16 plays −1 … 1 A (−10 … 10 V through driver.transconductance_A_per_V = 0.1), the design needs up to "
        "1.11 A; raise that to 0.12 if the current source can, or use a device of more volts",
    )
    assert found.delivered.current_A.max() <= 1.0
    assert rms_K(found) < 0.01  # the display catches up after the corner
    stronger = weak.with_(**{"driver.transconductance_A_per_V": 0.12})
    assert deliver(step, stronger, DAC).device_warnings == ()


def test_a_device_of_one_sign_is_not_cured_by_more_gain() -> None:
    positive = replace(changed(DAC, "output range", "V", low=0.0, high=10.0), name="half")
    (said,) = deliver(SIX["warming-step"], RIG, positive).device_warnings
    assert re.search(r"^half plays 0 … .* the design needs up to −[\d.]+ A; use a device of both signs$", said)


@pytest.mark.parametrize("name", ["thenar", "forearm", "hand-dorsum", "fingertip", "shani2021"])
def test_the_default_converter_gives_every_shipped_rig_all_that_its_driver_can(name: str) -> None:
    rig = Rig.load(name)
    low, high = DAC.interval("output range")
    gain = rig.driver.transconductance_A_per_V
    assert (low * gain, high * gain) == pytest.approx((rig.driver.current_min_A, rig.driver.current_max_A))
    assert within(DAC, rig).driver == rig.driver


def test_a_slew_rate_holds_the_command_back() -> None:
    found = deliver(STEP, RIG, changed(DAC, "slew rate", "V/s", value=10.0))
    assert np.abs(np.diff(found.played.command)).max() <= 0.1 + 1e-3
    assert found.device_warnings == ("dac-16: its slew rate of 10 V/s limits the command",)


@pytest.mark.parametrize(
    ("device", "requested", "length", "rate"),
    [
        (DAC, 100.0, 8.0, 100.0),
        (DAC, 20_000.0, 8.0, 10_000.0),
        (DAC, 10_000.0, 999.0, 10_000.0),  # nearly as many samples as are computed
        (changed(DAC, "update rate", "Hz", low=250.0, high=1e4), 100.0, 8.0, 300.0),  # each is played three times
        (Device.load("ni-analogue-output"), 10_000.0, 8.0, 5_000.0),
        (Device.load("dc-coupled-audio"), 100.0, 8.0, 100.0),  # each is held for 480 frames
        (Device.load("dc-coupled-audio"), 50_000.0, 8.0, 25_000.0),
        (Device.load("pwm-h-bridge-10"), 100.0, 8.0, 15_625 / 157),
        (changed(GENERATOR, "buffer length", "samples", low=8, high=16384), 100.0, 600.0, 25.0),  # all that it holds
    ],
)
def test_rates_are_what_the_device_can(device: Device, requested: float, length: float, rate: float) -> None:
    assert rate_of(device, requested, length) == pytest.approx(rate)


def test_a_slower_device_repeats_nothing_and_loses_no_charge() -> None:
    slow = changed(DAC, "update rate", "Hz", value=7.0)
    found = deliver(STEP, RIG, slow)
    played = found.played
    assert (found.requested_Hz, found.rate_Hz) == (100.0, 7.0)
    charge = float(np.sum(found.delivered.current_A[:-1] * np.diff(found.delivered.time_s)))
    designed = float(np.sum(found.designed.current_A[:-1] * np.diff(found.designed.time_s)))
    assert charge == pytest.approx(designed, abs=len(played.codes) * played.scale.step * 0.15 / 7.0)


def test_a_cue_that_no_buffer_holds_is_refused() -> None:
    tiny = changed(changed(GENERATOR, "buffer length", "samples", value=50), "update rate", "Hz", low=50.0, high=1e6)
    with pytest.raises(DeviceError, match=r"8 s at 100 Hz are 802 samples, it holds 50 and plays 50 Hz at the slowest"):
        deliver(STEP, RIG, tiny)


def test_an_icon_in_amperes_is_sampled_by_means() -> None:
    found = deliver(RAMP_A, RIG, DAC)
    rest = float(found.played.command[0]) * 0.15
    assert rest == pytest.approx(0.0824, abs=1e-3)
    assert found.played.command[1] * 0.15 == pytest.approx(rest + 0.005, abs=1e-4)
    assert rms_K(found) < 2e-3


class TestBridge:
    """A module that is switched."""

    def test_it_heats_as_much_as_the_formula_says(self) -> None:
        duty, peak = 0.25, 1.9
        state = steady_of(RIG, duty, peak)
        net = network_of(RIG)
        alpha, ohm, leak = (float(net.plates[k]) for k in range(3))
        hot, cold = float(state[0]), float(state[1])
        taken = alpha * (cold + 273.15) * duty * peak - 0.5 * ohm * duty * peak**2 - leak * (hot - cold)
        from_skin = float(net.conductance_W_per_K[0]) * (float(state[2]) - cold)
        assert taken == pytest.approx(from_skin, abs=1e-9)

    def test_full_duty_is_a_steady_current(self) -> None:
        assert steady_of(RIG, 0.5, 1.0)[1] != pytest.approx(state_under_current(network_of(RIG), 0.5)[1], abs=0.1)
        assert steady_of(RIG, 1.0, 0.9) == pytest.approx(state_under_current(network_of(RIG), 0.9), abs=1e-9)
        assert steady_of(RIG, 0.0, 1.9) == pytest.approx(state_under_current(network_of(RIG), 0.0), abs=1e-9)

    def test_the_mean_current_does_not_hold_the_baseline_but_equal_heat_does(self) -> None:
        bridge = Device.load("pwm-h-bridge-10")
        plain = deliver(STEP, RIG, replace(bridge, duty_rule="mean current"))
        best = deliver(STEP, RIG, bridge)
        coarse = 0.5 * 3.0 / 2048 * 85  # half a step of duty, and what an ampere does to the resting skin
        assert plain.trace.skin_C[0] - 32.0 > 2.0
        assert abs(best.trace.skin_C[0] - best.designed_trace.skin_C[0]) < coarse

    def test_no_more_than_rounding_is_lost_though_the_hot_plate_is_warmer(self) -> None:
        found = deliver(STEP, RIG, Device.load("pwm-h-bridge-10"))
        hotter = found.trace.hot_plate_C - found.designed_trace.hot_plate_C
        assert hotter.max() > 0.1
        # without it the heat that leaks back is left on the cold plate: tenths of a kelvin of skin
        plain = duty_of("equal heat", np.array([0.08]), 1.5, RIG.module, np.array([31.0]))
        more = duty_of("equal heat", np.array([0.08]), 1.5, RIG.module, np.array([31.0]), np.array([1.0]))
        heat = (more - plain) * 1.5 * (0.0521 * (31.0 + 273.15) - 0.5 * 6.35 * 1.5)
        assert heat[0] == pytest.approx(1.0 / 6.56)
        assert rms_K(found) < 0.5 * 3.0 / 2048 * 85

    def test_a_fast_carrier_is_simulated_slower_with_the_same_means(self) -> None:
        duty = np.array([0.25, -0.5, 1.0, 0.0])
        fast, slow = switched(duty, 100.0, 15_600.0, 1.5), switched(duty, 100.0, 500.0, 1.5)
        assert np.array_equal(fast.time_s, slow.time_s)
        assert len(slow.time_s) == 2 * 5 + 2 * 5 + 5 + 1
        assert switched(duty, 1000.0, 4000.0, 1.5).time_s[1] == pytest.approx(0.25e-3)  # never below the updates

    def test_a_slow_cycle_ripples_the_plate(self) -> None:
        bridge = Device.load("pwm-h-bridge-10")
        cycles = (changed(bridge, "carrier frequency", "Hz", value=hertz) for hertz in (490.0, 4.0))
        still = icon_of("hold for 5 s")
        fast, slow = (np.ptp(deliver(still, RIG, each).trace.display_C[100:]) for each in cycles)
        assert fast < 0.05
        # α·T·Ip flows for D of a 250 ms cycle into a plate of 2.6 J/K, the skin taking some of it
        assert 0.1 < slow < 0.0521 * 305 * 1.5 * 0.25 / 2.6


class TestSetpoints:
    """A thermode that follows segments."""

    THERMODE = Device.load("qst-tcs2")

    def test_corners_on_its_grid_are_followed_exactly(self) -> None:
        found = deliver(SIX["cooling-step"], RIG, self.THERMODE)
        assert found.played.segments == ((200, 260), (400, 260), (200, 320))
        assert rms_K(found) < 1e-9

    def test_a_skin_cue_is_drawn_with_few_segments_within_half_a_step(self) -> None:
        found = deliver(load_library("cooling-step-skin").icons[0], RIG, self.THERMODE)
        assert 3 < len(found.played.segments) < 100
        apart = np.abs(found.prompt_trace.display_C - found.designed_trace.display_C)
        assert apart.max() < 0.15  # half a step of drawing, half a step of rounding, and what the corner asks for

    def test_nothing_of_the_rigs_module_or_driver_takes_part(self) -> None:
        icon = icon_of("repeat 20 { cool by 16 °C over 10 ms; return over 10 ms; hold for 980 ms }")
        slow = RIG.with_(**{"driver.update_Hz": 1, "driver.current_limit_A": 0.1, "module.seebeck_V_per_K": 0.01})
        here, there = (deliver(icon, rig, self.THERMODE) for rig in (RIG, slow))
        assert np.array_equal(here.trace.skin_C, there.trace.skin_C)
        assert here.prompt_trace.display_C.min() == pytest.approx(16.0)  # each pulse is there, at its tick
        falls = np.diff(here.prompt_trace.skin_C).min() / 0.01
        assert falls < -100.0  # K/s: what the skin under such a pulse does
        assert here.outcome == there.outcome

    def test_the_trace_runs_behind_by_the_lag_which_is_no_loss_and_no_miss(self) -> None:
        found = deliver(SIX["cooling-step"], RIG, self.THERMODE)
        late = found.trace.display_C[150:200] - found.designed_trace.display_C[150:200]
        assert late == pytest.approx(3.0 * 0.21, rel=1e-3)
        assert found.deviation.lost == ()
        assert found.outcome.reached

    def test_a_thermode_has_no_current(self) -> None:
        found = deliver(STEP, RIG, self.THERMODE)
        assert (found.lead_s, found.end_s, found.rate_Hz) == (0.0, 8.0, 100.0)
        assert not found.trace.has_current
        with pytest.raises(DeviceError, match=r"qst-tcs2 is a thermode: its current is not known"):
            flow_of(self.THERMODE, RIG, deliver(STEP, RIG, DAC).played)
        words = r"qst-tcs2 is a thermode: it takes temperatures, and ramp prescribes a current; use control display"
        with pytest.raises(DeviceError, match=words):
            deliver(RAMP_A, RIG, self.THERMODE)

    def test_on_a_thermode_rig_it_plays_what_the_rig_does(self) -> None:
        rig = Rig.load("tcs2")
        for icon in (STEP, load_library("cooling-step-skin").icons[0]):
            found = deliver(icon, rig, self.THERMODE)
            alone = simulate(icon, rig).skin_C  # the file goes on, back to the baseline
            assert found.trace.skin_C[: len(alone)] == pytest.approx(alone, abs=0.12)

    def test_a_skin_that_the_range_does_not_reach_is_missed_and_says_why(self) -> None:
        outcome = deliver(icon_of("cool by 30 °C at 9 °C/s; hold for 2 s", "skin"), RIG, self.THERMODE).outcome
        assert "limited by the range of the thermode" in str(outcome.reason)

    def test_long_segments_are_split_and_end_in_time(self) -> None:
        points = setpoints_of(self.THERMODE, np.array([0.0, 25.0, 30.0]), np.array([30.0, 33.0, 30.0]), curve=False)
        assert max(ticks for ticks, _ in points.segments) <= 999
        assert points.time_s[-1] == pytest.approx(30.0)
        assert np.abs(points.at(np.linspace(0, 25, 100)) - np.linspace(30, 33, 100)).max() <= 0.05 + 1e-9

    def test_a_step_takes_no_longer_than_the_fastest_ramp_and_the_end_stays(self) -> None:
        times, levels = np.array([0.0, 1.0, 1.0 + 1e-7, 3.0]), np.array([32.0, 32.0, 26.0, 26.0])
        points = setpoints_of(self.THERMODE, times, levels, curve=False)
        assert points.segments == ((100, 320), (2, 260), (198, 260))

    @pytest.mark.parametrize(
        ("levels", "words"),
        [
            ([18.0, 20.0], r"a baseline of 18 °C is beyond 20 … 40 °C; change the icon, or use another device"),
            ([30.0, 61.0], r"qst-tcs2: a set-point of 61 °C is beyond 0\.1 … 60 °C"),
        ],
    )
    def test_what_is_beyond_the_thermode(self, levels: list[float], words: str) -> None:
        with pytest.raises(DeviceError, match=words):
            setpoints_of(self.THERMODE, np.array([0.0, 1.0]), np.array(levels), curve=False)

    def test_the_way_back_to_the_baseline_is_slow_and_no_part_of_the_cue(self) -> None:
        found = deliver(icon_of("cool by 12 °C at 3 °C/s"), RIG, self.THERMODE).played
        assert found.segments == ((400, 200), (600, 260), (600, 320))  # 12 K at 1 K/s, at most 9.99 s a segment
        assert (found.cue_s, found.closing) == (4.0, 2)
        assert closed(self.THERMODE, found) == replace(found, closing=0)
        full = Setpoints(0.01, 0.1, 320, tuple((10, 300) for _ in range(999)))
        with pytest.raises(DeviceError, match=r"1000 segments are needed with the return to baseline; it takes 999"):
            closed(self.THERMODE, full)

    def test_a_skin_cue_ends_where_it_began_and_may_be_played_again(self) -> None:
        found = deliver(icon_of("cool by 6 °C at 3 °C/s; return at 3 °C/s", "skin"), RIG, self.THERMODE)
        assert found.played.closing == 1
        assert found.played.level_C[-1] == found.played.level_C[0]
        assert max(one.rms_K for one in found.deviation.places) < 0.05
        assert worst_case(found, 10.0).safe

    def test_too_many_segments_are_an_error_for_corners_and_drawn_coarser_for_a_curve(self) -> None:
        times = np.arange(1200) * 0.1
        levels = 30.0 + np.where(np.arange(1200) % 2, 1.0, 0.0)
        with pytest.raises(DeviceError, match=r"1199 segments are needed, it takes 999; shorten the icon"):
            setpoints_of(self.THERMODE, times, levels, curve=False)
        assert len(setpoints_of(self.THERMODE, times, levels, curve=True).segments) <= 999


@pytest.mark.parametrize("name", ["dac-16", "pwm-h-bridge-10", "qst-tcs2"])
def test_traces_go_on_at_rest_after_the_end(name: str) -> None:
    found = deliver(STEP, WIDE, Device.load(name))
    designed, delivered = traces_until(found, 20.0)
    rows = len(found.trace.time_s) - 1
    assert designed.time_s[-1] == delivered.time_s[-1] == 20.0
    assert delivered.skin_C[:rows] == pytest.approx(found.trace.skin_C[:rows], abs=1e-6)
    assert abs(delivered.skin_C[-1] - delivered.skin_C[0]) < 1.0  # the skin is still warm


def test_ramps_levels_and_returns_on_the_clock_of_the_file() -> None:
    corners = SIX["cold-to-warm"].corners()
    found = [(event.name, round(event.time_s, 3), event.level) for event in events_of(corners, 0.01)]
    assert found == [
        ("ramp start", 0.01, 32.0),
        ("target reached", 1.51, 27.5),
        ("ramp start", 1.51, 27.5),
        ("target reached", 6.51, 36.0),
        ("return start", 6.51, 36.0),
        ("baseline reached", 8.01, 32.0),
        ("end", 8.01, 32.0),
    ]


def test_a_wave_is_one_event_a_half_swing_and_a_hold_none() -> None:
    up_in_pieces = Corners((0, 1, 2, 3, 5), (30, 31, 31.5, 31.5, 30), "temperature_C")
    told = "ramp start, target reached, return start, baseline reached, end"
    assert ", ".join(event.name for event in events_of(up_in_pieces)) == told
    still = Corners((0, 4), (30, 30), "temperature_C")
    assert [event.name for event in events_of(still)] == ["end"]


def test_a_loss_is_told_with_its_limit() -> None:
    apart = DeliveryDeviation((Deviation("skin", 0.3, 1.0, 0.2), Deviation("cold receptor", 0.1, 1.0, 0.0612)))
    assert lost_text(apart) == "the cold receptor differs by 0.061 K (rms) from the design, over the stated 0.05 K"


def test_the_deviation_that_is_stated_is_the_largest_and_stands_at_its_time() -> None:
    delivery = deliver(load_library("six-icons")["double-dip"], Rig.load("thenar"), Device.load("dac-12"))
    skin, _, _ = delivery.deviation.places
    away_K = delivery.trace.skin_C - delivery.designed_trace.skin_C
    assert 0.0 < abs(skin.largest_K) == np.abs(away_K).max() > skin.rms_K
    assert np.interp(skin.at_s, delivery.trace.time_s, away_K) == pytest.approx(skin.largest_K)
