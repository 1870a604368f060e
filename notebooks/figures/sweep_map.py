"""The figure of a sweep over two keys: heat maps, one row per icon, one column per quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .style import COOL, GREY, WARM
from .sweep_axes import MOST_TICKS, key_label

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

MOST_ROWS = 6
SHADES, BLUE_ORANGE = "cividis", "blue to orange"
QUANTITIES = (
    ("largest_miss_K", "largest miss (K)", SHADES),
    ("energy_J", "electrical energy (J)", SHADES),
    ("cold_receptor_peak_change_K", "peak change,\ncold receptor (K)", BLUE_ORANGE),
    ("warm_receptor_peak_change_K", "peak change,\nwarm receptor (K)", BLUE_ORANGE),
)
"""Columns of a sweep, their labels and colour maps; the diverging map is centred on 0."""


def sweep_map(
    frame: pd.DataFrame, key: str, second: str, quantities: Sequence[tuple[str, str, str]] = QUANTITIES
) -> Figure:
    """Draw heat maps of a sweep over two keys, for the first icons of the table.

    Quantities are columns with their labels and colour maps. A circle marks a combination at which the icon was not
    reached; combinations that could not be played are grey.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    names = [str(name) for name in frame["icon"].unique()][:MOST_ROWS]
    figure = Figure(figsize=(1.1 + 2.6 * len(quantities), 1.2 + 2.1 * len(names)), layout="constrained")
    axes = figure.subplots(len(names), len(quantities), sharex=True, sharey=True, squeeze=False)
    for column, (quantity, label, colours) in enumerate(quantities):
        shown = frame.loc[frame["icon"].isin(names), quantity].abs() if "miss" in quantity else frame[quantity]
        high = float(np.nanmax(np.abs(shown))) or 1.0
        low = -high if colours == BLUE_ORANGE else 0.0
        shades = blue_to_orange() if colours == BLUE_ORANGE else colours
        for row, name in enumerate(names):
            image = _map(axes[row, column], frame[frame["icon"] == name], (key, second, quantity), shades, (low, high))
        bar = figure.colorbar(
            image, ax=list(axes[:, column]), location="top", label=label, shrink=0.9, ticks=MaxNLocator(2)
        )
        bar.ax.tick_params(labelsize=7)
    for row, name in enumerate(names):
        axes[row, 0].set_ylabel(name, fontsize=9)
    figure.supxlabel(key_label(key), fontsize=10)
    figure.supylabel(key_label(second), fontsize=10)
    return figure


def blue_to_orange() -> Any:
    """Colours from cooling over white to warming."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list(BLUE_ORANGE, [COOL, "#ffffff", WARM])


def _map(
    ax: Axes, rows: pd.DataFrame, names: tuple[str, str, str], colours: Any, limits: tuple[float, float]
) -> AxesImage:
    """Draw one quantity of one icon, with a mark where it was not reached."""
    quantity = names[2]
    values = _grid(rows, names, quantity)
    cells = np.abs(values.to_numpy(dtype=float)) if "miss" in quantity else values.to_numpy(dtype=float)
    image = ax.imshow(cells, origin="lower", aspect="auto", cmap=colours, vmin=limits[0], vmax=limits[1])
    ax.set_facecolor(GREY)
    reached = _grid(rows, names, "reached").astype("boolean").fillna(True).to_numpy(dtype=bool)
    missed = [(x, y) for y, line in enumerate(reached) for x, hit in enumerate(line) if not hit]
    if missed:
        across, up = zip(*missed, strict=True)
        ax.scatter(across, up, s=20, facecolors="white", edgecolors="black", linewidths=0.7)
    for axis, ends in ((ax.xaxis, values.columns), (ax.yaxis, values.index)):
        places = np.unique(np.linspace(0, len(ends) - 1, min(len(ends), MOST_TICKS)).round().astype(int))
        axis.set_ticks(list(places), [_named(ends[k]) for k in places], fontsize=8)
    return image


def _grid(rows: pd.DataFrame, names: tuple[str, str, str], column: str) -> pd.DataFrame:
    """Values in the order in which both keys take them."""
    key, second, _ = names
    grid = rows.pivot(index=second, columns=key, values=column)
    return grid.reindex(index=rows[second].unique(), columns=rows[key].unique())


def _named(value: object) -> str:
    return value if isinstance(value, str) else f"{value:g}"
