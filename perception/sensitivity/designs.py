"""Designs of a sensitivity study, and what each makes of its runs: Saltelli with Sobol indices, Morris by SALib.

Shares of intervals, 0–1, have shape (runs, parameters); what was found has shape (runs, predictions).
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from ..arrays import Array
from ..sensation.parameters import latin

LEVELS = 4


class MissingError(Exception):
    """A library that is needed is not installed; the text says how to install it."""


def crossed(count: int, base: int, seed: int) -> Array:
    """Saltelli's design: A, B, and for every parameter A with that column from B."""
    both = latin(2 * count, base, seed)
    a, b = both[:, :count], both[:, count:]
    mixed = []
    for k in range(count):
        one = a.copy()
        one[:, k] = b[:, k]
        mixed.append(one)
    return np.concatenate([a, b, *mixed])


def total_indices(found: Array, base: int) -> Array:
    """Total indices (parameters, predictions) of a crossed design; 0 where a prediction does not vary."""
    from scipy.stats import sobol_indices

    parts = found.reshape(-1, base, found.shape[-1])
    sizes = np.zeros((len(parts) - 2, found.shape[-1]))
    for k in range(found.shape[-1]):
        a, b, mixed = parts[0, :, k], parts[1, :, k], parts[2:, :, k]
        if np.ptp(np.concatenate([a, b])) > 0.0:
            run: dict[Literal["f_A", "f_B", "f_AB"], Array] = {"f_A": a[None], "f_B": b[None], "f_AB": mixed[:, None]}
            sizes[:, k] = np.ravel(sobol_indices(func=run, n=base).total_order)
    return sizes


def screened(count: int, base: int, seed: int) -> Array:
    """Morris's design: `base` trajectories on a grid of shares, one parameter moved at a time. Needs SALib."""
    rows: Array = _salib("sample").sample(_problem(count), base, num_levels=LEVELS, seed=seed)
    return rows


def mean_effects(shares: Array, found: Array, seed: int) -> Array:
    """Mean size of the elementary effects over a whole interval (parameters, predictions)."""
    analyse = _salib("analyze").analyze
    sizes = [
        np.asarray(analyse(_problem(shares.shape[1]), shares, found[:, k], num_levels=LEVELS, seed=seed)["mu_star"])
        for k in range(found.shape[1])
    ]
    return np.stack(sizes, axis=-1)


def _problem(count: int) -> dict[str, Any]:
    return {"num_vars": count, "names": [f"p{k}" for k in range(count)], "bounds": [[0.0, 1.0]] * count}


def _salib(part: str) -> Any:
    from importlib import import_module

    try:
        return import_module(f"SALib.{part}.morris")
    except ImportError as problem:
        raise MissingError(
            "the method morris needs SALib, which is not installed: "
            'pip install "thermicon[psychometrics]", or use the method sobol'
        ) from problem
