"""Quantiles of weighted draws, with which coverage is judged."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def weighted_quantile(
    values: NDArray[np.float64], weights: NDArray[np.float64], shares: tuple[float, ...]
) -> tuple[float, ...]:
    """Quantiles of weighted values, linear between the middles of their weights."""
    order = np.argsort(values, kind="stable")
    place = np.cumsum(weights[order]) - 0.5 * weights[order]
    return tuple(float(q) for q in np.interp(shares, place, values[order]))
