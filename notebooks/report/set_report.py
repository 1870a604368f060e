"""The full report of a set."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from thermicon.perception.kernels.kept_parts import kept_until_done
from thermicon.perception.ranking.rank_file import as_text, plain, ranking_file

from ..messages import note, progress_bar, shown_at_once
from .choices import way_words

if TYPE_CHECKING:
    from thermicon.circuit import Layout, Rig
    from thermicon.icons import IconSet
    from thermicon.perception import Goal, Ranking
    from thermicon.perception.selection.advice import Way
    from thermicon.perception.selection.choose import Choice
    from thermicon.perception.selection.edit import Edit, NoEdit
    from thermicon.perception.selection.goal_result import GoalResult
    from thermicon.perception.selection.request import Objective, Selection


@dataclass(frozen=True, slots=True)
class SetReport:
    """A ranking, the icons chosen of it, the goal as set or choice meet it, edits by the names of pairs, warnings.

    `ways` to a goal that is missed were tried, until one met it; `edited` is the set with its edits made, ranked.
    """

    ranking: Ranking
    choice: Choice | None = None
    goal: GoalResult | None = None
    edits: Mapping[tuple[str, str], Edit | NoEdit] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    ways: tuple[Way, ...] = ()
    edited: Ranking | None = None

    @property
    def way(self) -> Way | None:
        """The cheapest of the ways that meets the goal."""
        return next((way for way in self.ways if way.result.met), None)

    def to_dict(self) -> dict[str, Any]:
        """The content of `rank --json` as plain data."""
        from thermicon.perception.selection.edit import NoEdit

        made = ranking_file(self.ranking)
        made["warnings"] = list(self.warnings)
        made["goal"] = None if self.goal is None else plain(self.goal.to_dict())
        if self.ways:
            made["goal"]["tried"] = [
                {"way": way_words(way), "rough": way.rough, **plain(way.result.to_dict())} for way in self.ways
            ]
        made["chosen"] = None if self.choice is None else plain(self.choice.to_dict())
        for pair in made["pairs"]:
            edit = self.edits.get((pair["a"], pair["b"]))
            if isinstance(edit, NoEdit):
                pair["no_edit"] = edit.reason
            elif edit is not None:
                pair["edit"] = plain(edit.to_dict())
        return made

    def to_json(self) -> str:
        """The content of `rank --json` as text, the same bytes for the same arguments."""
        return as_text(self.to_dict())


@kept_until_done()
def report_of(
    icons: IconSet,
    rig: Rig | Layout,
    draws: int,
    *,
    edits: Literal["worst", "all", "none"] = "worst",
    make_edits: bool = False,
    choosing: Selection | None = None,
    goal: Goal | None = None,
    warnings: tuple[str, ...] = (),
    workers: int | str | None = None,
    first: Callable[[SetReport], None] | None = None,
    **how: Any,
) -> SetReport:
    """Rank a set; choose of it, judge it by a goal and edit its pairs, as far as that is asked.

    `draws` are those of an interval, `how` other arguments of `rank`. With `make_edits`, the edited set is ranked too.
    `first` gets the ranking before the rest is computed. Icons on several elements are not edited.
    """
    from thermicon.perception import choose, rank
    from thermicon.perception.kernels.parallel import beside, step_counter
    from thermicon.perception.ranking.rank import with_intervals
    from thermicon.perception.selection.advice import Way, compatible, ranked_as, until_met, ways_to, with_edits
    from thermicon.perception.selection.edit import cheapest_edits
    from thermicon.perception.selection.goal_result import judge_goal
    from thermicon.perception.selection.request import check_selection

    if choosing is not None:
        check_selection(choosing, [icon.name for icon in icons])
    if goal is not None:
        goal.check_count(None if choosing is None else choosing.count)
        goal.check_draws(draws)
    with progress_bar("ranking") as progress:
        ranking = without = rank(icons, rig, parameters=0, workers=workers, progress=progress, **how)
    if first is not None:
        first(SetReport(ranking, warnings=warnings))
    # One edit takes as long as the draws, mostly on one core; more of them wait for the draws.
    cores = workers if isinstance(workers, int) else None
    edits = "none" if icons.spatial else edits
    edited = beside(lambda: cheapest_edits(without, edits, workers), cores if edits == "worst" else 1)
    choice = None
    with progress_bar("intervals" if choosing is None else "choosing") as progress:
        if choosing is not None:
            choice = choose(ranking, choosing, goal=goal, parameters=draws, progress=progress)
        elif draws:
            ranking = with_intervals(ranking, draws, step_counter(progress, draws), workers)
    reached = None if goal is None else judge_goal(goal, ranking, choice)
    found, ways, after = edited(), tuple[Way, ...](), None
    if reached is not None and not (reached.met or icons.spatial):
        if shown_at_once():
            note("trying ways to the goal …")
        ways = until_met(ways_to(ranking, reached, draws, found, choice, () if choosing is None else choosing.must))
    made = SetReport(ranking, choice, reached, found, warnings, ways)
    if make_edits and (some := made.way.edits if made.way else compatible(list(found.values()))):
        after = ranked_as(ranking.job, ranking.crowd, with_edits(ranking.job.icons, some), draws if goal else 0)
    return replace(made, edited=after)


def objective_of(goal: Goal | None) -> Objective:
    """The objective of a goal: the worst pair, unless it is about what is felt and named, named, or bits."""
    return "worst" if goal is None else goal.objective


def chosen(
    icons: IconSet,
    rig: Rig,
    count: int | None,
    objective: Objective,
    must: Sequence[str] | None,
    edits: bool,
    how: dict[str, Any],
) -> SetReport:
    """Choose the best few icons as they are, or edit them; judge them by a goal."""
    from thermicon.perception.selection.request import Selection

    goal: Goal | None = how["goal"]
    limits = (None, None) if goal is None else (goal.of("time"), goal.of("energy"))
    return report_of(
        icons,
        rig,
        how["parameters"],
        edits="all" if edits or (count is None and goal is None) else "worst" if count is None else "none",
        make_edits=count is None,
        choosing=None if count is None else Selection(count, objective, tuple(must or ()), *limits),
        warnings=tuple(rig.warnings),
        **{name: value for name, value in how.items() if name != "parameters"},
    )


def cures(ranking: Ranking, icons: IconSet) -> dict[str, str]:
    """Return, by name, how each icon that its rig does not reach could be changed so that it is reached."""
    from thermicon.circuit import nearest_reachable

    if icons.spatial:
        return {}
    missed = {score.name for score in ranking.icons if not score.reachable}
    near = {icon.name: nearest_reachable(icon, ranking.job.rig) for icon in icons if icon.name in missed}
    return {name: found.sentence for name, found in near.items() if found is not None}
