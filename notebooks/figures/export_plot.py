"""Delivered against designed as a figure: skin, drive current, and what is left between them at skin and receptors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .overview import COOL, GREY, INK, TARGET, WARM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.circuit import Export
    from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
    from thermicon.circuit.delivery.prepare import Prepared

PLACES = (("skin", "skin_C", INK, "-"), ("cold receptor", "cold_receptor_C", COOL, "-."),
          ("warm receptor", "warm_receptor_C", WARM, "--"))  # fmt: skip


def export_figure(ready: Export, place: int = 0, size: tuple[float, float] = (8.0, 6.4)) -> Figure:
    """Return a matplotlib Figure of one of the prepared icons: as designed and as its device delivers it.

    >>> from thermicon.circuit import export
    >>> from thermicon.icons import load_library
    >>> icon = load_library("six-icons")["cooling-step"]
    >>> export_figure(export(icon, "thenar")).get_suptitle()
    'cooling-step on dac-16, safety green'
    """
    from matplotlib.figure import Figure

    one = ready.prepared[place]
    figure = Figure(figsize=size, layout="constrained")
    delivery = one.delivery
    axes = figure.subplots(3, 1, sharex=True, height_ratios=[1.3, 1.0, 1.0])
    designed, delivered = delivery.designed_trace, delivery.trace
    time_s = delivered.time_s
    axes[0].plot(time_s, designed.skin_C, color=TARGET, lw=6.0, solid_capstyle="butt", label="skin, designed")
    axes[0].plot(time_s, delivered.skin_C, color=INK, lw=1.4, label="skin, delivered")
    axes[0].plot(time_s, delivered.display_C, color=GREY, lw=1.1, ls=(0, (6, 2)), label="display, delivered")
    axes[0].set_ylabel("temperature (°C)")
    _drive_panel(axes[1], delivery)
    for name, column, colour, style in PLACES:
        apart = 1e3 * (getattr(delivered, column) - getattr(designed, column))
        axes[2].plot(time_s, apart, color=colour, lw=1.2, ls=style, label=name)
    axes[2].set_ylabel("delivered −\ndesigned (mK)")
    axes[2].set_xlabel("time on the device's clock (s)")
    for ax in axes:
        ax.grid(alpha=0.25, linewidth=0.6)
        ax.spines[["top", "right"]].set_visible(False)
        ax.margins(x=0.0)
        ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8, handlelength=2.6)
    figure.align_ylabels(axes)
    figure.suptitle(title_of(one), fontsize=11)
    return figure


def _drive_panel(ax: Axes, delivery: DeliveredDrive) -> None:
    """What the device puts out: current, or the set-points of a thermode and the display behind them."""
    designed, delivered = delivery.designed_trace, delivery.trace
    time_s, label, style = delivered.time_s, "current", "steps-post"
    wide, thin = designed.current_A, delivered.current_A
    if not delivered.has_current:
        label, style, wide, thin = "display", "default", designed.display_C, delivered.display_C
    ax.plot(time_s, wide, color=TARGET, lw=4.0, drawstyle=style, label=f"{label}, designed")
    ax.plot(time_s, thin, color=INK, lw=1.0, drawstyle=style, label=f"{label}, delivered")
    ax.set_ylabel("current (A)" if delivered.has_current else "display (°C)")


def title_of(one: Prepared) -> str:
    """Which icon on which device, and the colour of the gate."""
    return f"{one.delivery.icon.name} on {one.delivery.device.name}, safety {one.verdict.colour}"
