"""The overview of one icon from drive to percept on one clock."""

from __future__ import annotations

import dataclasses
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy

from thermicon.base.checks.arguments import checked
from thermicon.circuit.solver.trace import Trace

from .set_figures import set_figure
from .style import COOL, GREY, INK, LIMIT, PLACES, TARGET, WARM, new_figure, on_one_clock
from .sweep_figure import sweep_figure

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.perception import Percept, Ranking

    from ..timeline.scene import Scene

FELT_TAIL_S = 5.0
"""How long an overview follows sensation after the last corner, unless a tail is given."""
WIDEST, MOST_LINES = 110, 6
"""Letters of a line, and lines, of what the figure of a scene says."""


@checked
def overview(
    trace: Trace | Ranking | pd.DataFrame, percept: Percept | None = None, rig_changes: Sequence[str] = ()
) -> Figure:
    """Draw one icon on one clock (temperatures, heat flow, current, with a percept sensation), a ranking or a sweep.

    Parameters
    ----------
    trace
        The run; a ranking, for distances and confusions side by side; or the table of `sweep`.
    percept
        What is felt of it; None: no panel of sensation.
    rig_changes
        Changes of the rig, named in the title.

    Returns
    -------
    matplotlib.figure.Figure
        A figure that is not shown. Line styles differ as well as colours, so that it can be printed in grey.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import load_library
    >>> trace = simulate(load_library("six-icons")["cooling-step"], Rig.load("thenar"))
    >>> [ax.get_ylabel() for ax in overview(trace).axes][2]
    'current (A)'
    """
    from thermicon.perception import Ranking

    if isinstance(trace, Ranking):
        return set_figure(trace)
    if not isinstance(trace, Trace):
        return sweep_figure(trace)
    panels = [_temperatures, _heat_flow, *([_current] if trace.has_current else [])]
    figure = new_figure(8.0, 8.4 if percept is not None else 6.4)
    count = len(panels) + (percept is not None)
    heights = [1.5, 1.2, *([0.9] if trace.has_current else []), *([] if percept is None else [1.1])]
    axes = figure.subplots(count, 1, sharex=True, height_ratios=heights)
    for panel, ax in zip(panels, axes, strict=False):
        panel(trace, ax)
    if percept is not None:
        _sensation(percept, axes[-1])
    icon = trace.icon or "drive"
    what_if = f" with {', '.join(rig_changes)}" if rig_changes else ""
    on_one_clock(figure, axes, "time (s)", f"{icon} on the {trace.rig_name} rig{what_if}")
    return figure


def _temperatures(trace: Trace, ax: Axes) -> None:
    t = trace.time_s
    if numpy.isfinite(trace.target_C).any():  # a broad band underneath, since the controlled line lies on it
        ax.plot(t, trace.target_C, color=TARGET, lw=5.0, solid_capstyle="butt", label="target")
    for name, (color, dashes, width) in PLACES.items():
        ax.plot(t, getattr(trace, f"{name.replace(' ', '_')}_C"), color=color, lw=width, ls=dashes, label=name)
    ax.set_ylabel("temperature (°C)")


def _heat_flow(trace: Trace, ax: Axes) -> None:
    t = trace.time_s
    ax.axhline(0.0, color=GREY, lw=0.6)
    for name, (color, dashes, width) in list(PLACES.items())[1:]:
        flow = getattr(trace, f"heat_flow_{name.replace(' ', '_')}_W_per_m2") / 1e3
        ax.plot(t, flow, color=color, lw=width, ls=dashes, label=name)
    ax.set_ylabel("heat flow\ninto skin (kW/m²)")


def _current(trace: Trace, ax: Axes) -> None:
    low, high = trace.driver_limits_A
    ax.axhline(0.0, color=GREY, lw=0.6)
    ax.plot(trace.time_s, trace.current_A, color=INK, lw=1.1, drawstyle="steps-post", label="current\n(+ cools)")
    for k, limit in enumerate((low, high)):
        ax.axhline(limit, color=LIMIT, lw=1.0, ls=(0, (2, 2)), label="driver's limits" if k == 0 else None)
    ax.set_ylabel("current (A)")


def _sensation(percept: Percept, ax: Axes) -> None:
    t = numpy.arange(len(percept.psi_cold)) * percept.dt_s
    ax.plot(t, percept.psi_cold, color=COOL, lw=1.5, ls="-.", label="cold")
    ax.plot(t, percept.psi_warm, color=WARM, lw=1.5, ls="--", label="warm")
    if percept.onset_s is not None:
        said = f"reported as {percept.channel}\nat {percept.onset_s:.2f} s by the\nnominal person\n(response clock)"
        ax.axvline(percept.onset_s, color=INK, lw=1.0, ls=":", label=said)
    else:
        ax.plot([], [], " ", label=f"not felt by the\nnominal person\n(p {percept.detected_probability:.2f})")
    ax.set_ylabel("sensation (d′)\nreceptor clock")


def felt(trace: Trace) -> tuple[Trace, Percept]:
    """A trace on an even clock, and what is felt of it."""
    from thermicon.perception import perceive

    steps = numpy.diff(trace.time_s)
    if len(steps) > 1 and abs(steps[-1] - steps[0]) >= 1e-6 * steps[0]:
        # The last row comes off the beat, as when a drive ends between two rows.
        columns = ((field.name, getattr(trace, field.name)) for field in dataclasses.fields(trace))
        cut: dict[str, Any] = {name: each[:-1] for name, each in columns if isinstance(each, numpy.ndarray)}
        trace = dataclasses.replace(trace, **cut)
    return trace, perceive(trace)


def scene_figure(scene: Scene) -> Figure:
    """Draw a scene: the overview of its icon, with safety and notes above.

    A scene without a drawing gives a figure that says why.
    """
    badge = scene.badge
    told = [f"{badge.colour.upper()}  {badge.text}"]
    told += [*(f"line {trouble.line}: {trouble.headline}" for trouble in scene.troubles), *scene.notes]
    lines = [row for text in dict.fromkeys(told) for row in textwrap.wrap(text, WIDEST)]
    if len(lines) > MOST_LINES:
        lines = [*lines[: MOST_LINES - 1], f"and {len(lines) - MOST_LINES + 1} more lines"]
    if scene.drawing is None:
        figure = new_figure(8.0, 2.0)
        figure.suptitle("\n".join(lines), fontsize=10, x=0.01, ha="left")
        return figure
    figure = overview(scene.drawing.trace, scene.drawing.percept, scene.drawing.rig.changes)
    head = figure.get_suptitle() + (", as it was before the errors" if scene.stale and scene.troubles else "")
    figure.suptitle("\n".join([head, *lines]), fontsize=10)
    return figure
