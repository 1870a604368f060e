"""``thermicon rank``: predicted detection, confusions and information of one set, as table, JSON and figures."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from ..figures.figure_look import SCREEN, Look
from ..files.outputs import FIGURE_SUFFIXES, STDOUT, check_folder, check_output, check_separate, complete_or_absent
from ..messages import check_draws, load_observer, note, progress_bar, usage
from ..report.options import check_norm_option
from ..report.rank_text import show_ranking
from .cues import MOST_ICONS, read_set, warn_of_frames

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Ranking
    from thermicon.perception.selection.request import Selection

PLAIN_OPTIONS = (
    "people",
    "seed",
    "tracking",
    "norm",
    "trials",
    "by",
    "parameters",
    "context",
    "gap",
    "bias",
    "observer",
    "goal",
)
OTHER_PICTURES = (".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".eps")


@dataclass(frozen=True, slots=True)
class Request:
    """Options of ``rank``: people, seed, tracking (None: by the icons' control), norm, trials, and what to score by.

    ``parameters`` is the number of draws of the posterior for the intervals of a new laboratory (None: 128, or
    as many as there are); 0 draws none.
    ``choosing`` selects the best few icons, ``edits`` finds the cheapest edit of the ``worst`` pair or of ``all``
    indistinguishable pairs.
    ``rig`` is the rig as it was asked for, a name or a file; ``observer`` a file in place of the shipped observer.
    ``context``, ``gap`` (s) and ``bias`` describe the task, as in ``thermicon.perception.Task``. ``workers`` is the
    number of cores, ``cluster`` the address of a scheduler to use instead, ``keep`` a folder for finished parts.
    """

    people: int = 200
    seed: int = 0
    tracking: str | None = None
    norm: str = "episodes"
    trials: int = 48
    by: str = "model"
    parameters: int | None = None
    choosing: Selection | None = None
    goal: str | None = None
    edits: str = "worst"
    context: float = 0.0
    gap: float | None = None
    bias: float = 0.0
    observer: Path | None = None
    rig: str | None = None
    workers: int | None = None
    cluster: str | None = None
    keep: Path | None = None


def rank_files(
    files: Sequence[str],
    rig: Rig,
    request: Request,
    json_out: Path | None,
    figures: Path | None,
    report_out: Path | None = None,
    look: Look = SCREEN,
) -> None:
    """Rank the joined icons of some files on the rig: the table on stdout, other outputs on request."""
    from thermicon.perception import Goal, Task, choose, rank
    from thermicon.perception.identification.laboratory import DRAWS
    from thermicon.perception.kernels.parallel import beside
    from thermicon.perception.progress import step_counter
    from thermicon.perception.ranking.rank import with_intervals
    from thermicon.perception.selection.goal_result import judge_goal
    from thermicon.perception.selection.pair_edits import cheapest_edits
    from thermicon.perception.selection.request import check_selection

    from ..report.set_report import SetReport

    check_norm_option(request.norm)
    if json_out is not None:
        check_output(json_out, (), "JSON")
    check_report(report_out)
    check_separate(files, [json_out, report_out, *_picture(figures)])
    check_figures(figures)
    icons = read_set(files)
    if len(icons) > MOST_ICONS:
        what = (
            f"there are {len(icons):,} icons, and every pair is compared: at most {MOST_ICONS:,} can be ranked at once"
        )
        raise usage(f"{what}; narrow a family, or put its best members into a separate set", "FILE")
    warnings = [*rig.warnings, *warn_of_frames(files, icons, rig)]
    wanted = None if request.goal is None else Goal.parse(request.goal)
    model = load_observer(request.observer, rig)
    draws = check_draws(model, request.parameters, "--parameters", DRAWS)
    asked = request.choosing
    if asked is not None:
        check_selection(asked, [icon.name for icon in icons])
    if wanted is not None:
        wanted.check_count(None if asked is None else asked.count)
        wanted.check_draws(draws * (request.by == "model"))
    if request.keep is not None:
        check_folder(request.keep)
    _say_if_first()
    with progress_bar("ranking") as progress:
        ranking = rank(
            icons,
            rig,
            people=request.people,
            seed=request.seed,
            trials=request.trials,
            tracking=request.tracking,
            norm=request.norm,
            by=request.by,
            parameters=0,
            task=Task(request.context, request.gap, request.bias),
            observer=model,
            workers=request.cluster or request.workers,
            keep=request.keep,
            progress=progress,
        )
    # One edit takes as long as the draws, mostly on one core; more of them wait for the draws.
    which, without = request.edits if request.by == "model" else "none", ranking
    edited = beside(lambda: cheapest_edits(without, which), request.workers if which == "worst" else 1)
    choice = None
    with progress_bar("intervals" if asked is None else "choosing") as progress:
        if asked is not None:
            choice = choose(ranking, asked, parameters=draws, progress=progress)
        elif draws and request.by == "model":
            ranking = with_intervals(ranking, draws, step_counter(progress, draws))
    reached = None if wanted is None else judge_goal(wanted, ranking, choice)
    found = SetReport(ranking, choice, reached, edited(), tuple(warnings))
    if json_out is not None and json_out != STDOUT:
        with complete_or_absent(json_out) as draft:
            draft.write_text(found.to_json() + "\n", encoding="utf-8")
        note(f"wrote {json_out}")
    if figures is not None:
        from ..figures.set_figures import write_figures

        write_figures(ranking, icons, rig, figures, look)
    near = cures(ranking, icons, rig) if report_out is not None or json_out != STDOUT else {}
    if report_out is not None:
        from ..report.report import report

        made = report(found, icons, rig, command_text(files, rig, request), near)
        with complete_or_absent(report_out) as draft:
            draft.write_text(made, encoding="utf-8", newline="\n")
        note(f"wrote {report_out}")
    if json_out == STDOUT:
        typer.echo(found.to_json())
    else:
        show_ranking(found.to_dict(mapped=False), [row["icon"] for row in ranking.rows()], icons.title, near)


def _say_if_first() -> None:
    """Say, where somebody watches, that a first ranking compiles; an empty file beside the code remembers it."""
    from thermicon.circuit.compiled import kept_in

    folder = kept_in()
    if folder is not None and sys.stderr.isatty() and not (ranked := folder / "ranked").exists():
        note("compiling for this computer, once: this ranking takes about half a minute longer")
        ranked.touch()


def check_report(out: Path | None) -> None:
    """Fail for a report that is not the name of a page."""
    if out is not None:
        check_output(out, (".html", ".htm"), "a report")
        if out == STDOUT:
            raise usage("- is not a file; give the name of a page, such as report.html", "--report")


def _picture(place: Path | None) -> list[Path]:
    return [] if place is None or place.suffix.lower() not in FIGURE_SUFFIXES else [place]


def check_figures(place: Path | None) -> None:
    """Fail where figures can neither go to a folder, nor one of the set to a file."""
    if place is None:
        return
    if place.suffix.lower() in FIGURE_SUFFIXES and not place.is_dir():
        check_output(place, FIGURE_SUFFIXES, "a figure")
        return
    if not place.is_dir() and (place.exists() or place.suffix.lower() in OTHER_PICTURES):
        hint = place.with_suffix("") if place.suffix else "figures"
        raise usage(
            f"{place} is the name of a file; give a folder, such as {hint}, for all figures, or a .pdf, .svg or .png "
            "for that of the set",
            "--figure",
        )
    check_folder(place)


def cures(ranking: Ranking, icons: IconSet, rig: Rig) -> dict[str, str]:
    """Return, by name, how each icon that the rig does not reach could be changed so that it is reached."""
    from thermicon.circuit import nearest_reachable

    missed = {score.name for score in ranking.icons if not score.reachable}
    near = {icon.name: nearest_reachable(icon, rig) for icon in icons if icon.name in missed}
    return {name: found.sentence for name, found in near.items() if found is not None}


def command_text(files: Sequence[str], rig: Rig, request: Request, *, paths: bool = False) -> str:
    """Return the command that reproduces a ranking, without its outputs: file names and non-default options.

    Files are named without their folders, or, with ``paths``, as they were given.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.notebooks.cli.ranking import Request
    >>> command_text(["/home/a/two icons.cue"], Rig.load("thenar"), Request(people=20))
    "thermicon rank 'two icons.cue' --people 20"
    """
    words = ["thermicon", "rank", *(name if paths else Path(name).name for name in files)]
    defaults, values = Request(), {name: getattr(request, name) for name in PLAIN_OPTIONS}
    # A rig from a file is named as a file, which its own name is not.
    name = rig.name if request.rig is None else request.rig if paths else Path(request.rig).name
    words += [] if name == "thenar" else ["--rig", name]
    words += [word for change in rig.changes for word in ("--set", change)]
    for name, value in values.items():
        shown = value.name if isinstance(value, Path) and not paths else str(value)
        words += [] if value == getattr(defaults, name) else [f"--{name}", shown]
    if (asked := request.choosing) is not None:
        words += ["--choose", str(asked.count), "--objective", asked.objective]
        words += [word for icon in asked.must for word in ("--must", icon)]
        words += [] if asked.most_s is None else ["--most-time", f"{asked.most_s:g}"]
        words += [] if asked.most_J is None else ["--most-energy", f"{asked.most_J:g}"]
    return shlex.join(words + ["--edits"] * (request.edits == "all"))
