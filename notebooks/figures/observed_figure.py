"""The figure of a pilot: icons observed beside predicted, the most confused pairs, and predictions before and after."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .overview import BROAD, COOL, INK, WARM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from thermicon.perception.pilot.measured import MeasuredPilot
    from thermicon.perception.pilot.observed import Observed

MOST_PAIRS, MOST_ICONS, LONGEST = 8, 16, 18
Three = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Row:
    """One line of a panel: middle and 95 % before and after, and what was observed (None: nothing)."""

    name: str
    before: Three
    after: Three
    seen: float | None = None


def observed_figure(found: Observed, stacked: bool = False) -> Figure:
    """Draw a pilot: grey bars are 95 % as predicted, blue ones after the answers, dots observed.

    Panels stand beside one another, or, stacked, below one another.
    """
    from matplotlib.figure import Figure

    icons = min(len(found.trials.icons), MOST_ICONS)
    tall = 0.36 * max(icons, 5)
    size = (6.0, 3.2 + 2.6 * tall) if stacked else (11.0, 1.8 + tall)
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(3, 1) if stacked else figure.subplots(1, 3, width_ratios=[1.0, 1.0, 0.8])
    left, middle, right = grid
    _icons(left, found)
    _pairs(middle, found)
    draw_sets(right, found)
    handles = legend_of("predicted after the answers, 95 %", "observed")
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False, fontsize=9)
    return figure


def legend_of(after: str, seen: str) -> list[Line2D]:
    """Handles of the legend: before, after, and what was seen."""
    from matplotlib.lines import Line2D

    return [
        Line2D([], [], color=BROAD, lw=6.0, label="predicted, 95 %"),
        Line2D([], [], color=COOL, lw=2.5, label=after),
        Line2D([], [], color=WARM, marker="o", ls="", label=seen),
    ]


def _icons(ax: Axes, found: Observed) -> None:
    trials, before, after = found.trials, found.fit.icons, found.fit_after.icons
    seen, shown = trials.pooled, trials.presented.sum(axis=0)
    rows = [
        Row(name, before[name], after[name], float(seen[k, k] / shown[k]))
        for k, name in enumerate(trials.icons)
        if name in before
    ]
    _draw(ax, rows[:MOST_ICONS])
    ax.set_title("each icon in this experiment\nper cent correct", fontsize=10)


def _pairs(ax: Axes, found: Observed) -> None:
    both = list(zip(found.fit.pairs, found.fit_after.pairs, strict=True))
    worst = sorted(both, key=lambda pair: -max(pair[0].observed, pair[0].predicted))[:MOST_PAIRS]
    rows = [Row(f"{p.a} – {p.b}", (p.predicted, *p.interval), (q.predicted, *q.interval), p.observed) for p, q in worst]
    _draw(ax, rows)
    ax.set_title("most confused pairs in this experiment\nper cent of trials", fontsize=10)


def draw_sets(ax: Axes, found: Observed | MeasuredPilot) -> None:
    """Draw the per cent correct of every set before and after."""
    rows = [
        Row(each.before.title or f"set {k + 1}", each.before.proportion_correct, each.after.proportion_correct)
        for k, each in enumerate(found.predictions)
    ]
    _draw(ax, rows)
    ax.set_title(f"{found.predictions[0].after.people} new people here\nper cent correct", fontsize=10)


def _draw(ax: Axes, rows: list[Row]) -> None:
    places = np.arange(len(rows))[::-1]
    for place, row in zip(places.tolist(), rows, strict=True):
        for (middle, low, high), color, width in ((row.before, BROAD, 8.0), (row.after, COOL, 2.5)):
            ax.plot([100 * low, 100 * high], [place, place], color=color, lw=width, solid_capstyle="butt")
            ax.plot([100 * middle], [place], color=INK if color == BROAD else color, marker="|", ms=9)
        if row.seen is not None:
            ax.plot([100 * row.seen], [place], color=WARM, marker="o", ms=5, zorder=5)
    ax.set_yticks(places, [_short(row.name) for row in rows], fontsize=8)
    ax.set_ylim(-0.7, len(rows) - 0.3)
    ax.tick_params(axis="x", labelsize=8)
    ax.grid(axis="x", alpha=0.25, linewidth=0.6)
    ax.spines[["top", "right"]].set_visible(False)


def _short(name: str) -> str:
    """A name that leaves room for the picture: a pair on two lines, a title wrapped."""
    if " – " in name:
        return name.replace(" – ", "\n– ")
    return "\n".join(textwrap.wrap(name, LONGEST, max_lines=3, placeholder=" …"))
