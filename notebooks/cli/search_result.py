"""What ``search`` says: the found set beside the initial one, the goal, and what would help where it is missed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.number_text import number, percent, percent_span

from ..figures.figure_look import SCREEN, Look
from ..files.outputs import complete_or_absent
from ..text.choices import goal_lines, laboratory
from ..text.messages import note, progress_bar
from ..text.tables import show, table

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Goal, Ranking, SearchResult
    from thermicon.perception.observer.observer_model import ObserverModel
    from thermicon.perception.ranking.reach import Trial

REFINING_PEOPLE = 24
"""As in `thermicon.perception.selection.evaluators`, repeated here to avoid its imports."""
BARELY = 0.75
"""An icon that fewer trials than these report is named: a good score of the set does not help who does not feel it."""
MOST_TRIALS = 3


@dataclass(frozen=True, slots=True)
class Ranked:
    """How both sets are ranked, as in ``rank``."""

    people: int
    seed: int
    tracking: str | None
    norm: str
    parameters: int


@dataclass(frozen=True, slots=True)
class FoundSet:
    """A found set with both rankings, and changes that were tried where a goal is not met."""

    found: SearchResult
    before: Ranking
    after: Ranking
    trials: tuple[Trial, ...]

    @classmethod
    def ranked(
        cls, found: SearchResult, icons: IconSet, rig: Rig, model: ObserverModel, how: Ranked, goal: Goal | None
    ) -> FoundSet:
        """Rank both sets, the initial one without the goal; try what would help where the found one misses it."""
        from thermicon.icons import IconSet
        from thermicon.perception import rank
        from thermicon.perception.ranking.reach import what_would_help

        start = IconSet(icons.name, icons.title, icons.context, icons.metadata, found.start)
        draws = 0 if model.posterior is None else how.parameters
        with progress_bar("ranking") as bar:
            before, after = (
                rank(
                    each,
                    rig,
                    people=how.people,
                    seed=how.seed,
                    tracking=how.tracking,
                    norm=how.norm,
                    parameters=draws,
                    goal=wanted,
                    observer=model,
                    progress=bar,
                )
                for each, wanted in ((start, None), (found.found, goal))
            )
        trials: tuple[Trial, ...] = ()
        if after.goal is not None and not after.goal.met:
            with progress_bar("trying changes") as bar:
                trials = what_would_help(
                    icons,
                    rig,
                    after.goal.goal,
                    objective=found.objective,
                    count=len(found.found),
                    seed=how.seed,
                    norm=how.norm,
                    observer=model,
                    step=bar,
                )
        return cls(found, before, after, trials)

    def write(self, rig: Rig, report_out: Path | None, figures: Path | None, command: str, look: Look = SCREEN) -> None:
        """Write report and figures of the found set, as ``rank`` does."""
        from .ranking import cures

        icons = self.found.found
        if figures is not None:
            from ..figures.set_figures import write_figures

            write_figures(self.after, icons, rig, figures, look)
        if report_out is not None:
            from ..pages.report import report

            made = report(self.after, icons, rig, command, cures(self.after, icons, rig))
            with complete_or_absent(report_out) as draft:
                draft.write_text(made, encoding="utf-8", newline="\n")
            note(f"wrote {report_out}")

    def show(self, title: str, rig: str) -> None:
        """Print the improved set, its scores next to those of the initial set, and the caveat."""
        found = self.found
        made = table("", "before", "after", numbers=("before", "after"))
        for what, before, after in self._rows():
            made.add_row(what, before, after)
        crowd = "1 virtual person" if self.after.people == 1 else f"{self.after.people} virtual people"
        icons = [
            f"  - {icon.name}: {icon.metadata.tags[-1]}"
            for icon in found.found
            if "found by search" in icon.metadata.tags
        ]
        show(
            *([title, ""] if title else []),
            "Found:",
            *icons,
            "",
            made,
            "",
            *self._remarks(),
            f"After: worst pair {' and '.join(found.after.worst_pair)}",
            f"Before: {', '.join(icon.name for icon in found.start)}",
            "",
            *self._goal(),
            f"{found.evaluations} icons were tried on a nominal person and {found.refined} on {REFINING_PEOPLE} "
            f"people, whatever --people is, with the objective {found.objective} (seed {found.seed}). Before and after "
            f"are for {crowd} on the {rig} rig.",
            "These are predictions of a model, not measurements, and the set was optimised for that same model: "
            "expect lower scores from people.",
        )

    def _rows(self) -> Iterator[tuple[str, str, str]]:
        before, after = self.found.before, self.found.after
        yield "worst pair, d′", number(before.d_prime), number(after.d_prime)
        yield "proportion correct", percent(before.proportion_correct), percent(after.proportion_correct)
        pair = (self.before, self.after)
        if self.after.people > 1:
            one, other = (percent_span(*each.proportion_correct_interval) for each in pair)
            yield "  95 % of people", one, other
        intervals = [each.new_laboratory for each in pair]
        if all(intervals):
            one, other = (percent_span(*each.proportion_correct) for each in intervals if each is not None)
            yield f"  {laboratory(self.after.observer, self.after.own_laboratory)} (95 %)", one, other
        yield "information, bits", f"{before.information_bits:.2f}", f"{after.information_bits:.2f}"
        yield "information rate, bits/s", f"{before.bits_per_s:.2f}", f"{after.bits_per_s:.2f}"
        yield "total duration, s", number(self.before.total_s), number(self.after.total_s)

    def _remarks(self) -> Iterator[str]:
        """Icons of the found set that are not green, or that many people will miss; ranges that end too early."""
        if self.found.at_ends:
            yield f"At the end of its range: {'; '.join(self.found.at_ends)}. A wider range may hold a better set."
        if self.found.listed:
            yield (
                f"Listed values only: {', '.join(self.found.listed)}. A range such as 0.5..2 s is searched between its "
                "ends, with or without a step."
            )
        for icon in self.after.icons:
            if not icon.playable:
                yield f"{icon.name} cannot be played: {icon.reason or 'the rig does not reach it'}"
            elif icon.cautions:
                yield f"{icon.name} is amber: {icon.cautions[0]}"
            if icon.detected_probability < BARELY:
                yield f"{icon.name} is detected in {percent(icon.detected_probability)} of trials only"

    def _goal(self) -> Iterator[str]:
        goal = self.after.goal
        if goal is None:
            return
        yield from goal_lines(goal.to_dict())
        if goal.met:
            yield ""
            return
        helpful = [trial for trial in self.trials if trial.met or trial.gain > 0.005]
        if not self.trials:
            yield "  Not reachable on this rig by this search, and no change of it could be tried."
        elif not helpful:
            yield "  Not reachable on this rig by this search; none of the changes tried brings it nearer."
        else:
            yield "  Not reachable on this rig by this search. What would bring it nearer, in short trials:"
        for trial in helpful[:MOST_TRIALS]:
            nearer = "the goal is met" if trial.met else f"what misses most is nearer by {100 * trial.gain:.0f} points"
            yield f"  - {trial.words} ({trial.change}): {nearer}"
        yield ""
