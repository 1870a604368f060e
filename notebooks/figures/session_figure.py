"""The figure of a session: temperatures with every play marked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .style import COOL, GREY, INK, LIMIT, PLACES, WARM, new_figure, on_one_clock

if TYPE_CHECKING:
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
    plays, trace, minutes = session.plays, session.trace, session.duration_s > 600.0
    figure = new_figure(9.0, 5.6 + NAMES_INCHES * (len(plays) <= MOST_NAMED))
    axes = figure.subplots(2, 1, sharex=True, height_ratios=[0.9, 2.2])
    scale = 1.0 / 60.0 if minutes else 1.0
    # How far the skin moves either way in each play, from where it was when the play began.
    changes, temperatures = axes
    starts = np.array([play.start_s for play in plays]) * scale
    widths = np.array([play.end_s for play in plays]) * scale - starts
    base = np.array([float(trace.skin_C[0]) + play.drift_K for play in plays])
    low = np.array([play.skin_min_C for play in plays]) - base
    high = np.array([play.skin_max_C for play in plays]) - base
    if low.min() < -FELT_K:
        changes.bar(starts, low, widths, align="edge", color=COOL, label="cooling in a play")
    if high.max() > FELT_K:
        look = {"color": WARM, "hatch": "//", "edgecolor": "white", "lw": 0.0}
        changes.bar(starts, high, widths, align="edge", label="warming", **look)
    drift = [play.drift_K for play in plays]
    changes.plot(starts, drift, color=INK, marker=".", ms=4, lw=1.0, label="baseline drift")
    changes.axhline(0.0, color=GREY, lw=0.8)
    changes.set_ylabel("skin (K)")
    if len(plays) <= MOST_NAMED:
        names = changes.secondary_xaxis("top")
        names.set_xticks(starts + 0.5 * widths, [play.icon for play in plays], rotation=45, ha="left")
        names.tick_params(length=0, labelsize=7)
        names.spines["top"].set_visible(False)
    spans = [(play.start_s * scale, (play.end_s - play.start_s) * scale) for play in plays]
    across = temperatures.get_xaxis_transform()
    temperatures.broken_barh(spans, (0.0, 1.0), transform=across, color=GREY, alpha=0.10, lw=0.0, zorder=0)
    for name, (color, dashes, width) in PLACES.items():
        drawn = getattr(trace, f"{name.replace(' ', '_')}_C")
        temperatures.plot(trace.time_s * scale, drawn, color=color, ls=dashes, lw=0.8 * width, label=name)
    temperatures.set_ylabel("temperature (°C)")
    coldest, warmest = temperatures.get_ylim()
    for rule in session.limits.rules:
        near = coldest - NEAR_K < rule.limit < warmest + NEAR_K
        if rule.quantity == "skin surface" and not rule.relative and near:
            thick, line = (1.4, "-") if rule.severity == "hard" else (0.9, (0, (4, 3)))
            label = f"{rule.severity} limit of skin, {rule.limit:g} °C"
            temperatures.axhline(rule.limit, color=LIMIT, lw=thick, ls=line, label=label)
    count = "1 play" if len(plays) == 1 else f"{len(plays)} plays"
    title = (
        f"{count}, {session.plan.gap_s:g} s apart, on the {trace.rig_name} rig: safety {session.verdict} in "
        f"the worst of {session.scenarios} scenarios"
    )
    on_one_clock(figure, axes, "time (min)" if minutes else "time (s)", title)
    return figure
