"""Figure of a frontier: proportion correct and total time of the best choices, by their number of icons."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.solver.draw import new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..selection.frontier import Frontier

DARK, GREY = "0.15", "0.55"


def plot_frontier(found: Frontier, ax: Axes | None = None) -> Axes:
    """Draw the mean over people, what 95 % of them reach, chance, and the total time at every point."""
    axes = new_axes(ax, (8.2, 4.2))
    sizes = np.array([len(point.icons) for point in found.points])
    correct = np.array([100.0 * point.proportion_correct for point in found.points])
    low = np.array([100.0 * point.reached for point in found.points])
    reach = "95 % of people reach, people and model" if found.draws else "95 % of people reach, nominal model"
    axes.fill_between(sizes, low, correct, color="0.9", linewidth=0)
    axes.plot(sizes, correct, color=DARK, marker="o", label="mean over people")
    axes.plot(sizes, low, color=GREY, marker="v", linestyle="--", label=reach)
    axes.plot(sizes, 100.0 / sizes, color=GREY, linestyle=":", label="chance")
    for size, value, point in zip(sizes.tolist(), correct.tolist(), found.points, strict=True):
        axes.annotate(
            f"{point.total_s:.0f} s", (size, value), (0, 7), textcoords="offset points", ha="center", fontsize=8
        )
    axes.set_xticks(sizes)
    axes.set_ylim(0.0, 112.0)
    axes.set_yticks(range(0, 101, 20))
    axes.set_xlim(float(sizes.min()) - 0.5, float(sizes.max()) + 0.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel(f"number of icons, the best of {found.pool} by {found.objective}\n(above the points: total time)")
    axes.set_ylabel("correct (%)")
    axes.set_title("How many icons are distinguishable", loc="left")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8)
    return axes
