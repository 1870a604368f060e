"""Evaluators of a search: the nominal person, which is fast, or a few people; both give d′ within a pool."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..observer.observer import Norm
from ..observer.observer_model import ObserverModel
from .appraise import population_dprime
from .candidates import Candidate
from .max_min_subset import Limits
from .nominal import Sensed, dprimes, end_of, sense
from .search_request import SearchRequest
from .subset_identification import Objective, SubsetIdentification

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

PEOPLE = 24
ANYTHING = SearchRequest()


class NominalEvaluator:
    """The nominal person; `objections` state why icons of the last pool cannot be chosen, `limits` the totals."""

    def __init__(
        self,
        rig: Rig,
        objective: Objective,
        norm: Norm,
        seed: int,
        model: ObserverModel,
        request: SearchRequest = ANYTHING,
    ) -> None:
        self.request = request
        self.rig, self.objective, self.norm, self.seed = rig, objective, norm, seed
        self.observer = model.nominal
        self.lapse = np.array([self.observer.lapse])
        self.objections: tuple[str | None, ...] = ()
        self.limits: Limits | None = None

    def pairwise_dprime(self, icons: Sequence[Icon]) -> Array:
        """d′ (1, icons, icons) from memory."""
        felt = self._sensed(icons)
        return dprimes(felt, felt, self.norm, self.observer)[None]

    def namings(self, d_prime: Array, icons: Sequence[Icon]) -> SubsetIdentification:
        """Who is named what, for the objectives that count errors."""
        return SubsetIdentification.of(d_prime, self.lapse, self._durations(icons), self.seed)

    def _sensed(self, icons: Sequence[Icon]) -> Sensed:
        """What the nominal person feels; objections and limits of the pool follow."""
        durations = self._durations(icons)
        felt = sense(icons, self.rig, end_of(durations.tolist()), self.observer)
        self.objections = self.request.objections(felt, self.observer, self.rig)
        self.limits = self.request.limits(felt.traces, durations)
        return felt

    def _durations(self, icons: Sequence[Icon]) -> Array:
        from thermicon.circuit.solver.simulate import duration_s

        return np.array([duration_s(icon, self.rig) for icon in icons])


class PopulationEvaluator(NominalEvaluator):
    """The first 24 people of a seed, who differ in contact, skin and thresholds."""

    def __init__(
        self,
        rig: Rig,
        objective: Objective,
        norm: Norm,
        seed: int,
        model: ObserverModel,
        tracking: str | None,
        request: SearchRequest = ANYTHING,
    ) -> None:
        super().__init__(rig, objective, norm, seed, model, request)
        self.crowd, self.tracking = model.people(PEOPLE, seed), tracking
        self.rigs, self.lapse = self.crowd.rigs(rig), self.crowd.lapse

    def pairwise_dprime(self, icons: Sequence[Icon]) -> Array:
        """d′ (24, icons, icons) from memory; safety and reach are those of the rig."""
        self._sensed(icons)
        return population_dprime(
            icons,
            self.rig,
            self.crowd,
            self.tracking,
            self.norm,
            rigs=self.rigs,
            rate_Hz=25.0,
            observer=self.observer,
        )[0]

    def better(self, *sets: list[Candidate]) -> list[Candidate]:
        """The best of some sets for these people; the first of those that are equal."""
        values = []
        for candidates in sets:
            icons = [candidate.icon for candidate in candidates]
            d = self.pairwise_dprime(icons)
            middle = np.median(d, axis=0)[np.triu_indices(len(icons), 1)]
            few = self.objective == "worst"
            values.append(
                float(middle.min()) if few else self.namings(d, icons).score(range(len(icons)), self.objective)
            )
        return sets[max(range(len(sets)), key=lambda k: values[k])]
