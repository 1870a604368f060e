"""The still figure of a scene: the same panels, bands, spans, marks and words."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

from thermicon.circuit import Rig
from thermicon.notebooks.figures.overview import MOST_LINES, scene_figure
from thermicon.notebooks.timeline.scene import scene

DIP = "cue 1\nicon dip { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }\n"
DEEP = "cue 1\nicon deep { cool by 9 °C at 10 °C/s; hold for 4 s; return at 1 °C/s }\n"
RIG = Rig.load("thenar")


def labels(figure: Figure, panel: int) -> str:
    """All that the legend of a panel says."""
    legend = figure.axes[panel].get_legend()
    assert legend is not None
    return "\n".join(text.get_text() for text in legend.get_texts())


def test_a_figure_has_the_panels_of_the_overview_with_bands_and_marks() -> None:
    figure = scene_figure(scene(DIP, RIG))
    assert len(figure.axes) == 4
    said = labels(figure, 0)
    for word in ("cold threshold\n0.062 K (fast change)", "warm threshold", "physical peak (cold)\n", "skin"):
        assert word in said
    assert "felt peak (cold)\n" in labels(figure, 3)
    assert "reported as cold" in labels(figure, 3)
    assert figure.get_suptitle().startswith("dip on the thenar rig\nGREEN  limits kept: in this simulation")
    figure.savefig(io.BytesIO(), format="png", dpi=40)


def test_unreached_stretches_are_shaded_and_the_title_says_why() -> None:
    figure = scene_figure(scene(DEEP, RIG))
    assert "unreachable:\ncurrent limit" in labels(figure, 0)
    assert "unreachable:\ncurrent limit" in labels(figure, 2)
    assert "deep is not reached: it misses its target by" in figure.get_suptitle()


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
