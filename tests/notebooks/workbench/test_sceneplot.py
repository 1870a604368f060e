"""The still figure of a scene: the same panels, bands, spans, marks and words."""

from __future__ import annotations

import io

import pytest
from matplotlib.figure import Figure

from thermicon.circuit import Rig
from thermicon.notebooks.timeline.scene import scene
from thermicon.notebooks.workbench.scene_plot import MOST_LINES, scene_figure, title_lines

DIP = "cue 1\nicon dip { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }\n"
DEEP = "cue 1\nicon deep { cool by 9 °C at 10 °C/s; hold for 4 s; return at 1 °C/s }\n"


@pytest.fixture(scope="module")
def rig() -> Rig:
    """The default rig."""
    return Rig.load("thenar")


def labels(figure: Figure, panel: int) -> str:
    """All that the legend of a panel says."""
    legend = figure.axes[panel].get_legend()
    assert legend is not None
    return "\n".join(text.get_text() for text in legend.get_texts())


def test_a_figure_has_the_panels_of_the_overview_with_bands_and_marks(rig: Rig) -> None:
    figure = scene_figure(scene(DIP, rig))
    assert len(figure.axes) == 4
    said = labels(figure, 0)
    for word in ("cold threshold\n0.062 K (fast change)", "warm threshold", "physical peak (cold)\n", "skin"):
        assert word in said
    assert "felt peak (cold)\n" in labels(figure, 3)
    assert "reported as cold" in labels(figure, 3)
    assert (
        figure.get_suptitle()
        == "dip on the thenar rig\nGREEN  limits kept: in this simulation (export judges worst cases)"
    )


def test_unreached_stretches_are_shaded_and_the_title_says_why(rig: Rig) -> None:
    figure = scene_figure(scene(DEEP, rig))
    assert "unreachable:\ncurrent limit" in labels(figure, 0)
    assert "unreachable:\ncurrent limit" in labels(figure, 2)
    assert "deep is not reached: it misses its target by" in figure.get_suptitle()


def test_a_stale_drawing_says_so(rig: Rig) -> None:
    figure = scene_figure(scene(DIP.replace("6 °C", "6"), rig, before=scene(DIP, rig)))
    first, second, third = figure.get_suptitle().splitlines()
    assert first == "dip on the thenar rig, as it was before the errors"
    assert second == "GREY  safety not judged: the text has errors"
    assert third == "line 2: missing unit: this number has no unit"


def test_a_scene_without_a_drawing_is_a_figure_of_words(rig: Rig) -> None:
    figure = scene_figure(scene("", rig))
    assert figure.axes == []
    assert "line 1: empty file: nothing but white space" in figure.get_suptitle()


def test_the_title_stays_short(rig: Rig) -> None:
    lines = title_lines(scene(DIP, rig, notes=[f"note {n}" for n in range(30)]))
    assert len(lines) == MOST_LINES
    assert lines[-1] == "and 26 more lines"


def test_a_changed_rig_is_named_and_the_figure_can_be_saved(rig: Rig) -> None:
    figure = scene_figure(scene(DIP, rig.with_(**{"skin.rest_C": 33})))
    assert "with skin.rest_C=33" in figure.get_suptitle()
    figure.savefig(io.BytesIO(), format="png", dpi=40)
