"""Figures for people in one style."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import PathCollection

from thermicon.circuit import Rig, fit, simulate
from thermicon.circuit.fitting.fit_figure import fit_figure
from thermicon.circuit.fitting.synthetic_log import synthetic_log
from thermicon.circuit.solver import draw as circuit_draw
from thermicon.icons import load_library, parse
from thermicon.notebooks import overview
from thermicon.notebooks.figures.overview import MOST_LINES, scene_figure
from thermicon.notebooks.figures.print_figure import restyle
from thermicon.notebooks.figures.set_figures import observed_figure, set_figure
from thermicon.notebooks.figures.style import COOL, WARM, Look
from thermicon.notebooks.figures.sweep_figure import COOLS, PANELS, WARMS
from thermicon.notebooks.timeline.scene import scene
from thermicon.perception import Percept, perceive, rank
from thermicon.perception.pilot.observed import observed
from thermicon.perception.pilot.trials import Trials


@pytest.fixture(scope="module")
def percept() -> Percept:
    return perceive(simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"), tail_s=4.0))


def test_cool_and_warm_have_one_colour_everywhere(percept: Percept) -> None:
    assert (COOL, WARM) == (circuit_draw.COOL, circuit_draw.WARM) == ("#2166ac", "#e08214")
    assert [line.get_color() for line in percept.plot().get_lines()[:2]] == [COOL, WARM]
    assert "<svg" in percept._repr_html_()
    assert COOL in COOLS
    assert WARM in WARMS


def test_an_overview_names_what_was_changed_and_the_clock_of_the_onset(percept: Percept) -> None:
    rig = Rig.load("thenar").with_(**{"contact.area_cm2": 4})
    trace = simulate(load_library("six-icons")["cooling-step"], rig)
    figure = overview(trace, percept, rig.changes)
    assert figure.get_suptitle() == "cooling-step on the thenar rig with contact.area_cm2=4"
    assert overview(trace).get_suptitle() == "cooling-step on the thenar rig"
    sensation = figure.axes[-1]
    assert sensation.get_ylabel() == "sensation (d′)\nreceptor clock"
    label = sensation.get_legend().get_texts()[-1].get_text()
    assert label == f"reported as cold\nat {percept.onset_s:.2f} s by the\nnominal person\n(response clock)"


def test_the_maps_of_one_icon_are_one_cell() -> None:
    icons = parse("cue 1\nset s { control display }\nicon a { cool by 2 °C at 1 °C/s; hold for 1 s }")
    ranking = rank(icons, Rig.load("thenar"), people=1)
    assert [len(ax.texts) for ax in set_figure(ranking).axes] == [1, 1]


@pytest.mark.parametrize("look", [Look(), Look(85.0)])
def test_observed_answers_stand_beside_the_predicted_ones(look: Look) -> None:
    icons = load_library("six-icons")
    names = tuple(icon.name for icon in icons)
    found = observed(Trials(names, ("P",), 5.0 * np.eye(6)[None] + 1.0), icons, "thenar", draws=20)
    seen, predicted, correct = observed_figure(found, look).axes
    assert {text.get_text() for text in seen.texts} == {"55", "9.1"}
    assert len(predicted.texts) == 36 and "Before and after" in correct.get_title("left")


def test_two_maps_below_one_another_name_the_columns_once() -> None:
    ranking = rank(load_library("six-icons"), Rig.load("thenar"), people=2)
    figure = set_figure(ranking, Look(85.0))
    restyle(figure, 85.0)
    upper, lower = figure.axes
    assert upper.get_xticklabels() == [] and len(lower.get_xticklabels()) == 6
    assert upper.get_title().endswith("Predicted d′ between icons")
    assert float(figure.get_figheight()) * 25.4 < 115.0


def test_a_sweep_marks_what_was_not_reached_and_bands_of_people() -> None:
    names, values = ["dip", "dip", "all icons", "all icons"], [0.5, 1.5, 0.5, 1.5]
    frame = pd.DataFrame({
        "icon": names, "driver.current_limit_A": values, "reached": [False, True, None, None],
        "cold_receptor_peak_change_K": [-1.0, -2.0, None, None],
        "named": [0.81, 0.93, 0.81, 0.93], "named_low": [0.72, 0.85, 0.72, 0.85],
        "named_high": [0.9, 0.96, 0.9, 0.96],
    })  # fmt: skip
    frame["reached"] = frame["reached"].astype("boolean")
    figure = overview(frame)
    (ax,) = figure.axes
    assert ax.get_ylim()[0] < 72.0 and ax.get_ylim()[1] == 100.5
    said = [text.get_text() for text in figure.legends[0].get_texts()]
    assert said == ["dip", "all icons", "95 % interval, new laboratory", "not reached"]
    points = [held.get_offsets().tolist() for held in ax.collections if isinstance(held, PathCollection)]
    assert points == [[[0.5, 81.0]]]
    assert figure.get_supxlabel() == "driver current limit (A)"
    same = {column: [1.0, 1.0] for columns, _ in PANELS for column in columns} | {"energy_J": [1.0, 2.0]}
    figure = overview(pd.DataFrame({"icon": "dip", "contact.area_cm2": [4.0, 9.0], "reached": [True, True], **same}))
    figure.draw_without_rendering()
    assert figure.get_tightbbox().width < figure.get_figwidth(), "what is the same at all values is cut off"


def test_a_fit_in_a_column_has_its_panels_below_one_another_and_one_key() -> None:
    rig = Rig.load("thenar").with_(**{"driver.update_Hz": 20})
    log = synthetic_log(rig, seed=1, rate_Hz=20.0)
    figure = fit_figure(fit(log, rig, free=["contact.resistance_m2K_per_W"]), across=1)
    assert [ax.get_title() for ax in figure.axes[::2]] == ["display", "voltage"]
    assert figure.get_suptitle() == "thenar fitted to synthetic.csv"
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["measured", "fitted"]
    assert len({round(ax.get_position().x0, 2) for ax in figure.axes}) == 1


DIP = "cue 1\nicon dip { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }\n"
DEEP = "cue 1\nicon deep { cool by 9 °C at 10 °C/s; hold for 4 s; return at 1 °C/s }\n"
RIG = Rig.load("thenar")


def test_a_figure_has_the_panels_of_the_overview_and_the_title_says_why_it_is_not_reached() -> None:
    figure = scene_figure(scene(DIP, RIG))
    assert len(figure.axes) == 4
    assert figure.get_suptitle().startswith("dip on the thenar rig\nGREEN  limits kept: in this simulation")
    assert "deep is not reached: it misses its target by" in scene_figure(scene(DEEP, RIG)).get_suptitle()


def test_the_title_says_what_is_stale_wrong_changed_and_no_more() -> None:
    stale = scene_figure(scene(DIP.replace("6 °C", "6"), RIG, before=scene(DIP, RIG))).get_suptitle().splitlines()
    assert stale[0] == "dip on the thenar rig, as it was before the errors"
    assert stale[1].startswith("GREY  safety not judged")
    assert stale[2].startswith("line 2: missing unit")
    empty = scene_figure(scene("", RIG))
    assert empty.axes == []
    assert "line 1: empty file" in empty.get_suptitle()
    assert "with skin.rest_C=33" in scene_figure(scene(DIP, RIG.with_(**{"skin.rest_C": 33}))).get_suptitle()
    lines = scene_figure(scene("", RIG, notes=[f"note {n}" for n in range(30)])).get_suptitle().splitlines()
    assert (len(lines), lines[-1]) == (MOST_LINES, "and 27 more lines")
