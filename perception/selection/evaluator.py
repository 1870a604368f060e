"""How a search evaluates pools of icons, by the nominal person or by people, and the sets that it holds at its end.

A goal for 95 % of people is about what 95 % of pairs of a draw of the posterior and a person reach: the sets that are
held at the end are judged with as many draws as in `rank`, and all people.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..identification.population import ReceptorTemperatures, memory_dprime, respond
from ..identification.task import USUAL
from ..observer.observer import Norm, Observer
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from ..ranking.rank import rank
from .appraise import Appraisal, appraise
from .goal import Goal, GoalPart
from .pool import POOL_HZ, Pool
from .request import Objective
from .subset_identification import SubsetIdentification

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

PEOPLE = 24
JUDGED = ("correct", "bits", "d_prime")
"""Quantities that sets are chosen by for their people's mean; `detected` only for a share of people."""


@dataclass(frozen=True, slots=True)
class Evaluator:
    """d′ within a pool and scores of its subsets, for the nominal person unless there is a `crowd`.

    `rigs` are those of the people of the crowd. `goal` says what is asked of single icons and of totals.
    """

    rig: Rig
    objective: Objective
    norm: Norm
    seed: int
    observer: Observer
    tracking: str | None = None
    goal: Goal | None = None
    rigs: tuple[Rig, ...] = ()
    crowd: People | None = None

    def with_people(self, model: ObserverModel) -> Evaluator:
        """The first 24 people of the seed, who differ in contact, skin and thresholds."""
        crowd = model.people(PEOPLE, self.seed)
        return replace(self, rigs=tuple(crowd.rigs(self.rig)), crowd=crowd)

    @property
    def totals(self) -> tuple[float | None, float | None]:
        """Most time, s, and energy, J, of all icons together."""
        return (None, None) if self.goal is None else self.goal.totals

    def pool(self, icons: Sequence[Icon]) -> Pool:
        """Icons on the nominal rig."""
        return Pool.of(icons, self.rig, self.observer)

    def d_prime(self, pool: Pool) -> Array:
        """d′ (people, icons, icons) from memory."""
        if self.crowd is None:
            return pool.dprimes(pool, self.norm, self.observer)[None]
        met = ReceptorTemperatures.simulated(pool.icons, self.rigs, self.rig, pool.end_s, POOL_HZ, self.tracking)
        felt = respond(met, self.crowd, self.observer, detection=False)
        return memory_dprime(felt, self.norm, self.crowd.memory, self.observer, USUAL)

    def namings(self, d_prime: Array, pool: Pool) -> SubsetIdentification:
        """Who is named what, for the objectives that count errors."""
        lapse = np.array([self.observer.lapse]) if self.crowd is None else self.crowd.lapse
        return SubsetIdentification.of(d_prime, lapse, pool.durations_s, self.seed)


@dataclass(frozen=True, slots=True)
class FinalJudge:
    """How the last sets of a search are judged: by the parts of a goal about what people perceive, then an objective.

    `by` is the evaluator of the search, `crowd` all people. A goal for a share of people needs draws of the posterior.
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
    def words(self) -> str:
        """What sets are judged by, in words: parts of the goal, or else the objective."""
        return " and ".join(map(in_words, self.parts)) or self.by.objective

    def appraisal(self, icons: Sequence[Icon]) -> Appraisal:
        """What all people make of a set."""
        by = self.by
        return appraise(
            icons, by.rig, people=self.crowd, seed=by.seed, tracking=by.tracking, norm=by.norm, observer=by.observer
        )

    def merit(self, icons: Sequence[Icon], scores: Appraisal) -> tuple[float, ...]:
        """What the better set has more of: nearness to the goal, then values of its parts, then of the objective."""
        persons = self._persons(icons) if any(part.people is not None for part in self.parts) else {}
        means = {"correct": scores.proportion_correct, "bits": scores.information_bits, "d_prime": scores.d_prime}
        values = [
            means[part.quantity]
            if part.people is None
            else float(np.quantile(persons[part.quantity], 1.0 - part.people))
            for part in self.parts
        ]
        missing = [max(0.0, 1.0 - value / part.limit) for part, value in zip(self.parts, values, strict=True)]
        return (-max(missing, default=0.0), *values, scores.value(self.by.objective))

    def _persons(self, icons: Sequence[Icon]) -> dict[str, Array]:
        """Values of single people of all draws, as in `rank`."""
        from thermicon.icons import IconSet

        by, people = self.by, len(self.crowd)
        members = IconSet("", "", icons[0].context, icons[0].metadata, tuple(icons))
        how: dict[str, Any] = {"seed": by.seed, "tracking": by.tracking, "norm": by.norm, "observer": self.model}
        found = rank(members, by.rig, people=people, parameters=self.draws, **how).new_laboratory
        return {} if found is None else found.persons


def in_words(part: GoalPart) -> str:
    """What a part is about, such as correct for 95 % of people."""
    return part.quantity + ("" if part.people is None else f" for {100.0 * part.people:g} % of people")
