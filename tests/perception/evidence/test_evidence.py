"""The evidence loads, says where it is from, and refuses what is wrong with its place."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from thermicon.circuit.records import RecordError
from thermicon.perception.evidence.rows import load_rows
from thermicon.perception.evidence.statistics import DATA, load_evidence, read_evidence


def test_every_statistic_has_an_experiment_an_error_and_a_licence() -> None:
    evidence = load_evidence()
    assert len(evidence.statistics) == 323
    assert {row.experiment for row in evidence.statistics} == {f"E{n}" for n in range(1, 8)}
    assert all(math.isfinite(row.se) for row in evidence.statistics)
    assert all(evidence.experiment(row.experiment).licence for row in evidence.statistics)


def test_log_rows_are_taken_in_logarithms() -> None:
    row = load_evidence().find("E3", "threshold_gm", "cold")
    assert row.scale == "log"
    assert row.place == pytest.approx(math.log(1.476))


def test_an_unknown_statistic_names_its_neighbours() -> None:
    with pytest.raises(RecordError, match=r"no statistic 'treshold_gm' \(cold\): did you mean threshold_gm"):
        load_evidence().find("E3", "treshold_gm", "cold")
    with pytest.raises(RecordError, match="no experiment 'E9'; there are E1"):
        load_evidence().experiment("E9")


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("1.476,0.03537", "1.476,-0.03537", "line 1.*: se: "),
        ("E3,threshold_gm,cold,1.476", "E3,threshold_gm,cold,none", "value: "),
        ("E3,threshold_gm,cold", "E3,threshold_gm,cool", "channel: "),
        ("E3,threshold_gm,cold", "E8,threshold_gm,cold", r"evidence.toml has no 'E8'"),
    ],
)
def test_a_wrong_row_is_named_by_line_and_column(tmp_path: Path, before: str, after: str, message: str) -> None:
    table = tmp_path / "evidence.csv"
    text = (DATA / "evidence.csv").read_text("utf-8")
    assert before in text
    table.write_text(text.replace(before, after, 1), "utf-8")
    with pytest.raises(RecordError, match=message):
        read_evidence(table, DATA / "evidence.toml")


def test_rows_are_published_numbers_with_errors() -> None:
    rows = load_rows()
    assert len({row.key for row in rows}) == len(rows) == 54
    limits = next(row for row in rows if row.key == ("E3", "threshold_gm", "warm"))
    assert limits.shown(limits.value) == pytest.approx(1.859)
    # 2 % of sampling error and 5 % that the model may miss by.
    assert limits.sd == pytest.approx(math.hypot(0.02016, 0.05))
    width = next(row for row in rows if row.key == ("E4", "sigma_gm_age30", "warm"))
    assert width.value == pytest.approx(math.log(2.269) - 0.14)
