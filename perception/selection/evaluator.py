"""The evaluator of a pool: the nominal person, which is fast, or people; both give d′ and who is named what.

A goal for 95 % of people is about what 95 % of pairs of a draw of the posterior and a person reach. Two hundred of them
are enough to climb by; the sets that are held at the end are judged with all draws.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..identification.laboratory_draws import DrawnLaboratories
from ..identification.population import ReceptorTemperatures, memory_dprime, respond
from ..identification.task import USUAL
from ..observer.observer import Norm, Observer
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from .goal import Goal, GoalPart
from .pool import RATE_HZ, Pool
from .subset_identification import Objective, SubsetIdentification

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

PEOPLE = 24
DRAWS, OF_EACH = 32, 6
"""Each of 32 laboratories invites 6 of 24 people, four of them in turn all: 192 pairs."""
EVERY = 2
"""Simulated at 25 Hz and judged at 12.5 Hz, the rate at which `rank` judges draws."""


@dataclass(frozen=True, slots=True)
class Evaluator:
    """d′ within a pool and scores of its subsets, for the nominal person unless there are `groups`.

    A group is some of the people who were simulated, `rigs`, with the observer who judges them and what differs between
    them; every k-th instant is judged. A `share` of all these people reaches the score of a subset; None: their mean.
    `goal` says what is asked of single icons and of totals.
    """

    rig: Rig
    objective: Objective
    norm: Norm
    seed: int
    observer: Observer
    tracking: str | None = None
    goal: Goal | None = None
    rigs: tuple[Rig, ...] = ()
    groups: tuple[tuple[slice, Observer, People], ...] = ()
    every: int = 1
    share: float | None = None

    def with_people(self, model: ObserverModel) -> Evaluator:
        """The first 24 people of the seed, who differ in contact, skin and thresholds."""
        crowd = model.people(PEOPLE, self.seed)
        return replace(self, rigs=tuple(crowd.rigs(self.rig)), groups=((slice(None), self.observer, crowd),))

    def with_share(self, part: GoalPart, model: ObserverModel, draws: int) -> Evaluator:
        """What the share of people of a goal reaches, people and uncertainty of the model together."""
        laboratories = DrawnLaboratories.of(model, self.norm, min(draws, DRAWS), self.seed)
        groups = []
        for place in range(len(laboratories)):
            observer, people = laboratories.at(place, PEOPLE)
            first = OF_EACH * place % PEOPLE
            groups.append((slice(first, first + OF_EACH), observer, people.part(first, first + OF_EACH)))
        return replace(self, groups=tuple(groups), every=EVERY, share=part.people)

    def pool(self, icons: Sequence[Icon]) -> Pool:
        """Icons on the nominal rig."""
        return Pool.of(icons, self.rig, self.observer)

    def d_prime(self, pool: Pool) -> Array:
        """d′ (people, icons, icons) from memory."""
        if not self.groups:
            return pool.dprimes(pool, self.norm, self.observer)[None]
        met = ReceptorTemperatures.simulated(pool.icons, self.rigs, self.rig, pool.end_s, RATE_HZ, self.tracking)
        found = []
        for persons, observer, people in self.groups:
            cold, warm = met.cold_C[persons, :, :: self.every], met.warm_C[persons, :, :: self.every]
            played = replace(met, cold_C=cold, warm_C=warm, time_s=met.time_s[:: self.every])
            felt = respond(played, people, observer, detection=False)
            found.append(memory_dprime(felt, self.norm, people.memory, observer, USUAL))
        return np.concatenate(found)

    def namings(self, d_prime: Array, pool: Pool) -> SubsetIdentification:
        """Who is named what, for the objectives that count errors."""
        lapse = [people.lapse for _, _, people in self.groups] or [np.array([self.observer.lapse])]
        return SubsetIdentification.of(
            d_prime, np.concatenate(lapse), pool.durations_s, self.seed, len(d_prime), share=self.share
        )
