"""Errors of logs with their place and cure."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.builders import messages
from thermicon.circuit import Rig
from thermicon.circuit.fitting.fit import fit
from thermicon.circuit.fitting.keys import FitError, fittable, free_keys, value_of
from thermicon.circuit.fitting.log import Log, LogError, read_log
from thermicon.circuit.fitting.overlay import aligned, check_clocks, check_sensors
from thermicon.circuit.fitting.problem import FitProblem
from thermicon.circuit.fitting.runs import runs_of
from thermicon.circuit.fitting.synthetic_log import write_log

from .conftest import altered

MESSAGES = messages(__file__)
CONTACT = ["contact.resistance_m2K_per_W"]
TIME = np.arange(100) / 10
PLAIN = {"time_s": TIME, "current_A": 0.1 + 0.3 * (TIME > 2), "display_C": np.full(100, 32.0)}
ALONE = Log.of("drive.csv", {"time_s": TIME, "current_A": PLAIN["current_A"]})
METER = Log.of("meter.csv", {"time_s": TIME, "display_C": PLAIN["display_C"]})


def changed(**columns: object) -> dict[str, object]:
    return {**PLAIN, **columns}


def at(row: int, value: float, column: str = "time_s") -> np.ndarray:
    values = np.array(PLAIN[column], dtype=float)
    values[row] = value
    return values


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"current_A": TIME}, r"the column time_s \(time in s\) is missing; found current_A"),
        (changed(display_C=[32.0] * 99), "unequal lengths: time_s has 100 rows, display_C has 99; cut the longer"),
        ({"time_s": TIME, "display_C": [np.nan] * 100}, "no column of a log; needed is .*, with numbers in it; found"),
        (changed(time_s=at(50, 2.0)), "row 51: time_s 2 s .* after 4.9 s; .*increase: this row is out of place"),
        (changed(time_s=at(7, np.nan)), "row 8: time_s is empty; remove the row"),
        (changed(time_s=TIME * 1000), "steps of 100 over 9900: these look like milliseconds; divide the column by"),
        (changed(time_s=TIME * 100000), "steps of 10000 s; a fit needs rows at most 2 s apart: log faster"),
        (changed(display_C=[305.2] * 100), r"305.2: .* kelvin .32.\d.* or tenths of °C .30.5.*subtract 273.15 or"),
        (changed(display_C=[89.6] * 100), "median of 89.6: these look like °F .*; subtract 32 and divide by 1.8 to"),
        (changed(display_C=[-273.0] * 100), "reads -273 °C in 100 % of its rows: a sensor that is unplugged"),
        (changed(current_A=[400.0] * 100), "reaches 400 A, above 50 A: it looks like milliamperes; divide it by 1000"),
        (changed(voltage_V=[4000.0] * 100), "reaches 4000 V, above 200 V: it looks like millivolts"),
        ({"time_s": TIME, "pressure": TIME}, "no column of a log; needed is one of current_A, com.*found time_s, pr"),
        (changed(time_s=at(99, 1e308)), r"time_s reaches 1e\+308, beyond the 1e\+38 that any"),
        (changed(display_C=at(99, 1e308, "display_C")), r"display_C reaches 1e\+308, beyond the 1e\+38 that any"),
        ({"time_s": TIME[:5], "current_A": TIME[:5]}, "5 rows; a fit needs at least 20"),
        ({"time_s": range(1_000_001), "current_A": range(1_000_001)}, "1,000,001 rows; the limit is 1,000,000"),
    ],
)  # fmt: skip
def test_a_log_that_cannot_be_one_is_refused(columns: Mapping[str, Sequence[float]], message: str) -> None:
    with pytest.raises(LogError, match=f"rig.csv(: |, ).*{message}"):
        Log.of("rig.csv", columns)


def test_columns_that_are_not_used_are_noted() -> None:
    log = Log.of("rig.csv", {**PLAIN, "pressure_kPa": TIME})
    assert log.notes == ("rig.csv: columns that are not used: pressure_kPa",)
    assert (log.drive, log.measured) == ("current_A", ("display_C",))
    with pytest.raises(KeyError, match=r"no column skin_C in rig\.csv; there is current_A, display_C"):
        log.column("skin_C")


def drive(**columns: object) -> Log:
    return Log.of("rig.csv", changed(**columns))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"current_A": np.where((TIME > 1.5) & (TIME < 4), np.nan, PLAIN["current_A"])},
         r"current_A is not known from 1.5 to 4 s, and differs on both sides \(0.1 and 0.4\)"),
        ({"current_A": np.where(TIME < 1, np.nan, PLAIN["current_A"])}, "current_A is empty until 1 s; cut the rows"),
        ({"current_A": np.full(100, 0.2)}, "current_A is 0.2 in every row: nothing changes"),
        ({"current_A": np.where(TIME > 3, np.nan, PLAIN["current_A"])}, "current_A is known for 3 s; a fit needs"),
    ],
)  # fmt: skip
def test_a_drive_must_be_known_throughout(columns: dict[str, object], message: str) -> None:
    with pytest.raises(LogError, match=message):
        runs_of([drive(**columns)])


def test_a_short_gap_is_bridged_and_a_long_one_under_a_constant_drive() -> None:
    current = np.where((TIME > 4) & (TIME < 8), np.nan, PLAIN["current_A"])
    run = runs_of([drive(current_A=current)])[0]
    assert len(run.time_s) == np.isfinite(current).sum()
    assert runs_of([drive(current_A=at(0, np.nan, "current_A"))])[0].begin_s == 0.1


def test_a_skin_that_seems_to_move_a_little_more_than_the_display_is_not_exchanged() -> None:
    assert runs_of([drive(display_C=32 + 0.30 * (TIME > 2), skin_C=32 + 0.33 * (TIME > 2))])
    with pytest.raises(LogError, match="exchange both columns"):
        runs_of([drive(display_C=32 + 0.30 * (TIME > 2), skin_C=32 + 0.39 * (TIME > 2))])


def test_logs_without_a_drive_or_without_a_sensor(thenar: Rig) -> None:
    with pytest.raises(LogError, match=r"no log has a drive: one of current_A or com.*meter.csv has display_C"):
        runs_of([METER])
    with pytest.raises(LogError, match=r"drive.csv: nothing measured beside the drive; log display_C, and voltage_V"):
        runs_of([ALONE])
    with pytest.raises(LogError, match="no log; name one or several files"):
        fit([], thenar, free=CONTACT)
    run = runs_of([ALONE, METER])[0]
    assert (run.clocks, run.channels[0].clock) == (("meter.csv",), 1)


def problem_of(log: Log, rig: Rig) -> FitProblem:
    return FitProblem.of(rig, free_keys(CONTACT, rig), runs_of([log]))


@pytest.mark.parametrize("part", [slice(None), slice(200, 700)])
def test_a_sensor_that_is_stuck_is_named_with_its_times(part: slice, log: Log, thenar: Rig) -> None:
    values = np.array(log.column("display_C"))
    values[part] = 30.0
    with pytest.raises(LogError, match=r"rig.csv: display_C reads 30 from .* s without any change, while the rig"):
        check_sensors(problem_of(altered(log, display_C=values), thenar))


def test_a_sensor_in_the_room_and_the_wrong_sign_are_named(log: Log, thenar: Rig) -> None:
    room = 24.0 + np.random.default_rng(0).normal(0.0, 0.02, len(log.time_s))
    with pytest.raises(LogError, match=r"display_C changes by 0.0\d+ K where the rig changes by \d.*unplugged, or not"):
        check_sensors(problem_of(altered(log, display_C=room), thenar))
    with pytest.raises(LogError, match="display_C goes the other way than the rig: positive current cools"):
        check_sensors(problem_of(altered(log, current_A=-log.column("current_A")), thenar))
    with pytest.raises(
        FitError, match=r"rig.csv: cannot be played on the rig to begin with: .* under 40.09 A; use less current"
    ):
        fit(altered(log, current_A=40.0 + log.column("current_A")), thenar, free=CONTACT)
    with pytest.raises(FitError, match="an offset of -1 K is not possible for a sensor; give 0 to 10 K"):
        fit(log, thenar, free=CONTACT, offset_K=-1.0)


GOOD = "time_s,current_A,display_C\n" + "".join(f"{k / 10:g},0.1,{32.0 + k / 100:g}\n" for k in range(40))


def saved(folder: Path, text: str) -> Path:
    (folder / "rig.csv").write_bytes(text.encode())
    return folder / "rig.csv"


@pytest.mark.parametrize(("change", "message"), MESSAGES["table"].items())
def test_a_table_that_is_no_log_is_refused_with_its_line(change: str, message: str, tmp_path: Path) -> None:
    text = GOOD.replace(*json.loads(change)) if change.startswith("[") else change
    with pytest.raises(LogError, match=f"rig.csv.*{message}"):
        read_log(saved(tmp_path, text))


@pytest.mark.parametrize("unit", ["s", "timedelta", "datetime"])
def test_the_index_of_a_table_of_pandas_may_hold_its_times(unit: str) -> None:
    seconds = np.arange(40) / 10
    index = {"s": pd.Index(seconds), "timedelta": pd.to_timedelta(seconds, "s"),
             "datetime": pd.Timestamp("2026-03-02 23:59:58") + pd.to_timedelta(seconds, "s")}[unit]  # fmt: skip
    frame = pd.DataFrame({"current_A": 0.1, "display_C": 32 + seconds / 10}, index=index)
    assert read_log(frame).time_s - read_log(frame).time_s[0] == pytest.approx(seconds)
    filtered = frame.reset_index(names="time_s")[::2]
    assert read_log(filtered).time_s[1] - read_log(filtered).time_s[0] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("form", "message"), [("{}", "look like milliseconds"), ("0:{:02d}:00", "60 s apart|log faster")]
)
def test_numbers_may_be_milliseconds_and_a_clock_is_what_it_says(tmp_path: Path, form: str, message: str) -> None:
    rows = "".join(f"{form.format(k if ':' in form else 60 * k)},0.1,{32 + k / 100:g}\n" for k in range(40))
    with pytest.raises(LogError, match=message):
        read_log(saved(tmp_path, f"time_s,current_A,display_C\n{rows}"))


def test_gaps_are_empty_cells_or_nan_or_missing_cells(tmp_path: Path) -> None:
    text = GOOD.replace(",32.05", ",").replace("32.06", "NaN").replace(",32.07", "")
    assert np.isnan(read_log(saved(tmp_path, text)).column("display_C")).sum() == 3


def test_a_file_that_is_too_large_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thermicon.circuit.fitting.log.MOST_MB", 1e-4)
    with pytest.raises(LogError, match=r"0 MB is too large for a log; the limit is 0.0001 MB"):
        read_log(saved(tmp_path, GOOD))
    with pytest.raises(LogError, match=r"nothing.csv: no such log"):
        read_log("nothing.csv")


def test_a_written_log_is_read_back(log: Log, tmp_path: Path) -> None:
    write_log(log, tmp_path / "a.csv")
    assert np.allclose(read_log(tmp_path / "a.csv").column("display_C"), log.column("display_C"), atol=1e-6)


@pytest.mark.parametrize("keys", MESSAGES["keys"])
def test_a_key_that_cannot_be_fitted_is_named_with_a_cure(keys: str, thenar: Rig) -> None:
    with pytest.raises(FitError, match=MESSAGES["keys"][keys]):
        free_keys(keys.split(",") if keys else [], thenar)


def test_each_rig_offers_its_own_keys(thenar: Rig) -> None:
    sensed = thenar.with_(probe=[{"name": "thermistor", "place": "display", "lag_s": 0.2}])
    assert fittable(sensed)[-1] == "probe.thermistor.lag_s"
    assert value_of(sensed, "probe.thermistor.lag_s") == 0.2
    assert fittable(Rig.load("tcs2")) == ("contact.resistance_m2K_per_W", "skin.rest_C")
    assert all(value_of(thenar, key) is not None for key in fittable(thenar))


@pytest.mark.parametrize(("after_s", "fits"), [(30.0, True), (90.0, False)])
def test_half_of_what_a_thermometer_read_must_lie_within_the_run(
    after_s: float, fits: bool, log: Log, true_rig: Rig
) -> None:
    electric = Log.of("daq.csv", {"time_s": log.time_s, "current_A": log.column("current_A")})
    display = np.append(log.column("display_C"), np.full(round(20 * after_s), log.column("display_C")[-1]))
    meter = Log.of("meter.csv", {"time_s": 100.0 + np.arange(len(display)) / 20, "display_C": display})
    if fits:
        assert aligned(true_rig, runs_of([electric, meter]))[0].shifts == pytest.approx((-100.0,), abs=0.01)
        return
    with pytest.raises(LogError, match=r"meter.csv: does not fit in time to daq.csv, which lasts 60 s"):
        aligned(true_rig, runs_of([electric, meter]))


def test_a_clock_of_another_rate_is_named(thenar: Rig) -> None:
    problem = FitProblem.of(thenar, free_keys(CONTACT, thenar), runs_of([ALONE, METER]))
    drift = [item.kind for item in problem.unknowns].index("drift")
    theta = problem.first.copy()
    theta[drift] = 0.0019
    check_clocks(problem, theta)
    theta[drift] = -0.0021
    with pytest.raises(LogError, match=r"meter.csv: its clock drifts, 0.21 % fast against drive.csv; correct its"):
        check_clocks(problem, theta)
    with pytest.raises(LogError, match=r"meter.csv: does not fit in time to drive.csv, which lasts 9.9 s: no shift"):
        aligned(thenar, problem.runs)
