"""The evidence as data with sources, or refused at a named place."""

import math
from pathlib import Path

import pytest

from thermicon.base.files.records import RecordError
from thermicon.perception.evidence.rows import load_evidence, load_rows, read_evidence
from thermicon.perception.observer.observer import DATA


def test_every_statistic_has_an_experiment_an_error_and_a_licence() -> None:
    evidence = load_evidence()
    assert len(evidence.statistics) == 346
    assert {row.experiment for row in evidence.statistics} == {
        *(f"E{n}" for n in (*range(1, 9), *range(10, 14))),
        "E9 Greenspan",
        "E9 Hagander",
        "E9 Wakolbinger",
    }
    assert all(math.isfinite(row.se) for row in evidence.statistics)
    assert all(each.licence for each in evidence.experiments.values())
    with pytest.raises(RecordError, match=r"no statistic 'treshold_gm' \(cold\): did you mean threshold_gm"):
        evidence.find("E3", "treshold_gm", "cold")


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("1.476,0.03537", "1.476,-0.03537", "line 1.*: se: "),
        ("E3,threshold_gm,cold,1.476", "E3,threshold_gm,cold,none", "value: "),
        ("E3,threshold_gm,cold", "E3,threshold_gm,cool", "channel: "),
        ("E3,threshold_gm,cold", "E0,threshold_gm,cold", r"evidence.toml has no 'E0'"),
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
    rows = {row.key: row for row in load_rows()}
    assert len(rows) == len(load_rows()) == 67
    limits = rows["E3", "threshold_gm", "warm"]
    assert limits.value == pytest.approx(math.log(1.859))
    assert limits.shown(limits.value) == pytest.approx(1.859)
    # 2 % of sampling error and 5 % that the model may miss by; 35 % of a spread.
    assert limits.sd == pytest.approx(math.hypot(0.02016, 0.05))
    spread = load_evidence().find("E3", "between_sd_log10_noise_removed", "warm")
    assert rows["E3", spread.statistic, "warm"].sd == pytest.approx(math.hypot(spread.se, 0.35 * spread.value))
    width = rows["E4", "sigma_gm_age30", "warm"]
    assert width.value == pytest.approx(math.log(2.269) - 0.14)
    warm = rows["E8", "share_warm_called_cold_all_fast", "warm"]
    assert (warm.value, warm.sd) == pytest.approx((0.0062583, math.hypot(0.0035638, 0.003)))
    steps = rows["steps", "steps from threshold to pain", "warm"]
    assert (steps.value, steps.sd) == (pytest.approx(math.log(30.0)), 0.3)
