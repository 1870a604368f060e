"""What ``improve`` says after a search: both sets, the goal, and what would help where it is missed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import count_of, number, percent, percent_span

from ..messages import progress_bar
from ..report.blocks import Block, Bullets, Heading, Text, grid
from ..report.choices import NAMES, goal_lines, goal_value, laboratory
from ..report.rank_report import BARELY
from ..report.set_report import SetReport

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception.selection.reach import Advice, Trial
    from thermicon.perception.selection.search import SearchResult

REFINING_PEOPLE = 24
"""As in `thermicon.perception.selection.evaluator`, repeated here to avoid its imports."""
MOST_TRIALS = 3
MOST_LISTED, NEARLY = 400, 0.8
"""Listed icons that a search starts from, as `SAMPLED` in `thermicon.perception.selection.search_run`; and the share of
the icons tried from which the number that was wanted is as good as kept: whole rounds are tried."""
LEAST_AGAIN = 0.01
"""Share of what is wanted, below which a second search is not worth a sentence."""


@dataclass(frozen=True, slots=True)
class FoundSet:
    """A found set with both rankings, and changes that were tried where a goal is not met."""

    found: SearchResult
    before: SetReport
    after: SetReport
    advice: Advice | None

    @classmethod
    def ranked(
        cls, found: SearchResult, icons: IconSet, rig: Rig, must: Sequence[str] | None, how: Mapping[str, Any]
    ) -> FoundSet:
        """Rank both sets as the search did; try what would help where the found one misses the goal."""
        from thermicon.icons import IconSet
        from thermicon.perception import rank
        from thermicon.perception.selection.goal_result import judge_goal
        from thermicon.perception.selection.reach import what_would_help

        start = IconSet(icons.name, icons.title, icons.context, icons.metadata, found.start)
        draws = 0 if how["observer"].posterior is None else how["parameters"]
        goal, asked = how["goal"], {**how, "parameters": draws}
        del asked["goal"]
        with progress_bar("ranking") as bar:
            rankings = [rank(each, rig, **asked, progress=bar) for each in (start, found.found)]
        before, after = (SetReport(each, goal=None if goal is None else judge_goal(goal, each)) for each in rankings)
        advice: Advice | None = None
        if after.goal is not None and not after.goal.met:
            with progress_bar("trying changes") as bar:
                advice = what_would_help(
                    icons,
                    rig,
                    after.goal.goal,
                    found.found,
                    objective=found.objective,
                    count=len(found.found),
                    must=must,
                    step=bar,
                    **{name: how[name] for name in ("seed", "tracking", "norm", "observer")},
                )
        return cls(found, before, after, advice)

    def report(self, title: str, rig: str, wanted: int) -> list[Block]:
        """Report the improved set, its scores next to those of the initial set, and the caveat.

        `wanted` is how many icons were to be tried.
        """
        found = self.found
        crowd = count_of(self.after.ranking.people, "virtual person", "virtual people")
        icons = [
            f"{icon.name}: {icon.metadata.tags[-1]}" for icon in found.found if "found by search" in icon.metadata.tags
        ]
        names = f"Before: {', '.join(icon.name for icon in found.start)}"
        return [
            *([Heading(title, 1)] if title else []),
            Text("Found:"),
            Bullets(tuple(icons)),
            grid(("", "before", "after"), self._rows(), ("before", "after")),
            Text("\n".join([*self._remarks(), f"After: worst pair {' and '.join(found.after.worst_pair)}", names])),
            *self._goal(),
            Text(
                f"{found.evaluations} icons were tried on a nominal person"
                f"{in_any_case(found.evaluations, wanted)} and {found.refined} on {REFINING_PEOPLE} people, whatever "
                f"--people is; what they maximised was {NAMES[found.objective]}{self._last_climb()} "
                f"(seed {found.seed}). {self._winner()} Before and after are for {crowd} on the {rig} rig.\n"
                "These are predictions of a model, not measurements, and the set was optimised for that same model: "
                "expect lower scores from people."
            ),
        ]

    def _last_climb(self) -> str:
        """What the last climb went by, where a goal is for a share of people."""
        by = self.found.climbed_by
        return f", in the last climb {by}, with people and draws of the model together" if by else ""

    def _winner(self) -> str:
        """What the result was chosen by, of the sets that the search held at its end."""
        found = self.found
        if found.finalists == 1:
            return "One set was held at the end."
        by = NAMES.get(found.chosen_by, found.chosen_by)
        return f"Of the {found.finalists} sets held at the end, this one was chosen by {by}."

    def _rows(self) -> Iterator[tuple[str, str, str]]:
        before, after = self.found.before, self.found.after
        yield "worst pair, d′", number(before.d_prime), number(after.d_prime)
        yield "proportion correct", percent(before.proportion_correct), percent(after.proportion_correct)
        pair = (self.before.ranking, self.after.ranking)
        if pair[1].people > 1:
            one, other = (percent_span(*each.proportion_correct_interval) for each in pair)
            yield "  middle 95 % of people", one, other
        intervals = [each.new_laboratory for each in pair]
        if all(intervals):
            one, other = (percent_span(*each.proportion_correct) for each in intervals if each is not None)
            yield f"  {laboratory(pair[1].observer, pair[1].own_laboratory)} (95 %)", one, other
        yield from self._shares()
        yield "information, bits", f"{before.information_bits:.2f}", f"{after.information_bits:.2f}"
        yield "information rate, bits/s", f"{before.bits_per_s:.2f}", f"{after.bits_per_s:.2f}"
        yield "total duration, s", number(pair[0].total_s), number(pair[1].total_s)

    def _shares(self) -> Iterator[tuple[str, str, str]]:
        """What the shares of people reach that the goal asks for, as the goal judges it."""
        goals = self.before.goal, self.after.goal
        if goals[0] is None or goals[1] is None:
            return
        for parts in zip(goals[0].parts, goals[1].parts, strict=True):
            if (people := parts[0].part.people) is not None:
                before, after = (goal_value(part.to_dict())[0] for part in parts)
                yield f"  goal: {parts[0].part.quantity} for {100.0 * people:g} % of people", before, after

    def _remarks(self) -> Iterator[str]:
        """Icons of the found set that are not green, or that many people will miss; ranges that end too early."""
        if self.found.at_ends:
            yield f"At the end of its range: {'; '.join(self.found.at_ends)}. A wider range may hold a better set."
        for icon in self.after.ranking.icons:
            if not icon.playable:
                yield f"{icon.name} cannot be played: {icon.reason or 'the rig does not reach it'}"
            elif icon.cautions:
                yield f"{icon.name} is amber: {icon.cautions[0]}"
            if icon.detected_probability < BARELY:
                yield f"{icon.name} is detected in {percent(icon.detected_probability)} of trials only"

    def _goal(self) -> list[Block]:
        goal = self.after.goal
        if goal is None:
            return []
        verdict = Text("\n".join(goal_lines(goal.to_dict())))
        return [verdict] if goal.met else [verdict, *advice_blocks(self.advice)]


def in_any_case(tried: int, wanted: int) -> str:
    """Why clearly more icons were tried than were to be; empty where they were about as many.

    >>> in_any_case(220, 50), in_any_case(2026, 2000)
    (' (not 50: what the families list is tried in any case, 400 icons at most)', '')
    """
    if tried * NEARLY <= wanted:
        return ""
    return f" (not {wanted}: what the families list is tried in any case, {MOST_LISTED} icons at most)"


def advice_blocks(advice: Advice | None) -> list[Block]:
    """Which changes bring a goal nearer that this search did not reach, and which were tried in vain.

    >>> advice_blocks(None)[0].text
    'Not reached by this search, and no change could be tried.'
    """
    if advice is None or not advice.trials:
        return [Text("Not reached by this search, and no change could be tried.")]

    def named(trials: Sequence[Trial]) -> list[str]:
        return [f"{trial.words} ({trial.change})" for trial in trials]

    helpful, more = advice.helpful[:MOST_TRIALS], named(advice.helpful[MOST_TRIALS:])
    if helpful:
        head = (
            f"Not reached by this search. What would bring it nearer, for {REFINING_PEOPLE} people, each against the "
            "best set of the rig as it is:"
        )
        points = [f"{said}: {_nearer(trial, advice)}" for said, trial in zip(named(helpful), helpful, strict=True)]
        points += [f"nearer by less: {'; '.join(more)}"] * bool(more)
        points += [f"tried and no nearer: {'; '.join(named(advice.idle))}"] * bool(advice.idle)
    else:
        head, points = "Not reached by this search. None of the changes tried brings it nearer:", named(advice.idle)
    if advice.again > LEAST_AGAIN:
        points.append(
            f"searching again alone came nearer by {100.0 * advice.again:.0f} % of what is wanted: give more "
            "--evaluations, or another --seed"
        )
    return [Text(head), Bullets(tuple(points))]


def _nearer(trial: Trial, advice: Advice) -> str:
    """The part that misses most without the change, before and with it."""
    from thermicon.perception.selection.reach import missing

    place = max(range(len(advice.baseline.parts)), key=lambda k: missing(advice.baseline.parts[k]))
    before, after = (goal_value(each.parts[place].to_dict())[0] for each in (advice.baseline, trial.result))
    met = ", and the goal is met" if trial.met else ""
    return f"{advice.baseline.parts[place].part.text}: {before} → {after}{met}"
