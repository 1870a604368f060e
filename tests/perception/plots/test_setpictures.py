from collections.abc import Sequence
from statistics import NormalDist
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.axes import Axes

from tests.legible import troubles
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import Percept, Ranking, plot, rank
from thermicon.perception.identification.map import MOST_CELLS, MOST_PEOPLE, between, map_of, perceptual_map
from thermicon.perception.plots.draw_heat import clustered_order, heat, light_map, plot_confusion, plot_distance
from thermicon.perception.plots.draw_map import label_offsets, plot_map, text_width
from thermicon.perception.plots.plot import plot_roc


@pytest.fixture(scope="module")
def ranking() -> Ranking:
    return rank(load_library("wilson-ramps"), Rig.load("thenar"), people=8, seed=1, parameters=0)


def boxes(axes: Axes, texts: Sequence[str]) -> list[tuple[float, float, float, float]]:
    """Boxes of texts, none of which covers another."""
    assert troubles(axes.get_figure(root=True)) == []
    return [t.get_window_extent().extents for t in axes.texts if t.get_text() in texts]


def test_near_icons_stand_side_by_side() -> None:
    line = np.array([[0.0], [9.0], [1.0], [8.0], [2.0]])
    assert clustered_order(between(line)).tolist() == [0, 2, 4, 3, 1]
    for icons in (2, 4):
        assert sorted(clustered_order(np.zeros((icons, icons))).tolist()) == list(range(icons))


def test_heat_maps_are_in_that_order_and_say_every_number(ranking: Ranking) -> None:
    order = clustered_order(ranking.d_prime)
    assert order.tolist() != list(range(8))
    for axes, values in ((plot_distance(ranking), ranking.d_prime), (plot_confusion(ranking), 100 * ranking.confusion)):
        names = [ranking.labels[k] for k in order]
        assert [label.get_text() for label in axes.get_xticklabels()] == names
        assert [label.get_text() for label in axes.get_yticklabels()] == names
        shown = np.array([float(t.get_text()) for t in axes.texts]).reshape(8, 8)
        assert shown == pytest.approx(values[np.ix_(order, order)], abs=0.51)
        assert len(axes.figure.axes) == 1


def test_shades_grow_darker_all_the_way_in_grey_and_numbers_are_readable_on_each() -> None:
    places = np.linspace(0.0, 1.0, 256)
    grey = light_map()(places)[:, :3] @ [0.299, 0.587, 0.114]
    assert np.all(np.diff(grey) < 0)
    assert grey[0] > 0.99
    axes = heat(["a"] * places.size, ["b"], places[None])
    shades = light_map()(places)[:, :3]
    linear = np.where(shades <= 0.04045, shades / 12.92, ((shades + 0.055) / 1.055) ** 2.4)
    for text, shade in zip(axes.texts, linear @ [0.2126, 0.7152, 0.0722], strict=True):
        light, dark = (1.0, shade) if text.get_color() == "white" else (shade, 0.0)
        assert (light + 0.05) / (dark + 0.05) >= 4.5


def test_many_icons_have_a_colour_bar_instead_of_numbers() -> None:
    names = [f"icon-{k}" for k in range(31)]
    axes = heat(names, names, np.ones((31, 31)))
    assert not axes.texts
    assert len(axes.figure.axes) == 2
    (label,) = heat(["x"], ["a" * 30 + "b" * 30], np.ones((1, 1))).get_yticklabels()
    assert label.get_text() == "a" * 22 + "…" + "b" * 21


@pytest.mark.slow
def test_the_map_shows_every_icon_and_its_stress(ranking: Ranking) -> None:
    found = map_of(ranking)
    axes = plot_map(found)
    assert axes.get_title("left") == f"perceptual map (stress {found.stress:.2f})"
    assert {t.get_text() for t in axes.texts} == {*ranking.labels, "ellipses: 50 % of 8 people"}
    assert len(axes.patches) == 16
    assert len(boxes(axes, ranking.labels)) == 8
    assert found.plot().get_xlabel() == "d′"


@pytest.mark.parametrize("icons", [1, 2, 12])
def test_names_do_not_cover_one_another(icons: int) -> None:
    names = [f"ramp_extent={k}_rate=1" for k in range(icons)]
    axes = plot_map(perceptual_map(between(np.random.default_rng(3).normal(size=(icons, 3))), names))
    found = boxes(axes, names)
    assert len(found) == icons
    left, low, right, high = axes.get_window_extent().extents
    assert all(left - 2 < box[0] and box[2] < right + 2 and low - 2 < box[1] and box[3] < high + 2 for box in found)


def test_names_of_icons_at_one_point_are_all_there() -> None:
    dots = np.full((4, 2), 150.0)
    offsets = label_offsets(dots, ["same"] * 4, np.array([300.0, 300.0]))
    assert len({tuple(offset) for offset in offsets.round(3).tolist()}) == 4
    assert text_width("wide name", 9.0) > text_width("name", 9.0) > 20
    assert text_width(" ", 9.0) == 0.0


@pytest.mark.parametrize(("icons", "people"), [(3, MOST_PEOPLE), (64, MOST_CELLS // 64**2)])
def test_a_map_is_of_few_people_of_many_and_of_fewer_of_many_icons(icons: int, people: int) -> None:
    apart, labels = between(np.random.default_rng(0).normal(size=(icons, 2))), [f"i{k}" for k in range(icons)]
    felt = SimpleNamespace(d_prime=np.stack([apart] * (MOST_PEOPLE + 5)))
    found = map_of(SimpleNamespace(icons=range(icons), d_prime=apart, labels=labels, felt=felt))  # type: ignore[arg-type]
    assert found.people == people


def test_hits_against_false_alarms_follow_d_prime(ranking: Ranking) -> None:
    pair, cdf = ranking.pairs[0], NormalDist().cdf
    chance, curve = plot(pair).get_lines()
    alarms, hits = (np.asarray(each) / 100.0 for each in curve.get_data())
    place = int(np.abs(alarms - (1.0 - cdf(0.5 * pair.d_prime))).argmin())
    assert hits[place] == pytest.approx(cdf(0.5 * pair.d_prime), abs=0.02)
    assert abs(np.trapezoid(hits, alarms)) == pytest.approx(cdf(pair.d_prime / 2**0.5), abs=1e-3)
    assert chance.get_linestyle() == ":"
    felt = Percept(np.array([1.0, 2.5, 1.0]), np.zeros(3), 0.01, None, None, 0.0, icon="dip")
    axes = plot_roc(felt)
    assert [t.get_text() for t in axes.get_legend().get_texts()] == ["chance", "cold: d′ 1.50, area 0.856"]
    assert axes.get_title() == "dip"
