"""What is said before measuring, and the drive that is measured with."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Device, Drive, Gate, Rig, export, fit, simulate, simulate_current
from thermicon.circuit.delivery.deliver import deliver
from thermicon.circuit.delivery.device import device_names
from thermicon.circuit.delivery.formats import format_names, load_format
from thermicon.circuit.fitting.keys import COMMON
from thermicon.circuit.fitting.laboratory import calibration_icon, plan, synthetic_log
from thermicon.circuit.fitting.log import Log, read_log
from thermicon.circuit.rig.rig import rig_names

FREE = [*COMMON, "module.thermal_resistance_K_per_W", "module.cold_plate_J_per_K", "module.hot_plate_J_per_K",
        "heat_sink.temperature_C", "heat_sink.resistance_K_per_W"]  # fmt: skip


def test_display_and_voltage_identify_what_the_display_alone_does_not() -> None:
    alone, both, *_ = plan(Rig.load("thenar"), FREE, fixed_skin=True)
    assert (alone.columns, both.columns) == (("display_C",), ("display_C", "voltage_V"))
    assert 0.01 < both.half_widths[0] < 0.04 and max(both.half_widths[1:3]) < 0.01
    assert alone.half_widths[0] > 3 * both.half_widths[0]
    assert not all(alone.identified) and all(both.identified)


def test_a_plan_is_what_a_fit_then_finds() -> None:
    rig = Rig.load("thenar").with_(**{"driver.update_Hz": 10})
    planned = plan(rig, COMMON, offset_K=0.1)[1]
    log = synthetic_log(rig, seed=2, rate_Hz=10.0)
    found = fit(log, rig, free=COMMON)
    for item, width in zip(found.parameters, planned.half_widths, strict=True):
        assert item.half_width == pytest.approx(width, rel=0.25)


def test_the_calibration_drive_is_reached_on_every_rig_with_a_module() -> None:
    icon = calibration_icon()
    assert icon.corners(32.0).duration_s == pytest.approx(60.0)
    rigs = [Rig.load(name) for name in rig_names()]
    assert all(simulate(icon, rig).reachable for rig in rigs)


@pytest.mark.slow
@pytest.mark.parametrize("device", device_names())
def test_the_calibration_drive_is_exported_for_every_device(device: str) -> None:
    rig = "tcs2" if Device.load(device).driven_by == "set-points" else "thenar"
    special = [name for name in format_names() if load_format(name).device == device]
    form = (special or ["csv"])[0]
    result = export(calibration_icon(), rig, device, form)
    assert result.refused == () and len(result.files) >= 2
    assert all(isinstance(each.verdict, Gate) or each.verdict is not None for each in result.prepared)


@pytest.mark.slow
def test_an_exported_drive_and_a_thermometer_of_its_own_clock_make_a_log(tmp_path: Path) -> None:
    rig, icon = Rig.load("thenar"), calibration_icon()
    played = deliver(icon, rig, Device.load("dac-16"))
    (tmp_path / "drive.csv").write_bytes(load_format("csv").write(played))
    drive = read_log(tmp_path / "drive.csv")
    bench = rig.with_(**{"contact.resistance_m2K_per_W": 7e-4})
    trace = simulate_current(
        Drive(drive.time_s - drive.time_s[0], drive.column("current_A"), held=True), bench, rate_Hz=20
    )
    noise = np.random.default_rng(0).normal(0.0, 0.02, len(trace.time_s))
    meter = Log.of("meter.csv", {"time_s": trace.time_s + 100.0, "display_C": trace.display_C + noise})
    found = fit([drive, meter], rig, free=["contact.resistance_m2K_per_W"], fixed_skin=True)
    assert found["contact.resistance_m2K_per_W"].value == pytest.approx(7e-4, rel=0.01)
    assert found.notes[-1].startswith("meter.csv: its clock was shifted by −100.0")
