"""Pairs of icons that a laboratory confuses more, or less, than its constants say.

The odds that icon a is called b, against its own name, are those of the model times e^(τz − τ²/2), with a standard
normal z that is the same both ways and for all people of a laboratory: their mean over laboratories is the model's.
"""

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.numbers.arrays import Array

from .confusion import normalised


def pair_scores(icons: int, laboratories: int, seed: int) -> Array:
    """Scores z (laboratories, icons, icons), symmetric and 0 on the diagonal.

    Those of the first icons do not depend on how many follow, so that versions of a set can be compared.

    >>> bool((pair_scores(3, 2, 0)[:, :2, :2] == pair_scores(2, 2, 0)).all())
    True
    """
    scores = np.zeros((laboratories, icons, icons))
    chance = np.random.default_rng(np.random.SeedSequence([seed, 14]))
    for b in range(icons):
        for a in range(b):
            scores[:, a, b] = scores[:, b, a] = chance.standard_normal(laboratories)
    return scores


def with_pairs(confusion: Array, spread: float, scores: Array) -> Array:
    """Confusions (..., icons, icons) of a laboratory whose pairs have a spread τ (ln) and scores (icons, icons).

    >>> one = np.array([[0.8, 0.2], [0.5, 0.5]])
    >>> with_pairs(one, 1.0, np.array([[0.0, 1.5], [1.5, 0.0]])).round(2)
    array([[0.6 , 0.4 ],
           [0.73, 0.27]])
    >>> bool((with_pairs(one, 0.0, np.ones((2, 2))) == one).all())
    True
    """
    return normalised(confusion * np.exp(pair_log_odds(spread, scores)))


def pair_log_odds(spread: ArrayLike, scores: Array) -> Array:
    """What the pairs of a laboratory add to ln odds against the own name, (..., icons, icons)."""
    tau, others = np.asarray(spread, dtype=np.float64), 1.0 - np.eye(scores.shape[-1])
    return np.asarray(others * (tau * scores - 0.5 * tau**2))
