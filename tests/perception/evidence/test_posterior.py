"""The search for the maximum of the posterior."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
import pytest

from thermicon.perception.evidence.posterior import LeftOut, Posterior, maximise, prediction_sd
from thermicon.perception.evidence.results import load_ablation, load_constants, load_predictions
from thermicon.perception.evidence.rows import Row, load_rows
from thermicon.perception.evidence.sampling import shipped_vector


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
    row = Row(("a", "b", "cold"), 1.0, 0.3, False, "s", "a row", "level")
    found = maximise(Line())  # type: ignore[arg-type]
    # The sum has the variance of its gradient (1, 1) through the covariance: 2/9 of the prior's 2.
    (sd,) = prediction_sd(found, [row])
    assert sd == pytest.approx(math.sqrt(2.0 / 9.0), rel=1e-3)
    out = LeftOut(row, 0.0, 0.5)
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


@pytest.mark.slow
def test_a_row_is_predicted_again_without_its_experiment() -> None:
    refitted = maximise(Posterior(left_out=frozenset({"steps"})), shipped_vector(Posterior()))
    (row,) = (each for each in load_rows() if each.experiment == "steps")
    (shipped,) = (each for each in load_predictions() if each.experiment == "steps")
    (sd,) = prediction_sd(refitted, [row]).tolist()
    out = LeftOut(row, refitted.predictions[row.key], math.hypot(sd, row.sd))
    assert row.shown(out.predicted) == pytest.approx(shipped.left_out, rel=0.01)
    assert [row.shown(end) for end in out.interval] == pytest.approx(
        [shipped.left_out_low, shipped.left_out_high], rel=0.02
    )


@contextmanager
def observed(truth: np.ndarray, random: np.random.Generator) -> Iterator[None]:
    """In place of the published rows, those that people with these constants would have given, errors at random."""
    predictions = Posterior().predictions(truth)
    drawn = tuple(replace(r, value=predictions[r.key] + r.sd * random.standard_normal()) for r in load_rows())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("thermicon.perception.evidence.posterior.load_rows", lambda: drawn)
        yield


@pytest.mark.slow
def test_intervals_of_fifty_data_sets_cover_what_they_should() -> None:
    """Truths are drawn from the prior; the search begins at the truth, since it is the intervals that are tested."""
    posterior = Posterior()
    scores = []
    for seed in range(50):
        random = np.random.default_rng([seed, 16])
        truth = np.clip(random.standard_normal(len(posterior.priors)), -2.0, 2.0)
        with observed(truth, random):
            found = maximise(posterior, truth)
        scores.append((found.vector - truth) / found.sd)
    z = np.stack(scores)
    assert 0.85 < (np.abs(z) < 1.96).mean() <= 0.99
    assert (np.abs(z) < 1.96).mean(axis=0).min() > 0.6


def test_heat_flow_answers_too() -> None:
    posterior = Posterior("heat flow")
    assert not {"cold limit", "warm limit"} & set(posterior.priors.names)
    assert np.isfinite(posterior.residuals(np.zeros(len(posterior.priors)))).all()
    assert len(Posterior(left_out=frozenset({"E3"})).rows) < len(posterior.rows)
