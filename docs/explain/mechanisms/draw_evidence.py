"""Pictures of the inference."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes

from thermicon.circuit.solver.draw import COOL, WARM, new_axes
from thermicon.perception.evidence.results import AblatedRow, Constant, PredictedRow

GREY, INK = "#9a9a9a", "#222222"
SAYS_NOTHING = 2.0
"""A difference of log evidence that is smaller says nothing."""
LOG_UNITS = ("s", "K", "0-100", "1/K")
"""Units of rows whose prediction is compared as a ratio of the published number."""


def plot_ablation(rows: Sequence[AblatedRow], ax: Axes | None = None) -> Axes:
    """Draw log evidence lost without each mechanism, most first; grey bars are too short to say anything."""
    shown = sorted((row for row in rows if row.without or row.difference), key=lambda row: row.difference)
    axes = new_axes(ax, (6.6, 0.3 * len(shown) + 1.1))
    places, values = range(len(shown)), [row.difference for row in shown]
    colours = [GREY if abs(v) < SAYS_NOTHING else COOL if v < 0.0 else WARM for v in values]
    axes.axvspan(-SAYS_NOTHING, SAYS_NOTHING, color="#eeeeee", zorder=0)
    axes.barh(places, values, color=colours, height=0.7)
    for place, value in enumerate(values):
        words, side, away = f"{value:.1f}".replace("-", "−"), *(("right", -4) if value < 0.0 else ("left", 4))
        where: dict[str, Any] = {"textcoords": "offset points", "va": "center", "ha": side, "fontsize": "small"}
        axes.annotate(words, (value, place), (away, 0), **where)
    axes.set_yticks(places, [f"without {row.without}" if row.without else row.variable for row in shown])
    axes.set_xscale("symlog", linthresh=10.0)
    axes.set_xlim(3.0 * min(values), 10.0)
    axes.set_xticks([-100.0, -30.0, -10.0, -5.0, 0.0, 5.0], ["−100", "−30", "−10", "−5", "0", "5"])
    axes.minorticks_off()
    axes.invert_yaxis()
    return _tidied(axes, "log evidence against the whole (grey: says nothing)")


def _tidied(axes: Axes, x_label: str) -> Axes:
    axes.set_xlabel(x_label)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    return axes


def plot_left_out(rows: Sequence[PredictedRow], ax: Axes | None = None) -> Axes:
    """Draw how far each published number lies from its prediction without its experiment; open markers are missed."""
    axes = new_axes(ax, (7.2, 0.2 * len(rows) + 1.2))
    axes.axvspan(-1.96, 1.96, color="#eeeeee", zorder=0)
    axes.axvline(0.0, color=GREY, lw=0.8)
    for place, row in enumerate(rows):
        colour = COOL if row.channel == "cold" else WARM if row.channel == "warm" else INK
        marker = "o" if row.channel == "cold" else "s" if row.channel == "warm" else "^"
        inside = abs(row.score) <= 1.959964
        axes.plot(row.score, place, ls="", marker=marker, ms=5, mec=colour, mfc=colour if inside else "w")
    axes.set_yticks(range(len(rows)), [f"{row.experiment}  {row.label}" for row in rows], fontsize=7)
    axes.set(xlim=(-4.0, 4.0), ylim=(len(rows) - 0.4, -0.6))
    axes.set_title("Left-out rows (open: missed)", loc="left", fontsize="medium")
    return _tidied(axes, "published minus predicted (SD of both)")


def plot_published_predicted(rows: Sequence[PredictedRow], ax: Axes | None = None) -> Axes:
    """Draw predictions without the experiment over published times, temperatures and ratings, with 95 % intervals."""
    shown = [row for row in rows if row.unit in LOG_UNITS or row.unit.startswith("times")]
    axes = new_axes(ax, (7.0, 0.27 * len(shown) + 1.4))
    axes.axvline(1.0, color=GREY, lw=1.0, ls=":")
    for place, row in enumerate(shown):
        colour, marker = (COOL, "o") if row.channel == "cold" else (WARM, "s")
        low, middle, high = (end / row.published for end in (row.left_out_low, row.left_out, row.left_out_high))
        axes.plot([low, high], [place, place], color=colour, lw=1.4)
        axes.plot(middle, place, ls="", marker=marker, ms=5.5, color=colour)
        axes.plot(row.fitted / row.published, place, ls="", marker="|", ms=10, color=INK)
    axes.set_xscale("log")
    axes.set_xticks([0.1, 0.3, 1.0, 3.0, 10.0], ["0.1", "0.3", "1", "3", "10"])
    axes.minorticks_off()
    axes.set_xlim(0.08, 32.0)
    axes.set_yticks(range(len(shown)), [f"{row.experiment}  {row.label}" for row in shown], fontsize=8)
    axes.set_ylim(len(shown) - 0.4, -0.6)
    return _tidied(axes, "prediction / published (dot, bar: left out; tick: fitted)")


def plot_narrowing(constants: Sequence[Constant], ax: Axes | None = None) -> Axes:
    """Draw how much of its prior's SD each constant keeps: 1 where the evidence says nothing of it."""
    shown = sorted((each for each in constants if each.mechanism != "laboratories"), key=lambda each: each.narrowed)
    axes = new_axes(ax, (6.6, 0.19 * len(shown) + 1.0))
    for place, each in enumerate(shown):
        colour = COOL if each.name.startswith("cold") else WARM if each.name.startswith("warm") else INK
        axes.plot([0.0, each.narrowed], [place, place], color=colour, lw=1.2)
        axes.plot(each.narrowed, place, ls="", marker="o", ms=4, color=colour)
    axes.axvline(1.0, color=GREY, lw=0.8, ls=":")
    axes.axvspan(0.9, 1.0, color="#eeeeee", zorder=0)
    axes.set_yticks(range(len(shown)), [each.name for each in shown], fontsize=7)
    axes.set(xlim=(0.0, 1.04), ylim=(len(shown) - 0.4, -0.6))
    return _tidied(axes, "SD over the prior's SD (grey: over 0.9, as good as assumed)")
