"""What keeps a goal out of reach of a rig: changes of the rig that were tried, and how near each comes."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..observer.observer_model import ObserverModel
from ..ranking.rank import rank
from .goal import Goal
from .goal_result import GoalPartResult, GoalResult, judge_goal
from .request import ChoiceError
from .search import search
from .subset_identification import Objective

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

    def __repr__(self) -> str:
        return f"Trial({self.words}: {'met' if self.met else f'nearer by {self.gain:.2f}'})"


@dataclass(frozen=True, slots=True)
class Advice:
    """What was tried for a goal that is not met: changes, and the same comparison without a change.

    Attributes
    ----------
    baseline
        The best set of all that were found, on the rig as it is.
    again
        By how much that set is nearer to the goal than the given one: the gain of searching more, without a change.
    trials
        Every change that could be tried, the most helpful first.
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
    step: Callable[[int, int], None] | None = None,
) -> Advice:
    """Try changes of the rig, and goals relaxed in time and energy, on a given set and in equally short searches.

    A change counts by the best set that can be played with it, out of the given one, that of a short search without a
    change and that of its own short search. It is compared with the best of all these sets on the rig as it is, so that
    neither a second search nor its luck counts as a gain. A change that the rig refuses is left out.
    """
    model = ObserverModel.of(observer)
    draws = model.most_draws(DRAWS)

    def searched(where: Rig, wanted: Goal) -> IconSet | None:
        try:
            return search(
                icons, where, count=count, objective=objective, evaluations=EVALUATIONS, people=PEOPLE, seed=seed,
                tracking=tracking, norm=norm, must=must, goal=wanted, parameters=draws,
                observer=model,
            ).found  # fmt: skip
        except ChoiceError:
            return None

    def judged(sets: Sequence[IconSet | None], where: Rig, wanted: Goal) -> GoalResult | None:
        """The best that these sets come to, of those that can be played."""
        results = []
        for each in sets:
            if each is None:
                continue
            ranking = rank(
                each, where, people=PEOPLE, parameters=draws, seed=seed, tracking=tracking, norm=norm, observer=model,
            )  # fmt: skip
            if all(icon.playable for icon in ranking.icons):
                results.append(judge_goal(wanted, ranking))
        return min(results, key=shortfall, default=None)

    changed = [*_rigs(rig), *((text, words, rig, relaxed) for text, words, relaxed in _relaxed(goal))]
    total = len(changed) + 2

    def report(done: int) -> None:
        if step is not None:
            step(done, total)

    plain = searched(rig, goal)
    report(1)
    reached: list[tuple[str, str, GoalResult]] = []
    others: list[IconSet | None] = [plain]
    for done, (change, words, where, wanted) in enumerate(changed, 2):
        asked = goal if wanted is None else wanted
        others.append(searched(where, asked))
        result = judged([given, plain, others[-1]], where, asked)
        if result is not None:
            reached.append((change, words, result))
        report(done)
    alone = judged([given], rig, goal)
    baseline = judged([given, *others], rig, goal) or alone
    report(total)
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


def _rigs(rig: Rig) -> list[tuple[str, str, Rig, Goal | None]]:
    from thermicon.circuit.rig.rigfile import RigError

    made: list[tuple[str, str, Rig, Goal | None]] = []
    most = _most_of_the_module(rig)
    for key, value_of, factor, words in FACTORS:
        try:
            now = value_of(rig)
            limit, limited = most.get(key, (math.inf, ""))
            if now >= limit:
                continue
            value, said = (factor * now, words) if factor * now <= limit else (limit, limited)
            changed = rig.with_(**{key: value})
        except RigError:  # a thermode has no driver; a module may not allow the value
            continue
        made.append((f"{key}={value:g}", said, changed, None))
    return made


def _most_of_the_module(rig: Rig) -> dict[str, tuple[float, str]]:
    """What a module with a name allows at most, by key, with words for it."""
    from thermicon.circuit.rig.modules import build_of

    name = json.loads(rig.document).get("module", {}).get("name")
    if name is None:
        return {}
    build = build_of(name)
    most = {"driver.current_limit_A": (build.i_max_A, f"the module's Imax of {build.i_max_A:g} A")}
    if build.face_cm2 is not None:
        most["contact.area_cm2"] = (build.face_cm2, f"contact with the module's whole face of {build.face_cm2:g} cm²")
    return most


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
