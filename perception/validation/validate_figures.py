"""Figures of the validation report that set predictions against published numbers; each returns a figure.

Colour distinguishes cold from warm and nothing else; variants differ in markers and dashes.
Published numbers are black.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.circuit.solver.draw import COOL, WARM

from ..observer.channels import CHANNELS
from ..observer.variants import VARIABLES
from .experiments import AREAS_CM2, RATES_K_PER_S
from .validate import Line, ValidationReport

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKS = ("o", "s", "^")
DASHES = ("-", (0, (5, 1.5)), (0, (1, 1.2)))
COLOUR = {"cold": COOL, "warm": WARM, "both": "#444444"}
PUBLISHED = "#111111"
BAND = "#dfe3e8"


def rate_figure(report: ValidationReport) -> Figure:
    """Forced-choice thresholds against the rate of change, cold and warm, of every variant."""
    figure = new_figure(8.0, 3.6)
    panels = figure.subplots(1, 2, sharey=True)
    (bound,) = {line.published.high for line in _lines(report, 1, "change over the fast rates")}
    for ax, channel in zip(panels, CHANNELS, strict=True):
        for k, variable in enumerate(VARIABLES):
            found = [
                report.evidence.find(variable, "rate curve", f"threshold at {rate:g} K/s", channel)
                for rate in RATES_K_PER_S
            ]
            values = np.array([np.nan if one.value is None else one.value for one in found])
            ax.plot(
                RATES_K_PER_S, values, color=COLOUR[channel], ls=DASHES[k], marker=MARKS[k], ms=5,
                mfc="white" if k else COLOUR[channel], lw=1.6, label=variable, zorder=3,
            )  # fmt: skip
            if k == 0 and all(one.low is not None and one.high is not None for one in found):
                low, high = ([getattr(one, end) for one in found] for end in ("low", "high"))
                ax.fill_between(RATES_K_PER_S, low, high, color=COLOUR[channel], alpha=0.15, lw=0)
        flat = report.evidence.find(VARIABLES[0], "rate curve", "threshold at 0.1 K/s", channel).value
        if flat is not None and bound is not None:
            ax.plot([0.1, 0.3], [flat, flat], color=PUBLISHED, lw=5, alpha=0.35, solid_capstyle="butt")
            ax.annotate(
                f"published: changes by\nless than {100 * bound:g} % here", (0.17, flat), (0.17, flat * 3.2),
                fontsize=8, ha="center", va="bottom", arrowprops={"arrowstyle": "-", "color": "0.4"},
            )  # fmt: skip
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xticks(RATES_K_PER_S, [f"{rate:g}" for rate in RATES_K_PER_S])
        ax.minorticks_off()
        ax.set_yticks([0.1, 0.2, 0.5, 1, 2, 5], ["0.1", "0.2", "0.5", "1", "2", "5"])
        ax.set_title(channel, loc="left", fontsize=10)
        ax.set_xlabel("rate of change (K/s)")
        _tidy(ax)
        ax.legend(fontsize=8, frameon=False)
    panels[0].set_ylabel("threshold by forced choice (K)")
    return figure


def method_figure(report: ValidationReport) -> Figure:
    """Thresholds of one observer by three methods, published limits beside them, cold and warm."""
    figure = new_figure(8.0, 3.6)
    panels = figure.subplots(1, 2, sharey=True)
    names = ("forced choice", "levels", "limits")
    for ax, channel in zip(panels, CHANNELS, strict=True):
        for k, variable in enumerate(VARIABLES):
            found = [report.evidence.find(variable, "method", f"threshold by {n}", channel) for n in names]
            place = np.arange(len(names)) + 0.14 * (k - 1)
            _points(ax, place, found, channel, k, variable)
        was = [
            line.published
            for line in _lines(report, 2, "back of the hand")
            if line.row.channel == channel and line.row.judged
        ]
        for n, one in enumerate(was):
            x = 2.32 + 0.13 * n
            if one.value is not None:
                ax.plot([x], [one.value], "D", color=PUBLISHED, ms=6, label=None if n else "published, ±1 SD")
            if one.low is not None and one.high is not None:
                ax.plot([x, x], [one.low, one.high], color=PUBLISHED, lw=1.2)
        ax.set_yscale("log")
        ax.set_yticks([0.1, 0.2, 0.5, 1, 2, 4], ["0.1", "0.2", "0.5", "1", "2", "4"])
        ax.minorticks_off()
        ax.set_xticks(np.arange(len(names)), names)
        ax.set_xlim(-0.4, 2.7)
        ax.set_title(f"{channel}, back of the hand, 1 K/s", loc="left", fontsize=10)
        _tidy(ax)
        ax.legend(fontsize=8, frameon=False, loc="upper left")
    panels[0].set_ylabel("threshold (K)")
    return figure


def reaction_figure(report: ValidationReport) -> Figure:
    """Choice reaction times against area, with the published medians and what is allowed about them."""
    figure = new_figure(8.0, 3.8)
    panels = figure.subplots(1, 2, sharey=True)
    for ax, channel in zip(panels, CHANNELS, strict=True):
        for k, variable in enumerate(VARIABLES):
            found = [
                report.evidence.find(variable, "choice reaction time", f"reaction time at {area:g} cm²", channel)
                for area in AREAS_CM2
            ]
            values = [np.nan if one.value is None else one.value for one in found]
            ax.plot(AREAS_CM2, values, color=COLOUR[channel], ls=DASHES[k], lw=1.2)
            _points(ax, np.array(AREAS_CM2) * (1 + 0.025 * (k - 1)), found, channel, k, variable)
        (line,) = [one for one in _lines(report, 3, "reaction time at") if one.row.channel == channel]
        (slope,) = [one.published for one in _lines(report, 3, "exponent of area") if one.row.channel == channel]
        if line.published.value is not None and line.row.value is not None and slope.value is not None:
            area = AREAS_CM2[-1]
            ax.errorbar(
                [area * 1.09], [line.published.value], [line.row.value * line.published.value], fmt="D", ms=6,
                color=PUBLISHED, capsize=3, label=f"published, ±{100 * line.row.value:g} %",
            )  # fmt: skip
            areas = np.linspace(AREAS_CM2[0], area, 50)
            curve = line.published.value * (areas / area) ** slope.value
            ax.plot(areas, curve, color=PUBLISHED, lw=1, ls="-.", label="published exponent")
        ax.set_xscale("log")
        ax.set_xticks(AREAS_CM2, [f"{area:g}" for area in AREAS_CM2])
        ax.minorticks_off()
        ax.set_xlabel("area (cm²)")
        ax.set_title(channel, loc="left", fontsize=10)
        _tidy(ax)
        ax.legend(fontsize=7.5, frameon=False, loc="upper right" if channel == "cold" else "lower left", ncols=2)
    panels[0].set_ylabel("reaction time (s)")
    panels[0].set_ylim(0.0, 1.02 * panels[1].dataLim.y1)
    return figure


def warmth_figure(report: ValidationReport) -> Figure:
    """Radiant flux that is just felt, with and without summation over the body, on a logarithmic axis."""
    lines = [line for line in _section(report, 4) if line.row.unit == "W/m²"]
    figure = new_figure(8.0, 2.3)
    ax = figure.subplots()
    _forest(ax, lines, lambda line: fill(line.row.name, 32))
    ax.set_xscale("log")
    ax.set_xlabel("radiant flux (W/m²)")
    return figure


def event_figure(report: ValidationReport) -> Figure:
    """Events that are reported of a step and its return, near threshold."""
    lines = list(_section(report, 8))
    figure = new_figure(8.0, 2.3)
    ax = figure.subplots()
    _forest(ax, lines, lambda line: fill(line.row.name, 32))
    ax.set_xlim(0.4, 2.2)
    ax.set_xlabel("events reported")
    return figure


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of a size in inches, which no window shows."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _section(report: ValidationReport, number: int) -> tuple[Line, ...]:
    (found,) = [section.lines for section in report.sections if section.target.number == number]
    return found


def _lines(report: ValidationReport, number: int, name: str) -> list[Line]:
    return [
        line for line in _section(report, number)
        if line.row.name.startswith(name) and line.row.channel in CHANNELS
    ]  # fmt: skip


def _points(ax: Axes, place: Any, found: Sequence[Any], channel: str, k: int, label: str) -> None:
    """Predicted values with the interval of parameters, one mark and one place for each variant."""
    for x, one in zip(place, found, strict=True):
        if one.low is not None and one.high is not None:
            ax.plot([x, x], [one.low, one.high], color=COLOUR[channel], lw=2.4, alpha=0.35, solid_capstyle="butt")
    values = [np.nan if one.value is None else one.value for one in found]
    face = COLOUR[channel] if k == 0 else "white"
    ax.plot(place, values, MARKS[k], color=COLOUR[channel], mfc=face, ms=5.5, label=label, zorder=3)


def _forest(ax: Axes, lines: Sequence[Line], name: Callable[[Line], str]) -> None:
    """Rows with the prediction of every variant, its interval, and what was published with what is allowed."""
    handles: dict[str, Any] = {}
    for y, line in enumerate(lines):
        row, was = line.row, line.published
        if was.value is not None:
            if row.rule in ("factor", "close") and row.value is not None:
                ends = (was.value / row.value, was.value * row.value)
                low, high = ends if row.rule == "factor" else (was.value - row.value, was.value + row.value)
                band = ax.fill_between([low, high], y - 0.4, y + 0.4, color=BAND, lw=0, zorder=0)
                handles.setdefault("allowed", band)
            (mark,) = ax.plot([was.value] * 2, [y - 0.4, y + 0.4], color=PUBLISHED, lw=1.6)
            handles.setdefault("published", mark)
        for k, one in enumerate(line.judged):
            found, at = one.predicted, y + 0.22 * (k - 1)
            colour = COLOUR[row.channel]
            if found.low is not None and found.high is not None:
                ax.plot([found.low, found.high], [at, at], color=colour, lw=2.4, alpha=0.4, solid_capstyle="butt")
            if found.value is not None:
                face = colour if k == 0 else "white"
                (mark,) = ax.plot([found.value], [at], MARKS[k], color=colour, mfc=face, ms=5.5, zorder=3)
                handles.setdefault(VARIABLES[k], mark)
    ax.set_yticks(np.arange(len(lines)), [name(line) for line in lines], fontsize=8.5)
    ax.set_ylim(len(lines) - 0.5, -0.5)
    _tidy(ax)
    ax.legend(handles.values(), handles.keys(), fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


def _tidy(ax: Axes) -> None:
    ax.spines[["top", "right"]].set_visible(False)
    ax.tick_params(labelsize=8.5)
    ax.grid(alpha=0.2, lw=0.6)
    ax.set_axisbelow(True)
