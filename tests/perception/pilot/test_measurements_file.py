"""The table of thresholds, reaction times and ratings: what is read, and what is refused with which words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.perception.pilot.madeup import synthetic_measurements
from thermicon.circuit import Rig
from thermicon.perception.pilot.measurements_file import Measurements, is_measurements, read_measurements
from thermicon.perception.pilot.trials_file import TrialsError

HEAD = "participant,kind,method,channel,size_K,value,unit,standard_error,trials,baseline_C\n"
GOOD = "P1,threshold,limits,cold,,1.2,K,0.1,,\nP1,reaction_time,,warm,6,850,ms,,12,31\nP2,rating,,warm,6,40,points,,,\n"


def measurements_text(measured: Measurements) -> str:
    """The measurements as a file that `read_measurements` reads."""
    lines = ["participant,kind,method,channel,size_K,rate_K_per_s,hold_s,baseline_C,value,unit,trials"]
    for name, values, trials in zip(measured.participants, measured.values, measured.trials, strict=True):
        for own, value, count in zip(measured.conditions, values.tolist(), trials.tolist(), strict=True):
            if value == value:
                cells = [name, own.kind, own.method, own.channel, "" if own.size_K is None else f"{own.size_K:g}"]
                cells += [f"{own.rate_K_per_s:g}", f"{own.hold_s:g}", f"{own.baseline_C:g}", f"{value:.4g}", own.unit]
                lines.append(",".join([*cells, f"{count:g}" if count == count else ""]))
    return "\n".join(lines) + "\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "values.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_values_units_defaults_and_gaps_are_read(tmp_path: Path) -> None:
    found = read_measurements(written(tmp_path, HEAD + GOOD), Rig.load("thenar"))
    limits, time, rating = found.conditions
    assert (limits.size_K, limits.rate_K_per_s, limits.baseline_C) == (12.0, 1.0, 32.0)
    assert (time.method, time.rate_K_per_s, time.baseline_C) == ("choice", 5.0, 31.0)
    assert rating.method == "magnitude"
    assert found.values[0, 1] == pytest.approx(0.85)
    assert np.isnan(found.values[0, 2]) and np.isnan(found.values[1, 0])
    assert found.errors[0, 0] == pytest.approx(0.1)
    assert found.trials[0, 1] == 12.0
    assert found.assumed_errors == 1
    assert len(found.digest) == 16


def test_made_up_measurements_are_written_and_read_alike(tmp_path: Path) -> None:
    rig = Rig.load("forearm")
    made = synthetic_measurements(rig, participants=2, seed=4)
    found = read_measurements(written(tmp_path, measurements_text(made)), rig)
    assert found.conditions == made.conditions
    np.testing.assert_allclose(found.values, made.values, rtol=1e-3)
    np.testing.assert_array_equal(found.trials, made.trials)


def test_a_table_of_measurements_is_recognised_by_its_header(tmp_path: Path) -> None:
    assert is_measurements(written(tmp_path, HEAD + GOOD))
    assert is_measurements(written(tmp_path, "participant;kind;channel\n"))
    assert not is_measurements(written(tmp_path, "participant,trial,presented,responded\n"))


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("P1,treshold,limits,cold,,1,K,,,", "treshold.*is not a kind; choose of threshold, reaction_time, rating"),
        ("P1,Reaction time,,cold,6,1,s,,,", "did you mean reaction_time"),
        ("P1,threshold,,cold,,1,K,,,", "method of a threshold is missing.*forced_choice, yes_no, limits"),
        ("P1,threshold,staircase,cold,,1,K,,,", "staircase.*choose of forced_choice"),
        ("P1,threshold,limits,cool,,1,K,,,", "cool.*is not a channel; choose of cold, warm"),
        ("P1,threshold,limits,cold,,1,s,,,", "is not a unit of a threshold; choose of K"),
        ("P1,threshold,limits,cold,,-1,K,,,", "lies within 0.005 to 20 K; thresholds are changes.*without sign"),
        ("P1,threshold,limits,cold,,31,°C,,,", "lies within 0.005 to 20 K; thresholds are changes"),
        ("P1,reaction_time,,cold,6,850,s,,,", "lies within 0.1 to 60 s.*check s against ms"),
        ("P1,reaction_time,,cold,,1,s,,,", "size_K is missing.*timed"),
        ("P1,rating,,cold,6,0,points,,,", "leave out what was not felt"),
        ("P1,threshold,limits,cold,,n/a,K,,,", "value is 'n/a', not a number"),
        ("P1,threshold,limits,cold,2,3,K,,,", "the ramp ends at 2 K"),
        ("P1,threshold,yes_no,cold,2,3,K,,,", "size_K belongs to limits"),
        ("P1,threshold,limits,cold,,1,K,-0.1,,", "standard_error is '-0.1'.*above 0"),
        ("P1,threshold,limits,cold,,1,K,,2.5,", "trials is '2.5', not a whole number"),
        ("P1,threshold,limits,cold,,1,K,,,305", "baseline_C is 305, outside 10 to 45 °C; that looks like kelvin"),
        (",threshold,limits,cold,,1,K,,,", "participant is empty"),
    ],
)
def test_each_mistake_is_named_with_its_line_and_cure(tmp_path: Path, row: str, message: str) -> None:
    path = written(tmp_path, HEAD + GOOD + row.replace("P1,", "P9,") + "\n")
    with pytest.raises(TrialsError, match=rf"values\.csv:5: .*{message}"):
        read_measurements(path, Rig.load("thenar"))


def test_a_value_that_stands_twice_is_refused_with_both_lines(tmp_path: Path) -> None:
    path = written(tmp_path, HEAD + GOOD + "P1,threshold,limits,cold,12,1.4,K,,,\n")
    with pytest.raises(TrialsError, match=r"csv:5: participant 'P1' has cold, limits, 1 K/s twice, also in line 2"):
        read_measurements(path, Rig.load("thenar"))


def test_a_missing_or_misspelt_column_is_named(tmp_path: Path) -> None:
    with pytest.raises(TrialsError, match=r"columns missing: channel, unit; found: participant, kind, value"):
        read_measurements(written(tmp_path, "participant,kind,value\nP1,rating,3\n"), Rig.load("thenar"))
    head = HEAD.replace("standard_error", "standard_eror")
    with pytest.raises(TrialsError, match=r"no column 'standard_eror'; did you mean standard_error"):
        read_measurements(written(tmp_path, head + GOOD), Rig.load("thenar"))
