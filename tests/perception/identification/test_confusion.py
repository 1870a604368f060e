import math
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

from thermicon.perception import confuse
from thermicon.perception.identification.confusion import SAMPLES, embed, sampling_error
from thermicon.perception.identification.map import stress
from thermicon.perception.identification.measures import proportion_correct


def equal_proportion_correct(d: float, icons: int) -> float:
    """Proportion correct for equally distant icons, PC = ∫φ(x − d)Φ(x)^(m−1)dx, with d = d′/√2."""
    x = np.linspace(-9.0, 9.0 + d, 4001)
    normal = NormalDist()
    density = np.array([normal.pdf(v - d) * normal.cdf(v) ** (icons - 1) for v in x.tolist()])
    return float(np.trapezoid(density, x))


def equal(d: float, icons: int = 6) -> np.ndarray:
    return d * np.sqrt(2) * (1 - np.eye(icons))


@pytest.mark.parametrize(("d", "published"), [(2.78, 0.91), (2.17, 0.80), (3.67, 0.98)])
def test_equally_distant_icons_follow_the_integral(d: float, published: float) -> None:
    assert equal_proportion_correct(d, 6) == pytest.approx(published, abs=0.005)
    found = confuse(np.repeat(equal(d)[None], 20, axis=0), lapse=0.0)
    assert proportion_correct(found.pooled) == pytest.approx(
        equal_proportion_correct(d, 6), abs=4 * found.standard_error
    )


def test_two_icons_are_exact() -> None:
    found = confuse([[0.0, 2.0], [2.0, 0.0]], lapse=0.02)
    assert found.pooled[0, 0] == pytest.approx(0.98 * NormalDist().cdf(1.0) + 0.01, abs=1e-12)
    assert found.standard_error == 0.0
    assert confuse([[0.0]]).pooled == pytest.approx(1.0)


def test_rows_sum_to_one_and_lapses_spread_evenly() -> None:
    found = confuse(equal(40.0), lapse=0.06)
    assert found.probability.sum(axis=-1) == pytest.approx(1.0, abs=1e-12)
    assert found.pooled[0] == pytest.approx([0.95, 0.01, 0.01, 0.01, 0.01, 0.01], abs=1e-12)


def test_the_noise_is_common_and_prefix_stable() -> None:
    rng = np.random.default_rng(0)
    many = equal(2.0)[None] * rng.uniform(0.5, 2.0, (30, 1, 1))
    few, all_ = confuse(many[:7], seed=4), confuse(many, seed=4)
    assert np.array_equal(few.probability, all_.probability[:7])
    assert np.array_equal(confuse(many[2:], seed=4, first=2).probability, all_.probability[2:])
    assert not np.array_equal(confuse(many, seed=5).probability, all_.probability)


@pytest.mark.parametrize("icons", [3, 6, 12])
@pytest.mark.parametrize("d", [0.5, 1.5, 3.0])
def test_one_person_is_within_the_stated_error_of_the_integral(icons: int, d: float) -> None:
    found = confuse(equal(d, icons), lapse=0.0, seed=3)
    exact = equal_proportion_correct(d, icons)
    assert found.person_standard_error <= 0.005
    assert np.diagonal(found.probability[0]) == pytest.approx(np.full(icons, exact), abs=4 * 0.005)
    off = (1.0 - exact) / (icons - 1)
    assert found.probability[0][~np.eye(icons, dtype=bool)] == pytest.approx(off, abs=4 * 0.005)
    assert proportion_correct(found.pooled) == pytest.approx(exact, abs=0.005)


def test_sampling_agrees_with_brute_force() -> None:
    rng = np.random.default_rng(7)
    points = rng.normal(0.0, 1.5, (7, 3))
    apart = np.linalg.norm(points[:, None] - points[None], axis=-1)
    brute = np.zeros((7, 7))
    for i in range(7):
        felt = points[i] + rng.standard_normal((200_000, 3))
        nearest = ((felt[:, None] - points[None]) ** 2).sum(axis=-1).argmin(axis=1)
        brute[i] = np.bincount(nearest, minlength=7) / 200_000
    found = confuse(apart, lapse=0.0)
    assert stress(apart, embed(apart[None])[0]) == pytest.approx(0.0, abs=1e-6)
    assert np.abs(found.probability[0] - brute).max() < 4 * (found.person_standard_error + sampling_error(0.5, 200_000))


def test_the_stated_error_is_no_less_than_the_scatter_between_seeds() -> None:
    rng = np.random.default_rng(1)
    points = rng.normal(0.0, 1.0, (8, 5))
    apart = np.linalg.norm(points[:, None] - points[None], axis=-1)
    many = [confuse(np.stack([apart] * 4), lapse=0.0, seed=seed, samples=512) for seed in range(60)]
    for each, stated in (
        ([found.probability[0] for found in many], many[0].person_standard_error),
        ([found.pooled for found in many], many[0].standard_error),
    ):
        assert 0.5 * stated < np.std(each, axis=0, ddof=1).max() < 1.3 * stated
    assert sampling_error(0.5, SAMPLES) < 0.005


@pytest.mark.parametrize(
    ("d_prime", "told", "said"),
    [
        (equal(1.0), {"samples": 0}, r"at least one sample is needed, not 0"),
        (np.zeros((2, 3)), {}, r"d_prime must have shape \(people, icons, icons\), not \(2, 3\)"),
        ([[0.0, np.nan], [np.nan, 0.0]], {}, r"d_prime must be finite"),
    ],
)
def test_messages(d_prime: Any, told: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        confuse(d_prime, **told)


def test_icons_that_one_person_does_not_feel_are_named_alike_in_any_order() -> None:
    felt = 3.0 * (1.0 - np.eye(4))
    faint = felt.copy()
    faint[:3, :3] = 0.0  # this person feels only the last
    found = confuse(np.stack([felt, faint]), lapse=0.0, seed=1).probability
    assert found[1, :3, :3] == pytest.approx(np.full((3, 3), found[1, 0, 0]), abs=1e-12)
    assert found[0].argmax(axis=1).tolist() == [0, 1, 2, 3]
    order = [3, 1, 0, 2]
    turned = confuse(np.stack([felt, faint])[:, order][:, :, order], lapse=0.0, seed=1).probability
    assert np.diagonal(turned[1])[0] == pytest.approx(np.diagonal(found[1])[3], abs=0.02)
    assert np.diagonal(turned[1])[1:] == pytest.approx(np.diagonal(found[1])[:3], abs=0.02)


@pytest.mark.parametrize("icons", [4, 12, 40])
@pytest.mark.parametrize("apart", [1e-7, 1e-4, 0.004, 0.02])
def test_two_icons_that_hardly_differ_share_their_names(icons: int, apart: float) -> None:
    """Neither single precision nor an axis without noise may decide between them."""
    points = np.zeros((icons, 9))
    points[:, :8] = np.random.default_rng(0).normal(0.0, 3.0, (icons, 8))
    points[-1] = points[-2]
    points[-1, 8] = apart
    distances = np.linalg.norm(points[:, None] - points, axis=-1)
    last = confuse(distances, lapse=0.0).pooled[-2:, -2:]
    assert last == pytest.approx(np.full((2, 2), last.mean()), abs=0.02)


def test_what_is_small_in_each_of_many_ways_counts_together() -> None:
    """64 icons that differ by 0.02 to 0.04 at most along any axis, and by a d′ of 0.17 in all."""
    signs = np.ones((1, 1))
    for _ in range(6):
        signs = np.block([[signs, signs], [signs, -signs]])
    points = signs[:, 1:] * np.linspace(0.01, 0.02, 63)
    apart = np.linalg.norm(points[:, None] - points, axis=-1)
    found = confuse(np.repeat(apart[None], 4, axis=0), lapse=0.0, samples=2048)
    middle = float(apart[~np.eye(64, dtype=bool)].mean())
    assert proportion_correct(found.pooled) == pytest.approx(
        equal_proportion_correct(middle / math.sqrt(2), 64), abs=0.0008
    )
