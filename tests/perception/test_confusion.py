import time
from statistics import NormalDist

import numpy as np
import pytest

from thermicon.perception import confuse, equal_percent_correct, percent_correct
from thermicon.perception.confusion import embed


def equal(d: float, icons: int = 6) -> np.ndarray:
    return d * np.sqrt(2) * (1 - np.eye(icons))


@pytest.mark.parametrize(("d", "published"), [(2.78, 0.91), (2.17, 0.80), (3.67, 0.98)])
def test_equally_distant_icons_follow_the_integral(d: float, published: float) -> None:
    assert equal_percent_correct(d, 6) == pytest.approx(published, abs=0.005)
    found = confuse(np.repeat(equal(d)[None], 20, axis=0), lapse=0.0)
    assert percent_correct(found.pooled) == pytest.approx(equal_percent_correct(d, 6), abs=4 * found.standard_error)


def test_two_icons_are_exact() -> None:
    found = confuse([[0.0, 2.0], [2.0, 0.0]], lapse=0.02)
    assert found.pooled[0, 0] == pytest.approx(0.98 * NormalDist().cdf(1.0) + 0.01, abs=1e-12)
    assert found.standard_error == 0.0
    assert confuse([[0.0]]).pooled == pytest.approx(1.0)


def test_three_icons_on_a_line_agree_with_the_normal_integral() -> None:
    line = np.abs(np.subtract.outer([0.0, 2.0, 5.0], [0.0, 2.0, 5.0]))
    cdf = NormalDist().cdf
    exact = [[cdf(1.0), cdf(3.5) - cdf(1.0), cdf(-3.5)], [cdf(-1.0), cdf(1.5) - cdf(-1.0), cdf(-1.5)]]
    found = confuse(np.repeat(line[None], 50, axis=0), lapse=0.0)
    assert found.pooled[:2] == pytest.approx(np.array(exact), abs=5 * found.standard_error)
    assert found.stress.max() == pytest.approx(0.0, abs=1e-7)


def test_rows_sum_to_one_and_lapses_spread_evenly() -> None:
    found = confuse(equal(40.0), lapse=0.06)
    assert found.probability.sum(axis=-1) == pytest.approx(1.0, abs=1e-12)
    assert found.pooled[0] == pytest.approx([0.95, 0.01, 0.01, 0.01, 0.01, 0.01], abs=1e-12)


def test_the_noise_is_common_and_prefix_stable() -> None:
    rng = np.random.default_rng(0)
    many = equal(2.0)[None] * rng.uniform(0.5, 2.0, (30, 1, 1))
    few, all_ = confuse(many[:7], seed=4), confuse(many, seed=4)
    assert np.array_equal(few.probability, all_.probability[:7])
    assert not np.array_equal(confuse(many, seed=5).probability, all_.probability)


def test_impossible_distances_report_their_stress() -> None:
    bent = np.array([[0.0, 1.0, 5.0], [1.0, 0.0, 1.0], [5.0, 1.0, 0.0]])
    points, stress = embed(bent[None])
    assert points.shape == (1, 3, 2)
    assert stress[0] > 0.1


def test_two_hundred_people_are_quick() -> None:
    many = np.repeat(equal(2.5)[None], 200, axis=0)
    confuse(many)
    start = time.perf_counter()
    confuse(many)
    assert time.perf_counter() - start < 1.0


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"d_prime must have shape \(people, icons, icons\), not \(2, 3\)"):
        confuse(np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"d_prime must be finite"):
        confuse([[0.0, np.nan], [np.nan, 0.0]])


def test_icons_that_nobody_can_tell_apart_share_their_answers_equally() -> None:
    apart = 3.0 * (1.0 - np.eye(4))
    apart[1, 2] = apart[2, 1] = 0.0
    named = confuse(np.repeat(apart[None], 5, axis=0), lapse=0.0).pooled
    assert named[1, 1] == pytest.approx(named[1, 2], abs=1e-12)
    assert named[1] == pytest.approx(named[2], abs=1e-12)
    assert named.sum(axis=1) == pytest.approx(1.0)
