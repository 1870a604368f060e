"""Pictures of mechanisms and of the inference: what is drawn is what was computed, and nothing covers anything."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.text import Text

from mechanisms.draw_effects import STAGES, plot_effect, plot_onset_stages
from mechanisms.draw_evidence import (
    plot_ablation,
    plot_left_out,
    plot_narrowing,
    plot_published_predicted,
)
from mechanisms.effects import EFFECTS, Curve, Effect
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception.evidence.conditioning import onset_stages
from thermicon.perception.evidence.results import load_ablation, load_constants, load_predictions

effect_of = pytest.fixture(scope="module")(lambda: {name: effect() for name, effect in EFFECTS.items()})


def tick_names(axes: Axes) -> list[str]:
    return [label.get_text() for label in axes.get_yticklabels()]


def inside(axes: Axes) -> bool:
    """Whether titles, labels and numbers of the axes lie inside the figure."""
    figure = axes.figure
    figure.draw_without_rendering()
    ticks = [*axes.get_xticklabels(), *axes.get_yticklabels(), *axes.get_xticklabels(minor=True)]
    texts = [text for text in axes.findobj(Text) if text not in ticks] + axes.get_yticklabels()
    boxes = [text.get_window_extent() for text in texts if text.get_text() and text.get_visible()]
    return all(figure.bbox.x0 <= b.x0 and b.x1 <= figure.bbox.x1 and figure.bbox.y0 <= b.y0 for b in boxes)


def named(effect: Effect, start: str) -> Curve:
    return next(curve for curve in effect.curves if curve.label.startswith(start))


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_is_drawn_with_every_curve_and_its_units(effect_of: dict[str, Effect], name: str) -> None:
    effect = effect_of[name]
    axes = plot_effect(effect)
    assert [line.get_label() for line in axes.lines] == [curve.label for curve in effect.curves]
    assert (axes.get_xlabel(), axes.get_ylabel()) == (effect.x_label, effect.y_label)
    looks = [(line.get_color(), line.get_linestyle(), line.get_linewidth()) for line in axes.lines]
    assert len(set(looks)) == len(looks), "two curves look alike"
    assert inside(axes)


def test_without_its_limit_cold_is_felt_before_the_skin_is_cool(effect_of: dict[str, Effect]) -> None:
    limits = effect_of["limits"]
    cold, free = named(limits, "cold"), named(limits, "cold, limit off")
    early = cold.x < 5.5
    assert cold.y[early].max() < 0.5 < free.y[early].max()


def test_adaptation_is_complete_inside_the_neutral_zone_alone(effect_of: dict[str, Effect]) -> None:
    kept = {curve.label: curve.y[-1] / curve.y.max() for curve in effect_of["adaptation"].curves}
    assert kept["to 31 °C"] < 0.1
    assert kept["to 24 °C"] > 0.9


def test_the_stratum_corneum_of_the_palm_delays_and_weakens(effect_of: dict[str, Effect]) -> None:
    depth = effect_of["depth"]
    assert np.all(named(depth, "thenar, below").y[50:] > named(depth, "forearm, below").y[50:])


def test_summation_has_ends_only_with_the_mechanism(effect_of: dict[str, Effect]) -> None:
    summation = effect_of["summation"]
    ends, free = named(summation, "cold"), named(summation, "cold, no ends")
    assert ends.y[-1] < 0.1 * free.y[-1]
    assert ends.y[0] > 5.0 * free.y[0]


def test_gain_noise_makes_the_psychometric_function_wider(effect_of: dict[str, Effect]) -> None:
    def width(curve: Curve) -> float:
        quarter, three = np.interp((25.0, 75.0), curve.y, curve.x)
        return float(three - quarter)

    noisy, quiet = effect_of["gain-noise"].curves
    assert width(noisy) > 1.1 * width(quiet)


def test_cautious_people_notice_larger_falls(effect_of: dict[str, Effect]) -> None:
    lax, middle, cautious = (float(np.interp(50.0, c.y, c.x)) for c in effect_of["criteria"].curves)
    assert lax < middle < cautious


def test_a_curve_checks_its_shape() -> None:
    with pytest.raises(ValueError, match="limit off: a curve needs as many x as y"):
        Curve("limit off", "off", np.zeros(3), np.zeros(2))


def test_stages_add_up_to_the_onset_and_are_drawn_in_order() -> None:
    stages = onset_stages(load_library("six-icons"), Rig.load("thenar"))
    axes = plot_onset_stages(stages)
    assert tick_names(axes) == [f"{each.icon}, {each.onset_s:.2f} s" for each in stages]
    assert len(axes.patches) == len(STAGES) * len(stages)
    ends = np.array([bar.get_x() + bar.get_width() for bar in axes.patches]).reshape(len(STAGES), -1)
    np.testing.assert_allclose(ends[-1], [each.onset_s for each in stages])
    assert all(each.leg_s > each.onset_s for each in stages)
    assert inside(axes)


def test_the_ablation_is_drawn_by_its_difference() -> None:
    rows = load_ablation()
    axes = plot_ablation(rows)
    drawn = [bar.get_width() for bar in axes.patches[1:]]
    assert drawn == sorted(row.difference for row in rows if row.without or row.difference)
    assert "heat flow" in tick_names(axes)
    assert inside(axes)


def test_missed_rows_have_an_open_marker() -> None:
    rows = load_predictions()
    axes = plot_left_out(rows)
    points = [line for line in axes.lines if line.get_marker() in "os^" and line.get_linestyle() == "None"]
    hollow = [line.get_markerfacecolor() == "w" for line in points]
    assert hollow == [abs(row.score) > 1.959964 for row in rows]
    assert inside(axes)


def test_predictions_are_drawn_over_the_published_number() -> None:
    row = next(row for row in load_predictions() if row.unit == "s")
    axes = plot_published_predicted([replace(row, published=2.0, left_out=3.0, left_out_low=1.0, left_out_high=6.0)])
    interval, middle = axes.lines[1], axes.lines[2]
    assert list(interval.get_xdata()) == [0.5, 3.0]
    assert float(np.asarray(middle.get_xdata())[0]) == 1.5
    assert inside(plot_published_predicted(load_predictions()))


def test_constants_are_drawn_by_how_far_they_were_narrowed() -> None:
    axes = plot_narrowing(load_constants())
    shown = tick_names(axes)
    assert shown[0] == min((c for c in load_constants() if c.unit != "SD"), key=lambda c: c.narrowed).name
    assert "thenar cold" not in shown
    assert inside(axes)
