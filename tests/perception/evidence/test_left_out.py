"""Left-out predictions: weights against algebra, scores against closed forms and the naive baseline."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermicon.perception.evidence.left_out import Predictive
from thermicon.perception.evidence.left_out_table import KINDS, LeftOutRow, naive_log_score
from thermicon.perception.evidence.rows import Row, load_rows


def predictive(value: float, draws: int = 4000) -> Predictive:
    """A row of SD 0.3 predicted by draws of mean 1 and SD 0.4: what would be measured has SD 0.5."""
    row = Row(("a", "b", "cold"), value, 0.3, True, "K", "a row")
    drawn = 1.0 + 0.4 * np.random.default_rng(0).standard_normal(draws)
    return Predictive(row, drawn, np.full(draws, 1.0 / draws), 0.1, "weights")


def test_scores_of_a_normal_prediction_are_those_of_a_normal() -> None:
    found = LeftOutRow.of(predictive(1.5))
    assert found.probability == pytest.approx(0.841, abs=0.01)
    assert found.log_score == pytest.approx(-0.5 - math.log(0.5 * math.sqrt(2.0 * math.pi)), abs=0.03)
    quantiles = np.log([found.low, found.lower, found.median, found.upper, found.high])
    assert quantiles == pytest.approx([0.02, 0.663, 1.0, 1.337, 1.98], abs=0.04)
    assert found.covered(0.95)
    assert not found.covered(0.5)
    assert not LeftOutRow.of(predictive(2.3)).covered(0.95)


def test_weights_move_a_prediction() -> None:
    flat = predictive(1.5)
    weights = np.exp(2.0 * flat.predicted)
    moved = Predictive(flat.row, flat.predicted, weights / weights.sum(), 0.1, "weights")
    assert moved.quantile(0.5) == pytest.approx(1.0 + 2.0 * 0.4**2, abs=0.03)


def test_the_naive_baseline_knows_the_other_experiments_alone() -> None:
    rows = {row.key: row for row in load_rows()}
    limits = rows["E3", "threshold_gm", "warm"]
    assert math.isfinite(naive_log_score(limits))
    assert math.isnan(naive_log_score(rows["E2", "rating_mean_5strip", "cold"]))
    assert {key[1] for key in rows} >= set(KINDS)
