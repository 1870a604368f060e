"""``thermicon rank``: the predicted identification of one set."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from thermicon.perception.criteria import MOST_ICONS

from ..files.outputs import STDOUT, check_output, check_separate
from ..loading import check_draws, site_warnings
from ..messages import fail, note, progress_bar, shown_at_once, usage
from ..report.following import after_ranking
from ..report.rank_report import doubt_report, rank_report, rules_report, table_report
from ..report.terminal import show
from .on_elements import layout_of
from .options import (
    CrowdOptions,
    FigureOptions,
    FileNames,
    Goals,
    Json,
    Options,
    RigOptions,
    command_text,
    commands,
    flag,
    goal_of,
    opt,
    out,
    read_set,
    write_text,
)

if TYPE_CHECKING:
    from thermicon.perception import Task
    from thermicon.perception.observer.observer_model import ObserverModel

    from ..report.set_report import SetReport

TRIALS, MOST_WORKERS = 48, 1024
MANY = 33
"""Of so many icons, who watches sees the table before edits and intervals, which take as long again."""
TASK = {"trials": (1.0, 1e6, ""), "gap": (0.0, 600.0, " s")}
"""Keys of --task with their limits, those of `thermicon.perception.Task`, repeated here to avoid its imports."""


@dataclass(frozen=True)
class RankedBy(CrowdOptions):
    """Virtual people with a form of memory, or the rules of the literature, which have no draws."""

    memory: Annotated[
        Literal["both", "episodes", "naming", "rules"],
        typer.Option("--memory", "--by", help="Form of memory, or rules of thumb instead of virtual people."),
    ] = "both"  # type: ignore[assignment]  # one more than other commands know

    @property
    def asked(self) -> dict[str, Any]:
        """Arguments of `rank`, whose result has the rules' scores whatever is remembered."""
        return {**super().asked, "memory": "both"} if self.memory == "rules" else super().asked

    def draws(self, model: ObserverModel) -> int:
        """The number of draws."""
        return 0 if self.memory == "rules" else super().draws(model)


@dataclass(frozen=True)
class TaskOptions(Options):
    """The predicted experiment."""

    task: Annotated[
        list[str] | None,
        opt(
            "KEY=VALUE",
            "The predicted experiment; may be given several times: trials=48, gap=S between icons (else until "
            "carry-over has faded).",
        ),
    ] = None

    def __post_init__(self) -> None:
        self.load()

    def load(self) -> tuple[int, Task]:
        """Number of trials, and the task as the model takes it; a usage error for what no experiment has."""
        from thermicon.perception import Task

        given = dict(_read_task(text) for text in self.task or [])
        return int(given.get("trials", TRIALS)), Task(given.get("gap"))


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
    figure: FigureOptions,
    goal: Goals = None,
    json: Json = None,
    report: Annotated[Path | None, out("OUT.html", "Write a report as one page to mail.", "--report")] = None,
    doubt: Annotated[
        bool, flag("--doubt", "Instead: which constants carry the doubt, and what to measure first.")
    ] = False,
    details: Annotated[
        bool, flag("--details", "Also reasons, intervals of people, assumptions, and all notes.")
    ] = False,
    workers: Annotated[
        str | None,
        opt(
            "N|ADDRESS", "Number of CPU cores, or a dask cluster by the address of its scheduler.  [default: all cores]"
        ),
    ] = None,
) -> None:
    """Rank a set of icons: predict detection, onset times, confusions and the information that the set carries.

    Several files are joined into one set. The numbers, the pair that is confused most often, its cheapest edit, and the
    command that helps most come first; --details, --report and --json have the rest. With --doubt, the set is predicted
    with many draws of the posterior (--people 24 is enough) as new laboratories would see it, and the table says which
    constants their differences come from.
    """
    if report is not None:
        check_output(report, (".html", ".htm"), "a report")
        if report == STDOUT:
            raise usage("- is not a file; give the name of a page, such as report.html", "--report")
    if json is not None:
        check_output(json, (".json",), "JSON")
    check_separate(files, [json, report, figure.figure])
    here = read_workers(workers)
    about_people: dict[str, object] = {"--doubt": doubt, "--report": report, "--goal": goal}
    for option, value in about_people.items():
        if value and crowd.memory == "rules":
            raise usage("is about predictions for people: leave out --by rules", option)
    wanted = goal_of(goal)
    if doubt:
        given = {"--task": task.task, "--goal": goal, "--report": report, "--workers": workers, "--details": details}
        for option, value in {**given, "--tracking": crowd.tracking}.items():
            if value:
                raise usage("belongs to a ranking; leave it out, or --doubt", option)
        doubt_about(files, crowd, rig, figure, json)
        return
    icons = read_set(files)
    if len(icons) > MOST_ICONS:
        what = (
            f"there are {len(icons):,} icons, and every pair is compared: at most {MOST_ICONS:,} can be ranked at once"
        )
        raise usage(f"{what}; narrow a family, or put its best members into a separate set", "FILE")
    from thermicon.circuit import Rig

    from ..report.set_report import cures, report_of

    layout = layout_of(icons, rig, files[0]) if icons.spatial else rig.load(icons, files[0], told=True)
    rigs = [layout] if isinstance(layout, Rig) else list(dict.fromkeys(each.rig for each in layout.elements))
    warnings = tuple(text for each in rigs for text in (*each.warnings, *site_warnings(files[0], icons, each)))
    model = crowd.load(rigs[0])
    draws = crowd.draws(model)
    _say_if_first()
    trials, named = task.load()
    asked = {**crowd.asked, "goal": wanted, "trials": trials, "task": named, "observer": model}
    watched = len(icons) >= MANY and shown_at_once() and json != STDOUT and crowd.memory != "rules"

    def show_table(ranked: SetReport) -> None:
        show(table_report(ranked, icons.title, cures(ranked.ranking, icons), details))
        typer.echo()

    asked["first"] = show_table if watched else None
    found = report_of(icons, layout, draws, warnings=warnings, workers=here, **asked)
    if json is not None and json != STDOUT:
        write_text(found.to_json() + "\n", json)
    figure.write_set(found.ranking)
    near = cures(found.ranking, icons) if report is not None or json != STDOUT else {}
    if report is not None:
        from ..report.rank_page import report as page

        command = command_text(files, rig, crowd, task)
        write_text(page(found, icons, command, near), report)
    if json == STDOUT:
        typer.echo(found.to_json())
    elif crowd.memory == "rules":
        show(rules_report(found.ranking, icons.title))
    else:
        following = after_ranking(found, commands(files, rig, crowd), near)
        show(rank_report(found, icons.title, near, following, details, watched))


def doubt_about(
    files: Sequence[str], crowd: CrowdOptions, rig: RigOptions, figure: FigureOptions, json: Path | None
) -> None:
    """Study which constants carry the doubt about a set: the table on stdout, other outputs on request."""
    from thermicon.perception.ranking.sensitivity import DRAWS, FEWEST_DRAWS, sensitivity

    if crowd.intervals is not None and crowd.intervals < FEWEST_DRAWS:
        raise usage(f"{crowd.intervals} draws are too few for --doubt: give {FEWEST_DRAWS} or more", "--intervals")
    icons = read_set(files)
    icons.check_one_element()
    if len(icons) < 2:
        fail(f"{files[0]}: --doubt needs at least two icons, since one alone is never confused")
    where = rig.load(icons, files[0])
    model = crowd.load(where, "what carries the doubt is read from draws of a posterior")
    draws = check_draws(model, crowd.intervals, "--intervals", DRAWS, FEWEST_DRAWS)
    with progress_bar("doubt") as progress:
        found = sensitivity(icons, where, draws=draws, observer=model, progress=progress, **crowd.asked)
    if json is not None:
        write_text(dumps(asdict(found), ensure_ascii=False, indent=1) + "\n", json)
    figure.write(lambda: found.plot().figure)
    if json != STDOUT:
        show(doubt_report(found, icons.title))


def read_workers(text: str | None) -> int | str | None:
    """Number of cores, or address of a cluster."""
    if text is None or not text.lstrip("-").isdecimal():
        return text
    if not 1 <= int(text) <= MOST_WORKERS:
        raise usage(f"{text} is outside 1 to {MOST_WORKERS}", "--workers")
    return int(text)


def _say_if_first() -> None:
    """Say, where somebody watches, that a first ranking compiles; an empty file beside the code remembers it."""
    from thermicon.base.numbers.compiled import kept_in

    folder = kept_in()
    if folder is not None and sys.stderr.isatty() and not (ranked := folder / "ranked").exists():
        note("compiling for this computer, once: this ranking takes about half a minute longer")
        ranked.touch()
