"""Virtual people and trials of the inference: the same quasi-random numbers for every set of constants.

With common random numbers a change of a constant changes a prediction smoothly, which a search for a maximum needs.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..arrays import Array
from ..sensation.detection import quarters

PEOPLE = 48
SEED = 7
SHARES = np.array([0.125, 0.375, 0.625, 0.875])
"""Middles of four equal parts of a distribution: sizes of gain, and shares of trials that have answered."""
TRIALS = SHARES.size**2
SHARES.setflags(write=False)


@dataclass(frozen=True, slots=True)
class Crowd:
    """Standard normal numbers: `people` (people, 5) for cold and warm sensitivity, cold and warm criterion, and
    decision; `decisions` (people, TRIALS) for decision times; `gains` (4,) for the gain of a presentation.
    """

    people: Array
    decisions: Array
    gains: Array

    def __len__(self) -> int:
        return int(self.people.shape[0])


@lru_cache(maxsize=4)
def draw_crowd(people: int = PEOPLE, seed: int = SEED) -> Crowd:
    """A crowd whose columns have mean 0 and SD 1."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    points = qmc.Sobol(5, seed=seed).random_base2(int(np.ceil(np.log2(people))))[:people]
    normal = ndtri(np.clip(points, 1e-6, 1.0 - 1e-6))
    normal = (normal - normal.mean(axis=0)) / normal.std(axis=0)
    middles = ndtri((np.arange(TRIALS) + 0.5) / TRIALS)
    decisions = np.random.default_rng(seed).permuted(np.tile(middles, (people, 1)), axis=1)
    return Crowd(normal, decisions, quarters(1.0))
