"""``thermicon rank``: predicted detection, confusions and information of one set, as table, JSON and figures."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from thermicon.icons.atomic import check_folder

from ..files.outputs import FIGURE_SUFFIXES, STDOUT, check_output, check_separate
from ..messages import note, progress_bar, usage
from ..report.rank_text import show_ranking
from .cues import MOST_ICONS, read_set, warn_of_frames
from .options import CrowdOptions, FigureOptions, FileNames, Json, Options, RigOptions, out, write_text

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Goal, Ranking, Task
    from thermicon.perception.observer.observer_model import ObserverModel
    from thermicon.perception.selection.request import Selection

    from ..report.set_report import SetReport

OTHER_PICTURES = (".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".eps")
TRIALS, MOST_WORKERS = 48, 1024
TASK = {"trials": (1.0, 1e6, ""), "gap": (0.0, 600.0, " s"), "context": (0.0, 1.0, ""), "bias": (0.0, 5.0, "")}
"""Keys of --task with their limits, those of `thermicon.perception.Task`, repeated here to avoid its imports."""


@dataclass(frozen=True)
class SetFigureOptions(FigureOptions):
    """All figures of a set in a folder, or the one of the whole set."""

    figure: Annotated[
        Path | None,
        out("DIR|OUT", "Write all figures to the folder DIR, or that of the set to a .pdf, .svg or .png file."),
    ] = None

    def check_place(self) -> None:
        """Fail where figures can neither go to a folder, nor one of the set to a file."""
        place = self.figure
        if place is None:
            return
        if self.picture is not None:
            check_output(place, FIGURE_SUFFIXES, "a figure")
            return
        if not place.is_dir() and (place.exists() or place.suffix.lower() in OTHER_PICTURES):
            hint = place.with_suffix("") if place.suffix else "figures"
            raise usage(
                f"{place} is the name of a file; give a folder, such as {hint}, for all figures, or a .pdf, .svg or "
                ".png for that of the set",
                "--figure",
            )
        check_folder(place)

    @property
    def picture(self) -> Path | None:
        """The file of the one figure of the set, where one was asked for."""
        single = self.figure is not None and self.figure.suffix.lower() in FIGURE_SUFFIXES
        return self.figure if single and self.figure is not None and not self.figure.is_dir() else None


@dataclass(frozen=True)
class RankedBy(CrowdOptions):
    """Virtual people with a form of memory, or the rules of the literature."""

    norm: Annotated[
        Literal["episodes", "naming", "rules"],
        typer.Option("--norm", "--by", help="How icons are remembered; rules: by the literature's rules, not people."),
    ] = "episodes"  # type: ignore[assignment]  # one more than other commands know

    @property
    def asked(self) -> dict[str, Any]:
        """Arguments of `rank`."""
        return {**super().asked, "norm": "episodes", "by": "rules"} if self.norm == "rules" else super().asked

    def draws(self, model: ObserverModel) -> int:
        """How many draws to use; rules have none."""
        return 0 if self.norm == "rules" else super().draws(model)


@dataclass(frozen=True)
class TaskOptions(Options):
    """The predicted experiment."""

    task: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUE",
            help="The predicted experiment; may be given several times: trials=48, gap=S between icons (else until "
            "carry-over has faded), context=SHARE of the memory noise that grows with the range of the set, 0 to 1, "
            "bias=SD of people's response bias in log likelihood, 0 to 5.",
        ),
    ] = None

    def __post_init__(self) -> None:
        self.read()

    @property
    def trials(self) -> int:
        """Number of trials."""
        return int(self.read().get("trials", TRIALS))

    def load(self) -> Task:
        """The task, as the model takes it."""
        from thermicon.perception import Task

        given = self.read()
        return Task(given.get("context", 0.0), given.get("gap"), given.get("bias", 0.0))

    def read(self) -> dict[str, float]:
        """The values by their keys; a usage error for what no experiment has."""
        return dict(_read_task(text) for text in self.task or [])


def _read_task(text: str) -> tuple[str, float]:
    key, equals, value = (part.strip() for part in text.partition("="))
    if not equals or key not in TASK:
        raise usage(f"{text!r} is not one of {', '.join(f'{name}=VALUE' for name in TASK)}", "--task")
    least, most, unit = TASK[key]
    try:
        number = int(value) if key == "trials" else float(value)
    except ValueError:
        raise usage(f"{text!r}: {value!r} is not a {'whole ' if key == 'trials' else ''}number", "--task") from None
    if not least <= number <= most:
        raise usage(f"{text!r}: {number:g}{unit} is outside {least:g} to {most:g}{unit}", "--task")
    return key, number


def rank_command(
    files: FileNames,
    crowd: RankedBy,
    task: TaskOptions,
    rig: RigOptions,
    figure: SetFigureOptions,
    json: Json = None,
    report: Annotated[Path | None, out("OUT.html", "Write a self-contained HTML report.", "--report")] = None,
    doubt: Annotated[
        bool, typer.Option("--doubt", help="Instead: which constants carry the doubt, and what to measure first.")
    ] = False,
    workers: Annotated[
        str | None,
        typer.Option(
            metavar="N|ADDRESS",
            help="Number of CPU cores, or a dask cluster by the address of its scheduler.  [default: all cores]",
        ),
    ] = None,
    keep: Annotated[
        Path | None, out("DIR", "Folder for finished parts, so that an interrupted run continues.", "--keep")
    ] = None,
) -> None:
    """Rank a set of icons: predict detection, onset times, confusions and the information that the set carries.

    Several files are joined into one set. With --doubt, the set is predicted with many draws of the posterior (--people
    24 is enough) as new laboratories would see it, and the table says which constants their differences come from.
    """
    if report is not None:
        check_output(report, (".html", ".htm"), "a report")
        if report == STDOUT:
            raise usage("- is not a file; give the name of a page, such as report.html", "--report")
    if json is not None:
        check_output(json, (), "JSON")
    check_separate(files, [json, report, figure.picture])
    here = read_workers(workers)
    if doubt:
        if crowd.norm == "rules":
            raise usage("is about predictions for people: leave out --by rules", "--doubt")
        from .doubt import doubt_about

        given = {"--task": task.task, "--report": report, "--workers": workers, "--keep": keep}
        doubt_about(files, crowd, rig, figure, json, {**given, "--tracking": crowd.tracking})
        return
    icons = read_set(files)
    if len(icons) > MOST_ICONS:
        what = (
            f"there are {len(icons):,} icons, and every pair is compared: at most {MOST_ICONS:,} can be ranked at once"
        )
        raise usage(f"{what}; narrow a family, or put its best members into a separate set", "FILE")
    where = rig.load()
    warnings = (*where.warnings, *warn_of_frames(files, icons, where))
    model = crowd.load(where)
    draws = crowd.draws(model)
    if keep is not None:
        check_folder(keep)
    _say_if_first()
    found = report_of(
        icons,
        where,
        draws,
        edits="none" if crowd.norm == "rules" else "worst",
        warnings=warnings,
        workers=here,
        **crowd.asked,
        trials=task.trials,
        task=task.load(),
        observer=model,
        keep=keep,
    )
    if json is not None and json != STDOUT:
        write_text(found.to_json() + "\n", json)
    if figure.figure is not None:
        from ..figures.set_figures import write_figures

        write_figures(found.ranking, icons, where, figure.figure, figure.look)
    near = cures(found.ranking, icons, where) if report is not None or json != STDOUT else {}
    if report is not None:
        from ..report.report import report as page

        write_text(page(found, icons, where, command_text(files, rig, crowd, task), near), report)
    if json == STDOUT:
        typer.echo(found.to_json())
    else:
        show(found, icons, near)


def report_of(
    icons: IconSet,
    rig: Rig,
    draws: int,
    *,
    edits: Literal["worst", "all", "none"] = "worst",
    choosing: Selection | None = None,
    goal: Goal | None = None,
    warnings: tuple[str, ...] = (),
    workers: int | str | None = None,
    **how: Any,
) -> SetReport:
    """Rank a set; choose of it, judge it by a goal and edit its pairs, as far as that is asked.

    `draws` are those of an interval, `how` other arguments of `rank`.
    """
    from thermicon.perception import choose, rank
    from thermicon.perception.kernels.parallel import beside
    from thermicon.perception.progress import step_counter
    from thermicon.perception.ranking.rank import with_intervals
    from thermicon.perception.selection.edit import cheapest_edits
    from thermicon.perception.selection.goal_result import judge_goal
    from thermicon.perception.selection.request import check_selection

    from ..report.set_report import SetReport

    if choosing is not None:
        check_selection(choosing, [icon.name for icon in icons])
    if goal is not None:
        goal.check_count(None if choosing is None else choosing.count)
        goal.check_draws(draws)
    with progress_bar("ranking") as progress:
        ranking = without = rank(icons, rig, parameters=0, workers=workers, progress=progress, **how)
    # One edit takes as long as the draws, mostly on one core; more of them wait for the draws.
    cores = workers if isinstance(workers, int) else None
    edited = beside(lambda: cheapest_edits(without, edits), cores if edits == "worst" else 1)
    choice = None
    with progress_bar("intervals" if choosing is None else "choosing") as progress:
        if choosing is not None:
            choice = choose(ranking, choosing, parameters=draws, progress=progress)
        elif draws:
            ranking = with_intervals(ranking, draws, step_counter(progress, draws))
    reached = None if goal is None else judge_goal(goal, ranking, choice)
    return SetReport(ranking, choice, reached, edited(), warnings)


def show(found: SetReport, icons: IconSet, near: Mapping[str, str]) -> None:
    """Print a ranking with what was asked of it; `near` are cures of icons that the rig does not reach."""
    names = [row["icon"] for row in found.ranking.rows()]
    show_ranking(found.to_dict(mapped=False), names, icons.title, near)


def read_workers(text: str | None) -> int | str | None:
    """Number of cores, or address of a cluster.

    >>> read_workers("2"), read_workers("tcp://10.0.0.1:8786")
    (2, 'tcp://10.0.0.1:8786')
    """
    if text is None or not text.lstrip("-").isdecimal():
        return text
    if not 1 <= int(text) <= MOST_WORKERS:
        raise usage(f"{text} is outside 1 to {MOST_WORKERS}", "--workers")
    return int(text)


def _say_if_first() -> None:
    """Say, where somebody watches, that a first ranking compiles; an empty file beside the code remembers it."""
    from thermicon.circuit.compiled import kept_in

    folder = kept_in()
    if folder is not None and sys.stderr.isatty() and not (ranked := folder / "ranked").exists():
        note("compiling for this computer, once: this ranking takes about half a minute longer")
        ranked.touch()


def cures(ranking: Ranking, icons: IconSet, rig: Rig) -> dict[str, str]:
    """Return, by name, how each icon that the rig does not reach could be changed so that it is reached."""
    from thermicon.circuit import nearest_reachable

    missed = {score.name for score in ranking.icons if not score.reachable}
    near = {icon.name: nearest_reachable(icon, rig) for icon in icons if icon.name in missed}
    return {name: found.sentence for name, found in near.items() if found is not None}


def command_text(files: Sequence[str], *groups: Options, paths: bool = False) -> str:
    """Return the command that reproduces a ranking, without its outputs: file names and non-default options.

    Files are named without their folders, or, with ``paths``, as they were given.

    >>> command_text(["/home/a/two icons.cue"], RigOptions(), CrowdOptions(people=20))
    "thermicon rank 'two icons.cue' --people 20"
    """
    words = ["thermicon", "rank", *(name if paths else Path(name).name for name in files)]
    return shlex.join([*words, *(word for group in groups for word in group.words(paths=paths))])
