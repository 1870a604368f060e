"""The figure of a run on several elements: a row for each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .style import INK, PLACES, TARGET, new_figure, on_one_clock

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermicon.circuit import LayoutTrace

ROW_INCHES = 1.3


def layout_figure(run: LayoutTrace) -> Figure:
    """Draw the temperatures of each element in a row of its own, on one clock and one scale.

    Returns a matplotlib ``Figure``; nothing is shown.
    """
    figure = new_figure(8.0, 1.0 + ROW_INCHES * len(run.played))
    rows = list(figure.subplots(len(run.played), 1, sharex=True, sharey=True, squeeze=False)[:, 0])
    for ax, (name, trace) in zip(rows, run.played, strict=True):
        ax.plot(trace.time_s, trace.target_C, color=TARGET, lw=5, label=f"target ({trace.control})")
        for place, (color, dashes, width) in PLACES.items():
            drawn = getattr(trace, f"{place.replace(' ', '_')}_C")
            ax.plot(trace.time_s, drawn, color=color, ls=dashes, lw=0.8 * width, label=place)
        ax.set_ylabel(f"{name} (°C)", color=INK).set_parse_math(False)
    on_one_clock(figure, rows, "time (s)", f"{run.icon} on {len(run.played)} elements")
    return figure
