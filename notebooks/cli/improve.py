"""``thermicon improve``: better icons by edits or by search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermicon.base.words.number_text import number, percent
from thermicon.perception.selection.request import Objective

from ..files.outputs import FIGURE_SUFFIXES, STDOUT, TRACE_SUFFIXES, check_output, check_separate
from ..messages import bars_aside, fail, note, progress_bar, shown_at_once, usage
from ..report.following import Command, after_choice, after_choices, after_searching, largest
from ..report.improve_report import edits_report, frontier_report, search_report
from ..report.rank_report import rank_report
from ..report.set_report import SetReport, chosen, cures, objective_of
from ..report.terminal import show
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
    write_frame,
    write_text,
)

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet
    from thermicon.perception import Ranking
    from thermicon.perception.observer.observer_model import Crowd
    from thermicon.perception.ranking.batches import Job
    from thermicon.perception.selection.advice import Way
    from thermicon.perception.selection.frontier import Frontier
    from thermicon.perception.selection.goal_result import GoalResult
    from thermicon.perception.selection.search import SearchResult

    from ..report.blocks import Block

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
    what: Objective = objective or ("felt-and-named" if up_to is not None else objective_of(wanted))
    if has_families and not searched:
        icons, must = _by_written_names(icons, must or [], where)
    command = commands(files, rig, crowd)
    refused = ""
    written = next((str(path) for path in outputs if path.suffix == ".cue"), None)
    if up_to is not None:
        tried = _frontier(icons, where, outputs, most=up_to, objective=what, **how)
        best = _best_of(tried, icons, where)
        for path in outputs:
            if path.suffix == ".cue":
                if best is not None:
                    write_text(str(best), path)
            elif path.suffix.lower() in FIGURE_SUFFIXES:
                FigureOptions(path).write(lambda: tried.plot().figure)
            else:
                write_frame(tried.to_frame(), path)
        figure.write(lambda: tried.plot().figure)
        ways: tuple[Way, ...] = ()
        if best is None and tried.goals:
            point, reached = tried.nearest
            ways = _on_contacts(tried.job, tried.crowd, [icons[name] for name in point.icons], reached, tried.draws)
        way = next((way for way in ways if way.result.met), None)
        following = after_choices(tried, command, written if best else None, way)
        told = frontier_report(tried, icons.title, following, ways)
        if written is not None and best is None:
            refused = f"no choice {'meets the goal' if tried.goals else 'is distinguishable'}, and no set was written"
    elif searched:
        count = USUAL_EVALUATIONS if evaluations is None else evaluations
        found = _searched(icons, where, outputs, count=choose, objective=what, evaluations=count, **how)
        for path in outputs:
            write_text(str(found.found), path)
        told = []
        if STDOUT not in outputs or figure.figure is not None:
            told = beside_start(found, icons, where, how, command, written, figure)
    else:
        made = chosen(icons, where, choose, what, must, edits, how)
        missed = ", which misses the goal" if made.goal is not None and not made.goal.met else ""
        for path in outputs:
            if path.suffix == ".cue" and made.choice is not None:
                write_text(str(set_to_write(icons, made.choice.icons, where)), path, missed)
            elif path.suffix == ".cue":
                if made.edited is None:
                    why = "no edit that was tried meets the goal" if missed else "there is no edit to write"
                    refused, written = f"{why}, and no set was written", None
                else:
                    write_text(str(_edited(icons, made.edited, where)), path, missed * (made.way is None))
            else:
                write_text(made.to_json() + "\n", path)
        if figure.figure is not None:
            figure.write_set(made.ranking if made.choice is None else _alone(made.choice.icons, icons, where, how))
        following = after_choice(made, command, written)
        told = edits_report(made, icons.title, following)
        if made.choice is not None:
            told = rank_report(made, icons.title, cures(made.ranking, icons, where), following)
    if STDOUT not in outputs:
        show(told)
    if refused:
        fail(refused)


def _frontier(icons: IconSet, rig: Rig, outputs: Sequence[Path], **how: Any) -> Frontier:
    """The table of choices; who watches it come is shown a rough one first, which stays if the rest is interrupted."""
    from thermicon.perception import frontier

    told: list[Frontier] = []

    def tell(rough: Frontier) -> None:
        with bars_aside():
            show([*frontier_report(rough, icons.title), ""])
        told.append(rough)

    first = tell if shown_at_once() and STDOUT not in outputs else None
    try:
        with progress_bar("choosing") as progress:
            return frontier(icons, rig, progress=progress, rough=first, **how)
    except KeyboardInterrupt:
        if told:
            note(f"the table above is the rough one, for {told[0].job.people} people: its refinement was ended")
        raise


def _searched(icons: IconSet, rig: Rig, outputs: Sequence[Path], **how: Any) -> SearchResult:
    """Search the families; an interrupted search leaves the best set that it held, as its outputs too."""
    from thermicon.perception import search

    held: list[IconSet] = []

    def hold(best: IconSet) -> None:
        if not held and shown_at_once() and STDOUT not in outputs:
            with bars_aside():
                typer.echo(f"Rough, where the search starts: {_roughly(best, rig, how)}; searching …\n")
        held[:] = [best]

    try:
        with progress_bar("searching") as progress:
            return search(icons, rig, progress=progress, best_so_far=hold, **how)
    except KeyboardInterrupt:
        if held:
            for path in outputs:
                write_text(str(held[0]), path)
            if STDOUT not in outputs:
                typer.echo(f"The best set so far, rough: {_roughly(held[0], rig, how)}")
            note("the search was ended early: more of it may find a better set")
        raise


def _roughly(icons: IconSet, rig: Rig, how: dict[str, Any]) -> str:
    """The icons of a set, and how well a few people name them."""
    from thermicon.perception.selection.appraise import appraise
    from thermicon.perception.selection.search_run import PEOPLE

    crowd = {key: value for key, value in how.items() if key in ("seed", "tracking", "memory", "observer")}
    found = appraise(icons, rig, people=PEOPLE, **crowd)
    named = f"{percent(found.felt_and_named)} felt and named, worst pair d′ {number(found.d_prime)}"
    return f"{', '.join(icon.name for icon in icons)}: {named}, for {PEOPLE} people"


def _best_of(found: Frontier, icons: IconSet, rig: Rig) -> IconSet | None:
    """The largest choice that does, as a set; None where none does."""
    if (count := largest(found)) is None:
        return None
    names = next(point.icons for point in found.points if len(point.icons) == count)
    return set_to_write(icons, names, rig)


def set_to_write(icons: IconSet, names: Sequence[str], rig: Rig) -> IconSet:
    """Some icons of a set as a set of the run: with its site and baseline, under the names that a file gives them."""
    from thermicon.perception.selection.candidates import Candidate, set_of_run

    return set_of_run(icons, [Candidate(icons[name]) for name in names], rig, f"best {len(names)}")


def _edited(icons: IconSet, made: Ranking, rig: Rig) -> IconSet:
    from thermicon.perception.selection.candidates import Candidate, set_of_run

    return set_of_run(icons, [Candidate(icon) for icon in made.job.icons], rig, "edited")


def _by_written_names(icons: IconSet, must: Sequence[str], rig: Rig) -> tuple[IconSet, list[str]]:
    """The icons as they would be written, so that the screen calls them as the file does, and those that must stay."""
    from thermicon.perception.selection.candidates import members_of, set_of_run

    found = members_of(icons)
    pool = set_of_run(icons, found, rig, "members")
    names = {each.icon.name: icon.name for each, icon in zip(found, pool, strict=True)}
    return replace(pool, name=icons.name, title=icons.title), [names.get(name, name) for name in must]


def _alone(names: Sequence[str], icons: IconSet, rig: Rig, how: dict[str, Any]) -> Ranking:
    """Rank the chosen icons as the set that they are then: nobody names an icon that is not in it."""
    from thermicon.perception import rank

    asked = {name: value for name, value in how.items() if name != "goal"}
    return rank(set_to_write(icons, names, rig), rig, **asked, parameters=0)


def beside_start(
    found: SearchResult,
    icons: IconSet,
    rig: Rig,
    how: dict[str, Any],
    command: Command,
    written: str | None,
    figure: FigureOptions,
) -> list[Block]:
    """Rank the found set and its start as the search did, judge both by the goal, and draw the found one."""
    from thermicon.perception import rank
    from thermicon.perception.selection.goal_result import judge_goal

    start = replace(found.found, name=icons.name, title=icons.title, entries=found.start)
    goal, asked = how["goal"], {name: value for name, value in how.items() if name != "goal"}
    if how["observer"].posterior is None:
        asked["parameters"] = 0
    with progress_bar("ranking") as bar:
        rankings = [rank(each, rig, **asked, progress=bar) for each in (start, found.found)]
    figure.write_set(rankings[1])
    before, after = (SetReport(each, goal=None if goal is None else judge_goal(goal, each)) for each in rankings)
    if after.goal is not None and not after.goal.met:
        made = rankings[1]
        after = replace(after, ways=_on_contacts(made.job, made.crowd, made.job.icons, after.goal, asked["parameters"]))
    return search_report(found, before, after, icons.title, after_searching(after, command, written))


def _on_contacts(job: Job, crowd: Crowd, icons: Sequence[Icon], missed: GoalResult, draws: int) -> tuple[Way, ...]:
    """Larger contacts, tried with icons that miss a goal until one meets it."""
    from thermicon.perception.selection.advice import contacts_to, until_met

    if shown_at_once():
        note("trying larger contacts …")
    return until_met(contacts_to(job, crowd, icons, missed, draws))
