"""A question to a set of icons, with its answer written and told: the best of them, better edits, a better set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from thermicon.base.words.number_text import number, percent
from thermicon.perception.selection.request import Objective

from ..files.outputs import FIGURE_SUFFIXES, STDOUT
from ..messages import bars_aside, note, progress_bar, shown_at_once
from ..report.following import Command, after_choice, after_choices, after_searching, largest
from ..report.improve_report import edits_report, frontier_report, search_report
from ..report.rank_report import rank_report
from ..report.set_report import SetReport, chosen, cures
from ..report.terminal import show
from .options import FigureOptions, write_frame, write_text

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

MISSES = ", which misses the goal"


@dataclass(frozen=True, slots=True)
class Request:
    """What was asked of a set: icons and rig, people and goal (`how`), what is improved, and where to write it.

    Each question writes its outputs, and returns what to show.
    """

    icons: IconSet
    rig: Rig
    how: dict[str, Any]
    objective: Objective
    outputs: Sequence[Path]
    figure: FigureOptions
    command: Command

    @property
    def written(self) -> str | None:
        """The cue file to write, if any."""
        return next((str(path) for path in self.outputs if path.suffix == ".cue"), None)

    def choices(self, most: int) -> tuple[list[Block], str]:
        """The best 2, 3, … icons as a table; and why no set was written, where none of them does."""
        tried = _frontier(self.icons, self.rig, self.outputs, most=most, objective=self.objective, **self.how)
        best = _best_of(tried, self.icons, self.rig)
        for path in self.outputs:
            if path.suffix == ".cue":
                if best is not None:
                    write_text(str(best), path)
            elif path.suffix.lower() in FIGURE_SUFFIXES:
                FigureOptions(path).write(lambda: tried.plot().figure)
            else:
                write_frame(tried.to_frame(), path)
        self.figure.write(lambda: tried.plot().figure)
        ways: tuple[Way, ...] = ()
        if best is None and tried.goals:
            point, missed = tried.nearest
            nearest = [self.icons[name] for name in point.icons]
            ways = _on_contacts(tried.job, tried.crowd, nearest, missed, tried.draws)
        met = next((way for way in ways if way.result.met), None)
        following = after_choices(tried, self.command, self.written if best else None, met)
        refused = ""
        if self.written is not None and best is None:
            refused = f"no choice {'meets the goal' if tried.goals else 'is distinguishable'}, and no set was written"
        return frontier_report(tried, self.icons.title, following, ways), refused

    def search(self, count: int | None, evaluations: int) -> list[Block]:
        """The best set among the members of families."""
        better = _searched(
            self.icons, self.rig, self.outputs,
            count=count, objective=self.objective, evaluations=evaluations, **self.how,
        )  # fmt: skip
        for path in self.outputs:
            write_text(str(better.found), path)
        if STDOUT in self.outputs and self.figure.figure is None:
            return []
        return self.beside_start(better)

    def beside_start(self, better: SearchResult) -> list[Block]:
        """Rank the found set and its start as the search did, judge both by the goal, and draw the found one."""
        from thermicon.perception import rank
        from thermicon.perception.selection.goal_result import judge_goal

        start = replace(better.found, name=self.icons.name, title=self.icons.title, entries=better.start)
        goal = self.how["goal"]
        draws = 0 if self.how["observer"].posterior is None else self.how["parameters"]
        with progress_bar("ranking") as bar:
            rankings = [
                rank(each, self.rig, **self.people, parameters=draws, progress=bar) for each in (start, better.found)
            ]
        self.figure.write_set(rankings[1])
        before, after = (SetReport(each, goal=None if goal is None else judge_goal(goal, each)) for each in rankings)
        if after.goal is not None and not after.goal.met:
            ranked = rankings[1]
            ways = _on_contacts(ranked.job, ranked.crowd, ranked.job.icons, after.goal, draws)
            after = replace(after, ways=ways)
        following = after_searching(after, self.command, self.written)
        return search_report(better, before, after, self.icons.title, following)

    def best(self, count: int | None, must: Sequence[str] | None, edits: bool) -> tuple[list[Block], str]:
        """The best `count` icons as they are, or all (None), edited; and why no set was written."""
        result = chosen(self.icons, self.rig, count, self.objective, must, edits, self.how)
        missed = result.goal is not None and not result.goal.met
        refused, written = "", self.written
        for path in self.outputs:
            if path.suffix != ".cue":
                write_text(result.to_json() + "\n", path)
            elif result.choice is not None:
                write_text(str(set_to_write(self.icons, result.choice.icons, self.rig)), path, MISSES * missed)
            elif result.edited is not None:
                edited = _edited(self.icons, result.edited, self.rig)
                write_text(str(edited), path, MISSES * (missed and result.way is None))
            else:
                why = "no edit that was tried meets the goal" if missed else "there is no edit to write"
                refused, written = f"{why}, and no set was written", None
        if self.figure.figure is not None:
            self.figure.write_set(result.ranking if result.choice is None else self.alone(result.choice.icons))
        following = after_choice(result, self.command, written)
        if result.choice is None:
            return edits_report(result, self.icons.title, following), refused
        return rank_report(result, self.icons.title, cures(result.ranking, self.icons), following), refused

    def alone(self, names: Sequence[str]) -> Ranking:
        """Rank the chosen icons as the set that they are then: nobody names an icon that is not in it."""
        from thermicon.perception import rank

        return rank(set_to_write(self.icons, names, self.rig), self.rig, **self.people, parameters=0)

    @property
    def people(self) -> dict[str, Any]:
        """Who judges, without a goal and the number of draws."""
        return {name: value for name, value in self.how.items() if name not in ("goal", "parameters")}


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


def _on_contacts(job: Job, crowd: Crowd, icons: Sequence[Icon], missed: GoalResult, draws: int) -> tuple[Way, ...]:
    """Larger contacts, tried with icons that miss a goal until one meets it."""
    from thermicon.perception.selection.advice import contacts_to, until_met

    if shown_at_once():
        note("trying larger contacts …")
    return until_met(contacts_to(job, crowd, icons, missed, draws))
