"""``thermicon simulate --order`` or ``--random``: a session as one run, with one verdict and one row per play."""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.number_text import number, span

from ..files.outputs import TRACE_SUFFIXES, check_output, check_separate
from ..messages import note, progress_bar
from ..report.blocks import Block, Text, grid
from ..report.terminal import show
from .cues import read_set, warn_of_site
from .export import CAUTION
from .options import FigureOptions, write_text

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Session
    from thermicon.icons import IconSet

NUMBERS, ORDER = ".json", ".txt"
MOST_SHOWN = 60
"""Plays in the table; all of them are in the JSON."""


def session_file(
    file: str,
    rig: Rig,
    order: Path | None,
    repeats: int | None,
    gap_s: float,
    seed: int,
    tracking: str | None,
    output: Path | None,
    figure: FigureOptions,
) -> None:
    """Simulate a session with the icons of a file, in the order of a file or shuffled; print and write the report."""
    from thermicon.circuit import SessionPlan, play_session
    from thermicon.circuit.safety.session import check_repeats, order_text, read_order

    from .simulate import write_traces

    if output is not None:
        check_output(output, (*TRACE_SUFFIXES, NUMBERS, ORDER), "a session")
    check_separate([file] if order is None else [file, order], (output, figure.figure))
    icons = read_set([file])
    if order is not None:
        plan = SessionPlan(read_order(order, icons), gap_s)
    else:
        check_repeats(repeats or 1, len(icons), "icons")
        plan = SessionPlan.shuffled([icon.name for icon in icons], repeats or 1, seed=seed, gap_s=gap_s)
    warn_of_site(file, icons, rig)
    with progress_bar("worst case") as progress:
        played = [icons[name] for name in plan.names]
        session = play_session(played, plan, rig, tracking=tracking or "replay", progress=progress)
    if output is not None and output.suffix == ORDER:
        write_text(order_text(plan), output)
    elif output is not None and output.suffix == NUMBERS:
        write_text(session_text(session, icons, rig), output)
    elif output is not None:
        write_traces([session.trace], output)
        note(f"wrote {output}")
    if figure.figure is not None:
        from ..figures.session_figure import session_figure

        figure.write(session_figure(session))
    show(session_report(session))
    note(CAUTION)


def session_text(session: Session, icons: IconSet, rig: Rig) -> str:
    """The session as JSON text; missing values are null."""
    facts = {
        "thermicon": version("thermicon"),
        "content_hash": icons.content_hash,
        **session.to_dict(),
        "rig_changes": list(rig.changes),
        "rig_text": rig.document,
    }
    return json.dumps(facts, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def session_report(session: Session) -> list[Block]:
    """Report the verdict, a summary of the session, and one row per play."""
    columns = ("play", "icon", "start", "skin", "display", "baseline", "safety")
    rows = [
        (
            str(place),
            play.icon,
            f"{number(play.start_s, 2)} s",
            span(play.skin_min_C, play.skin_max_C, "°C"),
            span(play.display_min_C, play.display_max_C, "°C"),
            f"{number(play.drift_K, 2)} K",
            play.verdict,
        )
        for place, play in enumerate(session.plays[:MOST_SHOWN], 1)
    ]
    more = len(session.plays) - MOST_SHOWN
    return [
        Text("\n".join(summary_lines(session))),
        grid(columns, rows, ("play", "start", "baseline"), ("icon",)),
        *([Text(f"and {more} more plays; -o OUT.json lists all")] if more > 0 else []),
    ]


def summary_lines(session: Session) -> list[str]:
    """The summary of a session, line by line."""
    trace, plan = session.trace, session.plan
    plays = "1 play" if len(session.plays) == 1 else f"{len(session.plays)} plays"
    shuffled = "" if plan.seed is None else f", shuffled with seed {plan.seed}"
    lines = [
        f"{plays} in {number(session.duration_s, 2)} s on {trace.rig_name}, "
        f"{number(plan.gap_s, 2)} s between plays{shuffled}",
        f"safety {session.verdict} in {session.scenarios} scenarios, during the whole session and after it",
        *(f"  - {'NOT SAFE: ' if finding.severity == 'hard' else ''}{finding}" for finding in session.findings),
    ]
    for words, column in (("skin", trace.skin_C), ("display", trace.display_C), ("hot plate", trace.hot_plate_C)):
        lines.append(f"  {words:<10} {span(float(column.min()), float(column.max()), '°C')}")
    after = "more than 10 min" if session.recovery_s is None else f"{number(session.recovery_s)} s"
    lines += [
        *_dose_lines(session),
        f"  baseline   {number(session.baseline_drift_K, 2)} K at most; within 0.1 K again {after} after the end",
        f"  energy     {number(session.energy_J)} J into the module",
    ]
    over = [
        f"  beyond     {number(each.seconds, 2)} s {'above' if each.upper else 'below'} the {each.severity} limit of "
        f"{number(each.limit_C)} °C ({each.quantity})"
        for each in session.time_beyond
        if each.seconds > 0
    ]
    return [*lines, *over]


def _dose_lines(session: Session) -> list[str]:
    """Thermal dose on the given rig and in the worst case, with the limits of a session."""
    lines = []
    for words, quantity, value, unit in (
        ("dose", "thermal dose", session.dose_cem43_min, " min CEM43"),
        ("Henriques", "Henriques integral", session.henriques, ""),
    ):
        worst = session.worst(quantity)
        if worst is not None:
            limit = f"{worst.value:.2g} in the worst case; the limit of a session is {worst.limit:g}"
            lines.append(f"  {words:<10} {value:.2g}{unit}, {limit}")
    return lines
