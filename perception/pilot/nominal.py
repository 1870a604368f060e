"""The laboratory in the middle of a sample, which stands for it where one observer is needed: its nominal observer.

It is a laboratory of the sample and not the medians of its constants, which belong to no laboratory and may predict
something else. The simulated score of a laboratory scatters by some 2 points of per cent correct with who its people
are, so that the few nearest ones are asked again with other people.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .playing import Stage
from .states import SEEDS, Laboratories

NEAREST, AGAIN = 6, 8
"""How many laboratories are asked again, and how often: the score of each is then known to within a point."""


def middle_of(some: Laboratories, constants: Array, predicted: Array, played: Stage, *, seed: int = 0) -> int:
    """Number of the laboratory in the middle.

    Parameters
    ----------
    some
        The sample.
    constants
        Constants (laboratories, constants) that must be near their medians.
    predicted
        What each predicts (laboratories, numbers), to be near its means; the first column is the proportion correct.
    played
        The set, to ask the nearest once more.
    seed
        Seed of their other people.

    """
    _, first, group, times = np.unique(some.place, axis=0, return_index=True, return_inverse=True, return_counts=True)
    # Resampled more than once, a laboratory has been asked with several groups of people.
    means = np.zeros((len(first), predicted.shape[1]))
    np.add.at(means, group.reshape(-1), predicted / times[group.reshape(-1), None])
    spread = predicted.std(axis=0)
    off = np.divide(means - predicted.mean(axis=0), spread, out=np.zeros_like(means), where=spread > 0.0)
    distance = off_middle(constants)[first] + np.square(off).mean(axis=1) + np.square(off[:, 0])
    near = np.argsort(distance, kind="stable")[:NEAREST]
    chosen = first[near]
    rng = np.random.default_rng(np.random.SeedSequence([seed, 41]))
    asked = np.repeat(chosen, AGAIN)
    # Each has people of its own: one group for all would shift the score of whichever is chosen.
    again = Laboratories(some.place[asked], rng.integers(SEEDS, size=len(asked)))
    scores = played.confusions(again).correct.reshape(len(chosen), AGAIN).sum(axis=1)
    scores = (scores + means[near, 0] * times[near]) / (AGAIN + times[near])
    return int(chosen[np.abs(scores - predicted[:, 0].mean()).argmin()])


def off_middle(values: Array) -> Array:
    """Mean square (rows,) of how many SDs a row lies from the median of each column, in logarithms where they exist.

    >>> int(off_middle(np.array([[0.0], [1.0], [5.0]])).argmin())
    1
    """
    positive = (values > 0.0).all(axis=0)
    values = np.where(positive, np.log(np.where(positive, values, 1.0)), values)
    spread = values.std(axis=0)
    off = np.divide(values - np.median(values, axis=0), spread, out=np.zeros_like(values), where=spread > 0.0)
    found: Array = np.square(off).mean(axis=1)
    return found
