"""Heat maps of a set's distances or answers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array
from thermicon.circuit.solver.draw import COOL, new_axes

from ..criteria import DISTINGUISHABLE_DPRIME

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap

    from ..ranking.ranking import Ranking

LIGHT = ("#ffffff", "#d7e5f2", "#93bcdc", COOL, "#0f3a69")
EQUAL_CONTRAST = 0.179
"""Relative luminance from which black stands out more than white; either then has 4.5 : 1 at least."""
FEW, MOST_NUMBERED = 10, 30
"""Rows up to which numbers are as large as names, and up to which there are numbers."""
LONGEST_LABEL = 44


def plot_confusion(ranking: Ranking, ax: Axes | None = None) -> Axes:
    """Draw the predicted answers in per cent, those that are often confused adjacent: icon presented, name answered."""
    order = clustered_order(ranking.d_prime)
    names = [ranking.marked[k] for k in order]
    axes = heat(names, names, 100.0 * ranking.confusion[np.ix_(order, order)], ax, top=100.0, bend=0.5)
    title = f"Predicted answers, % (diagonal named: {100 * ranking.proportion_correct:.0f} %)"
    axes.set(xlabel="answered", ylabel="presented", title=title)
    return axes


def plot_distance(ranking: Ranking, ax: Axes | None = None) -> Axes:
    """Draw the predicted d′ of every pair, the median over people; similar icons are adjacent."""
    order = clustered_order(ranking.d_prime)
    names = [ranking.marked[k] for k in order]
    matrix = ranking.d_prime[np.ix_(order, order)]
    axes = heat(names, names, matrix, ax, top=max(float(matrix.max()), 2.0 * DISTINGUISHABLE_DPRIME))
    title = f"Predicted d′ between icons (memory: {ranking.job.forms[0]})"
    axes.set(xlabel="… and", ylabel="d′ between …", title=title)
    return axes


def clustered_order(distances: Array) -> NDArray[np.intp]:
    """Order of icons in which near ones are side by side, the first of the file in the first half: average linkage."""
    icons = len(distances)
    if icons < 3:
        return np.arange(icons)
    from scipy.cluster.hierarchy import leaves_list, linkage, optimal_leaf_ordering

    condensed = distances[np.triu_indices(icons, 1)]
    leaves = leaves_list(optimal_leaf_ordering(linkage(condensed, "average"), condensed))
    order = np.asarray(leaves, dtype=np.intp)
    return order[::-1] if 2 * int(np.flatnonzero(order == 0)[0]) >= icons else order


def heat(
    columns: list[str],
    rows: list[str],
    values: Array,
    ax: Axes | None = None,
    top: float | None = None,
    bend: float = 1.0,
) -> Axes:
    """One heat map of values of 0 and more; `top` is the darkest, `bend` below 1 gives small values more shades."""
    from matplotlib.colors import PowerNorm

    room = 0.075 * max(map(len, map(short, rows)))
    cell = 0.55 if len(rows) <= 12 else 0.42 if len(rows) <= MOST_NUMBERED else 0.16
    width = 1.2 + room + cell * len(columns)
    axes = new_axes(ax, (max(4.6, width), max(2.2, cell * len(rows) + 1.1 + 0.8 * room)))
    highest = max(float(values.max()) if top is None else top, 1e-9)
    edges = [np.arange(count + 1) - 0.5 for count in (len(columns), len(rows))]
    norm = PowerNorm(bend, vmin=0.0, vmax=highest)
    drawn = axes.pcolormesh(*edges, values, cmap=light_map(), norm=norm, edgecolors="#e4e4e4", lw=0.4)
    axes.set(aspect="equal", xlim=(-0.5, len(columns) - 0.5), ylim=(len(rows) - 0.5, -0.5))
    size = 9.0 if len(rows) <= FEW else 8.0 if len(rows) <= MOST_NUMBERED else 6.0
    axes.set_xticks(np.arange(len(columns)), [short(name) for name in columns], fontsize=size)
    for label in axes.get_xticklabels():
        label.set(rotation=45, ha="right", rotation_mode="anchor")
    axes.set_yticks(np.arange(len(rows)), [short(name) for name in rows], fontsize=size)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    if len(rows) > MOST_NUMBERED:
        figure: Any = axes.get_figure()
        figure.colorbar(drawn, ax=axes, shrink=0.6, aspect=30)
        return axes
    number = 9.0 if len(rows) <= FEW else 7.0
    for (i, j), value in np.ndenumerate(values):
        colour = ink_on(drawn.cmap(norm(value)))
        # Two digits at most, as in 100, 9.9 and 0.
        said = f"{value:.0f}" if value >= 9.95 or value < 0.05 else f"{value:.1f}"
        axes.text(j, i, said, ha="center", va="center", fontsize=number, color=colour)
    return axes


def ink_on(shade: Sequence[float]) -> str:
    """Black or white, whichever can be read better on a shade (red, green and blue, 0–1)."""
    linear = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in shade)
    luminance = sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=False))
    return "black" if luminance > EQUAL_CONTRAST else "white"


def light_map() -> Colormap:
    """White to dark blue, ever darker: readable in print and in grey."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("thermicon light", LIGHT)


def short(name: str, most: int = LONGEST_LABEL) -> str:
    """A name that fits beside a figure: the middle of a very long one is left out."""
    if len(name) <= most:
        return name
    half = (most - 1) // 2
    return f"{name[: most - 1 - half]}…{name[-half:]}"
