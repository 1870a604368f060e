"""The search for the maximum: a known optimum, and the shipped one found again (slow)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from thermicon.perception.evidence.maximum import LeftOut, maximise
from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.results import load_ablation, load_constants
from thermicon.perception.evidence.rows import Row


@dataclass(frozen=True)
class Line:
    """A posterior that can be written down: one row y = x₀ + x₁ with SD ½ and value 2, priors of SD 1."""

    priors: tuple[int, ...] = (0, 1)

    def residuals(self, vector: np.ndarray) -> np.ndarray:
        return np.concatenate([[(vector.sum() - 2.0) / 0.5], vector])

    def predictions(self, vector: np.ndarray) -> dict[tuple[str, str, str], float]:
        return {("a", "b", "cold"): float(vector.sum())}


def test_maximum_and_evidence_of_a_line_are_those_of_algebra() -> None:
    found = maximise(Line())  # type: ignore[arg-type]
    np.testing.assert_allclose(found.vector, [8 / 9, 8 / 9], atol=1e-6)
    curvature = np.eye(2) + 4.0 * np.ones((2, 2))
    np.testing.assert_allclose(found.covariance, np.linalg.inv(curvature), atol=1e-8)
    cost = 0.5 * ((16 / 9 - 2) ** 2 * 4 + 2 * (8 / 9) ** 2)
    assert found.log_evidence == pytest.approx(-cost - 0.5 * np.log(np.linalg.det(curvature)))


def test_a_left_out_row_is_judged_with_both_errors() -> None:
    row = Row(("a", "b", "cold"), 1.0, 0.3, False, "s", "a row")
    out = LeftOut(row, 0.0, 0.4)
    assert out.score == pytest.approx(2.0)
    assert out.interval == pytest.approx((-0.98, 0.98), abs=1e-3)
    assert out.log_score == pytest.approx(-2.0 - np.log(0.5 * np.sqrt(2.0 * np.pi)))


@pytest.mark.slow
def test_the_search_finds_the_shipped_maximum_again() -> None:
    found = maximise(Posterior())
    assert found.log_evidence == pytest.approx(load_ablation()[0].log_evidence, abs=1.0)
    for each in load_constants():
        low, high = found.interval(each.name, 1.0)
        assert min(low, high) <= each.value <= max(low, high)
