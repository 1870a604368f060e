"""Whether chains have converged, and how much weighted draws are worth, by ArviZ."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from thermicon.circuit.records import RecordError

from ..arrays import Array

R_HAT, ESS = 1.01, 400.0
"""Chains have converged where every constant has an R-hat below and a bulk effective sample size above (Vehtari et
al. 2021)."""
K_HAT = 0.7
"""Pareto-smoothed weights with a larger shape of tail are not to be trusted (Vehtari et al. 2024)."""
EXTRA = 'sampling needs emcee and arviz-stats, which are not installed: pip install "thermicon[calibrate]"'


@dataclass(frozen=True, slots=True)
class Diagnostics:
    """Rank-normalised split R-hat (n,) and bulk effective sample size (n,) of every constant, by name."""

    names: tuple[str, ...]
    r_hat: Array
    ess: Array

    @property
    def converged(self) -> bool:
        """Whether every constant has converged."""
        return bool((self.r_hat < R_HAT).all() and (self.ess > ESS).all())

    @property
    def worst(self) -> str:
        """The constant with the largest R-hat or, where that is fine, the least effective sample size."""
        if float(self.r_hat.max()) >= R_HAT:
            return self.names[int(self.r_hat.argmax())]
        return self.names[int(self.ess.argmin())]

    def __repr__(self) -> str:
        state = "converged" if self.converged else f"not converged, worst {self.worst}"
        return f"Diagnostics({state}: R-hat up to {self.r_hat.max():.4f}, ESS from {self.ess.min():.0f})"


def require_extra() -> None:
    """Raise a RecordError with the cure where sampler or diagnostics are not installed."""
    try:
        import arviz_stats  # noqa: F401
        import emcee  # noqa: F401
    except ImportError:
        raise RecordError(EXTRA) from None


def diagnose(names: tuple[str, ...], chains: Array) -> Diagnostics:
    """Diagnostics of chains (chains, steps, n)."""
    stats = _array_stats()
    columns = range(chains.shape[2])
    r_hat = np.array([float(stats.rhat(chains[:, :, k])) for k in columns])
    ess = np.array([float(stats.ess(chains[:, :, k], method="bulk")) for k in columns])
    return Diagnostics(names, np.nan_to_num(r_hat, nan=np.inf), np.nan_to_num(ess))


def smoothed_weights(log_weights: Array) -> tuple[Array, float]:
    """Pareto-smoothed weights (draws,) that sum to 1, and the shape k-hat of their tail (Vehtari et al. 2024)."""
    # ArviZ takes log likelihoods, whose weights are one over them.
    smoothed, k_hat = _array_stats().psislw(-log_weights)
    weights = np.exp(smoothed - np.max(smoothed))
    return weights / weights.sum(), float(k_hat)


def _array_stats() -> Any:
    require_extra()
    return import_module("arviz_stats.base").array_stats
