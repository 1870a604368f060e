"""Two runs in one figure: both curves with their difference."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..files.trace_files import Aligned, quantity, unit_of_difference
from .style import BROAD, COOL, GREY, INK, PLACES, TARGET, WARM, new_figure, on_one_clock, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.base.numbers.arrays import Array
    from thermicon.circuit import Export

FIRST = ("skin_C", "display_C", "cold_receptor_C", "warm_receptor_C", "heat_flow_skin_W_per_m2", "current_A")
COLORS = {"cold_receptor_C": COOL, "warm_receptor_C": WARM}
LEAST = 0.005
"""The panel of differences shows at least this much to both sides, in its own unit."""


def compare_figure(pairs: Sequence[tuple[str, Aligned]], across: int = 3) -> Figure:
    """Draw comparisons: of one, up to six quantities; of several, one quantity of each under its title.

    A is a broad grey line, B a thin one on top; cold receptors are blue, warm ones orange.
    """
    from matplotlib.lines import Line2D

    panels = [(title, both, name) for title, both in pairs for name in _shown(both, 6 if len(pairs) == 1 else 1)]
    across = min(across, len(panels))
    down = -(-len(panels) // across)
    figure = new_figure(0.8 + 3.3 * across, 0.7 + 3.6 * down)
    grid = figure.subplots(2 * down, across, squeeze=False, height_ratios=[2.0, 1.0] * down)
    places = grid.reshape(down, 2, across).swapaxes(1, 2).reshape(-1, 2)
    for (above, below), (title, both, name) in zip(places, panels, strict=False):
        _pair(above, below, both, name, title if len(pairs) > 1 else "")
    for ax in places[len(panels) :].flat:
        ax.remove()
    _, first = pairs[0]
    handles = [
        Line2D([], [], color=BROAD, lw=4.0, label=f"A  {first.name_a}"),
        Line2D([], [], color=INK, lw=1.3, label=f"B  {first.name_b}"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=1 + (across > 1), frameon=False, fontsize=9)
    return figure


def _shown(both: Aligned, most: int) -> list[str]:
    """The columns to draw: those that people look at first, then the others, up to `most`."""
    order = [name for name in FIRST if name in both.columns]
    return [*order, *(name for name in both.columns if name not in order and name != "target_C")][:most] or ["target_C"]


def _pair(above: Axes, below: Axes, both: Aligned, name: str, title: str) -> None:
    a, b = both.columns[name]
    unit = unit_of_difference(name)
    scale, apart = (1e3, "kW/m²") if unit == "W/m²" else (1.0, unit)
    unit = "°C" if apart == "K" else apart
    color = COLORS.get(name, INK)
    _draw(above, both.time_s, a / scale, name, color=BROAD, lw=4.0)
    _draw(above, both.time_s, b / scale, name, color=color, lw=1.3)
    below.axhline(0.0, color=GREY, lw=0.6)
    below.axhspan(-LEAST, LEAST, color="none")  # so that rounding does not fill the panel
    _draw(below, both.time_s, (b - a) / scale, name, color=color, lw=1.1)
    above.set_title(title or quantity(name), fontsize=10)
    above.set_ylabel(f"{quantity(name)} ({unit})" if title else unit, fontsize=9)
    below.set_ylabel(f"B − A ({apart})", fontsize=9)
    below.set_xlabel("time (s)", fontsize=9)
    above.sharex(below)
    above.tick_params(labelbottom=False, labelsize=8)
    below.tick_params(labelsize=8)
    below.set_xlim(float(both.time_s[0]), float(both.time_s[-1]))
    plain(above, below)


def _draw(ax: Axes, time: Array, values: Array, name: str, *, color: str, lw: float) -> None:
    style = "steps-post" if name == "current_A" else "default"
    ax.plot(time, values, color=color, lw=lw, drawstyle=style, solid_capstyle="butt")


def export_figure(ready: Export, place: int = 0, size: tuple[float, float] = (8.0, 6.4)) -> Figure:
    """Return a matplotlib Figure of one of the prepared icons: as designed and as its device delivers it."""
    one = ready.prepared[place]
    figure = new_figure(*size)
    delivery = one.delivery
    axes = figure.subplots(3, 1, sharex=True, height_ratios=[1.3, 1.0, 1.0])
    designed, delivered = delivery.designed_trace, delivery.trace
    time_s = delivered.time_s
    axes[0].plot(time_s, designed.skin_C, color=TARGET, lw=6.0, solid_capstyle="butt", label="skin, designed")
    axes[0].plot(time_s, delivered.skin_C, color=INK, lw=1.4, label="skin, delivered")
    axes[0].plot(time_s, delivered.display_C, color=GREY, lw=1.1, ls=(0, (6, 2)), label="display, delivered")
    axes[0].set_ylabel("temperature (°C)")
    # What the device puts out: current, or the display behind the set-points of a thermode.
    label, style, wide, thin = "current", "steps-post", designed.current_A, delivered.current_A
    if not delivered.has_current:
        label, style, wide, thin = "display", "default", designed.display_C, delivered.display_C
    axes[1].plot(time_s, wide, color=TARGET, lw=4.0, drawstyle=style, label=f"{label}, designed")
    axes[1].plot(time_s, thin, color=INK, lw=1.0, drawstyle=style, label=f"{label}, delivered")
    axes[1].set_ylabel("current (A)" if delivered.has_current else "display (°C)")
    for name, (color, dashes, _) in list(PLACES.items())[1:]:
        column = f"{name.replace(' ', '_')}_C"
        apart = 1e3 * (getattr(delivered, column) - getattr(designed, column))
        axes[2].plot(time_s, apart, color=color, lw=1.2, ls=dashes, label=name)
    axes[2].set_ylabel("delivered −\ndesigned (mK)")
    title = f"{delivery.icon.name} on {delivery.device.name}, safety {one.verdict.colour}"
    on_one_clock(figure, axes, "time on the device's clock (s)", title)
    return figure
