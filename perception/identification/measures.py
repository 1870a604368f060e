"""Scores of a confusion matrix: proportion correct and information.

Published information is the plug-in estimate of a few dozen trials, which is biased upwards;
`plugin_bits` computes what such an experiment would report, `information_bits` the exact value.
"""

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.numbers.arrays import Array

ROUNDED = 1e-3
"""Rows may miss 1 by this much, as proportions of three decimals do."""


def proportion_correct(confusion: ArrayLike) -> Array:
    """Proportion correct (...,) of confusions (..., m, m) whose rows sum to 1, every icon presented equally often.

    >>> float(proportion_correct([[0.9, 0.1], [0.3, 0.7]]))
    0.8
    """
    found: Array = np.trace(np.asarray(confusion, dtype=np.float64), axis1=-2, axis2=-1) / np.shape(confusion)[-1]
    return found


def felt_and_named(reported: ArrayLike, confusion: ArrayLike) -> Array:
    """Shares of plays (..., m) that are reported and named correctly, where a play that is not felt is a miss.

    Of people one by one: who is less sensitive feels less, and confuses more or less. `reported` (..., m) are
    probabilities of a report, taken as independent of the name given the person; `confusion` is (..., m, m).

    >>> felt_and_named([0.5, 1.0], [[0.9, 0.1], [0.3, 0.7]]).tolist()
    [0.45, 0.7]
    """
    named: Array = np.diagonal(np.asarray(confusion), axis1=-2, axis2=-1)
    return np.asarray(np.asarray(reported) * named)


@checked
def information_bits(confusion: ArrayLike) -> Array:
    """Compute the information from icon to response in bits, with every icon presented equally often.

    Parameters
    ----------
    confusion
        Probabilities (..., m, m) of each answer (last axis) to each presented icon; rows sum to 1.

    Returns
    -------
    ndarray
        Information (...,) in bits, 0 to log2 m.

    Raises
    ------
    InputError
        For another shape, negative cells, and rows that do not sum to 1, such as counts.

    Examples
    --------
    >>> import numpy as np
    >>> counts = np.array([[8, 2, 0], [1, 9, 0], [0, 0, 10]])
    >>> round(float(information_bits(counts / counts.sum(axis=1, keepdims=True))), 3)
    1.183
    """
    given = np.asarray(confusion, dtype=np.float64)
    if given.ndim < 2 or given.shape[-1] != given.shape[-2]:
        raise InputError(f"information_bits: one row and one column for each icon are needed, not shape {given.shape}")
    worst = float(given.sum(axis=-1).flat[np.abs(given.sum(axis=-1) - 1.0).argmax()])
    if not (given.min() >= 0.0 and abs(worst - 1.0) <= ROUNDED):
        what = f"a row sums to {worst:g}" if given.min() >= 0.0 else f"a cell is {given.min():g}"
        raise InputError(
            f"information_bits: {what}; rows of probabilities sum to 1: divide each row of counts by its sum"
        )
    joint = given / given.shape[-1]
    return np.maximum(_mutual_information(joint), 0.0)


def plugin_bits(confusion: ArrayLike, trials: int, seed: int = 0, experiments: int = 1000) -> float:
    """The mean of `experiments` of `trials` trials of each person by the plug-in estimator, bits."""
    people = np.asarray(confusion, dtype=np.float64)
    return float(experiments_bits(people[None] if people.ndim == 2 else people, trials, seed, experiments).mean())


def experiments_bits(confusion: Array, trials: int, seed: int, experiments: int, first: int = 0) -> Array:
    """Bits that each experiment of a person reports, (people, experiments), from `confusion` (people, m, m).

    Icons are presented as evenly as possible. Chance depends on the seed and on the person's number, from `first`.
    """
    if trials < 1:
        raise ValueError(f"an experiment needs at least one trial, not {trials}")
    people, icons = confusion.shape[0], confusion.shape[-1]
    shown = np.full(icons, trials // icons)
    shown[: trials % icons] += 1
    played = np.flatnonzero(shown)
    found = np.empty((people, experiments))
    for person in range(people):
        rng = np.random.default_rng(np.random.SeedSequence([seed, 2], spawn_key=(first + person,)))
        counts = rng.multinomial(shown[played], confusion[person, played], size=(experiments, len(played)))
        found[person] = _mutual_information(counts / trials)
    return found


def _mutual_information(joint: Array) -> Array:
    presented = joint.sum(axis=-1, keepdims=True)
    answered = joint.sum(axis=-2, keepdims=True)
    expected = presented * answered
    ratio = np.divide(joint, expected, out=np.ones_like(joint), where=joint > 0)
    bits: Array = (joint * np.log2(ratio)).sum(axis=(-2, -1))
    return bits
