"""Receptor temperatures of many observers by interpolation over depth."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.numbers.arrays import Array

from ..observer.constants import Both
from ..observer.observer import Observer

RUNGS = 4
"""Depths that are simulated for each channel."""


def rungs(observers: Iterable[Observer], corneum_m: ArrayLike) -> tuple[Both[float], ...]:
    """Depths (m) to simulate for observers in skin with (people,) m of stratum corneum: Chebyshev's nodes."""
    thin, thick = float(np.min(corneum_m)), float(np.max(corneum_m))
    ends = np.array([[each.depths_m(thin), each.depths_m(thick)] for each in observers])
    low, high = ends[:, 0].min(axis=0), ends[:, 1].max(axis=0)
    shares = 0.5 - 0.5 * np.cos(np.pi * (np.arange(RUNGS) + 0.5) / RUNGS)
    return tuple(Both(*(low + share * (high - low)).tolist()) for share in shares)


def between(depths_m: Sequence[float], rungs_C: Array, at_m: Array) -> Array:
    """Temperatures (people, icons, n_time) at each person's depth: the polynomial through those at some depths."""
    weights = np.ones((len(depths_m), at_m.size))
    for k, own in enumerate(depths_m):
        for other in (*depths_m[:k], *depths_m[k + 1 :]):
            weights[k] *= (at_m - other) / (own - other)
    return np.asarray(np.einsum("kp,kpit->pit", weights, rungs_C))
