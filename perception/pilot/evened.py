"""Means of simulated laboratories without the scatter of who their few virtual people are.

A smooth function of the coordinates explains most of what laboratories differ in. What it leaves is the laboratory's
own in part; the rest has the variance of a mean over so few people, and goes.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..identification.confusion import normalised
from .likelihood import features_of, ridge
from .playing import LEAST_PROBABILITY, Confusions
from .states import Laboratories

FEWEST = 8
"""Laboratories of a form of memory below which nothing smooth is fitted."""


def evened(some: Laboratories, played: Confusions) -> Confusions:
    """Confusions and reports of the people of each laboratory, moved so that their means are those of many people."""
    named = _moved(some, played.probability.reshape(*played.reported.shape[:2], -1))
    probability = normalised(np.maximum(named.reshape(played.probability.shape), LEAST_PROBABILITY))
    reported = _moved(some, played.reported).clip(LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY)
    return replace(played, probability=probability, reported=reported)


def _moved(some: Laboratories, people: Array) -> Array:
    """Probabilities (laboratories, people, cells) with the means of many people, all by the same factor in a cell."""
    mean = people.mean(axis=1)
    wanted = mean.copy()
    for form in np.unique(some.form).tolist():
        own = np.flatnonzero(some.form == form)
        if len(own) < FEWEST:
            continue
        features = features_of(some.place[own], ())
        smooth = features @ ridge(features, mean[own], np.ones(len(own)))[0]
        left = mean[own] - smooth
        scatter = float(people[own].var(axis=1, ddof=1).mean(axis=0).sum()) / people.shape[1]
        all_left = float(np.square(left).mean(axis=0).sum())
        share = math.sqrt(max(1.0 - scatter / all_left, 0.0)) if all_left > 0.0 else 0.0
        wanted[own] = smooth + share * left
    return np.asarray(people * (np.maximum(wanted, LEAST_PROBABILITY) / mean)[:, None])
