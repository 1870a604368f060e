"""The figure of a fit: measured and fitted courses above their residuals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..solver.draw import COOL, DISPLAY, PROBE, SKIN, WARM, new_axes, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .rig_fit import ChannelFit, RigFit

COLORS = {"display_C": DISPLAY, "skin_C": SKIN, "hot_plate_C": WARM, "voltage_V": COOL}
POINTS = "#b9bec4"


def fit_figure(fit: RigFit, across: int = 2) -> Figure:
    """Two panels per measured column, `across` columns beside one another: both courses, and below them residuals."""
    from matplotlib.figure import Figure

    panels, files = fit.channels, {each.file for each in fit.channels}
    across = min(across, len(panels))
    down = -(-len(panels) // across)
    figure = Figure(figsize=(1.0 + 4.4 * across, 3.6 * down), layout="constrained")
    grid = figure.subplots(2 * down, across, squeeze=False, height_ratios=[2.2, 1.0] * down)
    pairs = grid.reshape(down, 2, across).swapaxes(1, 2).reshape(-1, 2)
    for (above, below), each in zip(pairs, panels, strict=False):
        _pair(above, below, each, named=len(files) > 1)
    for unused in pairs[len(panels) :].flat:
        unused.remove()
    if len(files) == 1:
        figure.suptitle(f"{fit.rig.name} fitted to {panels[0].file}", fontsize=11)
    key = grid[0, 0].get_legend_handles_labels()
    figure.legend(*key, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    return figure


def plot_residuals(channels: Sequence[ChannelFit], ax: Axes | None = None) -> Axes:
    """Draw measured minus fitted of columns against time, in K or V; returns the Axes."""
    ax = new_axes(ax, (7.0, 2.6))
    ax.axhline(0.0, color="#999999", lw=0.8)
    for each in channels:
        label, color = f"{_words(each.column)} ({each.unit})", COLORS.get(each.column, PROBE)
        ax.plot(each.time_s, each.difference, ".", ms=2.0, color=color, label=label)
    return tidy(ax, channels[0].time_s, "measured − fitted")


def _pair(above: Axes, below: Axes, each: ChannelFit, named: bool) -> None:
    color = COLORS.get(each.column, PROBE)
    above.plot(each.time_s, each.measured, ".", ms=2.5, color=POINTS, label="measured")
    above.plot(each.time_s, each.simulated, color=color, lw=1.3, label="fitted")
    below.axhline(0.0, color="#999999", lw=0.8)
    below.plot(each.time_s, each.difference, ".", ms=2.0, color=color)
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


def _words(column: str) -> str:
    return column.rpartition("_")[0].replace("_", " ")
