"""Tables of the inference in docs/ against the data files."""

import re

import evidence_tables as tables
import numpy as np
import pytest
from posterior_tables import TABLES, load_left_out, stacking_weights, summarise, variant_weights

from thermicon.perception.evidence.results import (
    judging_predictions,
    load_ablation,
    load_constants,
    load_missed,
    load_predictions,
)
from thermicon.perception.evidence.rows import load_rows
from thermicon.perception.observer.draws import PosteriorDraws


def body(table: str) -> list[list[str]]:
    """Cells of the rows below the head."""
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]


def test_experiments_hold_all_rows_and_a_licence() -> None:
    rows = body(tables.experiments_table())
    assert sum(int(row[-1]) for row in rows) == len(load_rows())
    assert all(all(row) for row in rows)


def test_every_constant_stands_once() -> None:
    named = [row[1] for row in body(tables.constants_table())]
    assert sorted(named) == sorted(each.name for each in load_constants() if each.unit != "SD")
    assert len(body(tables.offsets_table())) == sum(each.unit == "SD" for each in load_constants())
    assert set().union(*tables.GROUPS.values()) <= {each.mechanism for each in load_constants()}


def test_ablation_and_predictions_are_complete() -> None:
    assert len(body(tables.ablation_table())) == len(load_ablation())
    predicted = body(tables.left_out_table())
    assert len(predicted) == len(load_predictions())
    assert sum(row[1].startswith("**") for row in predicted) == len(load_missed())
    judging = judging_predictions()
    inside = sum(each.covered for each in judging)
    assert tables.coverage_sentence().startswith(f"{inside} of {len(judging)} rows") and len(judging) == 36


def test_experiments_that_disagree_pull_a_constant_apart() -> None:
    """E9 wants the palm no less sensitive than the forearm, E10 more sensitive than the fingers."""
    without = {each.left_out: each for each in tables.load_influence()}
    assert len(body(tables.influence_table())) == len(without)
    assert without["E10"].corneum < without[""].corneum < without["E9"].corneum
    assert without["E10"].over_finger > without[""].over_finger > without["E9"].over_finger
    # Of cool skin only what moves with it says anything.
    assert without["E12"].moving < without[""].moving < 0.0


def test_stacking_mixes_variants_that_are_good_at_different_rows() -> None:
    np.testing.assert_allclose(stacking_weights(np.array([[0.0, 0.0], [-9.0, -9.0]])), [1.0, 0.0], atol=5e-3)
    weights = stacking_weights(np.log(np.array([[0.9, 0.9, 0.1], [0.1, 0.1, 0.9]])))
    assert weights.sum() == pytest.approx(1.0)
    assert 0.5 < weights[0] < 0.9
    shipped = variant_weights()
    assert max(shipped, key=lambda each: shipped[each]) == "temperature"


def test_left_out_predictions_by_draws_cover_and_beat_the_naive_baseline() -> None:
    rows = load_left_out()
    assert all(row.low < row.lower < row.median < row.upper < row.high for row in rows)
    assert all(row.covered(0.95) == (row.low <= row.published <= row.high) for row in rows)
    assert 0.85 <= np.mean([row.covered(0.95) for row in rows]) <= 0.99
    assert 0.35 <= np.mean([row.covered(0.5) for row in rows]) <= 0.75
    compared = [row for row in rows if not np.isnan(row.naive)]
    assert len(compared) > 15
    assert sum(row.log_score - row.naive for row in compared) > 0.0


def test_summaries_say_what_was_not_moved() -> None:
    found = {each.name: each for each in summarise(PosteriorDraws.load())}
    assert found["smallest area that counts"].unmoved
    assert not found["warm threshold drive"].unmoved
    assert found["warm threshold drive"].narrowed < 0.4


@pytest.mark.parametrize("name", TABLES)
def test_a_table_has_one_width_and_no_exponents(name: str) -> None:
    text = TABLES[name]()
    lines = text.splitlines()
    assert len({line.count(" | ") for line in lines}) == 1
    assert not re.search(r"\d[eE][+-]?\d", re.sub(r"[^|]*(Ho & Jones)[^|]*", "", text))
