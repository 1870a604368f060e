"""Laboratories as the posterior allows them: the observer, the people and the memory that each draw brings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..observer.channels import Norm
from ..observer.draws import laboratory_with
from ..observer.observer import Observer
from ..observer.observer_model import ObserverModel
from ..observer.people import People
from ..observer.variants import Variable
from ..sensation.parameters import latin, memory_parameters

OFFSETS = ("laboratory, cold", "laboratory, warm")


@dataclass(frozen=True, slots=True)
class DrawnLaboratories:
    """One laboratory for each of some evenly spaced draws of a variant.

    `values` (n, constants) belong to `names`: the constants of the draw, memory, and how much more sensitive (ln) its
    people are.
    """

    variable: Variable
    names: tuple[str, ...]
    values: Array
    seed: int
    age_years: float | None

    @classmethod
    def of(cls, model: ObserverModel, norm: Norm, draws: int, seed: int) -> DrawnLaboratories:
        """As many laboratories of a model as `draws`; a ValueError for an observer without draws."""
        held = model.posterior
        if held is None:
            raise ValueError(
                f"{model.name} has no posterior draws, from which an interval for a new laboratory is made"
            )
        chosen = np.linspace(0, len(held) - 1, draws).round().astype(np.int64)
        free = [p for p in memory_parameters(norm, records=model.records) if p.name not in held.memory_names]
        shares = latin(len(free), draws, seed).tolist()
        memory = [[p.at(share) for p, share in zip(free, row, strict=True)] for row in shares]
        offsets, free_memory = held.new_laboratory(seed)[chosen], np.reshape(memory, (draws, len(free)))
        values = np.hstack([held.draws[chosen], held.memory[chosen], free_memory, offsets])
        names = (*held.names, *held.memory_names, *(p.name for p in free), *OFFSETS)
        return cls(held.variable, names, values, seed, model.age_years)

    def __len__(self) -> int:
        return len(self.values)

    def at(self, place: int, people: int) -> tuple[Observer, People]:
        """The observer of one laboratory, and its people."""
        return self.with_values(self.values[place], people)

    def with_values(self, values: Array, people: int) -> tuple[Observer, People]:
        """The observer and the people of a laboratory with these values of the constants (constants,)."""
        named = dict(zip(self.names, values.tolist(), strict=True))
        offsets = named[OFFSETS[0]], named[OFFSETS[1]]
        base = Observer.load(variable=self.variable)
        return laboratory_with(base, named, offsets, people, self.seed, self.age_years)

    def invited(self, people: int) -> NDArray[np.int64]:
        """Places (n, people) of the people whom each laboratory invites: a random sample of its own."""
        chance = np.random.default_rng(np.random.SeedSequence([self.seed, 9]))
        return chance.integers(people, size=(len(self), people))
