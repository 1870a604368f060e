"""One picture of everything that was published and predicted: a row for each number, as a ratio on a log axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from thermicon.circuit.solver.draw import COOL, WARM, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..validation.comparisons import Comparison

INK, BAND, LINE = "#222222", "#d9d9d9", "#8a8a8a"
LOOKS = {"cold": (COOL, "o"), "warm": (WARM, "s"), "both": (INK, "D")}
"""Colour and marker of a channel: by their shape they are distinguishable in grey."""
NOTE = {"fc": "w", "ec": "none", "pad": 0.6}
LEAST, MOST = 0.08, 12.5
TICKS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)


def plot_published(rows: Sequence[Comparison], ax: Axes | None = None) -> Axes:
    """Draw predictions over published numbers, a line each under the name of its experiment.

    The bar is the 95 % interval of the prediction and the grey box what was published with its error, or the criterion
    where no number was. Open markers miss; a marker at the edge points to where it lies.
    """
    lines = _lines(rows)
    axes = new_axes(ax, (6.4, 0.165 * len(lines) + 0.8))
    axes.set_xscale("log")
    axes.set_xlim(LEAST, MOST)
    axes.set_ylim(len(lines) - 0.3, -0.8)
    axes.axvline(1.0, color=LINE, lw=0.9, zorder=1)
    labels = axes.get_yaxis_transform()
    for place, line in enumerate(lines):
        if isinstance(line, str):
            axes.text(-0.02, place, line, transform=labels, ha="right", va="center", fontsize=7.5, fontweight="bold")
            continue
        style = "italic" if line.agrees is False else "normal"
        axes.text(
            -0.02, place, line.name, transform=labels, ha="right", va="center", fontsize=7.2, fontstyle=style
        )  # fmt: skip
        _row(axes, place, line)
    axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    axes.minorticks_off()
    axes.set_yticks([])
    axes.tick_params(labelsize=8)
    axes.set_xlabel("prediction / published number", fontsize=9)
    axes.spines[["top", "right", "left"]].set_visible(False)
    return axes


def published_legend() -> list[Any]:
    """Handles that explain `plot_published`."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    def mark(marker: str, colour: str, face: str, label: str) -> Line2D:
        return Line2D([], [], color=colour, marker=marker, ms=5.5, mfc=face, mec=colour, lw=1.3, label=label)

    return [
        mark("o", COOL, COOL, "cold"),
        mark("s", WARM, WARM, "warm"),
        mark("D", INK, INK, "both, or neither"),
        mark("o", INK, "w", "misses (name in italics)"),
        Line2D([], [], ls="", marker="x", color=INK, ms=5.5, label="no criterion"),
        Patch(color=BAND, label="published, with its error or criterion"),
    ]


def _lines(rows: Sequence[Comparison]) -> list[Comparison | str]:
    """Rows with a heading before the first of each group."""
    lines: list[Comparison | str] = []
    last = ""
    for row in rows:
        if row.group != last:
            lines.append(row.group)
            last = row.group
        lines.append(row)
    return lines


def _row(axes: Axes, place: int, row: Comparison) -> None:
    colour, marker = LOOKS[row.channel if row.channel in LOOKS else "both"]
    if row.published_low is not None and row.published_high is not None:
        low, high = _inside(row.published_low), _inside(row.published_high)
        # A number without an error still has a box, as wide as a line.
        axes.fill_betweenx([place - 0.36, place + 0.36], low / 1.01, high * 1.01, color=BAND, lw=0, zorder=0)
    if row.ratio is None:
        axes.text(1.0, place, row.note, ha="center", va="center", fontsize=6.8, color=INK, bbox=NOTE)
        return
    if row.low is not None and row.high is not None:
        axes.plot([_inside(row.low), _inside(row.high)], [place, place], color=colour, lw=1.3, zorder=2)
        for end, arrow in ((row.low, "<"), (row.high, ">")):
            if not LEAST <= end <= MOST:
                axes.plot(_inside(end), place, ls="", marker=arrow, ms=3.6, color=colour, clip_on=False, zorder=2)
    if row.agrees is None:
        axes.plot(_inside(row.ratio), place, ls="", marker="x", ms=4.6, mec=colour, zorder=3)
        return
    axes.plot(
        _inside(row.ratio), place, ls="", marker=marker, ms=4.6, mec=colour,
        mfc=colour if row.agrees else "w", zorder=3, clip_on=False,
    )  # fmt: skip


def _inside(ratio: float) -> float:
    """A ratio within the axis; what is 0 or less lies beyond its left end."""
    return LEAST if not ratio > LEAST else MOST if math.isinf(ratio) or ratio > MOST else ratio
