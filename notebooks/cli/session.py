"""``thermicon session``: a sequence of icons as one run, with one verdict and one row per play."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..figures.figure_look import (
    SCREEN,
    FigureFile,
    FigureStyle,
    FigureWidth,
    Look,
    NoTitle,
    figure_look,
)
from ..messages import check_bounds, check_changes, load_rig, note, usage
from ..report.options import Changes, OneFile, RigName
from .export import CAUTION

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Session, SessionPlan
    from thermicon.icons import IconSet

TRACKING = ("replay", "display")
LONGEST_GAP_S = 3600.0
"""The end of `thermicon.circuit.SessionPlan`, here without its imports."""

RANDOM_REPEATS, ORDER_REPEATS = 8, 1
MOST_SHOWN = 60
"""Plays in the table; all of them are in the JSON."""


@dataclass(frozen=True, slots=True)
class Request:
    """Options of a session; without an `order`, icons are shuffled with `seed`."""

    order: Path | None
    repeats: int
    seed: int
    gap_s: float
    tracking: str
    json: Path | None = None
    figure: Path | None = None
    order_out: Path | None = None
    look: Look = SCREEN


def session_command(
    file: OneFile,
    order: Annotated[
        Path | None,
        typer.Option(
            "--order",
            metavar="FILE",
            readable=False,
            help="File with the names of the icons in the order of play, one per line.",
        ),
    ] = None,
    random: Annotated[bool, typer.Option("--random", help="Play every icon --repeats times, in random order.")] = False,
    gap: Annotated[
        float,
        typer.Option(
            "--gap", metavar="S", help="Seconds from the end of one icon to the start of the next, 0 to 3600."
        ),
    ] = 10.0,
    repeats: Annotated[
        int | None,
        typer.Option(
            "--repeats",
            metavar="N",
            help="Number of plays of each icon, or of the whole order.  [default: 8 with --random, 1 with --order]",
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the random order.")] = 0,
    tracking: Annotated[
        str,
        typer.Option(
            "--tracking",
            metavar="|".join(TRACKING),
            help="Replay the currents open loop, or control the display temperature.",
        ),
    ] = "replay",
    json: Annotated[
        Path | None, typer.Option("--json", metavar="OUT", readable=False, help="Write every number as JSON.")
    ] = None,
    figure: FigureFile = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    order_out: Annotated[
        Path | None,
        typer.Option(
            "--order-out", metavar="OUT", readable=False, help="Write the order of play as a file for --order."
        ),
    ] = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Simulate a session, a sequence of icons: temperatures, thermal dose, baseline drift and worst-case safety.

    The verdict is only reported: the exit code is 0 whatever its colour. Only export refuses icons.
    """
    check_changes(changes or [])
    if (order is None) == (not random):
        raise usage("give either --order FILE or --random", "--order")
    if not (math.isfinite(gap) and 0.0 <= gap <= LONGEST_GAP_S):
        raise usage(f"{gap:g} s is outside 0 to {LONGEST_GAP_S:g} s", "--gap")
    if repeats is not None and repeats < 1:
        raise usage(f"{repeats} is not a number of repeats of 1 or more", "--repeats")
    check_bounds(("--seed", seed, 0, 2**63 - 1))
    if tracking not in TRACKING:
        raise usage(f"{tracking!r} is not one of {', '.join(TRACKING)}", "--tracking")
    count = repeats if repeats is not None else RANDOM_REPEATS if random else ORDER_REPEATS
    look = figure_look(figure, width, style, no_title)
    request = Request(order, count, seed, gap, tracking, json, figure, order_out, look)
    session_file(file, load_rig(rig, changes or []), request)


def session_file(file: str, rig: Rig, request: Request) -> None:
    """Simulate a session with the icons of a file; print the report and write the requested files."""
    from thermicon.circuit import play_session
    from thermicon.circuit.safety.sessionplan import order_text

    from ..files.outputs import FIGURE_SUFFIXES, check_output, check_separate, complete_or_absent
    from ..messages import progress_bar
    from .cues import read_set, warn_of_site

    for path, suffixes, what in (
        (request.json, (), "a report"),
        (request.figure, FIGURE_SUFFIXES, "a figure"),
        (request.order_out, (), "an order"),
    ):
        if path is not None:
            check_output(path, suffixes, what)
    read: list[str | Path] = [file] if request.order is None else [file, request.order]
    check_separate(read, (request.json, request.figure, request.order_out))
    icons = read_set([file])
    plan = plan_of(icons, request)
    warn_of_site(file, icons, rig)
    with progress_bar("worst case") as progress:
        played = [icons[name] for name in plan.names]
        session = play_session(played, plan, rig, tracking=request.tracking, progress=progress)
    if request.json is not None:
        with complete_or_absent(request.json) as draft:
            draft.write_text(session_text(session, icons, rig), encoding="utf-8")
    if request.order_out is not None:
        with complete_or_absent(request.order_out) as draft:
            draft.write_text(order_text(plan), encoding="utf-8")
    if request.figure is not None:
        from ..figures.print_figure import write_figure
        from ..figures.session_figure import session_figure

        write_figure(session_figure(session), request.figure, request.look)
    for written in (request.json, request.order_out, request.figure):
        if written is not None:
            note(f"wrote {written}")
    show_session(session)


def plan_of(icons: IconSet, request: Request) -> SessionPlan:
    """The requested plan; SessionError for an impossible one, before anything is simulated."""
    from thermicon.circuit import SessionPlan
    from thermicon.circuit.safety.sessionplan import check_repeats, read_order

    if request.order is not None:
        return SessionPlan.repeated(read_order(request.order, icons), request.repeats, gap_s=request.gap_s)
    check_repeats(request.repeats, len(icons), "icons")
    names = [icon.name for icon in icons]
    return SessionPlan.shuffled(names, request.repeats, seed=request.seed, gap_s=request.gap_s)


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


def show_session(session: Session) -> None:
    """Print the verdict, a summary of the session, and one row per play."""
    from thermicon.icons.number_text import number, span

    from ..report.tables import show, table

    rows = table(
        *("play", "icon", "start", "skin", "display", "baseline", "safety"),
        numbers=("play", "start", "baseline"),
        names=("icon",),
    )
    for place, play in enumerate(session.plays[:MOST_SHOWN], 1):
        rows.add_row(
            str(place),
            play.icon,
            f"{number(play.start_s, 2)} s",
            span(play.skin_min_C, play.skin_max_C, "°C"),
            span(play.display_min_C, play.display_max_C, "°C"),
            f"{number(play.drift_K, 2)} K",
            play.verdict,
        )
    more = len(session.plays) - MOST_SHOWN
    left = [f"and {more} more plays; --json lists all"] if more > 0 else []
    show(*summary_lines(session), "", rows, *left)
    note(CAUTION)


def summary_lines(session: Session) -> list[str]:
    """The summary of a session, line by line."""
    from thermicon.icons.number_text import number, span

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
