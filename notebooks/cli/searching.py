"""``thermicon search``: improve a set within its families, as a cue file and a table of before and after."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..figures.figure_look import (
    FigureFolder,
    FigureFormat,
    FigureStyle,
    FigureWidth,
    NoTitle,
    figure_look,
)
from ..files.outputs import STDOUT, check_output, check_separate, complete_or_absent
from ..messages import (
    DEFAULT_RIG,
    check_bounds,
    check_changes,
    check_draws,
    check_parameters,
    load_observer,
    load_rig,
    note,
    progress_bar,
    usage,
)
from ..report.choices import OBJECTIVES, GoalText, MostEnergy, MostTime, Must, check_totals
from ..report.options import (
    Changes,
    Draws,
    NormName,
    ObserverFile,
    OneFile,
    ReportPage,
    RigName,
    Tracking,
    check_norm_option,
    check_tracking,
)
from .ranking import check_figures, check_report
from .search_result import FoundSet, Ranked

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.perception import Goal

USUAL_EVALUATIONS, USUAL_PEOPLE = 2000, 200


def search_command(
    file: OneFile,
    choose: Annotated[
        int | None,
        typer.Option(
            "--choose", metavar="K", help="Number of icons to choose, from any family.  [default: one of each]"
        ),
    ] = None,
    objective: Annotated[
        str | None,
        typer.Option(
            "--objective",
            metavar="NAME",
            help="What to improve: worst (pair), correct, bits or bits-per-s.  [default: that of the goal, or worst]",
        ),
    ] = None,
    evaluations: Annotated[
        int,
        typer.Option(
            "--evaluations", metavar="N", help="Number of icons to try; more take longer and may find a better set."
        ),
    ] = USUAL_EVALUATIONS,
    people: Annotated[
        int, typer.Option("--people", metavar="N", help="Number of virtual people for the final scores.")
    ] = USUAL_PEOPLE,
    seed: Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the search and of the virtual people.")] = 0,
    tracking: Tracking = None,
    norm: NormName = "episodes",
    observer: ObserverFile = None,
    goal: GoalText = None,
    must: Must = None,
    most_time: MostTime = None,
    most_energy: MostEnergy = None,
    parameters: Draws = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT.cue",
            readable=False,
            help="Write the improved set to a cue file, or - for stdout.",
        ),
    ] = None,
    figure: FigureFolder = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    figure_format: FigureFormat = None,
    report: ReportPage = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Improve a set of icons over the continuous parameters of its families; all other icons stay as they are.

    With --goal, totals, the number of icons and what single icons must do are kept; where the goal is not met, changes
    of the rig are tried. The result is the best set for the model, with which it was searched: test it with people.
    """
    check_changes(changes or [])
    check_bounds(
        ("--choose", choose if choose is not None else 2, 2, 64),
        ("--evaluations", evaluations, 10, 1_000_000),
        ("--people", people, 1, 100_000),
        ("--seed", seed, 0, 2**32 - 1),
    )
    check_parameters(parameters)
    check_totals(most_time, most_energy)
    if objective is not None and objective not in OBJECTIVES:
        raise usage(f"{objective!r} is not one of {', '.join(OBJECTIVES)}", "--objective")
    check_tracking(tracking)
    check_norm_option(norm)
    if output is not None:
        check_output(output, (".cue",), "a set of icons")
    check_report(report)
    look = figure_look(figure, width, style, no_title, figure_format)
    check_figures(figure)
    check_separate([file], [output, report])
    from thermicon.perception import Goal, search
    from thermicon.perception.identification.laboratory import DRAWS

    from .cues import read_set, warn_of_frames

    wanted = None if goal is None else Goal.parse(goal)
    objective = objective or _objective(wanted)
    icons, where = read_set([file]), load_rig(rig, changes or [])
    model = load_observer(observer, where)
    drawn = check_draws(model, parameters, "--parameters", DRAWS)
    warn_of_frames([file], icons, where)
    with progress_bar("searching") as progress:
        found = search(
            icons,
            where,
            count=choose,
            objective=objective,  # type: ignore[arg-type]
            evaluations=evaluations,
            people=people,
            seed=seed,
            tracking=tracking,
            norm=norm,
            must=must,
            most_s=most_time,
            most_J=most_energy,
            goal=wanted,
            parameters=drawn,
            observer=model,
            progress=progress,
        )
    if output == STDOUT:
        typer.echo(str(found.found), nl=False)
        return
    if output is not None:
        with complete_or_absent(output) as draft:
            draft.write_text(str(found.found), encoding="utf-8")
        note(f"wrote {output}")
    how = Ranked(people, seed, tracking, norm, drawn, None if must is None else tuple(must), most_time, most_energy)
    made = FoundSet.ranked(found, icons, where, model, how, wanted)
    if report is not None or figure is not None:
        options = {
            "choose": choose,
            "objective": objective,
            "evaluations": None if evaluations == USUAL_EVALUATIONS else evaluations,
            "people": None if people == USUAL_PEOPLE else people,
            "seed": seed or None,
            "tracking": tracking,
            "norm": None if norm == "episodes" else norm,
            "observer": None if observer is None else observer.name,
            "goal": goal,
            "must": must,
            "most-time": most_time,
            "most-energy": most_energy,
            "parameters": parameters,
        }
        made.write(where, report, figure, command_text(file, where, rig, options), look)
    made.show(icons.title, where.name, evaluations)


def _objective(goal: Goal | None) -> str:
    """What a goal wants most of: the worst pair, unless it is about the proportion correct or bits."""
    wanted = [name for name in ("correct", "bits") if goal is not None and goal.of(name) is not None]
    return wanted[0] if wanted else "worst"


def command_text(file: str, rig: Rig, asked: str | None, options: Mapping[str, object]) -> str:
    """The command that reproduces a search, without its outputs; files are named without their folders.

    ``asked`` is the rig as it was asked for, a name or a file; ``options`` that are None are left out.

    >>> from thermicon.circuit import Rig
    >>> command_text("/home/a/two icons.cue", Rig.load("thenar"), None, {"seed": 4, "goal": None, "must": ["a", "b"]})
    "thermicon search 'two icons.cue' --seed 4 --must a --must b"
    """
    words = ["thermicon", "search", Path(file).name]
    name = rig.name if asked is None else Path(asked).name
    words += [] if name == DEFAULT_RIG else ["--rig", name]
    words += [word for change in rig.changes for word in ("--set", change)]
    for option, value in options.items():
        values = [] if value is None else value if isinstance(value, list) else [value]
        words += [word for each in values for word in (f"--{option}", str(each))]
    return shlex.join(words)
