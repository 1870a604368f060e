import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from thermicon.perception.identification.map import (
    between,
    classical,
    laid_onto,
    perceptual_map,
    settled,
    smacof,
    stress,
)

Points = arrays(
    np.float64, st.tuples(st.integers(1, 9), st.just(2)), elements=st.floats(-9, 9).map(lambda x: round(x, 3))
)


def names(points: np.ndarray) -> list[str]:
    return [f"i{k}" for k in range(len(points))]


def random_distances(icons: int, seed: int, axes: int = 5) -> np.ndarray:
    return between(np.random.default_rng(seed).normal(size=(icons, axes)))


@given(Points)
def test_distances_of_a_plane_are_kept(points: np.ndarray) -> None:
    found = perceptual_map(between(points), names(points))
    assert between(found.points) == pytest.approx(between(points), abs=1e-4)
    assert found.stress == pytest.approx(0.0, abs=1e-5)
    assert found.points.mean(axis=0) == pytest.approx(0.0, abs=1e-9)


@given(Points, st.floats(0, 6.28), st.booleans())
def test_a_map_does_not_hang_on_how_its_points_lay(points: np.ndarray, angle: float, mirrored: bool) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = points @ turn * ([1.0, -1.0] if mirrored else [1.0, 1.0]) + 3.0
    once, again = (settled(classical(between(one))) for one in (points, moved))
    lengths = np.linalg.svd(once - once.mean(axis=0), compute_uv=False)
    if lengths.size == 2 and lengths[0] - lengths[1] > 1e-2 * lengths[0] and lengths[1] > 1e-2 * lengths[0]:
        assert between(once) == pytest.approx(between(again), abs=1e-5)
        sure = np.abs(once) > 1e-3 * np.abs(once).max()
        if sure.all():
            assert again == pytest.approx(once, abs=1e-3)


@pytest.mark.parametrize("icons", [3, 6, 20])
def test_no_step_raises_the_stress(icons: int) -> None:
    wanted = random_distances(icons, icons)
    points = classical(wanted)
    seen = [float(stress(wanted, points))]
    for _ in range(40):
        points = smacof(wanted, points, steps=1)
        seen.append(float(stress(wanted, points)))
    assert np.all(np.diff(seen) <= 1e-12)
    assert seen[-1] < seen[0]


def test_many_maps_at_once_are_those_one_by_one() -> None:
    wanted = np.stack([random_distances(5, seed) for seed in range(4)])
    start = np.stack([classical(one) for one in wanted])
    together = smacof(wanted, start, steps=30, tolerance=0.0)
    assert together == pytest.approx(np.stack([smacof(w, s, 30, 0.0) for w, s in zip(wanted, start, strict=True)]))


@given(st.integers(0, 50))
def test_procrustes_undoes_turns_mirrors_and_shifts(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, angle = rng.normal(size=(5, 2)), rng.uniform(0, 6.28)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = points @ turn * [1.0, rng.choice([-1.0, 1.0])] + rng.normal(size=2)
    assert laid_onto(moved, moved, points) == pytest.approx(points)


def test_an_edited_set_is_found_where_it_was() -> None:
    points = np.array([[0.0, 0.0], [6.0, 1.0], [1.0, 5.5], [7.0, 6.0]])
    before = perceptual_map(between(points), list("abcd"))
    moved = points.copy()
    moved[3] += [-0.5, 2.5]  # one icon is edited, and the longer axis changes
    after = perceptual_map(between(moved[[3, 1, 0, 2]]), list("dbac"), reference=before)
    near = np.linalg.norm(after.points[[2, 1, 3]] - before.points[:3], axis=1)
    assert near.max() < 1.6
    grown = perceptual_map(between(np.vstack([points, [3.0, 3.0]])), list("abcde"), reference=before)
    assert grown.points[:4] == pytest.approx(before.points, abs=1e-6)
    other = perceptual_map(between(points), list("wxyz"), reference=before)
    assert other.points == pytest.approx(before.points)  # nothing in common: the convention holds
    assert not other.points.flags.writeable


def test_ellipses_are_the_spread_of_people() -> None:
    points = np.array([[0.0, 0.0], [6.0, 1.0], [1.0, 5.0]])
    wanted = between(points)
    people = wanted * np.linspace(0.8, 1.2, 21)[:, None, None]
    found = perceptual_map(wanted, list("abc"), people)
    assert found.people == 21
    assert found.covariance is not None
    radius = np.linalg.norm(found.points, axis=1)
    for covariance, r in zip(found.covariance, radius, strict=True):
        values = np.linalg.eigvalsh(covariance)
        assert values[0] == pytest.approx(0.0, abs=1e-4)  # larger or smaller only, so along one line
        assert np.sqrt(values[1]) == pytest.approx(r * np.linspace(0.8, 1.2, 21).std(ddof=1), rel=1e-3)
    same = perceptual_map(wanted, list("abc"), np.stack([wanted] * 3))
    assert same.covariance == pytest.approx(np.zeros((3, 2, 2)), abs=1e-9)
    assert perceptual_map(wanted, list("abc"), wanted[None]).covariance is None


def test_icons_that_nobody_tells_apart_are_one_point() -> None:
    assert perceptual_map(np.zeros((3, 3)), list("abc")).points == pytest.approx(np.zeros((3, 2)))
    assert perceptual_map([[0.0]], ["a"]).points.tolist() == [[0.0, 0.0]]
    two = perceptual_map([[0.0, 4.0], [4.0, 0.0]], list("ab"))
    assert two.points == pytest.approx(np.array([[-2.0, 0.0], [2.0, 0.0]]), abs=1e-12)
    equal = perceptual_map(3.0 * (1 - np.eye(3)), list("abc"))
    assert equal.points[0] == pytest.approx([-(3.0**0.5), 0.0], abs=1e-6)  # no longer axis: the first icon sets it


def test_the_first_icon_is_left_and_above() -> None:
    for seed in range(8):
        found = perceptual_map(random_distances(6, seed), list("abcdef"))
        assert found.points[0, 0] < 0 < found.points[0, 1]
        assert np.ptp(found.points[:, 0]) > 0.5 * np.ptp(found.points[:, 1])
