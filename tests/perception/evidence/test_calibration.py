"""Calibration on synthetic data: constants that are known are found again, with intervals that cover them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from thermicon.perception.evidence.maximum import maximise
from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.sampling import shipped_vector

FEW = (
    "warm conduction velocity",
    "cold threshold drive",
    "warm threshold drive",
    "cold area exponent",
    "cold rating exponent",
    "warm rating at threshold",
)


@dataclass(frozen=True)
class Some:
    """A posterior of a few constants; the others are known."""

    whole: Posterior
    truth: np.ndarray

    @property
    def places(self) -> np.ndarray:
        return np.array([self.whole.priors.names.index(name) for name in FEW])

    @property
    def priors(self) -> tuple[str, ...]:
        return FEW

    def filled(self, vector: np.ndarray) -> np.ndarray:
        full = self.truth.copy()
        full[self.places] = vector
        return full

    def residuals(self, vector: np.ndarray) -> np.ndarray:
        full = self.filled(vector)
        return np.concatenate([self.whole.misses(full), vector])

    def predictions(self, vector: np.ndarray) -> dict[tuple[str, str, str], float]:
        return self.whole.predictions(self.filled(vector))


@pytest.mark.slow
def test_a_few_constants_are_found_again_in_three_data_sets() -> None:
    scores = []
    for seed in range(3):
        random = np.random.default_rng(seed)
        truth = shipped_vector(Posterior())
        some = Some(Posterior(), truth)
        truth[some.places] = random.standard_normal(len(FEW)) * 0.7
        data = Some(Posterior().synthetic(truth, random), truth)
        found = maximise(data, 0.5 * truth[some.places])
        scores.append((found.vector - truth[some.places]) / found.sd)
    z = np.concatenate(scores)
    assert (np.abs(z) < 1.96).mean() >= 0.75
    assert 0.3 < np.square(z).mean() < 2.5
    assert np.abs(z).max() < 4.5


def test_synthetic_rows_are_the_predictions_but_for_their_errors() -> None:
    vector = shipped_vector(Posterior())
    data = Posterior().synthetic(vector, np.random.default_rng(1))
    misses = data.misses(vector)
    assert np.square(misses).mean() == pytest.approx(1.0, abs=0.6)
    assert [row.key for row in data.rows] == [row.key for row in Posterior().rows]
    assert not np.allclose(misses, Posterior().misses(vector))


@pytest.mark.slow
def test_intervals_of_fifty_data_sets_cover_what_they_should() -> None:
    """Truths are drawn from the prior; the search begins at the truth, since it is the intervals that are tested."""
    posterior = Posterior()
    scores = []
    for seed in range(50):
        random = np.random.default_rng([seed, 16])
        truth = np.clip(random.standard_normal(len(posterior.priors)), -2.0, 2.0)
        found = maximise(posterior.synthetic(truth, random), truth)
        scores.append((found.vector - truth) / found.sd)
    z = np.stack(scores)
    assert 0.85 < (np.abs(z) < 1.96).mean() <= 0.99
    assert (np.abs(z) < 1.96).mean(axis=0).min() > 0.6
