"""The figure of a study: who is played what in which order, and one session on the clock."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .session_figure import envelope
from .style import GREY, INK, skin_limits

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from thermicon.circuit import Session

    from ..study.schedule import Course, Pace, PlannedPlay

COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#999999")
"""Okabe and Ito's colours, which people of every colour vision can distinguish; beyond eight, hatches differ."""

DARK = ("#0072b2", "#009e73", "#d55e00")
"""Numbers on these are white."""
HATCHES = ("", "//", "..", "xx")
MOST_ROWS, MOST_NUMBERED = 40, 40
"""Participants that are drawn, and plays up to which every one has its number written in it."""


def study_figure(
    courses: Sequence[Course], shown: Course, plays: Sequence[PlannedPlay], pace: Pace, session: Session | None
) -> Figure:
    """Draw the orders of all participants, and the planned session of one of them with the predicted skin.

    Returns a matplotlib ``Figure``; nothing is shown.
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    drawn = list(courses[:MOST_ROWS])
    names = list(dict.fromkeys(sorted(trial.icon for trial in courses[0].trials)))
    heights = [max(1.2, 0.24 * len(drawn) + 0.4), 0.6, 2.2]
    figure = Figure(figsize=(10.0, sum(heights) + 1.6), layout="constrained")
    order, clock, skin = figure.subplots(3, 1, height_ratios=heights)
    _orders(drawn, names, order)
    more = f" (the first {len(drawn)} of {len(courses)})" if len(courses) > len(drawn) else ""
    order.set_title(f"order of play{more}", fontsize=10, loc="left")
    _clock(shown, plays, names, pace, clock)
    clock.set_title(f"planned session of participant {shown.label}", fontsize=10, loc="left")
    _skin(plays, session, skin)
    skin.sharex(clock)
    clock.tick_params(labelbottom=False)
    skin.set_xlabel("time from the start of the session (min)")
    for ax in (order, clock, skin):
        ax.spines[["top", "right"]].set_visible(False)
    handles = [Patch(**_fill(place), lw=0.0, label=f"{place + 1}  {name}") for place, name in enumerate(names)]
    order.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=8)
    return figure


def _fill(place: int) -> dict[str, Any]:
    """Colour and hatch of an icon by its place among their names."""
    hatch = HATCHES[place // len(COLOURS) % len(HATCHES)]
    return {"facecolor": COLOURS[place % len(COLOURS)], "hatch": hatch, "edgecolor": "white"}


def _orders(courses: Sequence[Course], names: Sequence[str], ax: Axes) -> None:
    """One row per participant, one cell per play; a line where a block begins."""
    for row, course in enumerate(courses):
        for trial in course.trials:
            place = names.index(trial.icon)
            fill, pale = _fill(place), 0.45 if trial.block == 0 else 1.0
            ax.bar(trial.place - 0.5, 0.86, 1.0, row - 0.43, align="edge", **fill, lw=0.6, alpha=pale)
            if len(course.trials) <= MOST_NUMBERED:
                ink = "white" if trial.block and fill["facecolor"] in DARK else INK
                ax.text(trial.place, row, str(place + 1), fontsize=7, ha="center", va="center", color=ink)
    blocks: dict[int, list[int]] = {}
    for trial in courses[0].trials:
        blocks.setdefault(trial.block, []).append(trial.place)
    for block, places in blocks.items():
        ax.axvline(places[0] - 0.5, color=INK, lw=1.2 if block else 0.0)
    ax.set_xlim(0.4, len(courses[0].trials) + 0.6)
    ax.set_ylim(len(courses) - 0.4, -0.6)
    ax.set_yticks(range(len(courses)), [course.label for course in courses], fontsize=7)
    ax.set_ylabel("participant")
    middles = [float(np.mean(places)) for places in blocks.values()]
    ax.set_xticks(middles, ["practice" if not block else f"block {block}" for block in blocks])
    ax.tick_params(length=0)


def _clock(course: Course, plays: Sequence[PlannedPlay], names: Sequence[str], pace: Pace, ax: Axes) -> None:
    """Landings, plays and breaks as bars on the clock."""
    last, ended = None, 0.0
    labelled: set[str] = set()

    def bar(begin_s: float, end_s: float, label: str, **style: object) -> None:
        if end_s > begin_s:
            shown = label if label not in labelled else None
            labelled.add(label)
            ax.barh(0.0, (end_s - begin_s) / 60.0, 0.8, begin_s / 60.0, label=shown, **style)  # type: ignore[arg-type]

    for trial, play in zip(course.trials, plays, strict=True):
        if trial.block != last and last != 0:
            landed = play.onset_s - pace.landing_s
            if last is not None:
                bar(ended, landed, "break, hand off", color="0.85")
            bar(landed, play.onset_s, "landing of the hand", color="white", hatch="////", edgecolor=GREY, lw=0.0)
        bar(play.onset_s, play.end_s, "", **_fill(names.index(trial.icon)), lw=0.0)
        last, ended = trial.block, play.end_s
    ax.set_yticks([])
    ax.set_xlim(0.0, plays[-1].end_s / 60.0)
    handles, labels = ax.get_legend_handles_labels()
    kept = [(handle, label) for handle, label in zip(handles, labels, strict=True) if label]
    if kept:
        ax.legend(*zip(*kept, strict=True), loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8)


def _skin(plays: Sequence[PlannedPlay], session: Session | None, ax: Axes) -> None:
    """The skin of the judged session, each play and its gap moved to its planned time."""
    if session is None:
        ax.text(0.5, 0.5, "no session is simulated for a thermode", transform=ax.transAxes, ha="center", color=GREY)
        ax.set_yticks([])
        return
    trace = session.trace
    rest = float(trace.skin_C[0])
    starts = [play.start_s for play in session.plays]
    for k, (play, begin) in enumerate(zip(plays, starts, strict=True)):
        until = starts[k + 1] if k + 1 < len(starts) else float(trace.time_s[-1])
        follows = k + 1 < len(plays) and plays[k + 1].onset_s - play.onset_s - (until - begin) < 1.0
        rows = slice(*np.searchsorted(trace.time_s, [begin, until if follows else min(until, session.plays[k].end_s)]))
        time, skin = envelope(trace.time_s[rows] - begin + play.onset_s, trace.skin_C[rows])
        ax.plot(time / 60.0, skin, color=INK, lw=0.9)
    skin_limits(ax, session, 4.0, "limit")
    ax.axhline(rest, color=GREY, lw=0.7, ls=":", label=f"rest, {rest:.3g} °C")
    ax.set_ylabel("skin (°C),\nrig as given")
    ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize=8)
