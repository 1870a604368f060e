"""Left-out predictions: weights against algebra, scores against closed forms and the naive baseline."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermicon.perception.evidence.left_out import KINDS, naive_log_score, row_predicted
from thermicon.perception.evidence.results import LeftOutRow, load_left_out
from thermicon.perception.evidence.rows import Row, load_rows

DRAWN = 1.0 + 0.4 * np.random.default_rng(0).standard_normal(4000)


def predicted(value: float, weights: np.ndarray | None = None) -> LeftOutRow:
    """A row of SD 0.3 predicted by draws of mean 1 and SD 0.4: what would be measured has SD 0.5."""
    row = Row(("a", "b", "cold"), value, 0.3, True, "K", "a row")
    flat = np.full(DRAWN.size, 1.0 / DRAWN.size)
    return row_predicted(row, DRAWN, flat if weights is None else weights / weights.sum(), 0.1, "weights")


def test_scores_of_a_normal_prediction_are_those_of_a_normal() -> None:
    found = predicted(1.5)
    assert found.published == pytest.approx(math.exp(1.5))
    assert found.probability == pytest.approx(0.841, abs=0.01)
    assert found.log_score == pytest.approx(-0.5 - math.log(0.5 * math.sqrt(2.0 * math.pi)), abs=0.03)
    quantiles = np.log([found.low, found.lower, found.median, found.upper, found.high])
    assert quantiles == pytest.approx([0.02, 0.663, 1.0, 1.337, 1.98], abs=0.04)
    assert found.covered(0.95)
    assert not found.covered(0.5)
    assert not predicted(2.3).covered(0.95)


def test_weights_move_a_prediction() -> None:
    moved = predicted(1.5, np.exp(2.0 * DRAWN))
    assert math.log(moved.median) == pytest.approx(1.0 + 2.0 * 0.4**2, abs=0.03)


def test_the_naive_baseline_knows_the_other_experiments_alone() -> None:
    rows = {row.key: row for row in load_rows()}
    assert {key[1] for key in rows} >= set(KINDS)
    shipped = {(row.experiment, row.statistic, row.channel): row.naive for row in load_left_out()}
    for key, row in rows.items():
        assert naive_log_score(row) == pytest.approx(shipped[key], rel=1e-5, abs=1e-5, nan_ok=True)
