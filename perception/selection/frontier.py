"""The frontier of a pool: identification of its best subset by the number of icons.

For each number of icons it is the choice of `choose`, judged by people who know only these icons. What 95 % of people
reach depends, as in a goal, on people and on the uncertainty of the model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Unpack

from thermicon.base.checks.arguments import checked
from thermicon.base.results.drawn import Drawn, Tabled
from thermicon.circuit.rig.rig import AnyRig, Rig
from thermicon.circuit.solver.simulate import duration_s
from thermicon.icons import IconSet
from thermicon.icons.files.shipped import Icons, set_of

from ..identification.new_laboratory import DRAWS
from ..identification.population import run_end_s
from ..kernels.parallel import Progress, step_counter
from ..observer.observer_model import EVERYBODY, Crowd, CrowdWords, ObserverModel
from ..ranking.batches import Job, felt_by_people
from ..ranking.rank import rank
from ..ranking.ranking import Ranking
from .choose import Choice, Chooser
from .goal import Goal
from .goal_result import GoalResult, SetOutcome, judge_goal
from .request import ChoiceError, Objective, Selection
from .subset_identification import PEOPLE, RESTARTS

ROUGH_DRAWS, ROUGH_RESTARTS = 64, 1
"""Draws of the posterior behind a rough frontier, whose people are the first that choices are compared by."""

MOST = 12
"""Most icons that a choice has unless more are asked for."""


@dataclass(frozen=True)
class Frontier(Drawn, Tabled):
    """Best choices of rising size, the `points`, from one pool as the people of a job feel it.

    `goals` say of each point whether it meets the goal; empty without one. `draws` are those of the posterior behind
    what people reach, and `cautioned` the names of the icons that pass a soft limit of safety. A `rough` one is of few
    people and draws, whose per cents lie within about 3 points of those of all.

    See Also
    --------
    frontier : Makes it.
    """

    icons: IconSet
    job: Job
    model: ObserverModel
    points: tuple[Choice, ...]
    goals: tuple[GoalResult, ...]
    draws: int
    cautioned: tuple[str, ...]
    rough: bool = False

    @property
    def crowd(self) -> Crowd:
        """The people who feel and remember the icons."""
        return self.job.crowd(self.model)

    @cached_property
    def ranking(self) -> Ranking:
        """The whole pool, ranked when it is first asked for: naming all icons takes longer than all choices."""
        return rank(self.icons, self.job.rig, crowd=self.crowd, parameters=0)

    @property
    def nearest(self) -> tuple[Choice, GoalResult]:
        """The choice that comes nearest to the goal, and how it meets it; ValueError without a goal."""
        return max(zip(self.points, self.goals, strict=True), key=lambda each: each[1].margin)

    def amber(self, point: Choice) -> tuple[str, ...]:
        """Names of the icons of a choice that pass a soft limit of safety."""
        return tuple(name for name in self.cautioned if name in point.icons)

    def rows(self) -> list[dict[str, Any]]:
        """One plain row for each size."""
        return [
            {
                "icons": len(point.icons),
                "felt_and_named": point.at_own_range.felt_and_named,
                "felt_and_named_95_percent_of_people": point.at_own_range.reached,
                "proportion_correct": point.at_own_range.proportion_correct,
                "proportion_correct_95_percent_of_people": point.at_own_range.reached_named,
                "information_bits": point.at_own_range.information_bits,
                "d_prime": point.at_own_range.d_prime,
                "total_s": point.total_s,
                "total_J": point.total_J,
                "proven_best": point.optimal,
                "names": " ".join(point.icons),
                "felt_and_named_95_percent_of_people_and_model": point.reached if self.draws else None,
                "proportion_correct_95_percent_of_people_and_model": point.reached_named if self.draws else None,
                "amber": " ".join(self.amber(point)),
                "meets_goal": self.goals[k].met if self.goals else None,
            }
            for k, point in enumerate(self.points)
        ]

    def __repr__(self) -> str:
        first, job = self.points[0], self.job
        sizes = f"{len(first.icons)} to {len(self.points[-1].icons)}"
        return f"Frontier({sizes} of {first.pool} icons by {first.objective} on {job.rig.name}, {job.people} people)"


@checked
def frontier(
    icons: Icons,
    rig: AnyRig = None,
    *,
    crowd: Crowd = EVERYBODY,
    most: int = MOST,
    objective: Objective = "felt-and-named",
    goal: Goal | str | None = None,
    parameters: int | None = None,
    progress: Progress | None = None,
    rough: Callable[[Frontier], None] | None = None,
    **words: Unpack[CrowdWords],
) -> Frontier:
    """Choose the best 2, 3, … icons of a pool, and judge each choice with people who know it alone.

    Parameters
    ----------
    icons
        The pool, its name or file; families count with all their members.
    rig
        The rig that plays it, or its name or file; None: the shipped rig of the icons' site, else thenar.
    crowd
        Who feels and remembers the icons.
    most
        Largest choice; fewer where the pool has fewer icons that can be played.
    objective
        What a choice maximises: `felt-and-named`, `named`, `worst` (d′ of the worst pair), `bits` or `bits-per-s`.
    goal
        What is wanted: icons are left out that miss its `safety`, `detected` or `onset`, its `time` and `energy` are
        kept, and every choice is judged by it.
    parameters
        Draws from the posterior for what 95 % of people reach, as in `rank` (None: 128, or as many as there are; 0:
        none).
    progress
        Called with (steps done, steps in all).
    rough
        Called with a rough frontier, of few people and draws, as soon as it stands, where there are many to wait for.
    **words
        Single words of the crowd, such as ``people=50``.

    Returns
    -------
    Frontier
        One point for each size that can be chosen.

    Raises
    ------
    ChoiceError
        Where not even two icons can be chosen, or no two keep the limits.
    ValueError
        For a single draw, and more draws than there are; a `GoalError` for a goal for a share of
        people without draws.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> found = frontier(read_cue("six-icons"), Rig.load("thenar"), people=4, most=3, parameters=0)
    >>> [len(point.icons) for point in found.points]
    [2, 3]
    """
    crowd = crowd.but(**words)
    crowd = crowd.but(observer=crowd.model)  # a file is read once
    if most < 2:
        raise ChoiceError(f"a choice of {most} has no pair to compare: give 2 or more")
    wanted = Goal.parse(goal) if isinstance(goal, str) else goal
    draws = crowd.model.draw_count(parameters, DRAWS)
    if wanted is not None:
        wanted.check_draws(draws)
    time, energy = (None, None) if wanted is None else wanted.totals
    asked = Selection(2, objective, most_s=time, most_J=energy)
    icons = set_of(icons)
    rig = Rig.of(rig, icons.context.site)
    end_s = run_end_s([duration_s(icon, rig) for icon in icons])
    job = Job.of(tuple(icons), rig, crowd, end_s)
    chooser = Chooser(job, crowd.model, asked, wanted)
    sizes = range(2, min(most, len(job.icons)) + 1)
    step = step_counter(progress, job.batches + len(sizes) * (1 + draws))
    for felt in felt_by_people(job, PEOPLE, step):
        chooser.feel(felt)
        if len(felt.pairs) == job.people:
            return _judged(icons, chooser, _choices(chooser, sizes, draws, step), draws)
        if rough is not None:
            few = min(draws, ROUGH_DRAWS)
            rough(_judged(icons, chooser, _choices(chooser, sizes, few, lambda: None, ROUGH_RESTARTS), few))
    raise AssertionError("the last are all people")


def _choices(
    chooser: Chooser, sizes: range, draws: int, step: Callable[[], None], restarts: int = RESTARTS
) -> tuple[Choice, ...]:
    """The best choice of each size until none keeps the limits; `step` is called as often as for all sizes."""
    choices: list[Choice] = []
    for count in sizes:
        choice = None
        if count <= len(chooser.pool):
            choice = chooser.best(count, draws, step, restarts, restarts == ROUGH_RESTARTS)
        if choice is None:  # nor will more keep the limits
            break
        choices.append(choice)
    for _ in range((len(sizes) - len(choices)) * (1 + draws)):
        step()
    if not choices:
        raise ChoiceError(chooser.pool.nothing_fits(chooser.asked))
    return tuple(choices)


def _judged(icons: IconSet, chooser: Chooser, choices: tuple[Choice, ...], draws: int) -> Frontier:
    """The choices of a pool, each judged by the goal, for the people whom the chooser chose by."""
    job, goal, people = chooser.job, chooser.goal, len(chooser.felt.pairs)
    outcome = SetOutcome.of_pool(chooser.whole, chooser.felt)
    goals = () if goal is None else tuple(judge_goal(goal, outcome, choice) for choice in choices)
    own, amber = replace(job, people=people), chooser.whole.amber
    return Frontier(icons, own, chooser.model, choices, goals, draws, amber, people < job.people)
