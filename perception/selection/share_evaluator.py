"""The evaluator of a goal for a share of people: pairs of a draw of the posterior and a person, as `rank` judges them.

A goal for 95 % of people is about what 95 % of such pairs reach. Two hundred of them are enough to climb by; the sets
that are held at the end are judged with all draws.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..identification.drawn_laboratories import DrawnLaboratories
from ..identification.population import ReceptorTemperatures, memory_dprime, respond
from ..identification.task import USUAL
from ..observer.observer import Norm
from ..observer.observer_model import ObserverModel
from .evaluators import ANYTHING, PEOPLE, PopulationEvaluator
from .goal import GoalPart
from .nominal import RATE_HZ, end_of
from .search_request import SearchRequest
from .subset_identification import Objective, SubsetIdentification

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

DRAWS, OF_EACH = 32, 6
"""Each of 32 laboratories invites 6 of 24 people, four of them in turn all: 192 pairs."""
EVERY = 2
"""Simulated at 25 Hz and judged at 12.5 Hz, the rate at which `rank` judges draws."""


class ShareEvaluator(PopulationEvaluator):
    """What a share of people reaches, people and uncertainty of the model together, of `correct` or `bits`."""

    def __init__(
        self,
        rig: Rig,
        part: GoalPart,
        norm: Norm,
        seed: int,
        model: ObserverModel,
        draws: int,
        tracking: str | None,
        request: SearchRequest = ANYTHING,
    ) -> None:
        objective: Objective = "bits" if part.quantity == "bits" else "correct"
        super().__init__(rig, objective, norm, seed, model, tracking, request)
        self.share = part.people
        laboratories = DrawnLaboratories.of(model, norm, min(draws, DRAWS), seed)
        self.groups = []
        for place in range(len(laboratories)):
            observer, people = laboratories.at(place, PEOPLE)
            first = OF_EACH * place % PEOPLE
            self.groups.append((slice(first, first + OF_EACH), observer, people.part(first, first + OF_EACH)))
        self.lapse = np.concatenate([people.lapse for _, _, people in self.groups])

    def pairwise_dprime(self, icons: Sequence[Icon]) -> Array:
        """d′ (pairs of a draw and a person, icons, icons) from memory; safety and reach are those of the rig."""
        self._sensed(icons)
        end = end_of(self._durations(icons).tolist())
        met = ReceptorTemperatures.simulated(icons, self.rigs, self.rig, end, RATE_HZ, self.tracking)
        found = []
        for persons, observer, people in self.groups:
            cold, warm = met.cold_C[persons, :, ::EVERY], met.warm_C[persons, :, ::EVERY]
            played = replace(met, cold_C=cold, warm_C=warm, time_s=met.time_s[::EVERY])
            felt = respond(played, people, observer, detection=False)
            found.append(memory_dprime(felt, self.norm, people.memory, observer, USUAL))
        return np.concatenate(found)

    def namings(self, d_prime: Array, icons: Sequence[Icon]) -> SubsetIdentification:
        """Who is named what by all pairs of a draw and a person, scored by what the share of them reaches."""
        return SubsetIdentification.of(
            d_prime, self.lapse, self._durations(icons), self.seed, len(d_prime), share=self.share
        )
