"""The figure of a pilot: icons and pairs, or what was measured, over the prediction, and sets before and after."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .style import BROAD, COOL, INK, WARM, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.perception.pilot.conditioning import Answered, Measured
    from thermicon.perception.pilot.observed import Observed
    from thermicon.perception.pilot.prediction import Fit, MeasurementFit, Three

MOST_PAIRS, MOST_ICONS, LONGEST = 8, 16, 18


@dataclass(frozen=True, slots=True)
class Row:
    """One line of a panel: middle and 95 % before and after, and what was observed (None: nothing)."""

    name: str
    before: Three
    after: Three
    seen: float | None = None


def observed_figure(found: Observed[Any, Any], stacked: bool = False) -> Figure:
    """Draw a pilot: grey bars are 95 % as predicted, blue ones after the data were used, dots observed or measured.

    The panels of answers stand beside one another, or, stacked, below one another.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from thermicon.perception.pilot.conditioning import Answered

    answered = isinstance(found.data, Answered)
    rows = min(len(found.data.trials.icons), MOST_ICONS) if answered else len(found.fit.conditions)
    tall = 0.36 * max(rows, 5)
    figure = Figure(layout="constrained")
    if not answered:
        figure.set_size_inches(9.0, 1.8 + tall)
        left, last = figure.subplots(1, 2, width_ratios=[1.4, 1.0])
        _conditions(left, found)
    else:
        figure.set_size_inches(*((6.0, 3.2 + 2.6 * tall) if stacked else (11.0, 1.8 + tall)))
        grid = figure.subplots(3, 1) if stacked else figure.subplots(1, 3, width_ratios=[1.0, 1.0, 0.8])
        left, middle, last = grid
        _icons(left, found)
        _pairs(middle, found)
    _sets(last, found)
    what, seen = ("answers", "observed") if answered else ("values", "measured")
    handles = [
        Line2D([], [], color=BROAD, lw=6.0, label="predicted, 95 %"),
        Line2D([], [], color=COOL, lw=2.5, label=f"predicted after the {what}, 95 %"),
        Line2D([], [], color=WARM, marker="o", ls="", label=seen),
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False, fontsize=9)
    return figure


def _icons(ax: Axes, found: Observed[Answered, Fit]) -> None:
    trials, before, after = found.data.trials, found.fit.icons, found.fit_after.icons
    seen, shown = trials.pooled, trials.presented.sum(axis=0)
    rows = [
        Row(_short(name), before[name], after[name], float(seen[k, k] / shown[k]))
        for k, name in enumerate(trials.icons)
        if name in before
    ]
    _draw(ax, rows[:MOST_ICONS])
    ax.set_title("each icon in this experiment\nper cent correct", fontsize=10)


def _pairs(ax: Axes, found: Observed[Answered, Fit]) -> None:
    both = list(zip(found.fit.pairs, found.fit_after.pairs, strict=True))
    worst = sorted(both, key=lambda pair: -max(pair[0].observed, pair[0].predicted))[:MOST_PAIRS]
    rows = [
        Row(f"{p.a}\n– {p.b}", (p.predicted, *p.predicted_interval), (q.predicted, *q.predicted_interval), p.observed)
        for p, q in worst
    ]
    _draw(ax, rows)
    ax.set_title("most confused pairs in this experiment\nper cent of trials", fontsize=10)


def _conditions(ax: Axes, found: Observed[Measured, MeasurementFit]) -> None:
    """Each condition as a ratio to the median of its prediction, so that all units share one axis."""
    rows = []
    for before, after in zip(found.fit.conditions, found.fit_after.conditions, strict=True):
        unit, name = before.predicted[0], f"{before.condition.label}\n{before.observed:.3g} {before.condition.unit}"
        both: list[Any] = [tuple(end / unit for end in each.predicted) for each in (before, after)]
        rows.append(Row(name, both[0], both[1], before.observed / unit))
    _draw(ax, rows, 1.0)
    ax.set_xscale("log")
    ends = ax.get_xlim()
    ticks = [tick for tick in (0.125, 0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0, 8.0) if ends[0] <= tick <= ends[1]]
    ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.set_xticks([], minor=True)
    ax.set_title("group means over the predicted median", fontsize=10)


def _sets(ax: Axes, found: Observed[Any, Any]) -> None:
    rows = [
        Row(_short(each.before.title or f"set {k + 1}"), each.before.proportion_correct, each.after.proportion_correct)
        for k, each in enumerate(found.predictions)
    ]
    _draw(ax, rows)
    ax.set_title(f"{found.predictions[0].after.people} new people here\nper cent correct", fontsize=10)


def _draw(ax: Axes, rows: list[Row], scale: float = 100.0) -> None:
    places = np.arange(len(rows))[::-1]
    for place, row in zip(places.tolist(), rows, strict=True):
        for (middle, low, high), color, width in ((row.before, BROAD, 8.0), (row.after, COOL, 2.5)):
            ax.plot([scale * low, scale * high], [place, place], color=color, lw=width, solid_capstyle="butt")
            ax.plot([scale * middle], [place], color=INK if color == BROAD else color, marker="|", ms=9)
        if row.seen is not None:
            ax.plot([scale * row.seen], [place], color=WARM, marker="o", ms=5, zorder=5)
    ax.set_yticks(places, [row.name for row in rows], fontsize=8)
    ax.set_ylim(-0.7, len(rows) - 0.3)
    ax.tick_params(axis="x", labelsize=8)
    plain(ax, grid="x")


def _short(name: str) -> str:
    """A name that leaves room for the picture."""
    return "\n".join(textwrap.wrap(name, LONGEST, max_lines=3, placeholder=" …"))
