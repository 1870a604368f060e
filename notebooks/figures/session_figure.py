"""The figure of a session: temperatures with every play marked, what each play changes, and the dose so far."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .style import COOL, GREY, INK, LIMIT, NEAR_K, PLACES, WARM, on_one_clock, skin_limits

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from thermicon.circuit import Session

MOST_BINS = 2000
"""Bins on the axis of time; each shows the least and the most of its rows, so that no peak is lost."""

MOST_NAMED = 16
"""Plays up to which each has its name written beside its bar."""

HOT = "#7f3b08"
LEAST_DOSE, FELT_K = 1e-8, 0.1
"""Where the axis of dose ends, as a share of the limit; changes of the skin below this get no bar."""


def session_figure(session: Session) -> Figure:
    """Draw a session on one clock: changes of the skin in each play, temperatures with limits, and dose.

    Cooling is blue and points down, warming is orange and points up; lines differ in dashes too, so that the figure
    reads in grey. Returns a matplotlib ``Figure``; nothing is shown.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 8.6), layout="constrained")
    minutes = session.duration_s > 600.0
    axes = figure.subplots(4, 1, sharex=True, height_ratios=[0.9, 2.2, 0.7, 1.0])
    scale = 1.0 / 60.0 if minutes else 1.0
    for panel, ax in zip((_changes, _temperatures, _hot_plate, _dose), axes, strict=True):
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
        top = float(max(high.max(), 0.0))
        for start, width, play in zip(starts, widths, session.plays, strict=True):
            ax.text(start + 0.5 * width, top + 0.4, play.icon, fontsize=7, ha="left", va="bottom", rotation=30)


def _temperatures(session: Session, ax: Axes, scale: float) -> None:
    trace = session.trace
    _mark_plays(session, ax, scale)
    for name, (color, dashes, width) in PLACES.items():
        time, drawn = envelope(trace.time_s * scale, getattr(trace, f"{name.replace(' ', '_')}_C"))
        ax.plot(time, drawn, color=color, ls=dashes, lw=0.8 * width, label=name)
    ax.set_ylabel("temperature (°C)")
    skin_limits(ax, session)


def _hot_plate(session: Session, ax: Axes, scale: float) -> None:
    trace = session.trace
    _mark_plays(session, ax, scale)
    time, drawn = envelope(trace.time_s * scale, trace.hot_plate_C)
    ax.plot(time, drawn, color=HOT, lw=1.1, label="hot plate")
    worst = session.worst("hot plate")
    if worst is not None:
        ax.axhline(worst.value, color=HOT, lw=0.9, ls=(0, (1, 1.5)), label="highest in the worst case")
        if worst.limit < worst.value + NEAR_K:
            ax.axhline(worst.limit, color=LIMIT, lw=1.4, label=f"hard limit, {worst.limit:g} °C")
    ax.set_ylabel("hot plate\n(°C)")


def _mark_plays(session: Session, ax: Axes, scale: float) -> None:
    spans = [(play.start_s * scale, (play.end_s - play.start_s) * scale) for play in session.plays]
    ax.broken_barh(spans, (0.0, 1.0), transform=ax.get_xaxis_transform(), color=GREY, alpha=0.10, lw=0.0, zorder=0)


def _dose(session: Session, ax: Axes, scale: float) -> None:
    """Dose so far as a share of what a session may have, on the rig as given; the worst case as a mark at the end."""
    from thermicon.circuit.safety.tally import cem43_min, henriques

    trace = session.trace
    for quantity, label, grow, color, dashes, mark in (
        ("thermal dose", "CEM43", cem43_min, INK, "-", "o"),
        ("Henriques integral", "Henriques", henriques, GREY, (0, (5, 2)), "s"),
    ):
        worst = session.worst(quantity)
        if worst is None:
            continue
        time, share = envelope(trace.time_s * scale, grow(trace.time_s, trace.skin_C) / worst.limit)
        none = "" if share[-1] > LEAST_DOSE else " (none)"
        ax.plot(time, np.maximum(share, LEAST_DOSE), color=color, ls=dashes, lw=1.3, label=f"{label}{none}")
        ax.plot(
            [trace.time_s[-1] * scale],
            [max(worst.value / worst.limit, LEAST_DOSE)],
            color=color,
            marker=mark,
            ms=6,
            ls="none",
            mfc="white",
            clip_on=False,
            label=f"{label}, worst case",
        )
    ax.axhline(1.0, color=LIMIT, lw=1.4, label="limit per session")
    ax.set_yscale("log")
    ax.set_ylim(LEAST_DOSE, 10.0)
    ax.set_ylabel("dose\n(share of the limit)")


def envelope(time_s: NDArray[np.float64], values: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Return fewer rows that look the same: the least and the most of each bin; as they are where they are few."""
    if len(time_s) <= 2 * MOST_BINS:
        return time_s, values
    edges = np.linspace(0, len(time_s), MOST_BINS + 1).astype(np.int64)[:-1]
    low, high = np.minimum.reduceat(values, edges), np.maximum.reduceat(values, edges)
    return np.repeat(time_s[edges], 2), np.stack([low, high], axis=1).ravel()
