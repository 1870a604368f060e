"""Pictures of percepts and rankings; each returns its axes and never shows a window."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.circuit.draw import COOL, WARM
from thermicon.perception.receptors import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from thermicon.perception.percept import Percept
    from thermicon.perception.ranking import Ranking

CLOCK = "response clock: with conduction and decision"
MAP = "cividis"


def plot_sensation(percept: Percept, ax: Axes | None = None) -> Axes:
    """Both sensations on the clock of the receptors, and when the first is reported, which is later."""
    axes = _axes(6.0, 3.2) if ax is None else ax
    axes.plot(percept.time_s, percept.psi_cold, color=COOL, lw=1.8, label="cold")
    axes.plot(percept.time_s, percept.psi_warm, color=WARM, lw=1.8, ls=(0, (5, 1.2)), label="warm")
    if percept.onset_s is not None:
        said = f"reported as {percept.channel} at {percept.onset_s:.2f} s\n({CLOCK})"
        axes.axvline(percept.onset_s, color="0.35", linewidth=1.0, linestyle=":", label=said)
    axes.set_xlabel(f"time (s), {percept.clock} clock")
    axes.set_ylabel("sensation (d′)")
    axes.set_title(percept.icon or "percept")
    axes.set_xlim(0.0, float(percept.time_s[-1]))
    axes.set_ylim(bottom=0.0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize="small", framealpha=0.8)
    return axes


def plot_confusion(ranking: Ranking, ax: Axes | None = None) -> Axes:
    """Predicted confusions in per cent: rows the icon presented, columns the name it is answered with.

    Every cell says its number, so there is no colour bar.
    """
    axes = _heat(ranking, 100.0 * ranking.confusion, ax, top=100.0)
    axes.set_xlabel("answered")
    axes.set_ylabel("presented")
    axes.set_title(f"predicted confusions, % ({100 * ranking.percent_correct:.0f} % correct)")
    return axes


def plot_distance(ranking: Ranking, ax: Axes | None = None) -> Axes:
    """Predicted d′ of every pair, the median over people; every cell says its number, so there is no colour bar."""
    axes = _heat(ranking, ranking.d_prime, ax, top=None)
    axes.set_xlabel("… and")
    axes.set_ylabel("d′ between …")
    axes.set_title(f"predicted d′ between icons ({ranking.norm})")
    return axes


def as_svg(axes: Axes) -> str:
    """The figure of some axes as SVG text, for a notebook."""
    held = io.StringIO()
    figure: Any = axes.figure
    figure.savefig(held, format="svg", bbox_inches="tight")
    text = held.getvalue()
    return text[text.index("<svg") :]


def _heat(ranking: Ranking, values: Array, ax: Axes | None, top: float | None) -> Axes:
    names, icons = ranking.labels, len(ranking.labels)
    side = 1.8 + 0.62 * icons
    axes = _axes(side + 0.6, side) if ax is None else ax
    highest = float(values.max()) if top is None else top
    axes.imshow(values, cmap=MAP, vmin=0.0, vmax=max(highest, 1e-9))
    axes.set_xticks(np.arange(icons), names, rotation=40, ha="right", rotation_mode="anchor")
    axes.set_yticks(np.arange(icons), names)
    axes.tick_params(length=0)
    size = 9.0 if icons <= 12 else max(4.0, 108.0 / icons)
    for i in range(icons):
        for j in range(icons):
            shade = values[i, j] / max(highest, 1e-9)
            axes.text(
                j, i, _cell(values[i, j]), ha="center", va="center", fontsize=size, color="k" if shade > 0.5 else "w"
            )
    return axes


def _cell(value: float) -> str:
    return f"{value:.0f}" if value >= 9.95 else f"{value:.1f}"


def _axes(width: float, height: float) -> Axes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()
