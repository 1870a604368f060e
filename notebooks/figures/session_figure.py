"""The figure of a session: temperatures with every play marked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .style import COOL, GREY, INK, LIMIT, PLACES, WARM, on_one_clock

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.circuit import Session

MOST_NAMED, NAMES_INCHES = 16, 0.8
"""Plays up to which each has its name written above its bar, and the room of the names."""

FELT_K = 0.1
"""Changes of the skin below this get no bar."""

NEAR_K = 6.0
"""Limits of the skin that are nearer than this to what is drawn get a line."""


def session_figure(session: Session) -> Figure:
    """Draw a session on one clock: changes of the skin in each play, and temperatures with limits.

    Cooling is blue and points down, warming is orange and points up; lines differ in dashes too, so that the figure
    reads in grey. Returns a matplotlib ``Figure``; nothing is shown.
    """
    from matplotlib.figure import Figure

    high = 5.6 + NAMES_INCHES * (len(session.plays) <= MOST_NAMED)
    figure = Figure(figsize=(9.0, high), layout="constrained")
    minutes = session.duration_s > 600.0
    axes = figure.subplots(2, 1, sharex=True, height_ratios=[0.9, 2.2])
    scale = 1.0 / 60.0 if minutes else 1.0
    for panel, ax in zip((_changes, _temperatures), axes, strict=True):
        panel(session, ax, scale)
    plays = "1 play" if len(session.plays) == 1 else f"{len(session.plays)} plays"
    title = (
        f"{plays}, {session.plan.gap_s:g} s apart, on the {session.trace.rig_name} rig: safety {session.verdict} in "
        f"the worst of {session.scenarios} scenarios"
    )
    on_one_clock(figure, axes, "time (min)" if minutes else "time (s)", title)
    return figure


def _changes(session: Session, ax: Axes, scale: float) -> None:
    """For every play how far the skin moves either way, from where it was when the play began."""
    rest = float(session.trace.skin_C[0])
    starts = np.array([play.start_s for play in session.plays]) * scale
    widths = np.array([play.end_s for play in session.plays]) * scale - starts
    base = np.array([rest + play.drift_K for play in session.plays])
    low = np.array([play.skin_min_C for play in session.plays]) - base
    high = np.array([play.skin_max_C for play in session.plays]) - base
    if low.min() < -FELT_K:
        ax.bar(starts, low, widths, align="edge", color=COOL, label="cooling in a play")
    if high.max() > FELT_K:
        ax.bar(starts, high, widths, align="edge", color=WARM, hatch="//", edgecolor="white", lw=0.0, label="warming")
    drift = [play.drift_K for play in session.plays]
    ax.plot(starts, drift, color=INK, marker=".", ms=4, lw=1.0, label="baseline drift")
    ax.axhline(0.0, color=GREY, lw=0.8)
    ax.set_ylabel("skin (K)")
    if len(session.plays) <= MOST_NAMED:
        names = ax.secondary_xaxis("top")
        names.set_xticks(starts + 0.5 * widths, [play.icon for play in session.plays], rotation=45, ha="left")
        names.tick_params(length=0, labelsize=7)
        names.spines["top"].set_visible(False)


def _temperatures(session: Session, ax: Axes, scale: float) -> None:
    spans = [(play.start_s * scale, (play.end_s - play.start_s) * scale) for play in session.plays]
    ax.broken_barh(spans, (0.0, 1.0), transform=ax.get_xaxis_transform(), color=GREY, alpha=0.10, lw=0.0, zorder=0)
    trace = session.trace
    for name, (color, dashes, width) in PLACES.items():
        drawn = getattr(trace, f"{name.replace(' ', '_')}_C")
        ax.plot(trace.time_s * scale, drawn, color=color, ls=dashes, lw=0.8 * width, label=name)
    ax.set_ylabel("temperature (°C)")
    low, high = ax.get_ylim()
    for rule in session.limits.rules:
        if rule.quantity == "skin surface" and not rule.relative and low - NEAR_K < rule.limit < high + NEAR_K:
            thick, line = (1.4, "-") if rule.severity == "hard" else (0.9, (0, (4, 3)))
            ax.axhline(
                rule.limit, color=LIMIT, lw=thick, ls=line, label=f"{rule.severity} limit of skin, {rule.limit:g} °C"
            )
