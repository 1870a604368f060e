"""Figure of a sensitivity study: two bars for each parameter, the most important at the top."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermicon.icons.pictures.draw import COOL, WARM

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..sensitivity.sensitivity import Sensitivity

HEIGHT = 0.38


def plot_sensitivity(found: Sensitivity, ax: Axes | None = None) -> Axes:
    """Draw the total Sobol indices of every parameter, proportion correct above bits."""
    axes = _axes(len(found.effects)) if ax is None else ax
    names = [effect.parameter.name for effect in found.effects]
    places = np.arange(len(names))
    correct = np.array([effect.proportion_correct for effect in found.effects])
    bits = np.array([effect.information_bits for effect in found.effects])
    axes.barh(places - HEIGHT / 2, correct, HEIGHT, color=COOL, label="proportion correct")
    axes.barh(places + HEIGHT / 2, bits, HEIGHT, color=WARM, label="bits")
    axes.set_yticks(places, names)
    axes.invert_yaxis()
    axes.set_xlim(left=0.0)
    axes.tick_params(axis="y", length=0)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.grid(axis="x", alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("share of the variance (total Sobol index)")
    axes.set_title("Parameters to measure first", loc="left")
    axes.legend(frameon=False, loc="lower right")
    return axes


def _axes(bars: int) -> Axes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.6, 1.4 + 0.34 * bars), layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()
