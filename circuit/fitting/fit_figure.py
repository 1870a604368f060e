"""Picture of a fit: measured and fitted courses, and their residuals below."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..arrays import Array
from ..solver.draw import COOL, DISPLAY, PROBE, SKIN, WARM, new_axes, tidy
from .rig_fit import ChannelFit, RigFit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLORS = {"display_C": DISPLAY, "skin_C": SKIN, "hot_plate_C": WARM, "voltage_V": COOL}
POINTS = "#b9bec4"
MOST_POINTS = 4000
"""More points than a page has dots to the inch show nothing more."""


def fit_figure(fit: RigFit, across: int = 2) -> Figure:
    """Two panels per measured column, `across` columns beside one another: both courses, and below them residuals."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    panels, files = fit.channels, {each.file for each in fit.channels}
    across = min(across, len(panels))
    down = -(-len(panels) // across)
    high = 3.9 if across > 1 or down == 1 else 3.0
    figure = Figure(figsize=(1.0 + 4.4 * across, high * down), layout="constrained")
    grid = figure.subplots(2 * down, across, squeeze=False, height_ratios=[2.2, 1.0] * down)
    for place in range(down * across):
        row, side = divmod(place, across)
        above, below = grid[2 * row, side], grid[2 * row + 1, side]
        if place >= len(panels):
            above.remove()
            below.remove()
            continue
        _pair(above, below, panels[place], named=len(files) > 1)
    if len(files) == 1:
        figure.suptitle(f"{fit.rig.name} fitted to {panels[0].file}", fontsize=11)
    points = Line2D([], [], color=POINTS, marker=".", ls="", ms=7.0, label="measured")
    figure.legend(
        handles=[points, Line2D([], [], color="#333333", lw=1.3, label="fitted")],
        loc="outside lower center", ncols=2, frameon=False, fontsize=9,
    )  # fmt: skip
    return figure


def plot_residuals(channels: Sequence[ChannelFit], ax: Axes | None = None) -> Axes:
    """Draw measured minus fitted of columns against time, in K or V; returns the Axes."""
    ax = new_axes(ax, (7.0, 2.6))
    ax.axhline(0.0, color="#999999", lw=0.8)
    for each in channels:
        label, color = f"{_words(each.column)} ({each.unit})", COLORS.get(each.column, PROBE)
        ax.plot(*_few(each.time_s, each.difference), ".", ms=2.0, color=color, label=label)
    return tidy(ax, channels[0].time_s, "measured − fitted")


def _pair(above: Axes, below: Axes, each: ChannelFit, named: bool) -> None:
    color = COLORS.get(each.column, PROBE)
    above.plot(*_few(each.time_s, each.measured), ".", ms=2.5, color=POINTS, label="measured")
    above.plot(each.time_s, each.simulated, color=color, lw=1.3, label="fitted")
    below.axhline(0.0, color="#999999", lw=0.8)
    below.plot(*_few(each.time_s, each.difference), ".", ms=2.0, color=color)
    most = max(4.5 * each.rms, 1e-4)
    below.set_ylim(-most, most)
    words = _words(each.column)
    above.set_title(f"{words}, {each.file}" if named else words, fontsize=10)
    above.set_ylabel("°C" if each.unit == "K" else "V", fontsize=9)
    below.set_ylabel(f"residual ({each.unit})", fontsize=9)
    below.set_xlabel("time (s)", fontsize=9)
    above.sharex(below)
    above.tick_params(labelbottom=False, labelsize=8)
    below.tick_params(labelsize=8)
    below.set_xlim(float(each.time_s[0]), float(each.time_s[-1]))
    for ax in (above, below):
        ax.grid(alpha=0.25, linewidth=0.6)
        ax.spines[["top", "right"]].set_visible(False)


def _few(*columns: Array) -> list[Array]:
    """Columns (rows,) with so many points as can be seen."""
    return [column[:: max(1, len(column) // MOST_POINTS)] for column in columns]


def _words(column: str) -> str:
    """A column as people say it: its name without the unit."""
    return column.rpartition("_")[0].replace("_", " ")
