"""``thermicon observed`` and ``thermicon plan``: what participants answered and what it changes, and what to measure.

``main`` registers them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..figures.figure_look import FigureFile, FigureStyle, FigureWidth, Look, NoTitle, figure_look
from ..files.outputs import FIGURE_SUFFIXES, STDOUT, check_free, check_output, check_separate, complete_or_absent
from ..messages import check_bounds, check_changes, load_observer, load_rig, note, progress_bar, usage
from ..report.options import (
    Changes,
    DrawsFile,
    NormName,
    OneFile,
    RigName,
    Tracking,
    check_norm_option,
    check_tracking,
)

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception.pilot.measurements import Measurements
    from thermicon.perception.pilot.observed import Observed
    from thermicon.perception.pilot.trials import Trials

    from .ranking import Request

LEAST_DRAWS, MOST_DRAWS = 20, 20_000
"""The least as in `thermicon.perception.pilot.observed`, repeated here to avoid its imports."""

MOST_LENGTH, MOST_SIZES = 1000, 12
KEEP_IT = "With --keep lab.toml, rank, search and the workbench can predict for this laboratory."

JsonOut = Annotated[
    Path | None, typer.Option("--json", metavar="OUT", readable=False, help="Write every number as JSON.")
]
Draws = Annotated[int, typer.Option("--draws", metavar="N", help="Draws of the posterior, each with a laboratory.")]
Seed = Annotated[int, typer.Option("--seed", metavar="S", help="Seed of the laboratories and their people.")]


def observed_command(
    trials: Annotated[
        Path,
        typer.Argument(
            metavar="TRIALS.csv",
            readable=False,
            help="Answers: columns participant, trial, presented, responded and, if recorded, time_s. Or measurements: "
            "participant, kind (threshold, reaction_time, rating), method, channel, size_K, value, unit, "
            "standard_error, trials.",
        ),
    ],
    file: OneFile,
    other: Annotated[
        list[str] | None,
        typer.Option("--for", metavar="FILE", help="Also predict this set for the laboratory; may be repeated."),
    ] = None,
    keep: Annotated[
        Path | None,
        typer.Option(
            "--keep",
            metavar="LAB.toml",
            readable=False,
            help="Write the conditioned observer, and its draws, half as many as --draws, beside it as LAB.csv.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="With --keep: replace the files that are there.")] = False,
    draws: Draws = 1000,
    seed: Seed = 0,
    norm: NormName = "episodes",
    tracking: Tracking = None,
    observer: DrawsFile = None,
    json: JsonOut = None,
    figure: FigureFile = None,
    width: FigureWidth = None,
    style: FigureStyle = "screen",
    no_title: NoTitle = False,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Compare answers or measurements of your participants with the prediction, and sharpen the prediction by them.

    FILE is the set that was presented; its icons are all the answers there were. With a table of thresholds, reaction
    times and ratings, FILE is any set to predict. A laboratory is one draw of the posterior with people of its own:
    those that make the answers likely count more.
    """
    check_changes(changes or [])
    check_numbers(draws, seed, norm)
    check_tracking(tracking)
    look = figure_look(figure, width, style, no_title)
    if json is not None:
        check_output(json, (), "JSON")
    if figure is not None:
        check_output(figure, FIGURE_SUFFIXES, "a figure")
    drawn = None if keep is None else keep.with_suffix(".csv")
    if keep is not None and drawn is not None:
        check_output(keep, (".toml",), "an observer")
        if keep == STDOUT:
            raise usage("- is not a file; give a name such as lab.toml", "--keep")
        check_output(drawn, (".csv",), "a table of draws")
    elif force:
        raise usage("belongs to --keep, whose files it replaces", "--force")
    check_separate([trials, file, *(other or []), *([observer] if observer else [])], [json, figure, keep, drawn])
    if keep is not None and drawn is not None:
        check_free([keep, drawn], replace=force)
    from thermicon.perception.pilot.measurements_file import is_measurements, read_measurements
    from thermicon.perception.pilot.observed import observed
    from thermicon.perception.pilot.trials_file import read_trials

    from ..report.observed_text import show_observed
    from .cues import read_set, warn_of_frames

    icons, where = read_set([file]), load_rig(rig, changes or [])
    model = load_observer(observer, where, "laboratories are drawn from draws of a posterior")
    data: Trials | Measurements
    if is_measurements(trials):
        data = read_measurements(trials, where)
    else:
        data = read_trials(trials, [icon.name for icon in icons])
        for warning in data.warnings:
            note(f"warning: {warning}")
    others = [read_set([name]) for name in other or []]
    warn_of_frames([file], icons, where)
    with progress_bar("simulating laboratories") as progress:
        found = observed(
            data,
            icons,
            where,
            others=others,
            draws=draws,
            seed=seed,
            norm=norm,
            tracking=tracking,
            observer=model,
            progress=progress,
        )
    _write(found, json, figure, keep, look)
    if json == STDOUT:
        typer.echo(found.to_json())
        return
    files, last = [file, *(other or [])], [KEEP_IT]
    if drawn is not None:
        from .ranking import Request

        last = _rank_lines(file, icons, where, Request(tracking=tracking, norm=norm, observer=drawn, rig=rig))
    show_observed(found, files, last)


def _rank_lines(file: str, icons: IconSet, rig: Rig, request: Request) -> list[str]:
    """The command that ranks the set with the laboratory that was kept, and the per cent correct that it shows."""
    from thermicon.perception import rank

    from ..report.observed_text import rank_lines
    from .ranking import command_text

    with progress_bar("ranking") as progress:
        ranking = rank(
            icons,
            rig,
            people=request.people,
            seed=request.seed,
            tracking=request.tracking,
            norm=request.norm,
            parameters=0,
            observer=request.observer,
            progress=progress,
        )
    return rank_lines(command_text([file], rig, request, paths=True), ranking.proportion_correct, ranking.people)


def check_numbers(draws: int, seed: int, norm: str) -> None:
    """Fail with a usage error for draws or a seed out of range, and for a norm that there is not."""
    check_bounds(("--draws", draws, LEAST_DRAWS, MOST_DRAWS), ("--seed", seed, 0, 2**32 - 1))
    check_norm_option(norm)


def _write(found: Observed[Any, Any], json: Path | None, figure: Path | None, keep: Path | None, look: Look) -> None:
    """Write the outputs that were asked for, each complete or absent."""
    if json is not None and json != STDOUT:
        with complete_or_absent(json) as draft:
            draft.write_text(found.to_json() + "\n", encoding="utf-8")
        note(f"wrote {json}")
    if figure is not None:
        from ..figures.observed_figure import observed_figure
        from ..figures.print_figure import write_figure

        write_figure(observed_figure(found, stacked=look.narrow), figure, look)
        note(f"wrote {figure}")
    if keep is not None:
        drawn = keep.with_suffix(".csv")
        observer, draws = found.files()
        with complete_or_absent(drawn) as table, complete_or_absent(keep) as draft:
            table.write_text(draws, encoding="utf-8")
            draft.write_text(observer, encoding="utf-8")
        note(f"wrote {keep} and {drawn}")


def plan_command(
    file: OneFile,
    other: Annotated[
        str | None, typer.Argument(metavar="FILE2", help="A second set, to be distinguished from the first.")
    ] = None,
    participants: Annotated[
        str, typer.Option("--participants", metavar="N,N,…", help="Numbers of participants to try, 2 to 500.")
    ] = "4,8,12,16,24,32,48",
    trials: Annotated[
        str, typer.Option("--trials", metavar="N,N,…", help="Trials of a participant with each set, to try.")
    ] = "12,24,48,96",
    width: Annotated[
        float | None,
        typer.Option("--width", metavar="POINTS", help="One set: wanted width of the 95 % interval.  [default: 10]"),
    ] = None,
    power: Annotated[
        float | None,
        typer.Option(
            "--power", metavar="PERCENT", help="Two sets: wanted share of experiments that do.  [default: 80]"
        ),
    ] = None,
    pilot: Annotated[
        int, typer.Option("--pilot", metavar="N", help="Number of presentations of a pilot with one participant.")
    ] = 20,
    draws: Annotated[
        int, typer.Option("--draws", metavar="N", help="Draws of the posterior, each with a laboratory.")
    ] = 300,
    seed: Seed = 0,
    norm: NormName = "episodes",
    tracking: Tracking = None,
    observer: DrawsFile = None,
    json: JsonOut = None,
    rig: RigName = None,
    changes: Changes = None,
) -> None:
    """Plan an identification experiment: participants and trials that it needs, and the icons to pilot.

    With one set, the size that gives the wanted interval of its per cent correct; with two, the size that
    distinguishes them. Whole experiments are simulated in laboratories that the evidence allows.
    """
    check_changes(changes or [])
    check_numbers(draws, seed, norm)
    check_tracking(tracking)
    people, times = _numbers(participants, "--participants", 2, 500), _numbers(trials, "--trials", 1, 5000)
    check_bounds(("--pilot", pilot, 1, MOST_LENGTH))
    if width is not None and other is not None:
        raise usage("belongs to one set; with two, give --power", "--width")
    if power is not None and other is None:
        raise usage("belongs to two sets; with one, give --width", "--power")
    for option, value in (("--width", width), ("--power", power)):
        if value is not None and not 0.0 < value < 100.0:
            raise usage(f"{value:g} is outside 0 to 100", option)
    if json is not None:
        check_output(json, (), "JSON")
    files = [file] if other is None else [file, other]
    check_separate(files, [json])
    from thermicon.perception.pilot.plan import plan

    from ..report.plan_text import show_plan
    from .cues import read_set, warn_of_frames

    sets, where = [read_set([name]) for name in files], load_rig(rig, changes or [])
    model = load_observer(observer, where, "laboratories are drawn from draws of a posterior")
    for name, each in zip(files, sets, strict=True):
        warn_of_frames([name], each, where)
    wish = width if other is None else power
    with progress_bar("simulating experiments") as progress:
        found = plan(
            sets[0],
            where,
            None if other is None else sets[1],
            participants=people,
            trials=times,
            wanted=None if wish is None else wish / 100.0,
            length=pilot,
            draws=draws,
            seed=seed,
            norm=norm,
            tracking=tracking,
            observer=model,
            progress=progress,
        )
    if json is not None and json != STDOUT:
        with complete_or_absent(json) as draft:
            draft.write_text(found.to_json() + "\n", encoding="utf-8")
        note(f"wrote {json}")
    if json == STDOUT:
        typer.echo(found.to_json())
        return
    show_plan(found, [Path(name).name for name in files])


def _numbers(text: str, option: str, least: int, most: int) -> tuple[int, ...]:
    """Whole numbers between commas, each once and in rising order."""
    try:
        found = sorted({int(part) for part in text.split(",")})
    except ValueError:
        raise usage(f"{text!r} is not a list of whole numbers such as 8,16,32", option) from None
    check_bounds(*((option, value, least, most) for value in found))
    if len(found) > MOST_SIZES:
        raise usage(f"{len(found)} numbers; at most {MOST_SIZES} are tried at once", option)
    return tuple(found)
