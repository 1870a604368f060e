"""The spread of pairs between laboratories as inferred from how six icons were named.

In a laboratory of the posterior, with either form of memory and pairs of its own, each icon is named in n trials with a
probability p of its own. What was published are the best and the worst of them, k and l trials of n, and their mean:

    L = P(most = k, least = l) · N(mean; mean of p, its binomial error)

Which icon was best and which worst does not count, since five of the six are reconstructions.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import bdtr

from thermicon.base.files.records import Record, RecordTable
from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig
from thermicon.icons import load_library

from ..identification.pairs import with_pairs
from ..observer.channels import MemoryChoice
from ..observer.constants import record_of
from ..observer.observer import Observer
from .identified import show
from .predicted import plausible_laboratories

SIX, RIG = "six-icons", "thenar"
PEOPLE, TRIALS = 10, 8
"""Participants of Singhal and Jones, and how often each was presented with an icon."""
LABORATORIES, SEED, SCORES = 128, 0, 100
"""Laboratories, and how often the pairs of each are drawn."""
TAUS: Array = np.exp(np.linspace(np.log(0.05), np.log(4.0), 19))
WITHIN_95 = 1.96


def pair_spread(known: RecordTable) -> Record:
    """Median and 95 % of τ: the record of the prior, with what was named in its place."""
    prior, logs = record_of(known, Observer, "pair_spread"), np.log(TAUS)
    weights = _prior(prior) * likelihood(known)
    share = (np.cumsum(weights) - 0.5 * weights) / weights.sum()
    ends = np.exp(np.interp([0.025, 0.5, 0.975], share, logs)).tolist()
    # Two figures: rounding on another machine does not show.
    low, middle, high = (float(f"{end:.2g}") for end in ends)
    return replace(
        prior,
        value=middle,
        low=low,
        high=high,
        use="calibrate",
        source="inferred from how well six icons were named: Singhal & Jones 2015 and 2018",
        conditions=f"{prior.conditions}; prior {prior.central:g}, {prior.low:g} to {prior.high:g}",
    )


def _prior(record: Record) -> Array:
    """Weights of a log-normal prior at each of `TAUS`; they add up to 1."""
    low, high = np.log(record.interval)
    sd = (high - low) / (2.0 * WITHIN_95)
    weights = np.exp(-0.5 * np.square((np.log(TAUS) - np.log(record.central)) / sd))
    return np.asarray(weights / weights.sum())


def log_evidence(known: RecordTable, memory: MemoryChoice) -> tuple[float, float]:
    """Log evidence of what was published with some forms of memory: with the least spread of pairs, and by its prior.

    >>> from thermicon.perception.observer.observer import load_thresholds
    >>> without, by_prior = log_evidence(load_thresholds(), "episodes")
    >>> without < by_prior
    True
    """
    likely = likelihood(known, memory)
    return float(np.log(likely[0])), float(np.log(_prior(record_of(known, Observer, "pair_spread")) @ likely))


MEAN, BEST, WORST = (
    "mean; range over people",
    "linear decrease in skin temperature",
    "linear increase from cold to warm",
)
"""Conditions of the published shares."""


def likelihood(known: RecordTable, memory: MemoryChoice = "both") -> Array:
    """Likelihood of what was published at each of `TAUS`, the mean over laboratories and their pairs."""
    shares = {record.conditions: record.central for record in known.select("icon identification")}
    mean, best, worst = (shares[conditions] for conditions in (MEAN, BEST, WORST))
    trials = PEOPLE * TRIALS
    most, least = round(best * trials), round(worst * trials)
    found = np.zeros(TAUS.size)
    for named, scores in _laboratories(memory):
        for place, tau in enumerate(TAUS.tolist()):
            # (pairs, people, icons): each person's share of right names, then the mean over people.
            each = with_pairs(named[None], tau, scores[:, None])
            p = np.diagonal(each, axis1=-2, axis2=-1).mean(axis=1)
            error = np.sqrt((p * (1.0 - p)).sum(axis=1) / trials) / p.shape[1]
            density = np.exp(-0.5 * np.square((mean - p.mean(axis=1)) / error)) / error
            found[place] += (density * extremes(p, trials, least, most)).sum()
    return found / (LABORATORIES * SCORES)


def extremes(p: Array, trials: int, least: int, most: int) -> Array:
    """Probability (n,) that of icons named with probabilities p (n, icons) the worst and the best are so often right.

    >>> float(extremes(np.array([[0.5, 0.5]]), 1, 0, 1)[0])
    0.5
    """

    def inside(low: int, high: int) -> Array:
        below = bdtr(low - 1, trials, p) if low > 0 else np.zeros_like(p)
        return np.asarray((bdtr(high, trials, p) - below).prod(axis=1))

    return inside(least, most) - inside(least + 1, most) - inside(least, most - 1) + inside(least + 1, most - 1)


def _laboratories(memory: MemoryChoice) -> Iterator[tuple[Array, Array]]:
    """Confusions (people, icons, icons) of the participants of each laboratory, and scores (pairs, icons, icons)."""
    icons = tuple(load_library(SIX))
    others = plausible_laboratories(LABORATORIES, SEED, "temperature", memory)
    shown = show(icons, Rig.load(RIG), PEOPLE, SEED)
    chance = np.random.default_rng(np.random.SeedSequence([SEED, 16]))
    above: tuple[NDArray[np.int64], ...] = np.triu_indices(len(icons), 1)
    for named in shown.named_in(others, "temperature"):
        scores = np.zeros((SCORES, len(icons), len(icons)))
        scores[:, above[0], above[1]] = chance.standard_normal((SCORES, len(above[0])))
        yield named, scores + scores.swapaxes(1, 2)
