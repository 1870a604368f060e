"""Pictures of a trace. Cool is blue and warm is orange; they also differ in grey."""

from __future__ import annotations

from typing import TYPE_CHECKING

from thermicon.base.numbers.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .trace import Trace

COOL, WARM, DISPLAY, SKIN, TARGET, LIMIT = "#2166ac", "#e08214", "#6b6b6b", "#111111", "#9a9a9a", "#b2182b"
PROBE = "#5e3c99"
PROBE_DASHES = ((0, (1, 1)), (0, (4, 1, 1, 1)), (0, (3, 2)), (0, (6, 1, 1, 1, 1, 1)))
"""Probes are distinguished by their dashes, not by colour."""


def new_axes(ax: Axes | None, size: tuple[float, float] = (7.0, 3.6)) -> Axes:
    """Return the Axes given, or those of a new figure of a size in inches."""
    if ax is not None:
        return ax
    from matplotlib.figure import Figure

    return Figure(figsize=size, layout="constrained").add_subplot()


def plot_temperatures(trace: Trace, ax: Axes | None = None, probes: bool = False) -> Axes:
    """Draw target, display, skin and receptor temperatures (and probes) in °C against time in s; returns the Axes."""
    ax = new_axes(ax)
    if trace.control in ("skin", "display"):
        label = f"target ({trace.control})"
        ax.plot(trace.time_s, trace.target_C, color=TARGET, lw=5, alpha=0.45, label=label, solid_capstyle="butt")
    ax.plot(trace.time_s, trace.display_C, color=DISPLAY, lw=1.3, ls="--", label="display")
    ax.plot(trace.time_s, trace.skin_C, color=SKIN, lw=1.4, label="skin surface")
    ax.plot(trace.time_s, trace.cold_receptor_C, color=COOL, lw=1.8, label="cold receptors")
    ax.plot(trace.time_s, trace.warm_receptor_C, color=WARM, lw=1.8, ls=(0, (5, 1.2)), label="warm receptors")
    for place, (name, values) in enumerate(trace.probes if probes else ()):
        dashes = PROBE_DASHES[place % len(PROBE_DASHES)]
        ax.plot(trace.time_s, values, color=PROBE, lw=1.3, ls=dashes, label=f"probe {name}")
    return tidy(ax, trace.time_s, "temperature (°C)")


def plot_current(trace: Trace, ax: Axes | None = None) -> Axes:
    """Draw the drive current in A with the driver's limits; positive cools; a thermode has none; returns the Axes."""
    ax = new_axes(ax)
    if not trace.has_current:
        ax.text(0.5, 0.5, "a thermode: no current", transform=ax.transAxes, ha="center", va="center")
        return tidy(ax, trace.time_s, "current (A)")
    low, high = trace.driver_limits_A
    ax.axhline(0, color="#cccccc", lw=0.8)
    for limit, label in ((high, "driver's limits"), (low, None)):
        ax.axhline(limit, color=LIMIT, lw=1.1, ls=":", label=label)
    ax.step(trace.time_s, trace.current_A, where="post", color=SKIN, lw=1.2, label="current")
    span = max(abs(low), abs(high), float(abs(trace.current_A).max()))
    ax.set_ylim(-1.15 * span if low < 0 else -0.15 * span, 1.15 * span)
    return tidy(ax, trace.time_s, "current (A)\ncools above 0")


def tidy(ax: Axes, time_s: Array, label: str) -> Axes:
    """Label an axis of time in s, and place the legend beside the axes; returns the Axes."""
    ax.set_xlim(float(time_s[0]), float(time_s[-1]))
    ax.set_xlabel("time (s)")
    ax.set_ylabel(label)
    ax.spines[["top", "right"]].set_visible(False)
    figure = ax.get_figure()
    if figure is not None and figure.get_layout_engine() is not None:  # it makes room beside the axes
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize="small")
    else:
        ax.legend(loc="best", fontsize="small", framealpha=0.8)
    return ax


def svg_of(trace: Trace) -> str:
    """Return a small SVG picture of a trace, for notebooks."""
    from thermicon.icons.pictures.draw import as_svg

    ax = plot_temperatures(trace, new_axes(None, (5.2, 2.2)))
    ax.set_title(trace.icon or "drive", fontsize="medium")
    return as_svg(ax)
