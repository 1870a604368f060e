"""Criterion: the change of sensation that is answered."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.numbers.arrays import Array

from ..constants import FROM_0, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Criterion(Mechanism):
    """Criteria in d′ of speeded answers and of questions without haste, and the correlation time of the noise.

    Nobody's criterion lies below the floor: people notice that they answer to nothing, and become more careful.
    """

    equation = "rate = (φ(z) + z·Φ(z))/τ · φ(g)/Φ(g), z = τ·dψ/dt, g = c − ψ, c = max(criterion · person, floor)"
    source = "Rice's rate of crossings; no source of the criteria"
    criterion: float = constant("criterion of speeded answers")
    unhurried: float = constant("criterion of yes and no", task=True)
    caution_after_pulse: float = constant("caution after a pre-pulse", task=True)
    noise_correlation_s: float = constant("noise correlation time")
    criterion_floor: float = constant("floor of the criterion", FROM_0)

    def criteria(self, level: float, person: ArrayLike) -> Array:
        """Criteria in d′ of people whose own are these multiples of a level."""
        return np.asarray(np.maximum(level * np.asarray(person, dtype=np.float64), self.criterion_floor))
