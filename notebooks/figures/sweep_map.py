"""The figure of a sweep over two keys: heat maps, one row per icon, one column per quantity."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .overview import GREY

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

MOST_ROWS = 6
MOST_TICKS = 6
QUANTITIES = (
    ("largest_miss_K", "largest miss (K)", "viridis"),
    ("energy_J", "electrical energy (J)", "viridis"),
    ("cold_receptor_peak_change_K", "peak change,\ncold receptor (K)", "RdBu_r"),
    ("warm_receptor_peak_change_K", "peak change,\nwarm receptor (K)", "RdBu_r"),
)
"""Columns of a sweep, their labels and colour maps; the diverging map is centred on 0."""


def sweep_map(frame: pd.DataFrame, key: str, second: str) -> Figure:
    """Draw heat maps of a sweep over two keys, for the first icons of the table.

    A circle marks a combination at which the icon was not reached; combinations that could not be played are
    grey.
    """
    from matplotlib.figure import Figure

    from thermicon.circuit.rig.keyunits import unit_of

    names = [str(name) for name in frame["icon"].unique()][:MOST_ROWS]
    figure = Figure(figsize=(11.5, 1.2 + 2.1 * len(names)), layout="constrained")
    axes = figure.subplots(len(names), len(QUANTITIES), sharex=True, sharey=True, squeeze=False)
    for column, (quantity, label, colours) in enumerate(QUANTITIES):
        shown = frame.loc[frame["icon"].isin(names), quantity].abs() if "miss" in quantity else frame[quantity]
        high = float(np.nanmax(np.abs(shown))) or 1.0
        low = -high if colours == "RdBu_r" else 0.0
        for row, name in enumerate(names):
            image = _map(axes[row, column], frame[frame["icon"] == name], (key, second, quantity), colours, (low, high))
        figure.colorbar(image, ax=list(axes[:, column]), location="top", label=label, shrink=0.9)
    for row, name in enumerate(names):
        axes[row, 0].set_ylabel(name, fontsize=9)
    figure.supxlabel(_named(key, unit_of(key)), fontsize=10)
    figure.supylabel(_named(second, unit_of(second)), fontsize=10)
    return figure


def _map(
    ax: Axes, rows: pd.DataFrame, names: tuple[str, str, str], colours: str, limits: tuple[float, float]
) -> AxesImage:
    """Draw one quantity of one icon, with a mark where it was not reached."""
    key, second, quantity = names
    values = rows.pivot(index=second, columns=key, values=quantity)
    cells = np.abs(values.to_numpy(dtype=float)) if "miss" in quantity else values.to_numpy(dtype=float)
    image = ax.imshow(cells, origin="lower", aspect="auto", cmap=colours, vmin=limits[0], vmax=limits[1])
    ax.set_facecolor(GREY)
    reached = rows.pivot(index=second, columns=key, values="reached").to_numpy(dtype=object)
    missed = [
        (x, y)
        for y, line in enumerate(reached)
        for x, hit in enumerate(line)
        if hit is not None and hit == False  # noqa: E712
    ]
    if missed:
        across, up = zip(*missed, strict=True)
        ax.scatter(across, up, s=20, facecolors="white", edgecolors="black", linewidths=0.7)
    for axis, ends in ((ax.xaxis, values.columns), (ax.yaxis, values.index)):
        places = np.unique(np.linspace(0, len(ends) - 1, min(len(ends), MOST_TICKS)).round().astype(int))
        axis.set_ticks(list(places), [f"{ends[k]:g}" for k in places], fontsize=8)
    return image


def _named(key: str, unit: str | None) -> str:
    return f"{key} ({unit})" if unit else key
