"""What pictures need of single people: at which place each of them ranks every icon, and the d′ of the first few."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

MOST_PEOPLE, MOST_CELLS = 64, 200_000
"""How many people a map is drawn from, and how many d′ are kept for it: fewer people of many icons."""


@dataclass(frozen=True, slots=True)
class PersonSpread:
    """Over people: `place_probability` (icons, places), whose rows and columns sum to 1; `d_prime` (few, icons, icons).

    Places go from the icon that a person names best to the one named worst. Icons that agree to the whole per cent
    share their places, since less is not told apart by the samples that the confusions are drawn from.
    """

    place_probability: Array
    d_prime: Array

    def __post_init__(self) -> None:
        for name in ("place_probability", "d_prime"):
            own = np.array(getattr(self, name), dtype=np.float64)
            own.setflags(write=False)
            object.__setattr__(self, name, own)


def spread_over_people(d_prime: Array, correct: Array) -> PersonSpread:
    """Places and a few d′ out of pairwise d′ (people, icons, icons) and proportions correct (people, icons)."""
    icons = d_prime.shape[-1]
    few = max(2, min(MOST_PEOPLE, MOST_CELLS // (icons * icons)))
    return PersonSpread(place_probability(correct), d_prime[:few])


def place_probability(correct: Array) -> Array:
    """Probability (icons, places) over people that an icon is at a place, from proportions correct (people, icons).

    >>> place_probability(np.array([[0.9, 0.7], [0.8, 0.8]])).tolist()
    [[0.75, 0.25], [0.25, 0.75]]
    """
    whole = np.rint(100.0 * np.asarray(correct, dtype=np.float64))
    people, icons = whole.shape
    found, places = np.zeros((icons, icons)), np.arange(icons)
    for person in whole:
        better = (person[None, :] > person[:, None]).sum(axis=1)
        equal = (person[None, :] == person[:, None]).sum(axis=1)
        within = (places >= better[:, None]) & (places < (better + equal)[:, None])
        found += within / equal[:, None]
    found /= people
    return found
