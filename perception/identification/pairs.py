"""Pairs of icons that a laboratory confuses more, or less, than its constants say.

The odds that icon a is called b, against its own name, are those of the model times e^(τz), with a standard normal z
that is the same both ways and for all people of a laboratory.
"""

import numpy as np

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


def with_pairs(confusion: Array, log_odds: Array) -> Array:
    """Confusions (..., icons, icons) with the odds of every pair changed by so much (ln), of shape (icons, icons).

    >>> with_pairs(np.array([[0.8, 0.2], [0.5, 0.5]]), np.array([[0.0, np.log(2.0)], [np.log(2.0), 0.0]])).round(3)
    array([[0.667, 0.333],
           [0.667, 0.333]])
    """
    return normalised(confusion * np.exp(log_odds))
