"""Means of simulated laboratories without the scatter of who their few virtual people are.

A smooth function of the coordinates explains most of what laboratories differ in. What it leaves is the laboratory's
own in part; the rest has the variance of a mean over so few people, and goes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..identification.confusion import normalised
from .likelihood import ridge, smooth_features
from .playing import LEAST_PROBABILITY, Confusions
from .states import Laboratories

FEWEST = 8
"""Laboratories of a form of memory below which nothing smooth is fitted."""


def evened(some: Laboratories, played: Confusions) -> Confusions:
    """Confusions and reports of the people of each laboratory, moved so that their means are those of many people."""
    parts = (_parts(some, each) for each in (_cells(played), played.reported))
    named, reported = (smooth + np.sqrt(share) * left for smooth, left, share, _ in parts)
    moved = _moved(played.reported, reported).clip(LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY)
    return replace(_named(played, named), reported=moved)


def smoothed(some: Laboratories, played: Confusions) -> tuple[Confusions, Array]:
    """Confusions with means that are smooth in the coordinates, and what such a mean misses of other laboratories.

    The second, (laboratories, icons, icons), is in ln of odds against the own name.
    """
    smooth, left, _, missed = _parts(some, _cells(played))
    found = _named(played, smooth)
    size = np.sqrt(np.square(smooth).mean(axis=0))
    relative = (np.sqrt(missed) * left / size).reshape(found.pooled.shape)
    return found, relative - np.diagonal(relative, axis1=1, axis2=2)[:, :, None]


def _cells(played: Confusions) -> Array:
    laboratories, people, icons = played.reported.shape
    return played.probability.reshape(laboratories, people, icons**2)


def _named(played: Confusions, mean: Array) -> Confusions:
    named = _moved(_cells(played), mean).reshape(played.probability.shape)
    return replace(played, probability=normalised(np.maximum(named, LEAST_PROBABILITY)))


def _moved(people: Array, mean: Array) -> Array:
    """Probabilities (laboratories, people, cells) with another mean, by the same factor in a cell."""
    return np.asarray(people * (np.maximum(mean, LEAST_PROBABILITY) / people.mean(axis=1))[:, None])


def _parts(some: Laboratories, people: Array) -> tuple[Array, Array, Array, Array]:
    """Mean (laboratories, cells) of people's probabilities: the smooth part, what it leaves, and two shares of that.

    The shares (laboratories, 1) of its variance are what is not the scatter of people, and what would be missed of
    laboratories to which nothing was fitted.
    """
    smooth = people.mean(axis=1)
    left, own, missed = np.zeros(smooth.shape), np.zeros((len(smooth), 1)), np.zeros((len(smooth), 1))
    for form in np.unique(some.form).tolist():
        which = np.flatnonzero(some.form == form)
        if len(which) < FEWEST:
            continue
        mean, even = smooth[which], np.ones(len(which))
        features, _ = smooth_features(some.place[which], mean, even)
        fitted, errors = ridge(features, mean, even)
        smooth[which] = features @ fitted
        left[which] = mean - smooth[which]
        scatter = float(people[which].var(axis=1, ddof=1).mean(axis=0).sum()) / people.shape[1]
        if (size := float(np.square(left[which]).mean(axis=0).sum())) > 0.0:
            own[which] = max(1.0 - scatter / size, 0.0)
            missed[which] = max(float(errors.sum()) - scatter, 0.0) / size
    return smooth, left, own, missed
