"""Fits with a partly or wholly unknown drive."""

from dataclasses import replace

import numpy as np
import pytest

from thermicon.circuit import Rig, fit
from thermicon.circuit.fitting.between import noise_sd, one_phase, tells_all, unknown_display
from thermicon.circuit.fitting.forward import predict, steady_level
from thermicon.circuit.fitting.keys import COMMON, CONTACT, FitError, free_keys
from thermicon.circuit.fitting.log import Log, LogError
from thermicon.circuit.fitting.problem import FitProblem
from thermicon.circuit.fitting.runs import runs_of
from thermicon.circuit.fitting.synthetic_log import synthetic_log
from thermicon.circuit.fitting.whiten import shared

from .conftest import TRUTH, altered

OHM, PROBE = COMMON[2], {"name": "deep", "place": "skin", "depth_mm": 0.3}


def every(log: Log, step: int, begin: int = 0, **columns: np.ndarray) -> Log:
    """Every so many rows of a log, with other columns."""
    values = {"time_s": log.time_s, **dict(log.columns), **columns}
    return Log.of("rows.csv", {name: value[begin::step] for name, value in values.items()})


@pytest.fixture(scope="module")
def fast(true_rig: Rig) -> Log:
    """A log of a driver that changes 100 times a second."""
    return synthetic_log(true_rig, seed=3)


@pytest.mark.slow
def test_rows_coarser_than_the_driver_hold_the_truth_and_narrow_nothing(fast: Log) -> None:
    rig = Rig.load("thenar")
    coarse, told = fit(every(fast, 20, 3), rig, free=COMMON), fit(every(fast, 1), rig, free=COMMON)
    for key, value in TRUTH.items():
        assert coarse[key].low < value < coarse[key].high, coarse
    assert any("rows are 200 ms apart, and the rig's driver may change every 10 ms" in note for note in coarse.notes)
    assert coarse[OHM].half_width > 3 * told[OHM].half_width and not coarse.misfit
    for name in ("contact_resistance_relative", "seebeck_relative"):
        before, after = getattr(rig.uncertainty, name), getattr(coarse.rig.uncertainty, name)
        assert getattr(told.rig.uncertainty, name) < before <= after
    assert coarse.notes[-1].startswith("the drive is known at points only, so that the uncertainty")


def test_slow_sensors_beside_a_fast_current_are_no_slow_log(fast: Log) -> None:
    rig, sensors = Rig.load("thenar"), np.arange(len(fast.time_s)) % 50 > 0
    slow = {name: np.where(sensors, np.nan, fast.column(name)) for name in ("display_C", "voltage_V")}
    found = fit(every(fast, 1, **slow), rig, free=COMMON, fixed_skin=True)
    assert all(found[key].low < value < found[key].high for key, value in TRUTH.items()), found
    assert found.rig.uncertainty.seebeck_relative < rig.uncertainty.seebeck_relative


def test_what_rows_tell_of_a_driver() -> None:
    time, climb = np.arange(200) / 100.0, np.arange(200.0)
    for rate, told in ((100.0, True), (67.0, False), (149.0, True), (151.0, False), (80.0, False), (50.0, True)):
        assert tells_all(time, climb, rate) is told, rate
    assert not tells_all(time, np.floor(0.8 * climb), 100.0)  # a loop at 80 Hz repeats every fifth row
    assert tells_all(time, np.floor(climb / 50), 100.0)  # levels stand still
    for jump, told in ((15.0, False), (25.0, True)):  # beside a jump, steps of a twentieth are steep
        assert tells_all(time, np.floor(0.8 * climb) + jump * (climb > 100), 100.0) is told
    rows = np.arange(4000.0)
    noise, bend = np.random.default_rng(1).normal(0.0, 0.02, 4000), 3.0 * np.sin(rows / 40)
    assert noise_sd(rows, bend + noise, 0.0) == pytest.approx(0.02, rel=0.1)
    assert noise_sd(rows[:50], np.zeros(50), 0.5) == pytest.approx(0.5 / 12**0.5)
    assert np.median(unknown_display(rows, noise)) == pytest.approx(0.02, rel=0.25)
    steps = np.repeat([0.0, 1.0, 0.5], 100)
    wrong = one_phase(np.arange(300) / 10, steps, 32.0 - 2 * np.clip(np.arange(300) - 100, 0, 50) / 10)
    assert np.abs(wrong).max() == pytest.approx(0.5)
    assert np.flatnonzero(np.abs(wrong) > 0.25)[[0, -1]] == pytest.approx([100, 149], abs=2)


def test_a_start_is_steady_until_the_drive_moves_by_more_than_noise() -> None:
    random = np.random.default_rng(2)
    assert steady_level(np.r_[0.1, 0.1, 0.12, np.linspace(0.2, 1.0, 60)]) == pytest.approx(0.1)
    noisy = np.r_[np.full(50, 0.1), np.full(50, 0.4)] + random.normal(0.0, 0.01, 100)
    assert steady_level(noisy) == pytest.approx(0.1, abs=0.01)
    assert steady_level(np.r_[0.1, np.full(60, 0.5)]) == 0.1, "a log whose only step is that to its second row"


def test_a_noisy_start_is_simulated_from_its_level_and_not_from_its_first_row(thenar: Rig) -> None:
    """Of a current and, where only the skin is measured, of a display."""
    time_s, noise = np.arange(400) / 20.0, np.tile([0.05, -0.05], 200)
    for column, level, measured in (("current_A", 0.1, "display_C"), ("display_C", 32.0, "skin_C")):
        drive = np.where(time_s < 10.0, level, level + 0.4)
        log = {"time_s": time_s, measured: np.linspace(32.0, 31.9, 400)}
        plain, noisy = (
            runs_of([Log.of("a.csv", {**log, column: values})], thenar)[0] for values in (drive, drive + noise)
        )
        first = [predict(thenar, run).at(measured, np.zeros(1))[0] for run in (plain, noisy)]
        wrong = predict(thenar, replace(plain, drive=plain.drive + 0.05)).at(measured, np.zeros(1))[0]
        assert abs(first[1] - first[0]) < 0.2 * abs(wrong - first[0])


def test_what_is_unknown_of_a_drive_reaches_all_rows_after_it(fast: Log) -> None:
    rig = Rig.load("thenar")
    (run,) = runs_of([every(fast, 20, hot_plate_C=fast.column("display_C"))], rig)
    alike = shared(rig, run, [channel.time_s for channel in run.channels])
    assert alike is not None and runs_of([every(fast, 1)], rig)[0].unknown is None
    spread = np.sqrt(np.diag(alike.covariance[0]))[
        : np.count_nonzero(run.channels[0].time_s <= run.channels[0].time_s[100])
    ]
    first = int(np.argmax(run.unknown > 1e-3))
    assert spread[:first].max(initial=0.0) < 1e-3 < 0.05 < spread[first + 1]
    residuals = np.random.default_rng(0).normal(size=sum(len(channel.values) for channel in run.channels))
    parts = np.split(residuals, np.cumsum([len(channel.values) for channel in run.channels])[:-1])
    white = np.concatenate(alike.independent(parts, (1.0,) * len(parts)))
    for rows, covariance in zip(alike.rows, alike.covariance, strict=True):
        expected = residuals[rows] @ np.linalg.solve(covariance + np.eye(len(rows)), residuals[rows])
        assert white[rows] @ white[rows] == pytest.approx(expected)


@pytest.fixture(scope="module")
def skin(true_rig: Rig) -> Log:
    """What a display and two sensors read, without the current that moved it."""
    log = synthetic_log(
        true_rig.with_(probe=[PROBE]), seed=5, rate_Hz=20.0, columns=["display_C", "skin_C", "probe_deep_C"]
    )
    return Log.of("skin.csv", {"time_s": log.time_s, **dict(log.columns[1:])})


@pytest.mark.slow
def test_without_a_current_the_display_is_the_drive(skin: Log, thenar: Rig) -> None:
    alone = Log.of("skin.csv", {"time_s": skin.time_s, **{name: skin.column(name) for name in ("display_C", "skin_C")}})
    found = fit(alone, thenar)
    assert found.notes[0] == "no keys were named; the logs tell best contact.resistance_m2K_per_W"
    assert found[CONTACT].low < TRUTH[CONTACT] < found[CONTACT].high and found[CONTACT].half_width < 0.3
    assert any(note.startswith("the display is the drive: contact and") for note in found.notes)
    problem = FitProblem.of(thenar, free_keys([CONTACT], thenar, True), runs_of([alone], thenar))
    assert [item.sd for item in problem.unknowns if item.kind == "offset"] == pytest.approx([0.1 * 2**0.5])  # of both
    with pytest.raises(FitError, match=r"seebeck_V_per_K: no log has a current, so that the display is the drive, and"):
        fit(alone, thenar, free=[COMMON[1]])
    with pytest.raises(FitError, match="resistance_ohm: rig tcs2 is a thermode, so that the display is the drive"):
        fit(alone, Rig.load("tcs2"), free=[OHM])
    columns = {name: skin.column(name) for name in ("display_C", "probe_deep_C")}
    depth = Log.of("deep.csv", {"time_s": skin.time_s, **columns})
    deep = fit(depth, Rig.load("tcs2").with_(probe=[PROBE]))
    series = next(note for note in deep.notes if "in series" in note).split("have ")[1].split()
    layer = thenar.skin.layers[0]
    both = TRUTH[CONTACT] + layer.thickness_m / layer.conductivity_W_per_mK
    assert float(series[0]) == pytest.approx(both, rel=0.3)
    assert float(series[2].strip("±")) / 100 < deep[CONTACT].half_width


def test_the_reading_of_a_probe_that_the_rig_lacks_is_named(skin: Log, thenar: Rig) -> None:
    with pytest.raises(
        LogError, match=r"skin.csv: probe_deep_C: rig thenar has no such probe; say where it is by the key probe="
    ):
        fit(skin, thenar)


def test_without_keys_what_the_log_can_tell_is_fitted(log: Log, thenar: Rig) -> None:
    quiet = Log.of(
        "display.csv", {name: log.column(name) for name in ("current_A", "display_C")} | {"time_s": log.time_s}
    )
    both, display = (fit(each, thenar, fixed_skin=True) for each in (log, quiet))
    assert both.notes[0].startswith(f"no keys were named; the logs tell best {', '.join(COMMON)}")
    assert OHM not in {item.key for item in display.parameters} or display[OHM].half_width > 5 * both[OHM].half_width
    assert not both.unidentified
    ax = both.plot()
    assert [len(line.get_ydata()) for line in ax.lines[1:]] == [1201, 1201] and len(
        both.plot(column="voltage_V").lines
    ) == 2


def test_of_a_long_log_five_minutes_with_a_change_are_fitted(log: Log, true_rig: Rig) -> None:
    time = np.arange(20_000) / 20.0
    columns = {name: np.r_[np.full(len(time) - len(value), value[0]), value] for name, value in log.columns}
    (run,) = runs_of([Log.of("long.csv", {"time_s": time, **columns})], true_rig)
    assert (run.begin_s, run.time_s[-1], len(run.time_s)) == pytest.approx((931.95, 68.0, 1361), abs=0.3)
    assert run.notes[0].endswith("to fit another part, cut it out")
    assert (run.channels[0].time_s[0], len(run.channels[0].values)) == (run.begin_s, len(run.time_s))
    rows = {"current_A": np.repeat([0.1, 0.2], 50_000), "display_C": np.linspace(30, 34, 100_000)}
    fine = Log.of("fine.csv", {"time_s": np.arange(100_000) / 1e3, **rows})
    (thin,) = runs_of([fine], true_rig)
    assert len(thin.drive) == 10_001 and len(thin.channels[0].values) <= 8000
    assert thin.drive @ np.diff(thin.time_s, append=99.999) == pytest.approx(0.1 * 50 + 0.2 * 49.999, rel=1e-6)


def test_an_hour_of_whole_numbers_is_asked_for_its_unit(log: Log) -> None:
    rows = np.arange(3601)
    columns = {"current_A": np.where(rows > 9, 0.2, 0.1), "display_C": 32.0 - 1e-3 * rows}
    Log.of("hour.csv", {"time_s": rows, **columns})
    with pytest.raises(
        LogError, match=r"steps of 1 over 3601: these look like milliseconds; divide the column by 1000 to"
    ):
        Log.of(
            "more.csv",
            {"time_s": np.append(rows, 3601), **{name: np.append(value, value[-1]) for name, value in columns.items()}},
        )
    assert altered(log).drive == "current_A"
