"""Pairs of icons that a laboratory confuses more, or less, than its constants say.

The odds that icon a is called b, against its own name, are those of the model times e^(τz), with a standard normal z
that is the same both ways and for all people of a laboratory.
"""

from collections.abc import Sequence
from itertools import combinations
from zlib import crc32

import numpy as np

from thermicon.base.numbers.arrays import Array

from .confusion import normalised


def pair_scores(names: Sequence[str], laboratories: int, seed: int) -> Array:
    """Scores z (laboratories, icons, icons), symmetric and 0 on the diagonal.

    Two icons of the same names have the same score in every set, so that sets and versions of one can be compared.

    >>> one, other = pair_scores(("a", "b", "c"), 2, 0), pair_scores(("c", "a"), 2, 0)
    >>> bool((one[:, 0, 2] == other[:, 0, 1]).all())
    True
    """
    scores = np.zeros((laboratories, len(names), len(names)))
    for a, b in combinations(range(len(names)), 2):
        pair = crc32("\0".join(sorted((names[a], names[b]))).encode("utf-8"))
        rng = np.random.default_rng(np.random.SeedSequence([seed, 14, pair]))
        scores[:, a, b] = scores[:, b, a] = rng.standard_normal(laboratories)
    return scores


def with_pairs(confusion: Array, log_odds: Array) -> Array:
    """Confusions (..., icons, icons) with the odds of every pair changed by so much (ln), of shape (icons, icons).

    >>> with_pairs(np.array([[0.8, 0.2], [0.5, 0.5]]), np.array([[0.0, np.log(2.0)], [np.log(2.0), 0.0]])).round(3)
    array([[0.667, 0.333],
           [0.667, 0.333]])
    """
    return normalised(confusion * np.exp(log_odds))
