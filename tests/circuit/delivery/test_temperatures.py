"""Temperatures for a controller around the rig's module."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from tests.circuit.delivery.one_drive import changed, icon_of, prepare, worst_case
from tests.circuit.surerig import sure_rig
from tests.circuit.verdicts import GreenVerdict
from thermicon.circuit import Device, Drive, Rig, simulate, simulate_current
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.delivery.worstcase import open_loop_spread
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.safety.corners import corners_of
from thermicon.icons import load_library

RIG = Rig.load("thenar")
LOOP = Device.load("closed-loop-controller")
STEP = load_library("six-icons")["cooling-step"]
SKIN = load_library("cooling-step-skin").icons[0]


VOLTS = changed(LOOP, "set-point gain", "V/K", value=0.1)


class TestDeliveredDrive:
    """What the display does under set-points."""

    def test_set_points_lead_the_display_of_the_cue_and_rest_before_and_after(self) -> None:
        played = deliver(STEP, RIG, LOOP).played
        middles = np.arange(800) * 0.01 + 0.005
        lead_K = played.command[1:-1] - np.interp(middles, [0, 2, 6, 8], [32, 26, 26, 32])
        assert lead_K[:190].max() < -0.3, "a calm loop falls as fast as the cue by set-points below it"
        assert lead_K[620:790].min() > 0.3
        assert np.abs(lead_K[400:590]).max() < 0.5, "while it holds they come near"
        assert played.command[0] == played.command[-1] == pytest.approx(32.0)

    def test_the_display_follows_the_design_on_the_rigs_module(self) -> None:
        found = deliver(STEP, RIG, LOOP)
        assert found.trace.has_current
        assert np.abs(found.trace.display_C - found.designed_trace.display_C).max() < 0.1
        assert found.trace.current_A.max() <= RIG.driver.current_max_A
        assert found.deviation.lost == ()
        again = simulate_current(found.delivered, RIG)
        assert again.skin_C == pytest.approx(found.trace.skin_C, abs=1e-9)

    def test_a_skin_cue_gets_the_display_that_its_design_finds(self) -> None:
        found = deliver(SKIN, RIG, LOOP)
        assert found.outcome.reached
        assert np.abs(found.trace.skin_C - found.designed_trace.skin_C).max() < 0.1

    def test_it_may_be_played_again_once_the_skin_of_the_design_is_back(self) -> None:
        known = sure_rig()
        skin = simulate(STEP, known, tail_s=30.0)
        away_s = skin.time_s[np.abs(skin.skin_C - skin.skin_C[0]) > 0.1][-1] - 8.0
        again_s = worst_case(deliver(STEP, known, LOOP)).repeated.recovery_s
        assert 5.0 < away_s < again_s < 1.5 * away_s, "a little later, since set-points lead"

    def test_the_drivers_limits_hold_it_back(self) -> None:
        weak = RIG.with_(**{"driver.current_limit_A": 0.6})
        found = deliver(STEP, weak, LOOP)
        assert found.trace.current_A.max() == pytest.approx(0.6)
        assert found.trace.display_C[202] > 26.5
        assert not found.outcome.reached

    def test_a_rigs_own_loop_is_what_follows(self) -> None:
        gains = {"lag_s": 0.1, "kp_A_per_K": 2.0, "ki_A_per_Ks": 1.0, "kd_As_per_K": 0.15}
        loop = RIG.with_(**{f"controller.{key}": value for key, value in gains.items()})
        stronger, usual = deliver(STEP, loop, LOOP), deliver(STEP, RIG, LOOP)
        leads = [float(np.ptp(one.played.command)) for one in (stronger, usual)]
        assert leads[0] < leads[1] - 0.5, "a strong loop needs less of a lead"
        assert np.abs(stronger.trace.display_C - stronger.designed_trace.display_C).max() < 0.1

    def test_a_slower_controller_gets_every_nth_set_point(self) -> None:
        found = deliver(STEP, RIG, changed(LOOP, "update rate", "Hz", value=10.0))
        assert (found.rate_Hz, found.requested_Hz, found.lead_s) == (10.0, 100.0, 0.1)
        assert found.deviation.places[1].rms_K < 0.1

    def test_what_it_cannot_be_told(self) -> None:
        with pytest.raises(DeviceError, match=r"controller takes temperatures, and ramp prescribes a current"):
            deliver(icon_of("to 0.6 A at 1 A/s; return at 1 A/s", "current", name="ramp"), RIG, LOOP)
        narrow = changed(LOOP, "set-point range", "°C", low=28.0, high=40.0)
        with pytest.raises(DeviceError, match=r"a set-point of 26 °C is beyond 28 … 40 °C; change the icon"):
            deliver(STEP, RIG, narrow)
        with pytest.raises(RigError, match="rig tcs2 is a thermode: it has no driver"):
            deliver(STEP, Rig.load("tcs2"), LOOP)


class TestFiles:
    """Set-points in files."""

    def test_a_table_has_times_temperatures_and_events(self) -> None:
        form = load_format("setpoint-csv")
        files = pack([prepare(STEP, RIG, LOOP, form, gate=GreenVerdict)], form)
        rows = list(csv.DictReader(io.StringIO(files["cooling-step.csv"].decode())))
        assert list(rows[0]) == ["time_s", "display_C", "event"]
        assert (rows[0]["display_C"], rows[0]["event"], rows[1]["event"]) == ("32.00", "rest", "ramp start")
        assert float(rows[-1]["time_s"]) == pytest.approx(8.01)
        assert rows[-1]["event"].endswith("end")

    def test_a_gain_puts_them_out_as_a_voltage(self) -> None:
        found = deliver(STEP, RIG, changed(VOLTS, "set-point offset", "V", value=-2.0))
        rows = list(csv.DictReader(io.StringIO(load_format("setpoint-csv").write(found).decode())))
        for row in rows:
            assert float(row["command_V"]) == pytest.approx(0.1 * float(row["display_C"]) - 2.0, abs=1e-6)

    def test_tdms_has_a_channel_of_temperatures(self, tmp_path: Path) -> None:
        from nptdms import TdmsFile

        found = deliver(STEP, RIG, VOLTS)
        (tmp_path / "a.tdms").write_bytes(load_format("tdms").write(found))
        group = TdmsFile.read(tmp_path / "a.tdms")["thermicon"]
        assert group["display_C"][:] == pytest.approx(found.played.command)
        assert group["command_V"][:] == pytest.approx(0.1 * found.played.command)
        assert group["display_C"].properties["unit_string"] == "°C"
        assert [column.name for column in load_format("tdms").columns(found)] == ["display_C", "code", "command_V"]


class TestSpread:
    """What an open loop leaves open."""

    def test_it_is_that_of_the_corners(self) -> None:
        found = deliver(STEP, RIG, Device.load("dac-16"))
        spread = open_loop_spread(found)
        rests, steps = [], []
        for corner in corners_of(RIG):
            amperes = found.delivered.current_A * (1.0 + corner.gain_relative)
            display = simulate_current(Drive(found.delivered.time_s, amperes, held=True), corner.rig).display_C
            rests.append(display[0])
            steps.append((display - display[0]).min())
        assert spread.baseline_C == pytest.approx((min(rests), max(rests)), abs=1e-6)
        assert spread.step_K == pytest.approx((min(steps), max(steps)), abs=0.05)

    @pytest.mark.parametrize("name", ["qst-tcs2", "closed-loop-controller"])
    def test_a_loop_leaves_none_open(self, name: str) -> None:
        assert open_loop_spread(deliver(STEP, RIG, Device.load(name))) is None
