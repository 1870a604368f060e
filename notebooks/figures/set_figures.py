"""Figures of a set: distances and confusions side by side, and predicted answers beside observed ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermicon.perception import Ranking
    from thermicon.perception.pilot.observed import Observed

FLAT = 0.75
"""Height of a cell to its width, where two heat maps stand below one another."""


def set_figure(ranking: Ranking, stacked: bool = False) -> Figure:
    """Draw distances (d′) and predicted confusions of one set side by side; stacked in a narrow column, as asked."""
    from matplotlib.figure import Figure

    from thermicon.perception.plots import draw_heat

    longest = max(map(len, map(draw_heat.short, ranking.labels)))
    side = max(4.2, 1.2 + 0.07 * longest + 0.45 * len(ranking.labels))
    down, across = (2, 1) if stacked else (1, 2)
    names = 0.06 * longest if stacked else 0.0  # of the upper one, which stand below the lower one
    high = down * (FLAT if stacked else 1.0) * side - names
    figure = Figure(figsize=(across * (side + 0.6), high), layout="constrained")
    distance, confusion = figure.subplots(down, across)
    draw_heat.plot_distance(ranking, ax=distance)
    draw_heat.plot_confusion(ranking, ax=confusion)
    if stacked:
        distance.set_xlabel("")
        distance.tick_params(labelbottom=False)
        for ax in (distance, confusion):
            ax.set_aspect(FLAT)
    return figure


def observed_figure(found: Observed[Any, Any], stacked: bool = False) -> Any:
    """Draw observed beside predicted answers, and per cent correct before and after; of measurements that alone."""
    from matplotlib.figure import Figure

    from thermicon.perception.pilot.conditioning import Answered
    from thermicon.perception.plots import draw_heat

    if not isinstance(found.data, Answered):
        return found.plot().figure
    names, counts = list(found.data.trials.icons), found.data.trials.pooled
    observed = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    maps = {"Observed": observed, "Predicted": found.conditioned.simulated.pooled.mean(axis=0)}
    side = max(4.2, 1.2 + 0.07 * max(map(len, names)) + 0.45 * len(names))
    low = 1.4 + 0.6 * len(found.predictions)
    rows: Any = [["Observed", "Predicted"], ["after"] * 2]
    heights = [side, low]
    if stacked:
        rows, heights = [[name] for name in (*maps, "after")], [FLAT * (side - 0.6), FLAT * side, low]
    figure = Figure(figsize=(len(rows[0]) * (side + 0.6), sum(heights)), layout="constrained")
    axes = figure.subplot_mosaic(rows, height_ratios=heights)
    for title, values in maps.items():
        draw_heat.heat(names, names, 100.0 * values, axes[title], top=100.0, bend=0.5)
        axes[title].set(title=f"{title} answers, %", xlabel="answered", ylabel="presented")
        if stacked:
            axes[title].set_aspect(FLAT)
    if stacked:
        axes["Observed"].set_xlabel("")
        axes["Observed"].tick_params(labelbottom=False)
    found.plot(axes["after"])
    return figure
