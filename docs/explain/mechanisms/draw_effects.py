"""Pictures of the effect of each mechanism on a cue."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from thermicon.circuit.solver.draw import COOL, WARM, new_axes

from .effects import Effect
from .onset_stages import OnsetStages

LOOKS: dict[str, dict[str, Any]] = {
    "cold": {"color": COOL, "lw": 2.0},
    "warm": {"color": WARM, "lw": 2.0, "ls": (0, (5, 1.2))},
    "off": {"color": "#8a8a8a", "lw": 1.4, "ls": (0, (2, 2))},
    "other": {"color": "#555555", "lw": 1.4, "ls": (0, (6, 1.5, 1, 1.5))},
    "reference": {"color": "#222222", "lw": 1.2},
}
"""Colour and dashes: every curve differs from the others in grey, too."""
STAGES = (
    ("receptor_s", "skin and receptors", 1.0, ""),
    ("nerve_s", "nerve", 0.62, "//"),
    ("cord_s", "cord to brain", 0.38, ".."),
    ("decision_s", "decision", 0.16, ""),
)
"""Attribute, name, how dark and hatching of each part of an onset."""


def plot_effect(effect: Effect, ax: Axes | None = None) -> Axes:
    """Draw the curves of an effect with their labels; a mechanism that is turned off is dashed and grey."""
    axes = new_axes(ax, (5.2, 3.2))
    for curve in effect.curves:
        axes.plot(curve.x, curve.y, label=curve.label, **LOOKS[curve.look])
    axes.set(xscale="log" if effect.log_x else "linear", yscale="log" if effect.log_y else "linear")
    for log, axis in ((effect.log_x, axes.xaxis), (effect.log_y, axes.yaxis)):
        if log:
            axis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_xlim(float(effect.curves[0].x.min()), float(effect.curves[0].x.max()))
    axes.set(xlabel=effect.x_label, ylabel=effect.y_label)
    axes.set_title(effect.title, loc="left", fontsize="medium")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize="small", frameon=False)
    return axes


def plot_onset_stages(stages: Sequence[OnsetStages], ax: Axes | None = None) -> Axes:
    """Draw one bar an icon, divided by stage; a diamond marks the onset with conduction of the leg."""
    axes = new_axes(ax, (6.2, 0.42 * len(stages) + 1.5))
    places = np.arange(len(stages))
    colours = [COOL if stage.channel == "cold" else WARM for stage in stages]
    start = np.zeros(len(stages))
    for attribute, _, alpha, hatch in STAGES:
        width = np.array([getattr(stage, attribute) for stage in stages])
        axes.barh(places, width, left=start, color=[(c, alpha) for c in colours], hatch=hatch, ec="w", lw=0.8)
        start = start + width
    axes.plot([stage.leg_s for stage in stages], places, ls="", marker="D", ms=5, mfc="w", mec="#222222")
    axes.set_yticks(places, [f"{stage.icon}, {stage.onset_s:.2f} s" for stage in stages])
    axes.invert_yaxis()
    axes.set_xlim(0.0, 1.05 * max(max(stage.leg_s, stage.onset_s) for stage in stages))
    axes.set_xlabel("time from the start of the cue (s)")
    axes.set_title("Onset of a nominal person (blue: cold, orange: warm)", loc="left", fontsize="medium")
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    grey = "#333333"
    handles: list[Any] = [Patch(fc=(grey, alpha), hatch=hatch, ec="w", label=name) for _, name, alpha, hatch in STAGES]
    handles.append(Line2D([], [], ls="", marker="D", ms=5, mfc="w", mec="#222222", label="conduction of the leg"))
    axes.figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    return axes
