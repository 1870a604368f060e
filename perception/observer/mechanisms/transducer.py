"""The transducer: drive in multiples of threshold becomes sensation in d′."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.numbers.arrays import Array

from ..constants import constant
from .gain import Gain


@dataclass(frozen=True, kw_only=True)
class Transducer(Gain):
    """A power near threshold, a logarithm far above it.

    Near threshold ψ ≈ u^p: p = 1 is a linear observer, p = 2 the square law of energy, under which a pedestal helps.
    Far above it equal ratios add equally. Neither a nor p has a thermal source: both are inferred.
    """

    equation = "ψ = a·ln(1 + u^p/b), b = 1/(e^(1/a) − 1), so that ψ(1) = 1"
    source = "amplitude differences and steps to pain for a; no thermal source of p"
    a: float = constant("slope of sensation")
    p: float = constant("transducer exponent")

    @property
    def b(self) -> float:
        """Constant that makes ψ(1) = 1."""
        return 1.0 / math.expm1(1.0 / self.a)

    def psi(self, multiple: ArrayLike) -> Array:
        """Sensation in d′ of drives in multiples of threshold (0 or more), of the same shape."""
        return np.asarray(self.a * np.log1p(np.asarray(multiple, dtype=np.float64) ** self.p / self.b))

    def multiple(self, psi: ArrayLike) -> Array:
        """Drive in multiples of threshold whose sensation is `psi` in d′.

        >>> from thermicon.perception import Observer
        >>> Observer.load().multiple(Observer.load().psi(3.0)).round(9)
        np.float64(3.0)
        """
        return np.asarray((self.b * np.expm1(np.asarray(psi, dtype=np.float64) / self.a)) ** (1.0 / self.p))

    def difference_threshold(self, pedestal: ArrayLike) -> Array:
        """Increment that adds d′ = 1 to a pedestal when nothing but sensory noise counts, in multiples of threshold."""
        base = np.asarray(pedestal, dtype=np.float64)
        return self.multiple(self.psi(base) + 1.0) - base
