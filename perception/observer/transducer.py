"""Receptor drive in multiples of threshold → sensation in d′: a power near threshold, a logarithm far above it.

    ψ(u) = a·ln(1 + u^p/b),  b = 1/(e^(1/a) − 1),  so that ψ(1) = 1

Near threshold ψ ≈ u^p: p = 1 is a linear observer, p = 2 the square law of energy, under which a pedestal helps.
Far above it equal ratios add equally. Neither a nor p has a thermal source: both are inferred.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array


@dataclass(frozen=True, slots=True)
class Transducer:
    """Slope `a` (d′) and exponent `p` of sensation.

    >>> Transducer(12.0, 2.0).psi(1.0).round(12)
    np.float64(1.0)
    """

    a: float
    p: float

    def __post_init__(self) -> None:
        for name in ("a", "p"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"the transducer needs {name} above 0, not {getattr(self, name):g}")

    @property
    def b(self) -> float:
        """Constant that makes ψ(1) = 1."""
        return 1.0 / math.expm1(1.0 / self.a)

    def psi(self, multiple: ArrayLike) -> Array:
        """Sensation in d′ of drives in multiples of threshold (0 or more), of the same shape."""
        sensation: Array = self.a * np.log1p(np.asarray(multiple, dtype=np.float64) ** self.p / self.b)
        return sensation

    def multiple(self, psi: ArrayLike) -> Array:
        """Drive in multiples of threshold whose sensation is `psi` in d′.

        >>> Transducer(12.0, 1.5).multiple(Transducer(12.0, 1.5).psi(3.0)).round(9)
        np.float64(3.0)
        """
        drive: Array = (self.b * np.expm1(np.asarray(psi, dtype=np.float64) / self.a)) ** (1.0 / self.p)
        return drive

    def difference_threshold(self, pedestal: ArrayLike) -> Array:
        """Increment that adds d′ = 1 to a pedestal when nothing but sensory noise counts, in multiples of threshold."""
        base = np.asarray(pedestal, dtype=np.float64)
        return self.multiple(self.psi(base) + 1.0) - base
