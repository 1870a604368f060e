"""What keeps a goal out of reach of a rig: changes of the rig that were tried, and how near each comes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..observer.observer_model import ObserverModel
from ..selection.goal import Goal
from ..selection.request import ChoiceError
from ..selection.search import search
from ..selection.subset_identification import Objective
from .goal_result import GoalResult
from .rank import rank

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

EVALUATIONS, PEOPLE, DRAWS = 160, 24, 32
"""Of each trial: fewer than of a search, since trials are compared with one another only."""
FACTORS: tuple[tuple[str, Callable[[Rig], float], float, str], ...] = (
    ("contact.area_cm2", lambda rig: rig.contact.area_m2 * 1e4, 2.0, "twice the area of contact"),
    ("driver.current_limit_A", lambda rig: rig.driver.current_max_A, 1.5, "one and a half times the current"),
    ("driver.voltage_limit_V", lambda rig: rig.driver.voltage_limit_V, 1.5, "one and a half times the voltage"),
    (
        "heat_sink.resistance_K_per_W",
        lambda rig: rig.heat_sink.resistance_K_per_W,
        0.5,
        "half the heat sink's resistance",
    ),
    ("contact.resistance_m2K_per_W", lambda rig: rig.contact.resistance_m2K_per_W, 0.5, "half the contact resistance"),
)
"""Keys with their values, the factor that is tried, and the change in words."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A change of the rig or of the goal, how far it comes, and whether the goal is then met.

    `gain` is by how much the part of the goal that misses most (in shares of what is wanted) is nearer than before.
    """

    change: str
    words: str
    met: bool
    gain: float
    result: GoalResult | None

    def __repr__(self) -> str:
        return f"Trial({self.words}: {'met' if self.met else f'nearer by {self.gain:.2f}'})"


def what_would_help(
    icons: IconSet,
    rig: Rig,
    goal: Goal,
    *,
    objective: Objective = "worst",
    count: int | None = None,
    seed: int = 0,
    norm: str = "episodes",
    observer: ObserverModel | Path | str | None = None,
    step: Callable[[int, int], None] | None = None,
) -> tuple[Trial, ...]:
    """Search again with each change of the rig, and with goals relaxed in time and energy; the most helpful first.

    A change that the rig refuses, or with which nothing can be found, is left out.
    """
    model = ObserverModel.of(observer)

    def missing(where: Rig, wanted: Goal) -> tuple[GoalResult, float] | None:
        try:
            found = search(
                icons, where, count=count, objective=objective, evaluations=EVALUATIONS, people=PEOPLE, seed=seed,
                norm=norm, goal=wanted, observer=model,
            )  # fmt: skip
        except ChoiceError:
            return None
        draws = model.most_draws(DRAWS)
        ranking = rank(
            found.found, where, people=PEOPLE, parameters=draws, seed=seed, norm=norm, goal=wanted, observer=model
        )
        assert ranking.goal is not None
        return ranking.goal, shortfall(ranking.goal)

    now = missing(rig, goal)
    before = 1.0 if now is None else now[1]
    trials: list[Trial] = []
    changed = [*_rigs(rig), *((text, words, rig, relaxed) for text, words, relaxed in _relaxed(goal))]
    for done, (change, words, where, wanted) in enumerate(changed):
        tried = missing(where, wanted if wanted is not None else goal)
        if tried is not None:
            trials.append(Trial(change, words, tried[0].met, before - tried[1], tried[0]))
        if step is not None:
            step(done + 1, len(changed))
    return tuple(sorted(trials, key=lambda trial: (not trial.met, -trial.gain)))


def shortfall(result: GoalResult) -> float:
    """How far the part that misses most is from what is wanted, as a share of that; 0 where the goal is met."""
    missed = [0.0]
    for each in result.parts:
        if not each.met:
            wanted = max(abs(each.part.limit), 1e-9)
            missed.append(1.0 if each.value is None else min(1.0, abs(each.value - each.part.limit) / wanted))
    return max(missed)


def _rigs(rig: Rig) -> list[tuple[str, str, Rig, Goal | None]]:
    from thermicon.circuit import RigError

    made: list[tuple[str, str, Rig, Goal | None]] = []
    for key, value_of, factor, words in FACTORS:
        try:
            value = factor * value_of(rig)
            changed = rig.with_(**{key: value})
        except RigError:  # a thermode has no driver; a module may not allow the value
            continue
        made.append((f"{key}={value:g}", words, changed, None))
    return made


def _relaxed(goal: Goal) -> list[tuple[str, str, Goal]]:
    """The goal with half as much time or energy again, where it limits them."""
    made = []
    for quantity, words in (("time", "half as much time again"), ("energy", "half as much energy again")):
        if goal.of(quantity) is not None:
            parts = tuple(
                type(part)(part.quantity, 1.5 * part.limit, part.people) if part.quantity == quantity else part
                for part in goal.parts
            )
            relaxed = Goal(parts)
            text = next(part.text for part in relaxed.parts if part.quantity == quantity)
            made.append((text, words, relaxed))
    return made
