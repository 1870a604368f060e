"""``thermicon frontier``: how many icons of a pool are distinguishable, at which per cent correct and total time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.icons.number_text import number, percent

from ..figures.figure_look import FigureData, FigureFile, FigureStyle, FigureWidth, NoTitle, figure_look
from ..files.outputs import FIGURE_SUFFIXES, TRACE_SUFFIXES, check_output, check_separate
from ..text.choices import OBJECTIVES, MostTime, check_totals
from ..text.messages import check_changes, load_observer, load_rig, progress_bar, usage
from ..text.options import Changes, Files, NormName, ObserverFile, RigName, Tracking, check_norm_option, check_tracking
from ..text.tables import show, table

if TYPE_CHECKING:
    from thermicon.perception import Frontier


def frontier_command(
    files: Files,
    most: Annotated[int, typer.Option("--most", metavar="K", help="Largest number of icons to choose.")] = 12,
    objective: Annotated[
        str,
        typer.Option("--objective", metavar="NAME", help="What a choice maximises: worst, correct, bits, bits-per-s."),
    ] = "correct",
    people: Annotated[int, typer.Option("--people", metavar="N", help="Number of virtual people.")] = 200,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the virtual people.")] = 0,
    tracking: Tracking = None,
    norm: NormName = "episodes",
    most_time: MostTime = None,
    observer: ObserverFile = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="OUT.csv", readable=False, help="Write the table to .csv or .parquet, or -."
        ),
    ] = None,
    figure: FigureFile = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    figure_data: FigureData = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Choose the best 2, 3, … icons of a file, and report per cent correct, bits and total time of each choice."""
    check_changes(changes or [])
    check_tracking(tracking)
    check_totals(most_time, None)
    look = figure_look(figure, width, style, no_title, figure_data)
    for option, value, least, highest in (
        ("--most", most, 2, 64),
        ("--people", people, 1, 100_000),
        ("--seed", seed, 0, 2**32 - 1),
    ):
        if not least <= value <= highest:
            raise usage(f"{value} is outside {least} to {highest}", option)
    if objective not in OBJECTIVES:
        raise usage(f"{objective!r} is not one of {', '.join(OBJECTIVES)}", "--objective")
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a table")
    if figure is not None:
        check_output(figure, FIGURE_SUFFIXES, "a figure")
    check_separate(files, [output, figure])
    from thermicon.perception import frontier

    from ..files.cues import read_set, warn_of_frames
    from .sweep import write_study

    check_norm_option(norm)
    icons, where = read_set(files), load_rig(rig, changes or [])
    model = load_observer(observer, where)
    warn_of_frames(files, icons, where)
    with progress_bar("choosing") as progress:
        found = frontier(
            icons,
            where,
            most=most,
            objective=objective,  # type: ignore[arg-type]
            people=people,
            seed=seed,
            tracking=tracking,
            norm=norm,
            most_s=most_time,
            observer=model,
            progress=progress,
        )
    if not write_study(found, output, figure, look):
        show_frontier(found, icons.title)


def show_frontier(found: Frontier, title: str) -> None:
    """Print one row for each number of icons, the names of the largest choices, and what was left out."""
    heads = ("icons", "correct", "95 % of people", "d′", "bits", "time", "energy")
    made = table(*heads, numbers=heads)
    for point in found.points:
        made.add_row(
            str(len(point.icons)) + ("" if point.optimal else " *"),
            percent(point.proportion_correct),
            f"from {percent(point.low)}",
            number(point.d_prime),
            f"{point.information_bits:.2f}",
            f"{number(point.total_s)} s",
            "–" if point.total_J != point.total_J else f"{number(point.total_J)} J",
        )
    last = found.points[-1] if found.points else None
    starred = any(not point.optimal for point in found.points)
    crowd = "1 virtual person" if found.people == 1 else f"{found.people} virtual people"
    what_if = f" with {', '.join(found.rig_changes)}" if found.rig_changes else ""
    show(
        *([title, ""] if title else []),
        made,
        "",
        *([] if last is None else [f"The {len(last.icons)}: {', '.join(last.icons)}"]),
        *(["* not proven to be the best of their number"] if starred else []),
        *(f"Left out: {name} {reason}" for name, reason in found.excluded[:3]),
        *([f"and {len(found.excluded) - 3} more left out"] if len(found.excluded) > 3 else []),
        "",
        f"The best by {found.objective} of {found.pool} icons that can be played, for {crowd} on the {found.rig} "
        f"rig{what_if} (seed {found.seed}). These are predictions of a model, not measurements.",
    )
