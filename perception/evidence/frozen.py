"""Comparisons that are finished: tables of numbers with the version that made them, and no code that makes them again.

What each mechanism is worth (the posterior maximised again without it), how well each variant predicts experiments that
it never saw (refitted without each, by the normal approximation), and forms of memory on published results that no
noise of memory was set on. The first line of each table says by which version, from which evidence and how.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..arrays import Array
from ..observer.variants import VARIABLES, Variable
from .results import read_rows

ABLATION, SCORES, FORMS = "ablation.csv", "variant-scores.csv", "memory_forms.csv"


@dataclass(frozen=True, slots=True)
class AblatedRow:
    """A variant without a mechanism: `difference` is its log evidence minus that of the variant with every mechanism.

    A difference under about 2 says nothing. A mechanism stays if it has a source or a gain.
    """

    variable: str
    without: str
    log_evidence: float
    difference: float
    squares: float
    worst: str
    worst_sd: float


@dataclass(frozen=True, slots=True)
class VariantScores:
    """Log scores of one left-out row by each variant: log densities of the published number on the row's scale."""

    experiment: str
    statistic: str
    channel: str
    temperature: float
    heat_flow: float


@dataclass(frozen=True, slots=True)
class FormScore:
    """One published row as one form of memory predicts it: value, 95 % of draws, and log score."""

    norm: str
    row: str
    published: str
    predicted: float
    low: float
    high: float
    log_score: float


@lru_cache(maxsize=1)
def load_ablation() -> tuple[AblatedRow, ...]:
    """The ablation, the default variant first."""
    return tuple(read_rows(ABLATION, AblatedRow))


@lru_cache(maxsize=1)
def load_forms() -> tuple[FormScore, ...]:
    """Scores of forms of memory, form by form."""
    return tuple(read_rows(FORMS, FormScore))


@lru_cache(maxsize=1)
def variant_log_scores() -> Array:
    """Log scores (variants, rows) in the order of VARIABLES and of the likelihood.

    >>> variant_log_scores().shape
    (2, 54)
    """
    rows = list(read_rows(SCORES, VariantScores))
    return np.array([[row.temperature for row in rows], [row.heat_flow for row in rows]])


def variant_weights() -> dict[Variable, float]:
    """Weights of the variants that predict the left-out rows best as a mixture.

    >>> round(sum(variant_weights().values()), 6)
    1.0
    """
    return dict(zip(VARIABLES, stacking_weights(variant_log_scores()).tolist(), strict=True))


def stacking_weights(log_scores: Array, rounds: int = 2000) -> Array:
    """Weights (variants,) that sum to 1 and maximise the log score of the mixture, from log scores (variants, rows).

    Expectation–maximisation, which rises with every round (Yao, Vehtari, Simpson & Gelman 2018).

    >>> stacking_weights(np.array([[0.0, 0.0], [-9.0, -9.0]])).round(2)
    array([1., 0.])
    """
    densities = np.exp(log_scores - log_scores.max(axis=0))
    weights = np.full(len(densities), 1.0 / len(densities))
    for _ in range(rounds):
        shares = weights[:, None] * densities
        weights = (shares / shares.sum(axis=0)).mean(axis=1)
    return weights
