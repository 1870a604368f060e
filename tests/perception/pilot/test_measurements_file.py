"""The table of thresholds, reaction times and ratings: what is read, and what is refused with which words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.builders import messages
from thermicon.circuit import Rig
from thermicon.perception.pilot.measurements_file import is_measurements, read_measurements
from thermicon.perception.pilot.trials_file import TrialsError

HEAD = "participant,kind,method,channel,size_K,value,unit,standard_error,trials,baseline_C\n"
GOOD = "P1,threshold,limits,cold,,1.2,K,0.1,,\nP1,reaction_time,,warm,6,850,ms,,12,31\nP2,rating,,warm,6,40,points,,,\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "values.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_values_units_defaults_and_gaps_are_read(tmp_path: Path, rig: Rig) -> None:
    found = read_measurements(written(tmp_path, HEAD + GOOD), rig)
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


def test_a_table_of_measurements_is_recognised_by_its_header(tmp_path: Path) -> None:
    assert is_measurements(written(tmp_path, HEAD + GOOD))
    assert is_measurements(written(tmp_path, "participant;kind;channel\n"))
    assert not is_measurements(written(tmp_path, "participant,trial,presented,responded\n"))


MESSAGES = messages(__file__)


@pytest.mark.parametrize("row", MESSAGES["measurements"])
def test_each_mistake_is_named_with_its_line_and_cure(tmp_path: Path, rig: Rig, row: str) -> None:
    path = written(tmp_path, HEAD + GOOD + (row if "12,1.4" in row else row.replace("P1,", "P9,")) + "\n")
    with pytest.raises(TrialsError, match=rf"values\.csv:5: .*{MESSAGES['measurements'][row]}"):
        read_measurements(path, rig)


def test_a_missing_or_misspelt_column_is_named(tmp_path: Path, rig: Rig) -> None:
    with pytest.raises(TrialsError, match=r"columns missing: channel, unit; found: participant, kind, value"):
        read_measurements(written(tmp_path, "participant,kind,value\nP1,rating,3\n"), rig)
    head = HEAD.replace("standard_error", "standard_eror")
    with pytest.raises(TrialsError, match=r"no column 'standard_eror'; did you mean standard_error"):
        read_measurements(written(tmp_path, head + GOOD), rig)
