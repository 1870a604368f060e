"""A scene as a still figure, where widgets cannot run: the overview of its icon, with what a design has to keep to."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from ..figures.overview import overview
from ..figures.style import COOL, GREY, INK, LIMIT, WARM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..timeline.scene import Drawing, Scene

_COLOURS = {"cold": COOL, "warm": WARM}
_STYLES = {"onset": ":", "felt peak": "--", "physical peak": "-"}
WIDEST = 110
MOST_LINES = 6


def scene_figure(scene: Scene) -> Figure:
    """Return a matplotlib Figure of a scene: threshold bands, unreached spans, events; safety and notes as its title.

    A scene without a drawing gives a figure that says why. Nothing is shown.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.notebooks.timeline.scene import scene
    >>> scene_figure(scene("cue 1; icon dip { cool by 6 at 3 °C/s }", Rig.load("thenar"))).get_suptitle().splitlines()
    ['GREY  safety not judged: the text has errors', 'line 1: missing unit: this number has no unit']
    """
    from matplotlib.figure import Figure

    lines = title_lines(scene)
    if scene.drawing is None:
        figure = Figure(figsize=(8.0, 2.0), layout="constrained")
        figure.suptitle("\n".join(lines), fontsize=10, x=0.01, ha="left")
        return figure
    figure = overview(scene.drawing.trace, scene.drawing.percept, scene.drawing.rig.changes)
    temperatures, _, current, sensation = figure.axes
    _bands(scene.drawing, temperatures)
    _missed(scene.drawing, temperatures, current)
    _moments(scene.drawing, temperatures, sensation)
    for ax in (temperatures, current, sensation):
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8, handlelength=2.6)
    head = figure.get_suptitle() + (", as it was before the errors" if scene.stale and scene.troubles else "")
    figure.suptitle("\n".join([head, *lines]), fontsize=10)
    return figure


def title_lines(scene: Scene) -> list[str]:
    """Return what the figure says in words: the badge, then errors and notes, six lines at most."""
    badge = scene.badge
    told = [
        f"{badge.colour.upper()}  {badge.text}",
        *(f"line {trouble.line}: {trouble.headline}" for trouble in scene.troubles),
        *scene.notes,
    ]
    rows = [row for text in dict.fromkeys(told) for row in textwrap.wrap(text, WIDEST)]
    left = len(rows) - MOST_LINES + 1
    return rows if left <= 1 else [*rows[: MOST_LINES - 1], f"and {left} more lines"]


def _bands(drawing: Drawing, ax: Axes) -> None:
    for band in drawing.bands:
        label = f"{band.channel} threshold\n{band.change_K:.2g} K (fast change)"
        ax.axhspan(band.low_C, band.high_C, color=_COLOURS[band.channel], alpha=0.3, lw=0, label=label)


def _missed(drawing: Drawing, *axes: Axes) -> None:
    for ax in axes:
        for n, missed in enumerate(drawing.missed):
            label = missed.label.replace(": ", ":\n") if n == 0 else None
            ax.axvspan(
                missed.from_s, missed.to_s, facecolor=LIMIT, edgecolor=LIMIT, alpha=0.15, hatch="//", lw=0, label=label
            )


def _moments(drawing: Drawing, temperatures: Axes, sensation: Axes) -> None:
    """Mark the peaks: the skin's where temperatures are, felt ones with sensation, whose onset the overview marks."""
    for moment in drawing.moments:
        if moment.kind == "onset":
            continue
        ax = temperatures if moment.kind == "physical peak" else sensation
        colour = _COLOURS.get(moment.channel, INK)
        label = moment.label.replace(") ", ")\n")
        ax.axvline(moment.time_s, color=colour, lw=1.0, ls=_STYLES[moment.kind], label=label)
    temperatures.axhline(drawing.trace.skin_C[0], color=GREY, lw=0.5, zorder=0)
