"""``thermicon frontier``: how many icons of a pool are distinguishable, at which per cent correct and total time."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.icons.number_text import count_of, number, percent

from ..figures.figure_look import FigureFile, FigureStyle, FigureWidth, NoTitle, figure_look
from ..files.outputs import FIGURE_SUFFIXES, TRACE_SUFFIXES, check_output, check_separate
from ..messages import (
    check_bounds,
    check_changes,
    check_draws,
    check_parameters,
    load_observer,
    load_rig,
    progress_bar,
    usage,
)
from ..report.choices import OBJECTIVES, GoalText, MostTime, check_totals, goal_lines
from ..report.options import (
    Changes,
    Draws,
    Files,
    NormName,
    ObserverFile,
    RigName,
    Tracking,
    check_norm_option,
    check_tracking,
)
from ..report.tables import show, table

if TYPE_CHECKING:
    from thermicon.perception.selection.frontier import Frontier
    from thermicon.perception.selection.frontier_point import FrontierPoint


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
    goal: GoalText = None,
    parameters: Draws = None,
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
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Choose the best 2, 3, … icons of a file, and report per cent correct, bits and total time of each choice.

    What 95 % of people reach is about people and the uncertainty of the model together, as in a goal. With --goal,
    icons are left out that miss its safety, or for the nominal person its detected or onset; totals are kept; and every
    choice is judged by it.
    """
    check_changes(changes or [])
    check_tracking(tracking)
    check_totals(most_time, None)
    look = figure_look(figure, width, style, no_title)
    check_bounds(("--most", most, 2, 64), ("--people", people, 1, 100_000), ("--seed", seed, 0, 2**32 - 1))
    check_parameters(parameters)
    if objective not in OBJECTIVES:
        raise usage(f"{objective!r} is not one of {', '.join(OBJECTIVES)}", "--objective")
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a table")
    if figure is not None:
        check_output(figure, FIGURE_SUFFIXES, "a figure")
    check_separate(files, [output, figure])
    from thermicon.perception import Goal, frontier
    from thermicon.perception.identification.laboratory import DRAWS

    from .cues import read_set, warn_of_frames
    from .sweep import write_study

    check_norm_option(norm)
    wanted = None if goal is None else Goal.parse(goal)
    icons, where = read_set(files), load_rig(rig, changes or [])
    model = load_observer(observer, where)
    drawn = check_draws(model, parameters, "--parameters", DRAWS)
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
            goal=wanted,
            parameters=drawn,
            observer=model,
            progress=progress,
        )
    if not write_study(found, output, figure, look):
        show_frontier(found, icons.title)


def show_frontier(found: Frontier, title: str) -> None:
    """Print one row for each number of icons, the names of the largest choices, and what was left out."""
    heads = ("icons", "correct", "95 % of people", "d′", "bits", "time", "energy", *(["goal"] * bool(found.goal)))
    made = table(*heads, numbers=heads[:7])
    for point in found.points:
        made.add_row(
            str(len(point.icons)) + ("" if point.optimal else " *"),
            percent(point.proportion_correct),
            f"from {percent(point.reached)}",
            number(point.d_prime),
            f"{point.information_bits:.2f}",
            f"{number(point.total_s)} s",
            "–" if point.total_J != point.total_J else f"{number(point.total_J)} J",
            *([] if point.goal is None else ["✓" if point.goal.met else "✗"]),
        )
    last = found.points[-1] if found.points else None
    starred = any(not point.optimal for point in found.points)
    crowd = count_of(found.people, "virtual person", "virtual people")
    what_if = f" with {', '.join(found.rig_changes)}" if found.rig_changes else ""
    show(
        *([title, ""] if title else []),
        made,
        "",
        *([] if last is None else [f"The {len(last.icons)}: {_named(last)}"]),
        *(["* not proven to be the best of their number"] if starred else []),
        *_amber(found),
        *_goal(found),
        *(f"Left out: {name} {reason}" for name, reason in found.excluded[:3]),
        *([f"and {len(found.excluded) - 3} more left out"] if len(found.excluded) > 3 else []),
        "",
        f"The best by {found.objective} of {found.pool} icons that can be {'chosen' if found.goal else 'played'}, for "
        f"{crowd} on the {found.rig} rig{what_if} (seed {found.seed}). {_reached(found)} These are predictions of a "
        "model, not measurements.",
    )


def _named(point: FrontierPoint) -> str:
    return ", ".join(f"{name} (amber)" if name in point.amber else name for name in point.icons)


def _amber(found: Frontier) -> Iterator[str]:
    """From how many icons on a choice has one that passes a soft limit; nothing where none has."""
    sizes = [str(len(point.icons)) for point in found.points if point.amber]
    if sizes:
        yield f"With icons that pass a soft limit of safety (amber): the choices of {', '.join(sizes)}"


def _goal(found: Frontier) -> Iterator[str]:
    """The largest choice that meets the goal with its parts, or the smallest with what is in its way."""
    judged = [(len(point.icons), point.goal) for point in found.points if point.goal is not None]
    if not judged:
        return
    met = [each for each in judged if each[1].met]
    if met:
        count, result = met[-1]
        more = "the largest choice here" if count == judged[-1][0] else "by no larger choice of these"
        yield from goal_lines(result.to_dict(), f"met by the best {count}, {more}")
    else:
        count, result = judged[0]
        yield from goal_lines(result.to_dict(), f"met by none of these choices; the best {count}:")


def _reached(found: Frontier) -> str:
    if found.draws:
        return (
            "What 95 % of people reach is about people and the uncertainty of the model together "
            f"({found.draws} draws), as in a goal."
        )
    return "What 95 % of people reach is about people alone, at the nominal constants: milder than in a goal."
