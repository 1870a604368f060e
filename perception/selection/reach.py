"""What keeps a goal out of reach of a rig: changes of the rig that were tried, and how near each comes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..kernels.parallel import Progress, step_counter
from ..observer.observer_model import ObserverModel
from ..ranking.rank import rank
from .goal import Goal
from .goal_result import GoalPartResult, GoalResult, judge_goal
from .request import ChoiceError, Objective
from .search import search

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

EVALUATIONS, PEOPLE, DRAWS = 160, 24, 32
"""Of each trial: fewer than of a search, since trials are compared with one another only."""
LEAST_GAIN = 0.01
"""A change that comes nearer by less than 1 % of what is wanted does not help."""
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

    `gain` is by how much the part of the goal that misses most (in shares of what is wanted) is nearer than without the
    change, by the same people and draws; `result` is that of the best set that can be played with the change.
    """

    change: str
    words: str
    met: bool
    gain: float
    result: GoalResult


@dataclass(frozen=True, slots=True)
class Advice:
    """What was tried for a goal that is not met: changes, the most helpful first, and the same without a change.

    `baseline` is that of the best set of all that were found, on the rig as it is; `again` is by how much that set is
    nearer to the goal than the given one: the gain of searching more, without a change.
    """

    baseline: GoalResult
    again: float
    trials: tuple[Trial, ...]

    @property
    def helpful(self) -> tuple[Trial, ...]:
        """Changes that come nearer than the rig as it is."""
        return tuple(trial for trial in self.trials if trial.gain > LEAST_GAIN)

    @property
    def idle(self) -> tuple[Trial, ...]:
        """Changes that do not."""
        return tuple(trial for trial in self.trials if trial.gain <= LEAST_GAIN)


def what_would_help(
    icons: IconSet,
    rig: Rig,
    goal: Goal,
    given: IconSet,
    *,
    objective: Objective = "worst",
    count: int | None = None,
    must: Sequence[str] | None = None,
    seed: int = 0,
    tracking: str | None = None,
    norm: str = "episodes",
    observer: ObserverModel | Path | str | None = None,
    step: Progress | None = None,
) -> Advice:
    """Try changes of the rig, and goals relaxed in time and energy, on a given set and in equally short searches.

    A change counts by the best set that can be played with it, out of the given one, that of a short search without a
    change and that of its own short search. It is compared with the best of all these sets on the rig as it is, so that
    neither a second search nor its luck counts as a gain. A change that the rig refuses is left out.
    """
    model = ObserverModel.of(observer)
    how: dict[str, Any] = {
        "people": PEOPLE, "parameters": model.most_draws(DRAWS), "seed": seed, "tracking": tracking, "norm": norm,
        "observer": model,
    }  # fmt: skip

    def searched(where: Rig, wanted: Goal) -> list[IconSet]:
        asked: dict[str, Any] = {"count": count, "objective": objective, "must": must, "evaluations": EVALUATIONS}
        try:
            return [search(icons, where, goal=wanted, **asked, **how).found]
        except ChoiceError:
            return []

    def judged(sets: Sequence[IconSet], where: Rig, wanted: Goal) -> GoalResult | None:
        """The best that these sets come to, of those that can be played."""
        rankings = [rank(each, where, **how) for each in sets]
        playable = [each for each in rankings if all(icon.playable for icon in each.icons)]
        return min((judge_goal(wanted, each) for each in playable), key=shortfall, default=None)

    changed = [*_rigs(rig, goal), *_relaxed(rig, goal)]
    report = step_counter(step, len(changed) + 2)
    plain = searched(rig, goal)
    report()
    reached: list[tuple[str, str, GoalResult]] = []
    others = plain
    for change, words, where, wanted in changed:
        own = searched(where, wanted)
        others = [*others, *own]
        result = judged([given, *plain, *own], where, wanted)
        if result is not None:
            reached.append((change, words, result))
        report()
    alone = judged([given], rig, goal)
    baseline = judged([given, *others], rig, goal)
    report()
    if baseline is None:
        raise ChoiceError("the given set cannot be played on this rig: there is nothing to compare changes with")
    before = shortfall(baseline)
    again = 0.0 if alone is None else shortfall(alone) - before
    trials = [Trial(change, words, result.met, before - shortfall(result), result) for change, words, result in reached]
    return Advice(baseline, again, tuple(sorted(trials, key=lambda trial: (not trial.met, -trial.gain))))


def shortfall(result: GoalResult) -> float:
    """How far the part that misses most is from what is wanted, as a share of that; 0 where the goal is met."""
    return max(map(missing, result.parts), default=0.0)


def missing(each: GoalPartResult) -> float:
    """How far a part is from what is wanted, as a share of that, at most 1; 0 where it is met."""
    if each.met:
        return 0.0
    wanted = max(abs(each.part.limit), 1e-9)
    return 1.0 if each.value is None else min(1.0, abs(each.value - each.part.limit) / wanted)


def _rigs(rig: Rig, goal: Goal) -> list[tuple[str, str, Rig, Goal]]:
    """Changes of the rig that it allows, for the same goal."""
    from thermicon.circuit.rig.rigfile import RigError

    made = []
    for key, value_of, factor, words in FACTORS:
        try:
            value = factor * value_of(rig)
            made.append((f"{key}={value:g}", words, rig.with_(**{key: value}), goal))
        except RigError:  # a thermode has no driver; a module may not allow the value
            continue
    return made


def _relaxed(rig: Rig, goal: Goal) -> list[tuple[str, str, Rig, Goal]]:
    """The goal with half as much time or energy again, where it limits them."""
    made = []
    for quantity in ("time", "energy"):
        if goal.of(quantity) is not None:
            parts = [
                replace(part, limit=1.5 * part.limit) if part.quantity == quantity else part for part in goal.parts
            ]
            text = next(part.text for part in parts if part.quantity == quantity)
            made.append((text, f"half as much {quantity} again", rig, Goal(tuple(parts))))
    return made
