"""Intervals of a fit as predicted before the measurement."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Device, Drive, Gate, Rig, export, fit, simulate, simulate_current
from thermicon.circuit.delivery.device import device_names
from thermicon.circuit.delivery.formats import format_names, load_format
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.fitting.identify import FittedParameter, cures, identified
from thermicon.circuit.fitting.keys import COMMON, CONTACT, free_keys
from thermicon.circuit.fitting.log import Log, read_log
from thermicon.circuit.fitting.overlay import aligned
from thermicon.circuit.fitting.problem import LAYER_KINDS, FitProblem, changed_layers
from thermicon.circuit.fitting.rig_fit import RigFit
from thermicon.circuit.fitting.runs import runs_of
from thermicon.circuit.fitting.solve import Solution, covariance_of, inverse_of, spreads
from thermicon.circuit.fitting.synthetic_log import calibration_icon, plan, synthetic_log
from thermicon.circuit.rig.rig import rig_names

from .conftest import TRUTH, altered

THICK = {"skin.layer.0.thickness_mm": 0.20}
"""One standard deviation of people more than the rig has."""


@pytest.fixture(scope="module")
def foreign(true_rig: Rig, thenar: Rig) -> RigFit:
    return fit(synthetic_log(true_rig.with_(**THICK), seed=3, rate_Hz=20.0), thenar, free=list(TRUTH))


def test_thicker_skin_does_not_pass_for_contact(foreign: RigFit, true_rig: Rig, thenar: Rig) -> None:
    contact = foreign[CONTACT]
    assert contact.low < TRUTH[CONTACT] < contact.high and contact.half_width > 0.1
    held = foreign.rig.uncertainty.contact_resistance_relative
    assert contact.half_width <= held < thenar.uncertainty.contact_resistance_relative
    assert not foreign.misfit


def test_the_fitted_rig_has_the_skin_that_was_logged(foreign: RigFit, true_rig: Rig, log: Log) -> None:
    drive = Drive(log.time_s, log.column("current_A"), True)
    mine, theirs = (simulate_current(drive, rig, rate_Hz=20.0) for rig in (foreign.rig, true_rig.with_(**THICK)))
    difference = mine.display_C - theirs.display_C
    assert np.abs(difference - difference.mean()).max() < 0.01
    assert "fitted along" in foreign.rig_text("mine")


@pytest.mark.parametrize("times", [1, 100, 1_000_000])
def test_rows_tell_nothing_of_a_key_that_they_do_not_depend_on(times: int, thenar: Rig, log: Log) -> None:
    """So many times the rows, beside a second logger, on whose clock all of them tell most."""
    names = ("time_s", "display_C"), ("time_s", "current_A", "voltage_V")
    columns = {"time_s": log.time_s, **dict(log.columns)}
    second, first = (Log.of("a.csv", {name: columns[name] for name in some}) for some in names)
    keys = free_keys(["module.seebeck_V_per_K", "driver.transconductance_A_per_V"], thenar)
    problem = FitProblem.of(thenar, keys, aligned(thenar, runs_of([first, second])))
    sigma = [0.02 if channel.temperature else 0.005 for _, _, channel in problem.channels()]
    jacobian, rows = problem.jacobian(problem.first, sigma), sum(len(each.values) for _, _, each in problem.channels())
    jacobian[:rows] *= math.sqrt(times)
    seebeck, driver = np.sqrt(np.diag(covariance_of(problem, jacobian, [1.0] * len(sigma))))[:2]
    assert seebeck < 0.01 / math.sqrt(times)
    assert driver == pytest.approx(0.5 * (problem.unknowns[1].high - problem.unknowns[1].low), rel=1e-6)


def test_information_is_inverted_in_the_units_of_each_number() -> None:
    size = np.array([1e-9, 1.0, 1e12])
    alike = np.array([[1.0, 0.5, 0.0], [0.5, 1.0, 0.2], [0.0, 0.2, 1.0]])
    found = inverse_of(alike * np.outer(size, size))
    np.testing.assert_allclose(found * np.outer(size, size), np.linalg.inv(alike), rtol=1e-9, atol=1e-12)
    assert np.array_equal(inverse_of(np.diag([4.0, 0.0])), np.diag([0.25, 0.0]))  # nothing is known of the second


def test_fixed_skin_is_what_the_rig_has(true_rig: Rig, thenar: Rig) -> None:
    log = synthetic_log(true_rig.with_(**THICK), seed=3, rate_Hz=20.0)
    found = fit(log, thenar, free=list(TRUTH), fixed_skin=True)
    assert found.rig.skin == thenar.skin
    assert found[CONTACT].low > TRUTH[CONTACT]  # the layer passes for contact


def test_layers_times_factors_are_what_a_log_sees_of_other_layers(thenar: Rig, log: Log) -> None:
    layer, factors = (
        thenar.skin.layers[1],
        dict(zip(((kind, 1) for kind in LAYER_KINDS), np.log([1.3, 1.2, 1.25]), strict=True)),
    )
    other = {"thickness_mm": 1.3e3 * layer.thickness_m, "conductivity_W_per_mK": 1.2 * layer.conductivity_W_per_mK,
             "heat_capacity_J_per_kgK": 1.25 * layer.heat_capacity_J_per_kgK}  # fmt: skip
    drive, mesh = Drive(log.time_s, log.column("current_A"), True), {"skin.elements": [40] * len(thenar.skin.layers)}
    rigs = (thenar.with_(**mesh, **changed_layers(thenar, factors)),
            thenar.with_(**mesh, **{f"skin.layer.1.{key}": value for key, value in other.items()}))  # fmt: skip
    mine, theirs = (simulate_current(drive, rig, rate_Hz=20.0).display_C for rig in rigs)
    plain = simulate_current(drive, thenar, rate_Hz=20.0).display_C
    assert np.abs(mine - theirs).max() < 2e-3 < 0.02 < np.abs(plain - theirs).max()


def test_the_error_of_the_mesh_is_some_millikelvin(thenar: Rig, log: Log) -> None:
    problem = FitProblem.of(thenar, free_keys([CONTACT], thenar), runs_of([log]))
    display, voltage, rest = np.split(problem.mesh_error(problem.first, [1.0, 1.0]), [1201, 2402])
    assert 5e-4 < np.abs(display).max() < 5e-3 and np.abs(voltage).max() < 1e-3 and not rest.any()
    beyond = problem.residuals(problem.first + 50.0, [1.0, 1.0])  # no rig has a contact of e⁵⁰
    assert beyond.shape == (2402 + len(rest),) and beyond.min() > 100
    own = Rig.load("shani2021")
    stated = FitProblem.of(own, free_keys([CONTACT], own), runs_of([log]))
    assert not stated.mesh_error(stated.first, spreads(stated, stated.first)).any()


@pytest.mark.slow
def test_a_sensor_that_is_far_off_narrows_nothing(log: Log, thenar: Rig) -> None:
    found = fit(altered(log, display_C=log.column("display_C") + 2.3), thenar, free=list(TRUTH))
    before, after = thenar.uncertainty, found.rig.uncertainty
    assert after.contact_resistance_relative >= before.contact_resistance_relative
    assert after.seebeck_relative >= before.seebeck_relative
    assert any("is not narrowed by this fit" in note for note in found.notes)
    assert found.notes[0].endswith("calibrate it, or say by how much it may be off (--offset K)")


@pytest.mark.parametrize(("column", "delay_s"), [("display_C", 0.3), ("voltage_V", 0.15), ("display_C", -0.1)])
def test_a_late_column_is_named_with_its_delay(log: Log, true_rig: Rig, column: str, delay_s: float) -> None:
    moved = np.interp(log.time_s - delay_s, log.time_s, log.column(column))
    found = fit(altered(log, "late.csv", **{column: moved}), true_rig, free=[CONTACT], fixed_skin=True)
    word = "late" if delay_s > 0 else "early"
    told = [re.match(rf"{column} of late.csv is (\S+) s {word} against the other", note) for note in found.notes]
    assert [float(each[1]) for each in told if each] == [pytest.approx(abs(delay_s), rel=0.02)]
    assert found.misfit


def test_a_plan_is_what_a_fit_then_finds() -> None:
    rig = Rig.load("thenar").with_(**{"driver.update_Hz": 10})
    planned = plan(rig, COMMON, offset_K=0.1)[1]
    log = synthetic_log(rig, seed=2, rate_Hz=10.0)
    found = fit(log, rig, free=COMMON)
    for item, width in zip(found.parameters, planned.half_widths, strict=True):
        assert item.half_width == pytest.approx(width, rel=0.25)


@pytest.mark.slow
def test_rounding_is_noise_and_a_truth_out_of_reach_is_not_known(log: Log, thenar: Rig, true_rig: Rig) -> None:
    rounded = altered(log, display_C=np.round(2 * log.column("display_C")) / 2)
    coarse, fine = (fit(each, thenar, free=list(TRUTH), fixed_skin=True) for each in (rounded, log))
    assert coarse[CONTACT].low < TRUTH[CONTACT] < coarse[CONTACT].high
    assert coarse[CONTACT].half_width > 2 * fine[CONTACT].half_width
    far = FitProblem.of(true_rig, free_keys(["skin.rest_C"], true_rig), runs_of([log]))
    for share, known in ((0.999, False), (0.99, True), (-0.999, False), (-0.99, True)):
        theta = far.first.copy()
        theta[0] += share * (far.bounds[1][0] - theta[0])
        small = Solution(theta, 1e-6 * np.eye(len(theta)), (0.02, 0.005), (1.0, 1.0), True)
        (item,), _ = identified(far, small, true_rig)
        assert item.identified is known and bool(item.cure) is not known, share
    contact = FitProblem.of(true_rig, free_keys([CONTACT], true_rig), runs_of([log]))
    for sd, known in ((0.3, True), (0.4, False)):  # fitted a third as large, and known to its own size or not
        less = Solution(
            contact.first - math.log(3.0), sd**2 * np.eye(len(contact.first)), (0.02, 0.005), (1.0, 1.0), True
        )
        (item,), _ = identified(contact, less, true_rig)
        assert (item.identified, item.interval != "unknown") == (known, known), sd
    wide = FittedParameter("a", "a", "", 1.0, 1.0, 0.5, 2.0, True, True)
    assert (wide.half_width, replace(wide, low=0.9, high=1.05).half_width) == pytest.approx((1.0, 0.1))


def test_a_pair_is_named_from_a_correlation_of_nine_tenths_on(log: Log, thenar: Rig) -> None:
    keys = free_keys(["ambient.temperature_C", "skin.rest_C"], thenar)
    problem = FitProblem.of(thenar, keys, runs_of([log]))
    for size, named in ((0.85, False), (0.95, True), (-0.95, True)):
        pair = np.array([[1.0, size], [size, 1.0]])
        assert ("cannot be separated from skin at rest" in cures(problem, problem.first, [0], pair)[0]) is named


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
