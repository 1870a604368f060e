"""Samples of laboratories that the evidence allows.

All but the seed of the people are kept in coordinates in which the prior is standard normal, so that they can be moved
without leaving it: constants on the scales of their priors, with the mean and covariance of the draws.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from thermicon.base.files.records import RecordTable
from thermicon.base.numbers.arrays import Array

from ..identification.laboratory_draws import Uncertain, laboratory_forms, latin, memory_parameters
from ..observer.channels import CHANNELS, MemoryChoice
from ..observer.constants import BETWEEN_LABORATORIES
from ..observer.draws import PosteriorDraws
from ..observer.observer import Observer
from ..observer.observer_model import ObserverModel
from ..observer.people import normal_scores
from ..observer.priors import Prior, priors_of

LEAST_VARIANCE = 1e-12
"""Directions in which draws vary less, such as a constant that is the same in all, are left as they are."""
OFFSETS = tuple(f"sensitivity of the laboratory, {channel}" for channel in CHANNELS)
OUTERMOST = 1e-9
"""Shares of an interval of memory stay this far within it, so that their normal scores are finite."""
SEEDS = 2**31
"""Seeds of people lie below this."""


@dataclass(frozen=True, slots=True)
class Laboratories:
    """Some laboratories: `place` (n, coordinates), which are constants, memory, offsets; `seed` (n,) of their people.

    `form` (n,) is the place of their form of memory in `MEMORY_FORMS`.
    """

    place: Array
    seed: NDArray[np.int64]
    form: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.place)

    def of(self, which: NDArray[np.int64]) -> Laboratories:
        """Some of them, by number."""
        return Laboratories(self.place[which], self.seed[which], self.form[which])

    def joined(self, other: Laboratories) -> Laboratories:
        """These and further ones."""
        seed, form = np.concatenate([self.seed, other.seed]), np.concatenate([self.form, other.form])
        return Laboratories(np.vstack([self.place, other.place]), seed, form)


class LaboratoryPrior:
    """The prior of laboratories: draws of the posterior, intervals and forms of memory, and the spread of offsets.

    Memory that the draws have themselves is kept with their constants, on the scale of its shipped interval.
    """

    def __init__(self, draws: PosteriorDraws, choice: MemoryChoice, records: RecordTable | None = None) -> None:
        self.draws, self.choice = draws, choice
        own = [each for each in memory_parameters(choice) if each.name in draws.memory_names]
        free = [each for each in memory_parameters(choice, records=records) if each.name not in draws.memory_names]
        self.memory = (*own, *free)
        known = {prior.name: prior for prior in priors_of(draws.variable).each}
        self._scales: tuple[Prior, ...] = tuple(known[name] for name in draws.names)
        # Coordinates that belong to the draws: constants, and memory that they have themselves.
        self._held, self._free = len(self._scales) + len(own), len(free)
        places = np.array([[p.to_place(v) for p, v in zip(self._scales, row, strict=True)] for row in draws.draws])
        places = np.hstack([places, *(_scores(each, draws)[:, None] for each in own)])
        self._middle = places.mean(axis=0)
        off = places - self._middle
        values, vectors = np.linalg.eigh(off.T @ off / max(len(off) - 1, 1))
        values = np.where(values > LEAST_VARIANCE, values, 0.0)
        turned = np.divide(1.0, np.sqrt(values), out=np.zeros_like(values), where=values > 0.0)
        # Symmetric roots keep each coordinate near its own constant, which the surrogate of the likelihood relies on.
        self._spread = (vectors * np.sqrt(values)) @ vectors.T
        self._whitened = off @ ((vectors * turned) @ vectors.T)

    @classmethod
    def of(cls, observer: ObserverModel | Path | str | None, choice: MemoryChoice) -> LaboratoryPrior:
        """From a model, a file of draws, or the shipped draws; a ValueError for an observer without draws."""
        model = ObserverModel.of(observer)
        if model.posterior is None:
            raise ValueError(
                f"{model.name} has no posterior draws, from which laboratories are made: give a table of draws (.csv)"
            )
        return cls(model.posterior, choice, model.records)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the constants, of memory, and of the offsets, as `values` has them."""
        return (*self.draws.names, *(parameter.name for parameter in self.memory), *OFFSETS)

    @property
    def units(self) -> tuple[str, ...]:
        """Unit of each of `names`; empty for plain numbers."""
        units = [*(scale.unit for scale in self._scales), *(own.unit for own in self.memory), *("ln" for _ in OFFSETS)]
        return tuple("" if unit == "1" else unit for unit in units)

    def first(self, n: int, seed: int) -> Laboratories:
        """The draws themselves, evenly spaced (over and over where n is larger), each with a laboratory around it.

        Draws that have a form of memory keep it, where both forms count.
        """
        total = len(self.draws)
        chosen = [k % total for k in range(n)] if n > total else self.draws.spaced(n)
        rng = np.random.default_rng(np.random.SeedSequence([seed, 11]))
        normal = normal_scores(latin(self._free, n, seed), OUTERMOST)
        offsets = rng.standard_normal((n, len(CHANNELS)))
        forms = laboratory_forms(self.draws, chosen, self.choice, seed)
        return Laboratories(np.hstack([self._whitened[chosen], normal, offsets]), rng.integers(SEEDS, size=n), forms)

    def values(self, some: Laboratories) -> Array:
        """Constants in their own units, in the order of the draws, memory in its own, and offsets (ln), (n, names)."""
        first, places = self._held, self._middle + some.place[:, : self._held] @ self._spread
        rows, own = places[:, : len(self._scales)].tolist(), places[:, len(self._scales) :]
        constants = np.array([[p.to_value(v) for p, v in zip(self._scales, row, strict=True)] for row in rows])
        constants = constants.reshape(len(some), len(self._scales))
        scores = np.hstack([own, some.place[:, first : first + self._free]])
        memory = np.array(
            [[p.at(NormalDist().cdf(z)) for p, z in zip(self.memory, row, strict=True)] for row in scores.tolist()]
        ).reshape(len(some), len(self.memory))
        spread = constants[:, self.draws.names.index(BETWEEN_LABORATORIES)]
        return np.hstack([constants, memory, spread[:, None] * some.place[:, -len(CHANNELS) :]])

    def observer_of(self, values: Array) -> tuple[Observer, list[float]]:
        """The observer of one laboratory, by a row of `values`, and how much more sensitive (ln) its people are."""
        named = dict(zip(self.names, values.tolist(), strict=True))
        return Observer.from_values(named, self.draws.variable), [named[offset] for offset in OFFSETS]


def _scores(parameter: Uncertain, draws: PosteriorDraws) -> Array:
    """Normal scores (n,) of the memory that draws have, within its interval."""
    column = draws.memory[:, draws.memory_names.index(parameter.name)]
    # Tables may have been rounded beyond the ends.
    values = np.clip(column, parameter.low, parameter.high).tolist()
    return normal_scores(np.array([parameter.share(value) for value in values]), OUTERMOST)
