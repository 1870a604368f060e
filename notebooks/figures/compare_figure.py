"""The figure of a comparison: curves of A and B above, what B has more below, a pair of panels a quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .differences import Aligned, quantity, unit_of_difference
from .overview import BROAD, COOL, GREY, INK, WARM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.circuit.arrays import Array

FIRST = ("skin_C", "display_C", "cold_receptor_C", "warm_receptor_C", "heat_flow_skin_W_per_m2", "current_A")
COLORS = {"cold_receptor_C": COOL, "warm_receptor_C": WARM}
LEAST = 0.005
"""The panel of differences shows at least this much to both sides, in its own unit."""

ACROSS = 3


def compare_figure(pairs: Sequence[tuple[str, Aligned]], across: int = ACROSS) -> Figure:
    """Draw comparisons: of one, up to six quantities; of several, one quantity of each under its title.

    A is a broad grey line, B a thin one on top; cold receptors are blue, warm ones orange.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    panels = [(title, both, name) for title, both in pairs for name in _shown(both, 6 if len(pairs) == 1 else 1)]
    across = min(across, len(panels))
    down = -(-len(panels) // across)
    figure = Figure(figsize=(0.8 + 3.3 * across, 0.7 + 3.6 * down), layout="constrained")
    grid = figure.subplots(2 * down, across, squeeze=False, height_ratios=[2.0, 1.0] * down)
    for place in range(down * across):
        row, column = divmod(place, across)
        above, below = grid[2 * row, column], grid[2 * row + 1, column]
        if place >= len(panels):
            above.remove()
            below.remove()
            continue
        title, both, name = panels[place]
        _pair(above, below, both, name, title if len(pairs) > 1 else "")
    _, first = pairs[0]
    handles = [
        Line2D([], [], color=BROAD, lw=4.0, label=f"A  {first.name_a}"),
        Line2D([], [], color=INK, lw=1.3, label=f"B  {first.name_b}"),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False, fontsize=9)
    return figure


def _shown(both: Aligned, most: int) -> list[str]:
    """The columns to draw: those that people look at first, then the others, up to `most`."""
    order = [name for name in FIRST if name in both.columns]
    return [*order, *(name for name in both.columns if name not in order and name != "target_C")][:most] or ["target_C"]


def _pair(above: Axes, below: Axes, both: Aligned, name: str, title: str) -> None:
    a, b = both.columns[name]
    scale, unit, difference_unit = _units(name)
    color = COLORS.get(name, INK)
    _draw(above, both.time_s, a / scale, name, color=BROAD, lw=4.0)
    _draw(above, both.time_s, b / scale, name, color=color, lw=1.3)
    below.axhline(0.0, color=GREY, lw=0.6)
    below.axhspan(-LEAST, LEAST, color="none")  # so that rounding does not fill the panel
    _draw(below, both.time_s, (b - a) / scale, name, color=color, lw=1.1)
    above.set_title(title or quantity(name), fontsize=10)
    above.set_ylabel(f"{quantity(name)} ({unit})" if title else unit, fontsize=9)
    below.set_ylabel(f"B − A ({difference_unit})", fontsize=9)
    below.set_xlabel("time (s)", fontsize=9)
    above.sharex(below)
    above.tick_params(labelbottom=False, labelsize=8)
    below.tick_params(labelsize=8)
    below.set_xlim(float(both.time_s[0]), float(both.time_s[-1]))
    for ax in (above, below):
        ax.grid(alpha=0.25, linewidth=0.6)
        ax.spines[["top", "right"]].set_visible(False)


def _units(name: str) -> tuple[float, str, str]:
    """Divisor, unit of the values and unit of their difference: heat flow is drawn in kW/m²."""
    unit = unit_of_difference(name)
    if unit == "W/m²":
        return 1e3, "kW/m²", "kW/m²"
    return 1.0, "°C" if unit == "K" else unit, unit


def _draw(ax: Axes, time: Array, values: Array, name: str, *, color: str, lw: float) -> None:
    style = "steps-post" if name == "current_A" else "default"
    ax.plot(time, values, color=color, lw=lw, drawstyle=style, solid_capstyle="butt")
