"""The best k of the ranked icons.

Icons are compared at the range of the pool they come from, so that the d′ of a pair is the same in every choice; the
chosen icons are then evaluated again at their own range.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermicon.base.checks.arguments import checked

from ..identification.carry_over import CarryOver, task_among
from ..identification.new_laboratory import DRAWS, NewLaboratory, Nominal, new_laboratory
from ..identification.population import RATE_HZ
from ..identification.tracks import Tracks
from ..kernels.parallel import Progress, step_counter
from ..observer.observer_model import ObserverModel
from ..ranking.batches import FeltResult, Job
from ..ranking.ranking import Ranking
from .appraise import REACHED_BY, Appraisal, appraise, nearest_two
from .goal import Goal
from .goal_result import SetOutcome, judge_goal
from .max_min_subset import SubsetChoice
from .pool import Pool
from .request import ChoiceError, Objective, Selection, check_selection
from .subset_identification import PEOPLE, RESTARTS, SubsetIdentification, pick

TOLD = ("icons", "objective", "value", "optimal", "bound", "worst_pair", "total_s", "total_J", "pool", "people")
"""What `rank --json` calls alike, in its order."""


@dataclass(frozen=True, slots=True)
class Choice:
    """The chosen icons in the order of the file, and how they were found.

    Attributes
    ----------
    icons
        Names of the chosen.
    objective, value, bound, optimal
        What was maximised; its value at the range of the pool, with median d′ over all people, or of the first
        `people`; a value that no choice exceeds; and whether no other choice is better.
    worst_pair
        Names of the pair with the smallest d′.
    total_s, total_J
        Time in s and energy in J of all chosen icons together.
    pool, people, seen, excluded
        Numbers of icons that could be chosen, of people behind `value` and of choices looked at; icons that could not
        be chosen, and why.
    at_own_range
        The chosen icons alone, as a set of their own.
    new_laboratory
        What a new laboratory will find with the chosen; None: not requested.
    """

    icons: tuple[str, ...]
    objective: Objective
    value: float
    optimal: bool
    bound: float
    worst_pair: tuple[str, str]
    total_s: float
    total_J: float
    pool: int
    people: int
    seen: int
    excluded: tuple[tuple[str, str], ...]
    at_own_range: Appraisal
    new_laboratory: NewLaboratory | None = None

    @property
    def reached(self) -> float:
        """Felt and named that 95 % of people reach: with the uncertainty of the model, where there are draws."""
        return self._reached("felt_and_named", self.at_own_range.reached)

    @property
    def reached_named(self) -> float:
        """Named that 95 % of people reach, likewise."""
        return self._reached("named", self.at_own_range.reached_named)

    def _reached(self, quantity: str, nominal: float) -> float:
        if self.new_laboratory is None:
            return nominal
        return float(np.quantile(self.new_laboratory.persons[quantity], 1.0 - REACHED_BY))

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `rank --json`."""
        elsewhere, own = self.new_laboratory, self.at_own_range
        a, b = (self.icons.index(name) for name in own.worst_pair)
        return {
            **{name: getattr(self, name) for name in TOLD},
            "looked_at": self.seen,
            "excluded": [{"icon": name, "reason": reason} for name, reason in self.excluded],
            "at_own_range": {
                **own.to_dict(),
                "proportion_correct_interval_new_laboratory": elsewhere and elsewhere.proportion_correct,
                "information_bits_interval_new_laboratory": elsewhere and elsewhere.information_bits,
                "d_prime_interval_new_laboratory": elsewhere and elsewhere.pair(a, b),
                "icons": elsewhere.rows(self.icons) if elsewhere else [],
            },
        }

    def __repr__(self) -> str:
        how = f"proven best for {self.people} people" if self.optimal else f"none exceeds {self.bound:.3g}"
        return f"Choice({', '.join(self.icons)}: {self.objective} {self.value:.3g}, {how})"


@checked
def choose(
    ranking: Ranking,
    asked: Selection,
    *,
    goal: Goal | None = None,
    parameters: int | None = None,
    progress: Progress | None = None,
) -> Choice:
    """Choose the best few icons of a set that was ranked.

    Parameters
    ----------
    ranking
        The pool, as people identify it. It needs no intervals of its own: the draws are spent on the chosen.
    asked
        The request.
    goal
        What is wanted of the chosen, as in `frontier`.
    parameters
        Draws from the posterior, for what a new laboratory will find with the chosen, as in `rank`.
    progress
        Called with (steps done, steps in all).

    Returns
    -------
    Choice
        The chosen icons, and whether it is proven that no other choice is better.

    Raises
    ------
    ChoiceError
        Where too few icons are usable or no choice keeps the limits.
    ValueError
        For a single draw, and for more draws than there are.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception import rank
    >>> pool = rank(read_cue("six-icons"), Rig.load("thenar"), people=4, parameters=0)
    >>> len(choose(pool, Selection(2), parameters=0).icons)
    2
    """
    draws = ranking.model.draw_count(parameters, DRAWS)
    if goal is not None:
        goal.check_draws(draws)
    chooser = Chooser(ranking.job, ranking.model, asked, goal, ranking.carry_over)
    chooser.feel(ranking.felt)
    found = chooser.best(asked.count, draws, step_counter(progress, 1 + draws))
    if found is None:
        raise ChoiceError(chooser.pool.nothing_fits(asked))
    return found


class Chooser:
    """The icons of a pool that can be chosen by a request, and who is named what among them, for any number.

    The pool is that of a job, as its people feel it; of fewer people, it is chosen and judged by these. A goal leaves
    icons out that miss what it asks of single ones, and the choice has the largest margin of its other parts. Raises
    `ChoiceError` where too few are left.
    """

    def __init__(
        self, job: Job, model: ObserverModel, asked: Selection, goal: Goal | None = None, left: CarryOver | None = None
    ) -> None:
        self.job, self.model, self.asked, self.left = job, model, asked, left
        self.whole = Pool.of(job.icons, job.rig, model.nominal, end_s=job.end_s, rate_Hz=RATE_HZ)
        check_selection(asked, [icon.name for icon in job.icons])
        self.goal = goal

    def feel(self, felt: FeltResult) -> None:
        """Choose from now on by what some people feel, the first of the job or all of them."""
        self.felt, self.middle, people, asked = felt, felt.middle, len(felt.pairs), self.asked
        self.places, self.excluded = self.whole.usable(asked, felt.detected, felt.detection.onset_s, self.goal)
        self.pool = self.whole.some(self.places)
        self.must = [k for k, icon in enumerate(self.pool.icons) if icon.name in asked.must]
        self.limits = self.pool.limits(asked.most_s, asked.most_J)
        self.crowd = replace(self.job, people=people).crowd(self.model)
        self.people = self.model.people(people, self.job.seed)
        self.namings = None
        self.picks: dict[tuple[int, int], SubsetChoice | None] = {}
        parts = () if self.goal is None else self.goal.of_sets
        if asked.objective != "worst" or parts:
            d, reports = felt.square(felt.pairs[:PEOPLE])[:, self.places][:, :, self.places], felt.reports
            namings = SubsetIdentification.of(
                d, self.people.lapse, reports[:, self.places], self.pool.durations_s, self.job.seed
            )
            self.namings = replace(namings, middle=self.middle[np.ix_(self.places, self.places)], parts=parts)

    def hopes(self, count: int) -> float:
        """The margin of the goal in the best choice of so many, by the mean of a few people at nominal constants."""
        picked = self._picked(count, RESTARTS)
        assert self.namings is not None
        return -math.inf if picked is None else self.namings.margin(picked.chosen)

    def _picked(self, count: int, restarts: int) -> SubsetChoice | None:
        """The choice of so many, picked once for each number of icons and restarts."""
        if (count, restarts) not in self.picks:
            middle, asked = self.middle[np.ix_(self.places, self.places)], self.asked
            self.picks[count, restarts] = pick(
                middle, self.namings, count, asked.objective, self.must, self.limits, self.job.seed, restarts
            )
        return self.picks[count, restarts]

    def best(
        self, count: int, draws: int, step: Callable[[], None], restarts: int = RESTARTS, alone: bool = False
    ) -> Choice | None:
        """The best choice of so many, judged as a set of its own by people and draws; None where none keeps the totals.

        Where it misses the goal, the next best are judged too, unless it is wanted `alone`. `step` is called once, and
        after each draw.
        """
        picked = self._picked(count, restarts)
        if picked is None:
            return None
        first = self._judged(picked, picked.chosen, draws, step)
        if self.goal is None or not self.goal.of_sets or alone:
            return first
        outcome = SetOutcome.of_pool(self.whole, self.felt)
        best, margin = first, judge_goal(self.goal, outcome, first).margin
        for chosen in picked.others if margin < 0.0 else ():
            other = self._judged(picked, chosen, draws, lambda: None)
            if (found := judge_goal(self.goal, outcome, other).margin) > margin:
                best, margin = other, found
            if margin >= 0.0:
                break
        every = margin >= 0.0 or picked.seen <= 1 + len(picked.others)
        return best if every else replace(best, optimal=False)

    def _judged(self, picked: SubsetChoice, places: Sequence[int], draws: int, step: Callable[[], None]) -> Choice:
        """One of the choices that were picked, as a set of its own."""
        job, felt, asked, pool, namings = self.job, self.felt, self.asked, self.pool, self.namings
        chosen = [self.places[k] for k in places]
        icons, middle = [job.icons[k] for k in chosen], self.middle[np.ix_(chosen, chosen)]
        names = [icon.name for icon in icons]
        a, b = nearest_two(middle)
        task = task_among(job.task, self.left, chosen)
        own = appraise(icons, job.rig, crowd=self.crowd, task=task)
        step()
        value = picked.value
        if namings is not None and places != picked.chosen:
            value = float(namings.values(places, len(places) - 1, places[-1:], asked.objective)[0])
        found = None
        if draws:
            onset_s = felt.detection.onset_s[chosen]
            named, alert = own.confused, own.each_felt_and_named
            alone = Nominal(
                own.proportion_correct, own.information_bits, felt.detected[chosen], middle, onset_s, named, alert
            )
            found = new_laboratory(
                Tracks.of(icons, job.layout), job.end_s, self.people, alone, job.memory,
                tracking=job.tracking, model=self.model, draws=draws, seed=job.seed, task=task, step=step,
            )  # fmt: skip
        return Choice(
            icons=tuple(names),
            objective=asked.objective,
            value=value,
            optimal=picked.optimal,
            bound=max(picked.bound, value),
            worst_pair=(names[a], names[b]),
            total_s=math.fsum(pool.durations_s[list(places)]),
            total_J=math.fsum(pool.energies_J[list(places)]),
            pool=len(self.places),
            people=len(self.people) if namings is None else len(namings.lapse),
            seen=picked.seen,
            excluded=self.excluded,
            at_own_range=own,
            new_laboratory=found,
        )
