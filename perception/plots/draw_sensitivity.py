"""Figure of a sensitivity study: two bars for each constant, the most important at the top."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.solver.draw import new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..ranking.sensitivity import Sensitivity

HEIGHT = 0.38
MOST = 16
"""Further constants explain less than chance does."""


def plot_sensitivity(found: Sensitivity, ax: Axes | None = None) -> Axes:
    """Draw the shares of the constants that count most, proportion correct above bits."""
    shown = found.effects[:MOST]
    axes = new_axes(ax, (7.6, 1.4 + 0.34 * len(shown)))
    names = [effect.constant for effect in shown]
    places = np.arange(len(names))
    correct = np.array([effect.proportion_correct for effect in shown])
    bits = np.array([effect.information_bits for effect in shown])
    axes.barh(places - HEIGHT / 2, correct, HEIGHT, color="0.3", label="proportion correct")
    axes.barh(places + HEIGHT / 2, bits, HEIGHT, color="0.68", label="bits")
    axes.set_yticks(places, names)
    axes.invert_yaxis()
    axes.set_xlim(left=0.0)
    axes.tick_params(axis="y", length=0)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.grid(axis="x", alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("share of the variance between draws of the posterior")
    axes.set_title("Constants that carry the doubt", loc="left")
    axes.legend(frameon=False, loc="lower right")
    return axes
