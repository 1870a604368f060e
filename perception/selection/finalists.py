"""Sets that a search holds at its end, judged by the goal itself: what a goal for a share of people asks of each.

What a share of people reaches is climbed by with a few draws of the posterior; the last few sets are judged with as
many as in `rank`, and with all people.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..identification.laboratory import Nominal, new_laboratory
from ..identification.laboratory_draws import EVERY, PEOPLE
from ..identification.population import RATE_HZ, ReceptorTemperatures, run_end_s
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from .appraise import Appraisal, appraise
from .evaluator import Evaluator
from .goal import GoalPart

if TYPE_CHECKING:
    from thermicon.icons import Icon

JUDGED = ("correct", "bits", "d_prime")
"""Quantities that sets are chosen by for their people's mean; `detected` only for a share of people."""


@dataclass(frozen=True, slots=True)
class FinalJudge:
    """How the last sets of a search are judged: by the parts of a goal about what people perceive, then an objective.

    `by` is the evaluator of the search, `crowd` all people. Raises `GoalError` for a goal for a share of people without
    draws of the posterior.
    """

    by: Evaluator
    model: ObserverModel
    crowd: People
    draws: int

    def __post_init__(self) -> None:
        if self.by.goal is not None:
            self.by.goal.check_draws(0 if self.draws < 2 or self.model.posterior is None else self.draws)

    @property
    def parts(self) -> tuple[GoalPart, ...]:
        """Parts of the goal that sets are judged by, those for a share of people first."""
        held = () if self.by.goal is None else self.by.goal.parts
        some = [part for part in held if part.quantity in JUDGED or part.people is not None]
        return tuple(sorted(some, key=lambda part: (part.people is None, -(part.people or 0.0))))

    @property
    def climbed(self) -> GoalPart | None:
        """The part for a share of people that sets are climbed by: the first about names; None without one."""
        return next((part for part in self.parts if part.people is not None and part.quantity in JUDGED), None)

    @property
    def words(self) -> str | None:
        """What sets are judged by besides the objective, in words; None for nothing."""
        return " and ".join(map(in_words, self.parts)) or None

    def appraisal(self, icons: Sequence[Icon]) -> Appraisal:
        """What all people make of a set."""
        by = self.by
        return appraise(
            icons, by.rig, people=self.crowd, seed=by.seed, tracking=by.tracking, norm=by.norm, observer=by.observer
        )

    def merit(self, icons: Sequence[Icon], scores: Appraisal) -> tuple[float, ...]:
        """What the better set has more of: nearness to the goal, then values of its parts, then of the objective."""
        persons = self._persons(icons, scores) if any(part.people is not None for part in self.parts) else {}
        values = [_value(part, scores, persons) for part in self.parts]
        missing = [max(0.0, 1.0 - value / part.limit) for part, value in zip(self.parts, values, strict=True)]
        return (-max(missing, default=0.0), *values, scores.value(self.by.objective))

    def _persons(self, icons: Sequence[Icon], scores: Appraisal) -> dict[str, Array]:
        """Values of single people of all draws, laid about what all people reach, as in `rank`."""
        from thermicon.circuit.solver.simulate import duration_s

        by = self.by
        end = run_end_s(duration_s(icon, by.rig) for icon in icons)
        few = self.crowd.part(0, min(PEOPLE, len(self.crowd)))
        met = ReceptorTemperatures.simulated(icons, few.rigs(by.rig), by.rig, end, RATE_HZ, by.tracking)
        played = met.thinned(len(few), EVERY)
        n = len(icons)
        # Single people are laid about correct and bits alone; the rest of the prediction is not used.
        predicted = Nominal(
            scores.proportion_correct, scores.information_bits, np.zeros(n), np.zeros((n, n)), np.zeros(n)
        )
        return new_laboratory(
            played, self.crowd, predicted, by.norm, model=self.model, draws=self.draws, seed=by.seed
        ).persons


def _value(part: GoalPart, scores: Appraisal, persons: dict[str, Array]) -> float:
    if part.people is not None:
        return float(np.quantile(persons[part.quantity], 1.0 - part.people))
    return {
        "correct": scores.proportion_correct,
        "bits": scores.information_bits,
        "d_prime": scores.d_prime,
    }[part.quantity]


def in_words(part: GoalPart) -> str:
    """What a part is about.

    >>> from thermicon.perception import Goal
    >>> in_words(Goal.parse("correct >= 90 % for 95 % of people").parts[0])
    'correct for 95 % of people'
    """
    return part.quantity + ("" if part.people is None else f" for {100.0 * part.people:g} % of people")
