"""How far the limits of quality are from the skin's temperature: what a quadratic in the constants cannot follow.

Where a limit leaves the skin, drive falls by a factor σ(x), the logistic function of x = (limit − T)/softness for cold
and (T − limit)/softness for warmth. Its logarithm bends from 0 to a straight line within one constant's prior.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..observer.priors import Priors

NAMES = ("cold limit", "warm limit", "softness of the limits")
COLD_C, WARM_C = (30.0, 31.0, 31.8, 32.0), (31.0, 32.0, 32.4, 34.0)
"""Temperatures of skin at rest in the experiments of the evidence, and near them."""
COUNT = len(COLD_C) + len(WARM_C)


@dataclass(frozen=True, slots=True)
class LimitFeatures:
    """Logarithms of σ(x) at COUNT temperatures, from vectors in SDs of the prior: `places`, `middle` and `sd` (3,)."""

    places: tuple[int, int, int]
    middle: Array
    sd: Array

    @classmethod
    def of(cls, priors: Priors) -> LimitFeatures | None:
        """The features of a posterior; None where its limits are not inferred."""
        if any(name not in priors.names for name in NAMES):
            return None
        cold, warm, softness = (priors.names.index(name) for name in NAMES)
        chosen = [cold, warm, softness]
        return cls((cold, warm, softness), priors.middle[chosen], priors.sd[chosen])

    def at(self, vectors: Array) -> Array:
        """Features (..., COUNT) of vectors (..., n)."""
        return -np.logaddexp(0.0, -self._x(vectors))

    def slopes(self, vector: Array) -> Array:
        """Derivatives (COUNT, 3) by the coordinates of the three constants at one vector (n,)."""
        x = self._x(vector)
        softness = float(np.exp(self.middle[2] + self.sd[2] * vector[self.places[2]]))
        slopes = np.zeros((COUNT, 3))
        cold = len(COLD_C)
        slopes[:cold, 0] = self.sd[0] / softness
        slopes[cold:, 1] = -self.sd[1] / softness
        slopes[:, 2] = -self.sd[2] * x
        return slopes * np.exp(-np.logaddexp(0.0, x))[:, None]

    def _x(self, vectors: Array) -> Array:
        cold, warm, log_softness = (
            self.middle[k] + self.sd[k] * vectors[..., place] for k, place in enumerate(self.places)
        )
        away = [cold - at for at in COLD_C] + [at - warm for at in WARM_C]
        x: Array = np.stack(away, axis=-1) / np.exp(log_softness)[..., None]
        return x
