"""The figure of a set: distances and confusions side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermicon.perception import Ranking

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
