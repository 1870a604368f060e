"""Pictures of mechanisms or of the inference: computed curves, legible labels."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes

from mechanisms.draw_effects import STAGES, plot_effect, plot_onset_stages
from mechanisms.draw_evidence import (
    plot_ablation,
    plot_left_out,
    plot_narrowing,
    plot_published_predicted,
)
from mechanisms.effects import EFFECTS, Curve, Effect
from mechanisms.onset_stages import onset_stages
from tests.legible import troubles
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import Observer
from thermicon.perception.evidence.results import load_ablation, load_constants, load_predictions

effect_of = pytest.fixture(scope="module")(lambda: {name: effect() for name, effect in EFFECTS.items()})


def tick_names(axes: Axes) -> list[str]:
    return [label.get_text() for label in axes.get_yticklabels()]


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
    assert troubles(axes.figure) == []


def cold_is_felt_late_with_its_limit(limits: Effect) -> bool:
    cold, free = named(limits, "cold"), named(limits, "cold, limit off")
    early = cold.x < 35.5
    return bool(cold.y[early].max() < 0.5 < free.y[early].max())


def adaptation_is_complete_inside_the_neutral_zone_alone(adaptation: Effect) -> bool:
    kept = {curve.label: curve.y[-1] / curve.y.max() for curve in adaptation.curves}
    return bool(kept["to 31 °C"] < 0.1 and kept["to 24 °C"] > 0.9)


def the_palm_delays_and_weakens(depth: Effect) -> bool:
    return bool(np.all(named(depth, "thenar, below").y[50:] > named(depth, "forearm, below").y[50:]))


def summation_has_ends_only_with_the_mechanism(summation: Effect) -> bool:
    ends, free = named(summation, "cold"), named(summation, "cold, no ends")
    return bool(ends.y[-1] < 0.1 * free.y[-1] and ends.y[0] > 5.0 * free.y[0])


def gain_noise_widens_the_psychometric_function(effect: Effect) -> bool:
    noisy, quiet = (np.ptp(np.interp((25.0, 75.0), curve.y, curve.x)) for curve in effect.curves)
    return bool(noisy > 1.1 * quiet)


def cautious_people_notice_larger_falls(criteria: Effect) -> bool:
    lax, middle, cautious = (float(np.interp(50.0, c.y, c.x)) for c in criteria.curves)
    return lax < middle < cautious


SHOWN = {
    "limits": cold_is_felt_late_with_its_limit,
    "adaptation": adaptation_is_complete_inside_the_neutral_zone_alone,
    "depth": the_palm_delays_and_weakens,
    "summation": summation_has_ends_only_with_the_mechanism,
    "gain-noise": gain_noise_widens_the_psychometric_function,
    "criteria": cautious_people_notice_larger_falls,
}


@pytest.mark.parametrize("name", SHOWN)
def test_a_mechanism_does_what_its_picture_says(effect_of: dict[str, Effect], name: str) -> None:
    assert SHOWN[name](effect_of[name])


def test_stages_add_up_to_the_onset_and_are_drawn_in_order() -> None:
    stages = onset_stages(load_library("six-icons"), Rig.load("thenar"))
    axes = plot_onset_stages(stages)
    assert tick_names(axes) == [f"{each.icon}, {each.onset_s:.2f} s" for each in stages]
    assert len(axes.patches) == len(STAGES) * len(stages)
    ends = np.array([bar.get_x() + bar.get_width() for bar in axes.patches]).reshape(len(STAGES), -1)
    np.testing.assert_allclose(ends[-1], [each.onset_s for each in stages])
    assert all(each.leg_s > each.onset_s for each in stages)
    person = Observer.load()
    for each in stages:
        assert each.nerve_s + each.cord_s == pytest.approx(person.delay_s(each.channel, person.path_m("thenar")))
        assert each.decision_s == person.decision_s
    assert troubles(axes.figure) == []


def test_the_ablation_is_drawn_by_its_difference() -> None:
    rows = load_ablation()
    axes = plot_ablation(rows)
    drawn = [bar.get_width() for bar in axes.patches[1:]]
    assert drawn == sorted(row.difference for row in rows if row.without or row.difference)
    assert "heat flow" in tick_names(axes)
    assert troubles(axes.figure) == []


def test_missed_rows_have_an_open_marker() -> None:
    rows = load_predictions()
    axes = plot_left_out(rows)
    points = [line for line in axes.lines if line.get_marker() in "os^" and line.get_linestyle() == "None"]
    hollow = [line.get_markerfacecolor() == "w" for line in points]
    assert hollow == [abs(row.score) > 1.959964 for row in rows]
    assert troubles(axes.figure) == []


def test_predictions_are_drawn_over_the_published_number() -> None:
    row = next(row for row in load_predictions() if row.unit == "s")
    axes = plot_published_predicted([replace(row, published=2.0, left_out=3.0, left_out_low=1.0, left_out_high=6.0)])
    interval, middle = axes.lines[1], axes.lines[2]
    assert list(interval.get_xdata()) == [0.5, 3.0]
    assert float(np.asarray(middle.get_xdata())[0]) == 1.5
    assert troubles(plot_published_predicted(load_predictions()).figure) == []


def test_constants_are_drawn_by_how_far_they_were_narrowed() -> None:
    axes = plot_narrowing(load_constants())
    shown = tick_names(axes)
    assert shown[0] == min((c for c in load_constants() if c.unit != "SD"), key=lambda c: c.narrowed).name
    assert "thenar cold" not in shown
    assert troubles(axes.figure) == []
