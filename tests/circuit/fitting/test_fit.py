"""Fits of synthetic logs."""

from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, Trace, fit, simulate, simulate_current
from thermicon.circuit.fitting.identify import half_width
from thermicon.circuit.fitting.keys import FitError
from thermicon.circuit.fitting.log import Log, LogError
from thermicon.circuit.fitting.notes import milli
from thermicon.circuit.fitting.overlay import best_shift_s, overlay
from thermicon.circuit.fitting.rig_fit import RigFit
from thermicon.circuit.fitting.runs import Channel
from thermicon.circuit.fitting.solve import alike, huber
from thermicon.circuit.fitting.synthetic_log import calibration_icon, synthetic_log

from .conftest import TRUTH, altered

KEYS = list(TRUTH)


@pytest.fixture(scope="module")
def fitted(log: Log, thenar: Rig) -> RigFit:
    return fit(log, thenar, free=KEYS, fixed_skin=True)


def holds(found: RigFit, truth: dict[str, float], slack: float = 1.5) -> None:
    """Every truth lies within 1.5 half widths, which white noise leaves about once in 300."""
    for key, value in truth.items():
        item = found[key]
        low, high = item.value - slack * (item.value - item.low), item.value + slack * (item.high - item.value)
        assert low <= value <= high, found


def test_contact_and_module_are_found_from_display_and_voltage(fitted: RigFit, log: Log) -> None:
    holds(fitted, TRUTH)
    assert fitted.converged and not fitted.unidentified
    assert fitted["contact.resistance_m2K_per_W"].half_width < 0.03
    assert all(fitted[key].half_width < 0.01 for key in KEYS[1:])
    display, voltage = fitted.channels
    assert display.rms == pytest.approx(0.02, rel=0.1)
    assert voltage.rms == pytest.approx(0.005, rel=0.1)
    assert abs(display.largest) > 2 * display.rms and display.run == log.name
    assert fitted.notes == ()
    frame = fitted.to_frame()
    assert list(frame["key"]) == KEYS
    assert (frame["low"] < frame["value"]).all() and (frame["value"] < frame["high"]).all()
    assert np.allclose(np.diag(fitted.correlation), 1.0)
    with pytest.raises(KeyError, match=r"colour was not fitted; fitted were contact\.resistance_m2K_per_W, module"):
        fitted["colour"]


def test_ambient_and_rest_cannot_be_separated_and_both_are_named(log: Log, thenar: Rig, true_rig: Rig) -> None:
    found = fit(log, true_rig, free=["ambient.temperature_C", "skin.rest_C", KEYS[0]])
    ambient, rest = found.unidentified
    assert (ambient.key, rest.key) == ("ambient.temperature_C", "skin.rest_C")
    assert ambient.cure == "cannot be separated from skin at rest here; measure it directly: a thermometer in the room"
    assert found.correlation[0, 1] > 0.99
    assert found.rig.uncertainty.ambient_K == thenar.uncertainty.ambient_K
    holds(found, {KEYS[0]: TRUTH[KEYS[0]]})


@pytest.mark.slow
def test_the_measurement_that_would_help_is_named_with_its_gain(true_rig: Rig) -> None:
    log = synthetic_log(true_rig, seed=5, rate_Hz=20.0, columns=["display_C"])
    hot = "module.hot_plate_J_per_K"
    plates = [hot, "module.cold_plate_J_per_K"]
    sink = ["heat_sink.resistance_K_per_W", "heat_sink.temperature_C"]
    free = [*KEYS, "module.thermal_resistance_K_per_W", *plates, *sink]
    found = fit(log, true_rig, free=free, fixed_skin=True)
    assert hot in {item.key for item in found.unidentified}
    assert "log hot_plate_C as well: it would then be known to about ±" in found[hot].cure
    more = synthetic_log(true_rig, seed=5, rate_Hz=20.0, columns=["display_C", "hot_plate_C"])
    better = fit(more, true_rig, free=free, fixed_skin=True)
    assert better[hot].identified
    holds(better, {hot: 2.6})


@pytest.mark.slow
def test_two_clocks_one_shifted_and_one_that_drifts(true_rig: Rig, thenar: Rig, log: Log) -> None:
    columns = dict(log.columns)
    electric = {name: columns[name] for name in ("current_A", "voltage_V")}
    drive = Log.of("daq.csv", {"time_s": log.time_s, **electric})
    time = (log.time_s[40:] + 812.3) / (1 + 1e-4)
    meter = Log.of("thermometer.csv", {"time_s": time, "display_C": columns["display_C"][40:]})
    found = fit([drive, meter], thenar, free=KEYS)
    holds(found, TRUTH)
    assert found.notes[-1].startswith("thermometer.csv: its clock was shifted by −812.")
    assert found.sources == (("daq.csv", ""), ("thermometer.csv", ""))
    wrong = Log.of("thermometer.csv", {"time_s": log.time_s * 1.01, "display_C": columns["display_C"]})
    with pytest.raises(LogError, match=r"thermometer.csv: its clock drifts, (0.99|1) % fast against daq.csv; correct"):
        fit([drive, wrong], thenar, free=KEYS)


@pytest.mark.slow
def test_several_runs_share_the_rig(true_rig: Rig, thenar: Rig, log: Log) -> None:
    again = synthetic_log(true_rig, seed=4, rate_Hz=20.0, name="second.csv")
    both, alone = (fit(each, thenar, free=KEYS, fixed_skin=True) for each in ([log, again], log))
    holds(both, TRUTH)
    assert both[KEYS[2]].half_width < 0.85 * alone[KEYS[2]].half_width  # of contact both share the error of the mesh
    assert {each.run for each in both.channels} == {"synthetic.csv", "second.csv"}


def test_gaps_and_wild_rows_do_little_harm(log: Log, thenar: Rig) -> None:
    display, random = np.array(log.column("display_C")), np.random.default_rng(2)
    display[300:420] = np.nan
    display[random.choice(len(display), 12, replace=False)] += 5.0
    found = fit(altered(log, display_C=display), thenar, free=KEYS, fixed_skin=True)
    holds(found, TRUTH, slack=2.0)


def test_a_sensor_that_is_off_is_fitted_and_named(log: Log, thenar: Rig) -> None:
    found = fit(altered(log, display_C=log.column("display_C") + 0.6), thenar, free=KEYS)
    assert found.channels[0].offset_K == pytest.approx(0.6, abs=0.3)
    assert not any(item.identified for item in found.parameters)
    assert found.notes[0].startswith("rig.csv: display_C reads +0.")
    assert found.notes[0].endswith("calibrate it, or say by how much it may be off (--offset K)")


@pytest.mark.slow
@pytest.mark.parametrize("off_K", [-1.5, 1.5])
def test_a_sensor_that_is_said_to_be_off_leaves_the_truth_in_the_intervals(
    log: Log, true_rig: Rig, thenar: Rig, off_K: float
) -> None:
    keys = [*TRUTH, "heat_sink.temperature_C", "ambient.temperature_C"]
    found = fit(altered(log, display_C=log.column("display_C") + off_K), thenar, free=keys, offset_K=2.0)
    assert found.channels[0].offset_K == pytest.approx(off_K, abs=0.7)
    truth = {**TRUTH, "heat_sink.temperature_C": true_rig.heat_sink.temperature_C}
    holds(found, truth | {"ambient.temperature_C": true_rig.ambient.temperature_C})


@pytest.mark.slow
def test_a_command_can_drive_in_place_of_the_current(true_rig: Rig, log: Log) -> None:
    columns = {"time_s": log.time_s, **dict(log.columns)}
    command = {**columns, "command_V": columns["current_A"] / 0.15}
    del command["current_A"]
    gain = "driver.transconductance_A_per_V"
    gained = fit(Log.of("command.csv", command), true_rig.with_(**{gain: 0.14}), free=[gain])
    holds(gained, {gain: 0.15}, slack=3.0)
    assert gained.rig.uncertainty.gain_relative == 0.05


@pytest.mark.slow
def test_a_start_that_is_not_steady(true_rig: Rig, thenar: Rig) -> None:
    log = synthetic_log(true_rig, seed=6, rate_Hz=20.0)
    late = log.time_s >= 6.0
    cut = Log.of("late.csv", {"time_s": log.time_s[late], **{name: value[late] for name, value in log.columns}})
    assert any("log a few seconds of rest first" in note for note in fit(cut, thenar, free=KEYS).notes)


@pytest.mark.slow
def test_the_lag_of_a_thermistor(thenar: Rig) -> None:
    sensor = [{"name": "thermistor", "place": "display", "lag_s": 0.05}]
    rig = thenar.with_(probe=sensor)
    slow = rig.with_(**{"probe.thermistor.lag_s": 0.3})
    made = synthetic_log(slow, seed=7, rate_Hz=20.0, columns=["probe_thermistor_C"])
    log = Log.of("slow.csv", {"time_s": made.time_s, "current_A": made.column("current_A"),
                              "display_C": made.column("probe_thermistor_C")})  # fmt: skip
    found = fit(log, rig, free=["probe.thermistor.lag_s"])
    assert found["probe.thermistor.lag_s"].value == pytest.approx(0.3, abs=0.03)
    loop = {"kp_A_per_K": 0.5, "ki_A_per_Ks": 0.1, "lag_s": 0.1}
    controlled = fit(log, thenar.with_(**{f"controller.{key}": value for key, value in loop.items()}),
                     free=["controller.lag_s"])  # fmt: skip
    assert controlled["controller.lag_s"].value == pytest.approx(0.3, abs=0.03)


def test_a_module_given_by_data_sheet_becomes_parameters(log: Log, thenar: Rig, tmp_path: Path) -> None:
    named = thenar.with_(**{"module.name": "TEC1-12706", "driver.current_limit_A": 2.0})
    begin = {"module.seebeck_V_per_K", "module.resistance_ohm", "module.thermal_resistance_K_per_W"}
    made = synthetic_log(named, seed=9, rate_Hz=20.0)
    found = fit(made, named, free=sorted(begin))
    path = tmp_path / "rig.toml"
    found.save(path)
    assert Rig.load(path).module.seebeck_V_per_K == pytest.approx(named.module.seebeck_V_per_K, rel=0.01)
    with pytest.raises(FitError, match=r"cannot write .*absent.rig\.toml: No such file or directory"):
        found.save(tmp_path / "absent" / "rig.toml")


def test_residuals_that_are_alike_widen_the_intervals(true_rig: Rig, thenar: Rig, log: Log) -> None:
    other_skin = true_rig.with_(**{"skin.layer.dermis.thickness_mm": 0.6, "skin.layer.subcutis.thickness_mm": 6.0})
    foreign = synthetic_log(other_skin, seed=3, rate_Hz=20.0)
    found, plain = (fit(each, thenar, free=KEYS, fixed_skin=True) for each in (foreign, log))
    assert found[KEYS[0]].half_width > 1.5 * plain[KEYS[0]].half_width
    assert any("neighbouring residuals are alike" in note for note in found.notes)


@pytest.fixture(scope="module")
def trace(true_rig: Rig) -> Trace:
    return simulate(calibration_icon(), true_rig, rate_Hz=20.0)


@pytest.mark.parametrize("shift", [-1000.0, 0.37, 12.0])
def test_the_shift_of_a_clock_is_found(shift: float, log: Log, trace: Trace) -> None:
    later = {name: column[7:] for name, column in log.columns}  # begins between two shifts of the search
    found = overlay(trace, Log.of("late.csv", {"time_s": log.time_s[7:] - shift, **later}))
    assert found.shift_s == pytest.approx(shift, abs=0.002)
    display = next(each for each in found.columns if each.column == "display_C")
    assert display.rms == pytest.approx(float(np.mean(display.difference**2)) ** 0.5)
    assert abs(display.largest) == pytest.approx(float(np.abs(display.difference).max()))


@pytest.mark.parametrize("since_s", [0.0, 1.7e9])
def test_a_log_in_seconds_of_any_clock_keeps_its_first_and_last_row(since_s: float, true_rig: Rig) -> None:
    trace = simulate_current(Drive(np.array([0.0, 12.4]), np.array([0.1, 0.1])), true_rig, rate_Hz=20.0)
    log = Log.of("clock.csv", {"time_s": trace.time_s + since_s, "display_C": trace.display_C})
    for shift_s, lost in ((-since_s, 0), (1e-3 - since_s, 1), (-1e-3 - since_s, 1)):
        (display,) = overlay(trace, log, shift_s=shift_s).columns
        assert len(display.time_s) == len(trace.time_s) - lost


def test_a_shift_can_be_given_and_must_overlap(log: Log, trace: Trace) -> None:
    assert overlay(trace, log, shift_s=0.5).shift_s == 0.5
    with pytest.raises(LogError, match="no row at a time of the trace, 0 to 60 s, with a shift of 500 s; check time_s"):
        overlay(trace, log, shift_s=500.0)
    commands = Log.of("a.csv", {"time_s": log.time_s, "command_V": log.column("current_A")})
    with pytest.raises(LogError, match=r"a.csv: no column in common with the trace of calibration; the log has comm"):
        overlay(trace, commands)


def test_noise_and_likeness_of_rows_are_those_of_known_series() -> None:
    random, time = np.random.default_rng(0), np.arange(600) / 10
    assert (alike(random.normal(size=500)), round(alike(np.sin(np.arange(500) / 30)), -1)) == (1.0, 60.0)
    row = np.zeros(500)
    for k, noise in enumerate(random.normal(size=499), 1):
        row[k] = 0.2 * row[k - 1] + noise
    assert alike(row) == pytest.approx(1.2 / 0.8, rel=0.15)
    assert np.diff([huber(np.array([size])) for size in (0.0, 2.0, 3.0, 4.0, 9.0)]).tolist() == [4.0, 5.0, 6.0, 30.0]
    slow = Channel("display_C", "a.csv", 0, time, np.sin(time / 5) + 0.02 * random.standard_normal(600))
    assert slow.noise == pytest.approx(0.02, rel=0.1)
    shift, same = best_shift_s(time[:300], np.sin(time[:300] / 3), time[:300], np.sin((time[:300] + 1.3) / 3))
    assert (round(shift, 2), round(same, 3)) == (1.3, 1.0)
    assert best_shift_s(time[:50], np.ones(50), time[:50], np.sin(time[:50])) == (0.0, 0.0)
    assert half_width(False, 1.0) == 1.96 and half_width(True, 0.1) == pytest.approx(np.exp(0.196) - 1)
    assert (milli(0.0344, "V"), milli(-1.23, "K")) == ("34.4 mV", "−1.23 K")
