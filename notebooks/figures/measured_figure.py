"""The figure of measurements: each condition over its prediction, and the predictions of sets before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .observed_figure import draw_sets, legend_of
from .overview import BROAD, COOL, INK, WARM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.perception.pilot.measured import MeasuredPilot


def measured_figure(found: MeasuredPilot) -> Figure:
    """Draw measurements: grey bars are 95 % as predicted, blue ones after the values were used, dots measured."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 1.8 + 0.36 * max(len(found.conditions), 5)), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1.4, 1.0])
    _conditions(left, found)
    draw_sets(right, found)
    figure.legend(
        handles=legend_of("predicted after the values, 95 %", "measured"),
        loc="outside upper center",
        ncols=3,
        frameon=False,
        fontsize=9,
    )
    return figure


def _conditions(ax: Axes, found: MeasuredPilot) -> None:
    """Each condition as a ratio to the median of its prediction, so that all units share one axis."""
    places = np.arange(len(found.conditions))[::-1]
    for place, (before, after) in zip(places.tolist(), found.conditions, strict=True):
        unit = before.predicted[0]
        for (middle, low, high), color, width in ((before.predicted, BROAD, 8.0), (after.predicted, COOL, 2.5)):
            ax.plot([low / unit, high / unit], [place, place], color=color, lw=width, solid_capstyle="butt")
            ax.plot([middle / unit], [place], color=INK if color == BROAD else color, marker="|", ms=9)
        ax.plot([before.observed / unit], [place], color=WARM, marker="o", ms=5, zorder=5)
    names = [
        f"{before.condition.label}\n{before.observed:.3g} {before.condition.unit}" for before, _ in found.conditions
    ]
    ax.set_yticks(places, names, fontsize=8)
    ax.set_ylim(-0.7, len(names) - 0.3)
    ax.set_xscale("log")
    ends = ax.get_xlim()
    ticks = [tick for tick in (0.125, 0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0, 8.0) if ends[0] <= tick <= ends[1]]
    ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.set_xticks([], minor=True)
    ax.tick_params(axis="x", labelsize=8)
    ax.grid(axis="x", alpha=0.25, linewidth=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_title("group means over the predicted median", fontsize=10)
