"""Figures of a set as heat maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.perception.plots import draw_heat

from .style import SCREEN, Look, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermicon.perception import Ranking
    from thermicon.perception.pilot.observed import Observed

FLAT = 0.75
"""Height of a cell to its width, where two heat maps stand below one another."""
CELL_MM, LETTER_MM, LABEL_MM = 3.4, 1.1, 14.0
"""Widths in print: a cell with its number, a letter of a name, the label of the ordinate with its margins."""


def narrowest_mm(names: Sequence[str], beside: int = 1) -> float:
    """The least width of one or two heat maps of so many names at which each can be read."""
    return beside * (LABEL_MM + LETTER_MM * _longest(names) + CELL_MM * len(names))


def _longest(names: Sequence[str]) -> int:
    return max(len(draw_heat.short(name)) for name in names)


def _side(names: Sequence[str], look: Look) -> tuple[float, bool]:
    """Inches of a heat map on the screen, and whether two of them stand below one another."""
    cell = 0.45 if len(names) <= draw_heat.FEW else 0.28
    stacked = look.narrow or (look.width_mm is not None and look.width_mm < narrowest_mm(names, 2))
    return max(4.2, 1.2 + 0.07 * _longest(names) + cell * len(names)), stacked


def set_figure(ranking: Ranking, look: Look = SCREEN) -> Figure:
    """Draw distances (d′) and predicted confusions of one set side by side, in print below one another as needed."""
    side, stacked = _side(ranking.labels, look)
    down, across = (2, 1) if stacked else (1, 2)
    names = 0.06 * _longest(ranking.labels) if stacked else 0.0  # of the upper one, which stand below the lower one
    high = down * (FLAT if stacked else 1.0) * side - names
    figure = new_figure(across * (side + 0.6), high)
    distance, confusion = figure.subplots(down, across)
    draw_heat.plot_distance(ranking, ax=distance)
    draw_heat.plot_confusion(ranking, ax=confusion)
    if stacked:
        distance.set_xlabel("")
        distance.tick_params(labelbottom=False)
        for ax in (distance, confusion):
            ax.set_aspect(FLAT)
    return figure


def observed_figure(found: Observed[Any, Any], look: Look = SCREEN) -> Any:
    """Draw observed beside predicted answers, and felt and named before and after; of measurements that alone."""
    from thermicon.perception.pilot.conditioning import Namings

    if not isinstance(found.data, Namings):
        return found.plot().figure
    names, counts = list(found.data.trials.icons), found.data.trials.pooled
    observed = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    maps = {"Observed": observed, "Predicted": found.conditioned.simulated.pooled.mean(axis=0)}
    side, stacked = _side(names, look)
    low = 1.4 + 0.6 * len(found.predictions)
    rows: Any = [["Observed", "Predicted"], ["after"] * 2]
    heights = [side, low]
    if stacked:
        rows, heights = [[name] for name in (*maps, "after")], [FLAT * (side - 0.6), FLAT * side, low]
    figure = new_figure(len(rows[0]) * (side + 0.6), sum(heights))
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
