"""The frontier of a pool: how well the best few icons of it are distinguished, by how many they are.

For each number of icons it is the choice of `choose`, judged by people who know only these icons. What 95 % of people
reach depends, as in a goal, on people and on the uncertainty of the model.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..drawn import Drawn
from ..identification.laboratory import DRAWS
from ..kernels.parallel import Progress, step_counter
from ..observer.channels import USUAL_NORM
from ..observer.observer_model import ObserverModel
from ..ranking.rank import rank
from ..ranking.ranking import Ranking
from .appraise import REACHED_BY
from .choose import Choice, Chooser
from .goal import Goal
from .goal_result import GoalResult, judge_goal
from .request import ChoiceError, Objective, Selection

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

MOST = 12
"""Most icons that a choice has unless more are asked for."""


@dataclass(frozen=True, slots=True)
class FrontierPoint:
    """The best choice of one size, by names of its `icons`.

    `proportion_correct` and `information_bits` are means over people, `low` the proportion correct that 95 % of them
    reach at the nominal constants, `low_with_model` with the uncertainty of the model too (None: without draws);
    `d_prime` is the median of the worst pair, `total_J` NaN on a thermode, which states no energy. `optimal` says
    whether no other choice of the size is better; `amber` icons pass a soft limit of safety.
    """

    icons: tuple[str, ...]
    proportion_correct: float
    low: float
    information_bits: float
    d_prime: float
    total_s: float
    total_J: float
    optimal: bool
    low_with_model: float | None = None
    amber: tuple[str, ...] = ()
    goal: GoalResult | None = None

    @property
    def reached(self) -> float:
        """What 95 % of people reach: with the uncertainty of the model, where there are draws of it."""
        return self.low if self.low_with_model is None else self.low_with_model


@dataclass(frozen=True, slots=True)
class Frontier(Drawn):
    """Best choices of rising size, the `points`, from one pool, and how they were made and judged.

    Of the `pool` icons that could be chosen, others were `excluded` for a reason each; `draws` of the posterior are
    behind `low_with_model`.

    See Also
    --------
    frontier : Makes it.
    """

    rig: str
    rig_changes: tuple[str, ...]
    people: int
    seed: int
    norm: str
    objective: Objective
    pool: int
    excluded: tuple[tuple[str, str], ...]
    points: tuple[FrontierPoint, ...]
    draws: int = 0
    goal: Goal | None = None

    def rows(self) -> list[dict[str, Any]]:
        """One plain row for each size."""
        return [
            {
                "icons": len(point.icons),
                "proportion_correct": point.proportion_correct,
                "proportion_correct_95_percent_of_people": point.low,
                "information_bits": point.information_bits,
                "d_prime": point.d_prime,
                "total_s": point.total_s,
                "total_J": point.total_J,
                "proven_best": point.optimal,
                "names": " ".join(point.icons),
                "proportion_correct_95_percent_of_people_and_model": point.low_with_model,
                "amber": " ".join(point.amber),
                "meets_goal": None if point.goal is None else point.goal.met,
            }
            for point in self.points
        ]

    def to_frame(self) -> pd.DataFrame:
        """The rows as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows())

    def __repr__(self) -> str:
        sizes = f"{len(self.points[0].icons)} to {len(self.points[-1].icons)}" if self.points else "no"
        return f"Frontier({sizes} of {self.pool} icons by {self.objective} on {self.rig}, {self.people} people)"


def frontier(
    icons: IconSet,
    rig: Rig,
    *,
    most: int = MOST,
    objective: Objective = "correct",
    people: int = 200,
    seed: int = 0,
    tracking: str | None = None,
    norm: str = USUAL_NORM,
    goal: Goal | str | None = None,
    parameters: int | None = None,
    observer: ObserverModel | Path | str | None = None,
    progress: Progress | None = None,
) -> Frontier:
    """Choose the best 2, 3, … icons of a pool, and judge each choice with people who know it alone.

    Parameters
    ----------
    icons
        The pool; families count with all their members.
    rig
        The rig that plays it.
    most
        Largest choice; fewer where the pool has fewer icons that can be played.
    objective
        What a choice maximises: `worst` (d′ of the worst pair), `correct`, `bits` or `bits-per-s`.
    people, seed, tracking, norm
        As in `rank`.
    goal
        What is wanted: icons are left out that miss its `safety`, or for the nominal person its `detected` or `onset`,
        its `time` and `energy` are kept, and every choice is judged by it.
    parameters
        Draws from the posterior for what 95 % of people reach, as in `rank` (None: 128, or as many as there are; 0:
        none).
    observer
        An observer or its file, as in `rank`.
    progress
        Called with (steps done, steps in all).

    Returns
    -------
    Frontier
        One point for each size that can be chosen.

    Raises
    ------
    ChoiceError
        Where not even two icons can be chosen, or no two keep the limits.
    ValueError
        For an unknown norm, a single draw, and more draws than there are; a `GoalError` for a goal for a share of
        people without draws.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> found = frontier(read_cue("six-icons"), Rig.load("thenar"), people=4, most=3, parameters=0)
    >>> [len(point.icons) for point in found.points]
    [2, 3]
    """
    model = ObserverModel.of(observer)
    if most < 2:
        raise ChoiceError(f"a choice of {most} has no pair to compare: give 2 or more")
    wanted = Goal.parse(goal) if isinstance(goal, str) else goal
    draws = model.draw_count(parameters, DRAWS)
    if wanted is not None:
        wanted.check_draws(draws)
    time, energy = (None, None) if wanted is None else wanted.totals
    asked = Selection(2, objective, most_s=time, most_J=energy)
    how: dict[str, Any] = {"people": people, "seed": seed, "tracking": tracking, "norm": norm, "observer": model}
    ranking = rank(icons, rig, parameters=0, progress=progress, **how)
    chooser = Chooser(ranking, asked, wanted)
    largest = min(most, len(chooser.pool))
    step = step_counter(progress, (largest - 1) * (1 + draws))
    points: list[FrontierPoint] = []
    for count in range(2, largest + 1):
        choice = chooser.best(count, draws, step)
        if choice is None:  # nor will more keep the limits
            break
        points.append(_point(choice, ranking, wanted))
    if not points:
        raise ChoiceError(chooser.pool.nothing_fits(asked))
    return Frontier(
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        people=people,
        seed=seed,
        norm=norm,
        objective=objective,
        pool=len(chooser.pool),
        excluded=chooser.excluded,
        points=tuple(points),
        draws=draws,
        goal=wanted,
    )


def _point(choice: Choice, ranking: Ranking, goal: Goal | None) -> FrontierPoint:
    """A choice in the numbers of a frontier, and a goal judged for it."""
    own, elsewhere = choice.at_own_range, choice.new_laboratory
    low = None if elsewhere is None else float(np.quantile(elsewhere.persons["correct"], 1.0 - REACHED_BY))
    return FrontierPoint(
        icons=choice.icons,
        proportion_correct=own.proportion_correct,
        low=own.reached,
        information_bits=own.information_bits,
        d_prime=own.d_prime,
        total_s=choice.total_s,
        total_J=choice.total_J,
        optimal=choice.optimal,
        low_with_model=low,
        amber=tuple(icon.name for icon in ranking.icons if icon.name in choice.icons and icon.cautions),
        goal=None if goal is None else judge_goal(goal, ranking, choice),
    )
