"""``thermicon improve``: better icons by edits or by search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

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
    refuse,
    write_frame,
    write_text,
)

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet
    from thermicon.perception import Goal, Ranking
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
    wanted = goal_of(goal)
    icons = read_set(files)
    as_they_are = bool(choose or up_to or edits)
    searched = evaluations is not None or (bool(icons.families) and not as_they_are)
    others = bool(choose or edits or searched)
    refuse({"--up-to": up_to}, others, "is a question of its own: leave out --choose, --edits and --evaluations")
    refuse(
        {"--edits": edits}, searched, "edits icons as they are, which a search does not leave: leave out --evaluations"
    )
    refuse(
        {"--must": must}, choose is None or searched,
        "needs --choose K, which chooses the best K icons; a search keeps all that are no families",
    )  # fmt: skip
    improves = bool(choose or up_to or searched)
    refuse({"--objective": objective}, not improves, "needs --choose K, --up-to K or a search of families")
    table = (*TRACE_SUFFIXES, *FIGURE_SUFFIXES, ".cue")
    kinds = (".cue",) if searched else table if up_to is not None else (".cue", ".json")
    outputs = output or []
    for path in outputs:
        check_output(path, kinds, "what this finds")
    check_separate(files, [*outputs, figure.figure])
    if searched and len(files) > 1:
        raise usage("one file is searched; join its families into one set", "FILE")
    where = rig.load(icons, files[0])
    people = crowd.load(where)
    draws = crowd.draws(people.model)
    aim: Objective = objective or ("felt-and-named" if up_to is not None else objective_of(wanted))
    if icons.families and not searched:
        icons, must = _by_written_names(icons, must or [], where)
    asked = Improvement(icons, where, people, draws, wanted, aim, outputs, figure, commands(files, rig, crowd))
    if up_to is not None:
        asked.by_table(up_to)
    elif searched:
        asked.by_search(choose, USUAL_EVALUATIONS if evaluations is None else evaluations)
    else:
        asked.by_choice(choose, must or [], edits)


@dataclass(frozen=True)
class Improvement:
    """What was asked of a set, for whom, and where it goes; `command` writes the commands that may follow."""

    icons: IconSet
    rig: Rig
    crowd: Crowd
    draws: int
    goal: Goal | None
    objective: Objective
    outputs: Sequence[Path]
    figure: FigureOptions
    command: Command

    @property
    def shown(self) -> bool:
        """Whether the report is printed, and not an output instead."""
        return STDOUT not in self.outputs

    @property
    def set_file(self) -> str | None:
        """The file that a set is to be written to, if any."""
        return next((str(path) for path in self.outputs if path.suffix == ".cue"), None)

    def by_table(self, most: int) -> None:
        """Choose the best icons in every number, and write the largest choice that does as a set."""
        table = self._frontier(most)
        count = largest(table)
        names = next((point.icons for point in table.points if len(point.icons) == count), None)
        best = None if names is None else self._set_of(names)
        self._write_table(table, best)
        ways: tuple[Way, ...] = ()
        if best is None and table.goals:
            point, missed = table.nearest
            nearest = [self.icons[name] for name in point.icons]
            ways = _on_contacts(table.job, table.crowd, nearest, missed, table.draws)
        way = next((way for way in ways if way.result.met), None)
        following = after_choices(table, self.command, self.set_file if best else None, way)
        lacking = f"no choice {'meets the goal' if table.goals else 'is distinguishable'}"
        self._tell(frontier_report(table, self.icons.title, following, ways), best, lacking)

    def _frontier(self, most: int) -> Frontier:
        """The table; who watches it come is shown a rough one first, which stays if the rest is interrupted."""
        from thermicon.perception import frontier

        told: list[Frontier] = []

        def tell(rough: Frontier) -> None:
            with bars_aside():
                show([*frontier_report(rough, self.icons.title), ""])
            told.append(rough)

        try:
            with progress_bar("choosing") as progress:
                return frontier(
                    self.icons, self.rig, crowd=self.crowd, most=most, objective=self.objective, goal=self.goal,
                    parameters=self.draws, progress=progress, rough=tell if shown_at_once() and self.shown else None,
                )  # fmt: skip
        except KeyboardInterrupt:
            if told:
                note(f"the table above is the rough one, for {told[0].job.people} people: its refinement was ended")
            raise

    def _write_table(self, table: Frontier, best: IconSet | None) -> None:
        """Write the table and its figure, and the best set where there is one."""
        for path in self.outputs:
            if path.suffix == ".cue":
                if best is not None:
                    write_text(str(best), path)
            elif path.suffix.lower() in FIGURE_SUFFIXES:
                FigureOptions(path).write(lambda: table.plot().figure)
            else:
                write_frame(table.to_frame(), path)
        self.figure.write(lambda: table.plot().figure)

    def by_search(self, count: int | None, evaluations: int) -> None:
        """Search the families for the best set, and tell it beside that which the search started from."""
        result = self._searched(count, evaluations)
        for path in self.outputs:
            write_text(str(result.found), path)
        if self.shown or self.figure.figure is not None:
            before, after = self._beside_start(result)
            following = after_searching(after, self.command, self.set_file)
            self._tell(search_report(result, before, after, self.icons.title, following), result.found)

    def _searched(self, count: int | None, evaluations: int) -> SearchResult:
        """Search the families; an interrupted search leaves the best set that it held, as its outputs too."""
        from thermicon.perception import search

        held: list[IconSet] = []

        def hold(best: IconSet) -> None:
            if not held and shown_at_once() and self.shown:
                with bars_aside():
                    typer.echo(f"Rough, where the search starts: {self._roughly(best)}; searching …\n")
            held[:] = [best]

        try:
            with progress_bar("searching") as progress:
                return search(
                    self.icons, self.rig, crowd=self.crowd, count=count, objective=self.objective,
                    evaluations=evaluations, goal=self.goal, parameters=self.draws, progress=progress, best_so_far=hold,
                )  # fmt: skip
        except KeyboardInterrupt:
            if held:
                for path in self.outputs:
                    write_text(str(held[0]), path)
                if self.shown:
                    typer.echo(f"The best set so far, rough: {self._roughly(held[0])}")
                note("the search was ended early: more of it may find a better set")
            raise

    def _roughly(self, icons: IconSet) -> str:
        """The icons of a set, and how well a few people name them."""
        from thermicon.perception.selection.appraise import appraise
        from thermicon.perception.selection.search_run import PEOPLE

        scores = appraise(icons, self.rig, crowd=self.crowd, people=PEOPLE)
        named = f"{percent(scores.felt_and_named)} felt and named, worst pair d′ {number(scores.d_prime)}"
        return f"{', '.join(icon.name for icon in icons)}: {named}, for {PEOPLE} people"

    def _beside_start(self, result: SearchResult) -> tuple[SetReport, SetReport]:
        """Rank the found set and its start as the search did, judge both by the goal, and draw the found one."""
        from thermicon.perception import rank
        from thermicon.perception.selection.goal_result import judge_goal

        start = replace(result.found, name=self.icons.name, title=self.icons.title, entries=result.start)
        sets, goal = (start, result.found), self.goal
        draws = 0 if self.crowd.model.posterior is None else self.draws
        with progress_bar("ranking") as bar:
            rankings = [rank(icons, self.rig, crowd=self.crowd, parameters=draws, progress=bar) for icons in sets]
        self.figure.write_set(rankings[1])
        before, after = (SetReport(each, goal=None if goal is None else judge_goal(goal, each)) for each in rankings)
        if after.goal is not None and not after.goal.met:
            job = after.ranking.job
            after = replace(after, ways=_on_contacts(job, after.ranking.crowd, job.icons, after.goal, draws))
        return before, after

    def by_choice(self, count: int | None, must: Sequence[str], edits: bool) -> None:
        """Choose the best few icons as they are, or edit pairs of all."""
        how = {"crowd": self.crowd, "goal": self.goal, "parameters": self.draws}
        report = chosen(self.icons, self.rig, count, self.objective, must, edits, how)
        best = self._best_of(report)
        missed = report.goal is not None and not report.goal.met
        self._write_report(report, best, missed)
        if self.figure.figure is not None:
            self.figure.write_set(report.ranking if report.choice is None else self._alone(report.choice.icons))
        following = after_choice(report, self.command, None if best is None else self.set_file)
        told = (
            edits_report(report, self.icons.title, following)
            if report.choice is None
            else rank_report(report, self.icons.title, cures(report.ranking, self.icons, self.rig), following)
        )
        lacking = "no edit that was tried meets the goal" if missed else "there is no edit to write"
        self._tell(told, best, lacking)

    def _best_of(self, report: SetReport) -> IconSet | None:
        """The chosen icons, or the edited ones, as a set; None where no edit was made."""
        from thermicon.perception.selection.candidates import Candidate, set_of_run

        if report.choice is not None:
            return self._set_of(report.choice.icons)
        if report.edited is None:
            return None
        return set_of_run(self.icons, [Candidate(icon) for icon in report.edited.job.icons], self.rig, "edited")

    def _write_report(self, report: SetReport, best: IconSet | None, missed: bool) -> None:
        """Write the ranking, and the best set where there is one, with a word where that misses the goal."""
        mended = report.choice is None and report.way is not None
        for path in self.outputs:
            if path.suffix != ".cue":
                write_text(report.to_json() + "\n", path)
            elif best is not None:
                write_text(str(best), path, ", which misses the goal" * (missed and not mended))

    def _alone(self, names: Sequence[str]) -> Ranking:
        """Rank the chosen icons as the set that they are then: nobody names an icon that is not in it."""
        from thermicon.perception import rank

        return rank(self._set_of(names), self.rig, crowd=self.crowd, parameters=0)

    def _set_of(self, names: Sequence[str]) -> IconSet:
        """Some icons as a set of the run: with its site and baseline, under the names that a file gives them."""
        from thermicon.perception.selection.candidates import Candidate, set_of_run

        candidates = [Candidate(self.icons[name]) for name in names]
        return set_of_run(self.icons, candidates, self.rig, f"best {len(names)}")

    def _tell(self, told: Sequence[Block], best: IconSet | None, lacking: str = "") -> None:
        """Show the report, unless an output was printed; then fail where there was no set to write."""
        if self.shown:
            show(told)
        if best is None and self.set_file is not None:
            fail(f"{lacking}, and no set was written")


def _by_written_names(icons: IconSet, must: Sequence[str], rig: Rig) -> tuple[IconSet, list[str]]:
    """The icons as they would be written, so that the screen calls them as the file does, and those that must stay."""
    from thermicon.perception.selection.candidates import members_of, set_of_run

    members = members_of(icons)
    pool = set_of_run(icons, members, rig, "members")
    names = {member.icon.name: icon.name for member, icon in zip(members, pool, strict=True)}
    return replace(pool, name=icons.name, title=icons.title), [names.get(name, name) for name in must]


def _on_contacts(job: Job, crowd: Crowd, icons: Sequence[Icon], missed: GoalResult, draws: int) -> tuple[Way, ...]:
    """Larger contacts, tried with icons that miss a goal until one meets it."""
    from thermicon.perception.selection.advice import contacts_to, until_met

    if shown_at_once():
        note("trying larger contacts …")
    return until_met(contacts_to(job, crowd, icons, missed, draws))
