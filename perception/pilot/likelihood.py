r"""How likely the answers of an experiment are in a laboratory, and the weights that follow.

A participant j of laboratory ℓ is one of its people, nobody knows which. With S virtual people whose confusions are
C, and N_j[a, b] answers b to icon a,

    L_j(ℓ) = (1/S) Σ_s Π_ab C_ℓs[a, b]^N_j[a, b],      w_ℓ ∝ Π_j L_j(ℓ),      ESS = (Σ w)² / Σ w².

Each participant is integrated over people on their own, so that a few odd answers of one person do not move the
constants of the laboratory as the same answers of many would.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .playing import Small

AT_ONCE = 4_000_000
"""Logarithms of probabilities that are held at once: 32 MB."""


def log_likelihoods(probability: Small, counts: Array) -> Array:
    """Ln L_j of every laboratory and participant (laboratories, participants).

    `probability` (laboratories, people, icons, icons), `counts` (participants, icons, icons).

    >>> probability = np.array([[[[0.9, 0.1], [0.2, 0.8]]]], dtype=np.float32)
    >>> round(float(np.exp(log_likelihoods(probability, np.array([[[1.0, 0.0], [1.0, 0.0]]]))[0, 0])), 3)
    0.18
    """
    each = person_log_likelihoods(probability, counts)
    largest = each.max(axis=1)
    found: Array = largest + np.log(np.exp(each - largest[:, None]).mean(axis=1))
    return found


def person_log_likelihoods(probability: Small, counts: Array) -> Array:
    """Ln of Π C^N for every laboratory, person and participant (laboratories, people, participants)."""
    laboratories, people = probability.shape[:2]
    used = np.flatnonzero(counts.sum(axis=0).ravel())
    answers = counts.reshape(len(counts), -1)[:, used].T
    found = np.empty((laboratories, people, len(counts)))
    rows = max(1, AT_ONCE // max(people * used.size, 1))
    for start in range(0, laboratories, rows):
        part = probability[start : start + rows].reshape(-1, probability.shape[-1] ** 2)[:, used]
        found[start : start + rows] = (np.log(part, dtype=np.float64) @ answers).reshape(-1, people, len(counts))
    return found


def normalised_weights(log_weights: Array) -> Array:
    """Weights that add up to 1, from their logarithms."""
    own = np.exp(log_weights - log_weights.max())
    found: Array = own / own.sum()
    return found


def effective(weights: Array) -> float:
    """Effective sample size of weights that add up to 1.

    >>> effective(np.full(4, 0.25))
    4.0
    """
    return float(1.0 / np.square(weights).sum())
