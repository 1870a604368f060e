"""Figures of the validation report that show courses in time, confusions and trade-offs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.solver.draw import COOL, DISPLAY, SKIN, WARM

from ..arrays import Array
from ..observer.channels import CHANNELS
from ..observer.variants import VARIABLES
from .tradeoffs import STRONG
from .validate import ValidationReport
from .validate_figures import (
    DASHES,
    event_figure,
    method_figure,
    new_figure,
    rate_figure,
    reaction_figure,
    warmth_figure,
)
from .waves import PAIRS, SHAPES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

MAP = "cividis"
SHAPE_STYLES = (("#111111", "-"), ("#5e3c99", (0, (5, 1.2))), ("#8c8c8c", (0, (1, 1))))


def peak_figure(report: ValidationReport) -> Figure:
    """The smooth pulse at display and skin, and as it is felt, each scaled to its own peak; peaks are marked."""
    figure = new_figure(8.0, 4.4)
    panels = figure.subplots(2, 1, sharex=True)
    colour = dict(zip(CHANNELS, (COOL, WARM), strict=True))
    for ax, channel in zip(panels, CHANNELS, strict=True):
        own = [pulse for pulse in report.evidence.pulses if pulse.channel == channel]
        sign = -1.0 if channel == "cold" else 1.0
        time = own[0].time_s
        for values, name, shade, dashes in (
            (own[0].display_K, "display", DISPLAY, (0, (4, 2))),
            (own[0].skin_K, "face of the skin", SKIN, "-"),
        ):
            scaled = sign * values / np.abs(values).max()
            ax.plot(time, scaled, color=shade, lw=1.3, ls=dashes, label=name)
        ax.axvline(time[int(np.abs(own[0].skin_K).argmax())], color=SKIN, lw=0.8)
        for k, pulse in enumerate(own):
            delay = report.evidence.find(pulse.variable, "felt peak", "felt peak minus the skin's", channel)
            peak = time[int(np.abs(pulse.skin_K).argmax())] + (delay.value or 0.0)
            late = peak - time[int(pulse.felt.argmax())]
            ax.plot(
                time + late, pulse.felt / max(float(pulse.felt.max()), 1e-9), color=colour[channel], lw=1.8,
                ls=DASHES[k], label=f"felt, {pulse.variable}",
            )  # fmt: skip
            if delay.value is not None:
                ax.plot(
                    [peak], [1.06 + 0.07 * k], "v", color=colour[channel], ms=5, mfc="white" if k else colour[channel]
                )
        ax.set_title(
            f"{channel}: felt with conduction; triangles mark felt peaks, the line that of the skin",
            loc="left",
            fontsize=9,
        )
        ax.set_ylabel("share of its peak (1)", fontsize=9)
        ax.set_ylim(-0.05, 1.32)
        ax.spines[["top", "right"]].set_visible(False)
        ax.tick_params(labelsize=8.5)
        ax.legend(fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    panels[0].set_xlim(0.0, float(report.evidence.pulses[0].time_s[-1]))
    panels[-1].set_xlabel("time (s)")
    return figure


def six_figure(report: ValidationReport) -> Figure:
    """Predicted confusions of the six icons in per cent, one map for each variant."""
    figure = new_figure(11.0, 4.3)
    for k, (ax, found) in enumerate(zip(figure.subplots(1, 3), report.evidence.six, strict=True)):
        _map(ax, found.pooled, found.labels, found.labels if k == 0 else (), 8.0)
        correct = 100.0 * float(np.trace(found.pooled)) / len(found.labels)
        ax.set_title(f"{found.variable}: {correct:.0f} % correct", fontsize=9.5)
        ax.set_xlabel("answered", fontsize=9)
        if k == 0:
            ax.set_ylabel("presented, answers in %", fontsize=9)
    return figure


def skin_figure(report: ValidationReport) -> Figure:
    """What the display makes of the three shapes: skin temperature in every group, with how far shapes are apart."""
    figure = new_figure(9.6, 5.4)
    for ax, group in zip(figure.subplots(2, 2, sharey=True).flat, report.evidence.skin, strict=True):
        for (shade, dashes), shape, skin in zip(SHAPE_STYLES, SHAPES, group.skin_C, strict=True):
            ax.plot(group.time_s, skin, color=shade, ls=dashes, lw=1.5, label=shape)
        apart = {one.pair: one for one in report.evidence.alike if one.group == group.group}
        said = [f"{a}–{b} {100 * apart[a, b].largest:.0f} % ({100 * apart[a, b].rms:.0f} %)" for a, b in PAIRS]
        ax.set_title(f"{group.group}; apart at most (rms): {said[0]},\n{said[1]}, {said[2]}", loc="left", fontsize=8.5)
        ax.set_xlim(0.0, float(group.time_s[-1]))
        ax.set_xlabel("time (s)", fontsize=9)
        ax.set_ylabel("skin (°C)", fontsize=9)
        ax.spines[["top", "right"]].set_visible(False)
        ax.tick_params(labelsize=8.5)
    handles, names = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return figure


def wave_figure(report: ValidationReport) -> Figure:
    """Predicted confusions of the waves among each other and with the six icons, from temperature and heat flow."""
    figure = new_figure(13.0, 7.4)
    for k, (ax, found) in enumerate(zip(figure.subplots(1, 2), report.evidence.waves[:2], strict=True)):
        _map(ax, found.pooled, found.labels, found.labels if k == 0 else (), 6.5)
        for edge in (3, 6, 9, 12):
            ax.axhline(edge - 0.5, color="w", lw=1.2)
            ax.axvline(edge - 0.5, color="w", lw=1.2)
        ax.set_title(f"{found.variable}: answers in %", fontsize=10)
        ax.set_xlabel("answered", fontsize=9)
        if k == 0:
            ax.set_ylabel("presented", fontsize=9)
    return figure


def trade_figure(report: ValidationReport) -> Figure:
    """Rank correlations of the judged predictions over the plausible observers, from temperature and heat flow."""
    pairs = report.trade_offs[:2]
    names = list(dict.fromkeys(name for one in pairs for trade in one for name in (trade.first, trade.second)))
    if not names:
        figure = new_figure(8.0, 1.2)
        ax = figure.subplots()
        ax.text(0.0, 0.5, "too few draws for correlations", fontsize=10)
        ax.set_axis_off()
        return figure
    figure = new_figure(13.5, 5.6)
    codes = _codes(names)
    for k, (ax, trades) in enumerate(zip(figure.subplots(1, 2), pairs, strict=True)):
        table = np.full((len(names), len(names)), np.nan)
        for trade in trades:
            a, b = names.index(trade.first), names.index(trade.second)
            if trade.correlation is not None:
                table[max(a, b), min(a, b)] = trade.correlation
        drawn = ax.imshow(table, cmap=_opposed(), vmin=-1.0, vmax=1.0)
        ax.set_xticks(np.arange(len(names)), codes, rotation=90, fontsize=7)
        said = [f"{name.partition(' ')[2]}  {code}" for name, code in zip(names, codes, strict=True)]
        ax.set_yticks(np.arange(len(names)), said if k == 0 else codes, fontsize=7)
        ax.tick_params(length=0)
        ax.spines[:].set_visible(False)
        ax.set_title(VARIABLES[k], fontsize=10)
        for y, x in zip(*np.nonzero(np.abs(np.nan_to_num(table)) >= STRONG), strict=True):
            ax.plot(x, y, ".", ms=2.5, color="w" if abs(table[y, x]) > 0.75 else "k")
    figure.colorbar(drawn, ax=figure.axes, shrink=0.6, label="Spearman's correlation over plausible observers (1)")
    return figure


def _codes(names: Sequence[str]) -> list[str]:
    """Short codes of labels that begin with the number of their target.

    >>> _codes(["1 a", "1 b", "2 c"])
    ['1a', '1b', '2a']
    """
    seen: dict[str, int] = {}
    codes = []
    for name in names:
        target = name.partition(" ")[0]
        seen[target] = seen.get(target, -1) + 1
        codes.append(f"{target}{chr(ord('a') + seen[target])}")
    return codes


def _map(ax: Axes, shares: Array, columns: Sequence[str], rows: Sequence[str], size: float) -> None:
    percent = 100.0 * shares
    ax.imshow(percent, cmap=MAP, vmin=0.0, vmax=100.0)
    ax.set_xticks(np.arange(len(columns)), columns, rotation=50, ha="right", rotation_mode="anchor", fontsize=size)
    ax.set_yticks(np.arange(len(columns)), rows or [""] * len(columns), fontsize=size)
    ax.tick_params(length=0)
    ax.spines[:].set_visible(False)
    for i, j in np.ndindex(percent.shape):
        if percent[i, j] >= 0.95 or i == j:
            ax.text(
                j, i, f"{percent[i, j]:.0f}", ha="center", va="center", fontsize=size,
                color="k" if percent[i, j] > 50.0 else "w",
            )  # fmt: skip


Drawn = tuple[str, str, Callable[[ValidationReport], "Figure"]]

_BARS = "Bars: interval from parameters."
FIGURES: dict[int, tuple[Drawn, ...]] = {
    1: (
        (
            "rate-curve",
            "Thresholds by forced choice against the rate of change. The band is the interval that unmeasured "
            "parameters leave to the prediction from temperature; where a line ends, the largest change was not felt.",
            rate_figure,
        ),
    ),
    2: (("limits", f"One observer by three methods. {_BARS} Published: women, then men.", method_figure),),
    3: (("reaction-times", f"Choice reaction times against area. {_BARS}", reaction_figure),),
    4: (("warmth", f"Radiant flux that is just felt. {_BARS}", warmth_figure),),
    5: (("peaks", "A smooth pulse and how it is felt, each course scaled to its own peak.", peak_figure),),
    6: (("six-icons", "Predicted confusions of the six icons. Less than 1 % is not written out.", six_figure),),
    7: (
        (
            "wave-skin",
            "Skin temperature of the three shapes under display control; differences over the swing.",
            skin_figure,
        ),
        (
            "waves",
            "Predicted confusions of the waves and the six icons. Less than 1 % is not written out.",
            wave_figure,
        ),
    ),
    8: (("return", f"Events reported of a step and its return. {_BARS}", event_figure),),
}
"""File name, caption and drawing of the figures of every target."""
TRADE_OFF: Drawn = (
    "trade-offs",
    "How judged predictions move together over the plausible observers. Orange: both rise; blue: one falls; dots: "
    "0.5 and stronger. Codes begin with the number of the target.",
    trade_figure,
)


def _opposed() -> Colormap:
    """Colours from blue over white to orange, for what has two signs."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("blue to orange", [COOL, "#ffffff", WARM])
