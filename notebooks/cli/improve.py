"""``thermicon improve``: better icons by edits or by search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.perception.selection.request import Objective

from ..files.outputs import FIGURE_SUFFIXES, STDOUT, TRACE_SUFFIXES, check_output, check_separate
from ..messages import fail, usage
from ..report.set_report import objective_of
from ..report.terminal import show
from .improving import Request
from .options import (
    CrowdOptions,
    FigureOptions,
    FileNames,
    Goals,
    RigOptions,
    commands,
    flag,
    goal_of,
    opt,
    out,
    read_set,
)

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

USUAL_EVALUATIONS, MOST_CHOSEN = 2000, 64


def improve_command(
    files: FileNames,
    crowd: CrowdOptions,
    rig: RigOptions,
    figure: FigureOptions,
    choose: Annotated[int | None, opt("N", "Choose the best N icons.", 2, MOST_CHOSEN)] = None,
    up_to: Annotated[int | None, opt("N", "Choose the best 2, 3, … N icons, as a table.", 2, MOST_CHOSEN)] = None,
    goal: Goals = None,
    edits: Annotated[
        bool,
        flag("--edits", "Find the cheapest edit of every pair that is not distinguishable; -o writes the edited set."),
    ] = False,
    evaluations: Annotated[
        int | None,
        opt(
            "N",
            "Search the families of FILE: number of icons to try; more take longer and may find a better set.  "
            "[default: 2000]",
            10,
            1_000_000,
        ),
    ] = None,
    objective: Annotated[
        Objective | None,
        typer.Option(
            help="What a choice or a search improves beside its goal.  [default: that of the goal, or worst (pair)]"
        ),
    ] = None,
    must: Annotated[list[str] | None, opt("ICON", "An icon that must be chosen; may be given several times.")] = None,
    output: Annotated[
        list[Path] | None,
        out(
            "OUT",
            "Write what was found: a set to .cue (of --up-to the largest that meets the goal), the table of --up-to to "
            ".csv or .parquet and its figure to .pdf, .svg or .png, a choice with its ranking to .json; - prints it.",
            "-o",
            "--output",
        ),
    ] = None,
) -> None:
    """Improve a set of icons: edit pairs, choose the best icons, or search the families of a set.

    Families are searched over their continuous parameters, unless --choose, --up-to or --edits without --evaluations
    asks for icons as they are; all other icons stay. Totals, numbers and single icons that a goal asks for are kept.
    What is found is the best for the model: test it with people.
    """
    from thermicon.icons import Family

    wanted = goal_of(goal)
    icons = read_set(files)
    icons.check_one_element()
    has_families = any(isinstance(entry, Family) for entry in icons.entries)
    as_they_are = choose is not None or up_to is not None or edits
    searched = evaluations is not None or (has_families and not as_they_are)
    if up_to is not None and (choose is not None or edits or searched):
        raise usage("is a question of its own: leave out --choose, --edits and --evaluations", "--up-to")
    if edits and searched:
        raise usage("edits icons as they are, which a search does not leave: leave out --evaluations", "--edits")
    if must and (choose is None or searched):
        raise usage(
            "needs --choose K, which chooses the best K icons; a search keeps all that are no families", "--must"
        )
    if objective is not None and not (choose or up_to or searched):
        raise usage("needs --choose K, --up-to K or a search of families", "--objective")
    table = (*TRACE_SUFFIXES, *FIGURE_SUFFIXES, ".cue")
    kinds = (".cue",) if searched else table if up_to is not None else (".cue", ".json")
    outputs = output or []
    for path in outputs:
        check_output(path, kinds, "what this finds")
    check_separate(files, [*outputs, figure.figure])
    if searched and len(files) > 1:
        raise usage("one file is searched; join its families into one set", "FILE")
    where = rig.load(icons, files[0])
    model = crowd.load(where)
    how = {**crowd.asked, "goal": wanted, "parameters": crowd.draws(model), "observer": model}
    if has_families and not searched:
        icons, must = _by_written_names(icons, must or [], where)
    sought: Objective = objective or ("felt-and-named" if up_to is not None else objective_of(wanted))
    request = Request(icons, where, how, sought, outputs, figure, commands(files, rig, crowd))
    if up_to is not None:
        told, refused = request.choices(up_to)
    elif searched:
        told, refused = request.search(choose, USUAL_EVALUATIONS if evaluations is None else evaluations), ""
    else:
        told, refused = request.best(choose, must, edits)
    if STDOUT not in outputs:
        show(told)
    if refused:
        fail(refused)


def _by_written_names(icons: IconSet, must: Sequence[str], rig: Rig) -> tuple[IconSet, list[str]]:
    """The icons as they would be written, so that the screen calls them as the file does, and those that must stay."""
    from thermicon.perception.selection.candidates import members_of, set_of_run

    found = members_of(icons)
    pool = set_of_run(icons, found, rig, "members")
    names = {each.icon.name: icon.name for each, icon in zip(found, pool, strict=True)}
    return replace(pool, name=icons.name, title=icons.title), [names.get(name, name) for name in must]
