"""Sampling of posteriors in closed form."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from thermicon.perception.evidence import chains as chains_module
from thermicon.perception.evidence import sampling
from thermicon.perception.evidence.chains import Chain, Diagnostics, Reference, begin, diagnose, extend
from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.sampling import in_the_middle, sample
from thermicon.perception.evidence.surrogate import LimitFeatures, Surrogate, fit_surrogate

SIZE = 3
TRUTH = np.array([[1.0, 0.5, 0.0], [0.0, 2.0, -0.5], [0.3, 0.0, 1.5], [1.0, 1.0, 1.0]])


@dataclass(frozen=True)
class Bent:
    """Four rows that are quadratic in three constants."""

    def residuals(self, vector: np.ndarray) -> np.ndarray:
        return np.concatenate([TRUTH @ vector + 0.2 * vector[0] ** 2, vector])


def surrogate_and_reference() -> tuple[Surrogate, Reference]:
    precision = TRUTH.T @ TRUTH + np.eye(SIZE)
    reference = Reference.at(np.zeros(SIZE), np.linalg.inv(precision))
    white = np.random.default_rng(1).standard_normal((300, SIZE))
    rows = np.stack([Bent().residuals(vector)[:4] for vector in reference.vector(white)])
    return fit_surrogate(white, rows, reference.middle, reference.factor), reference


def test_a_surrogate_of_quadratics_is_exact_and_its_gradient_is_one() -> None:
    surrogate, reference = surrogate_and_reference()
    white = np.array([0.3, -0.8, 0.5])
    density, gradient = surrogate.log_density(white)
    residuals = Bent().residuals(reference.vector(white))
    assert density == pytest.approx(-0.5 * residuals @ residuals, rel=0.01)
    for place in range(SIZE):
        step = np.zeros(SIZE)
        step[place] = 1e-5
        slope = (surrogate.log_density(white + step)[0] - surrogate.log_density(white - step)[0]) / 2e-5
        assert gradient[place] == pytest.approx(slope, rel=1e-5)


@pytest.mark.slow
def test_chains_have_the_moments_of_the_posterior() -> None:
    surrogate, reference = surrogate_and_reference()
    chains = [extend(begin(SIZE, 0, k), Bent().residuals, reference, surrogate, 1500) for k in range(4)]
    drawn = reference.vector(np.stack([chain.white[100:] for chain in chains]))
    axis = np.linspace(-4.0, 4.0, 61)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, SIZE)
    residuals = np.concatenate([grid @ TRUTH.T + 0.2 * grid[:, :1] ** 2, grid], axis=1)
    weights = np.exp(-0.5 * np.square(residuals).sum(axis=1))
    weights /= weights.sum()
    found = diagnose(("a", "b", "c"), drawn)
    assert found.converged
    mean, sd = weights @ grid, np.sqrt(weights @ grid**2 - (weights @ grid) ** 2)
    np.testing.assert_allclose(drawn.mean(axis=(0, 1)), mean, atol=5.0 * float((sd / np.sqrt(found.ess)).max()))
    np.testing.assert_allclose(drawn.std(axis=(0, 1)), sd, rtol=0.1)


def test_a_chain_is_the_same_in_one_go_and_in_parts() -> None:
    surrogate, reference = surrogate_and_reference()
    start = begin(SIZE, 7, 2)
    whole = extend(start, Bent().residuals, reference, surrogate, 60)
    rest = extend(extend(start, Bent().residuals, reference, surrogate, 25), Bent().residuals, reference, surrogate, 35)
    np.testing.assert_array_equal(rest.white, whole.white)


def test_chains_apart_have_not_converged() -> None:
    rng = np.random.default_rng(0)
    apart = rng.standard_normal((4, 500, 2))
    apart[0, :, 1] += 3.0
    found = diagnose(("near", "far"), apart)
    assert not found.converged
    assert found.worst == "far"
    assert repr(found).startswith("not converged, worst far: R-hat up to ")
    chain = Chain(np.zeros((101, 2)), np.zeros(101), ())
    assert sampling._kept([chain] * 4, Reference(np.zeros(2), np.eye(2))).shape == (4, 90, 2), "a tenth is left out"
    for r_hat, ess, converged in ((1.009, 401.0, True), (1.011, 401.0, False), (1.009, 399.0, False)):
        assert Diagnostics(("a",), np.array([r_hat]), np.array([ess])).converged == converged


@pytest.mark.slow
def test_a_short_run_can_be_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chains_module, "AROUND", 1500)
    monkeypatch.setattr(chains_module, "ROUNDS", (240,))
    monkeypatch.setattr(chains_module, "CHAIN_ROUNDS", 1)
    monkeypatch.setattr(chains_module, "CHAIN_STEPS", 50)
    once, again = (sample(Posterior(), 5, least_steps=100, most_steps=200) for _ in range(2))
    np.testing.assert_array_equal(once.vectors, again.vectors)
    assert not once.diagnostics.converged


def test_features_of_the_limits_have_the_right_slopes() -> None:
    priors = Posterior().priors
    features = LimitFeatures.of(priors)
    assert features is not None
    vector = np.random.default_rng(2).standard_normal(len(priors))
    slopes = features.slopes(vector)
    for k, place in enumerate(features.places):
        step = np.zeros(vector.size)
        step[place] = 1e-6
        np.testing.assert_allclose(
            slopes[:, k], (features.at(vector + step) - features.at(vector - step)) / 2e-6, atol=1e-6
        )
    assert LimitFeatures.of(Posterior("heat flow").priors) is None


def test_the_nominal_draw_is_nearest_to_the_medians_of_constants_and_of_predictions() -> None:
    constant, offset = SimpleNamespace(mechanism="depth"), SimpleNamespace(mechanism="laboratories")
    posterior: Any = SimpleNamespace(
        priors=SimpleNamespace(each=(constant, offset)),
        rows=(SimpleNamespace(key="latency"),),
        predictions=lambda vector: {"latency": vector[0] ** 2},
    )
    vectors = np.array([[-2.0, 0.0], [0.9, 50.0], [1.0, 9.0], [1.1, 0.0], [4.0, 0.0]])
    assert in_the_middle(posterior, vectors) == 2
