"""Who is named what in every subset of a pool: the same persons, points and noise for all subsets.

A presented icon is felt as its point plus noise and named after the nearest point of the subset, as in `confuse`, but
the points stay those of the whole pool.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..arrays import Array
from ..identification.confusion import embed

Objective = Literal["worst", "correct", "bits", "bits-per-s"]
OBJECTIVES: tuple[Objective, ...] = get_args(Objective)
PEOPLE = 24
HALF = 64
"""Noise of every person, used with both signs: 24 people give 3,072 presentations of each icon."""


@dataclass(frozen=True, slots=True)
class SubsetIdentification:
    """A pool as some people feel it: `half` (people, n, n) half squared distances, `push` (people, n, draws) noise
    projected on the points, `lapse` (people,), `durations_s` (n,).
    """

    half: Array
    push: Array
    lapse: Array
    durations_s: Array

    @classmethod
    def of(
        cls,
        d_prime: Array,
        lapse: Array,
        durations_s: Array,
        seed: int,
        most: int = PEOPLE,
        *,
        favour: Array | float = 0.0,
    ) -> SubsetIdentification:
        """The first `most` people of d′ (people, n, n); a person's noise does not depend on how many they are.

        `favour` (people, n) is the log likelihood that people favour names by.
        """
        points, _ = embed(d_prime[:most])
        people, _, axes = points.shape
        noise = np.random.default_rng(np.random.SeedSequence([seed, 5])).standard_normal((people, HALF, axes))
        push = np.einsum("psa,pna->pns", noise, points)
        own = (points**2).sum(axis=-1)
        half = 0.5 * (own[:, :, None] + own[:, None, :]) - np.einsum("pia,pja->pij", points, points)
        favoured = np.broadcast_to(np.asarray(favour, dtype=np.float64), d_prime.shape[:2])[:most, :, None]
        return cls(half, np.concatenate([push, -push], axis=2) + favoured, np.asarray(lapse[:most]), durations_s)

    def __len__(self) -> int:
        return int(self.half.shape[1])

    def person(self, which: int) -> SubsetIdentification:
        """One of the people alone."""
        only = slice(which, which + 1)
        return SubsetIdentification(self.half[only], self.push[only], self.lapse[only], self.durations_s)

    def score(self, chosen: Sequence[int], objective: Objective) -> float:
        """Per cent correct (0–1), bits, or bits a second of the chosen, mean over the people."""
        from . import subset_kernels as subsetkernels

        index = np.asarray(chosen, dtype=np.int64)
        correct, bits = subsetkernels.score_of(self.half, self.push, self.lapse, index)
        return float(subsetkernels.valued(correct, bits, float(self.durations_s[index].mean()), _code(objective)))

    def swapped(self, chosen: Sequence[int], objective: Objective, allowed: Array) -> Array:
        """Scores (k, n) with one chosen icon replaced by another; −inf where `allowed` (k, n) says no."""
        found = np.full((len(chosen), len(self)), -math.inf)
        for place, other in zip(*np.nonzero(allowed), strict=True):
            trial = [*chosen]
            trial[place] = int(other)
            found[place, other] = self.score(trial, objective)
        return found

    def enumerated(
        self, count: int, objective: Objective, must: Sequence[int], costs: Array, most: Sequence[float]
    ) -> tuple[tuple[int, ...], float, int] | None:
        """The best of all subsets that hold `must` and keep the limits, its score, and how many were looked at."""
        from . import subset_kernels as subsetkernels

        order = np.array([*must, *(k for k in range(len(self)) if k not in set(must))], dtype=np.int64)
        best = np.full(count, -1, dtype=np.int64)
        highest = np.asarray(most, dtype=np.float64)
        found = np.array([-math.inf, 0.0])
        subsetkernels.all_subsets(
            np.ascontiguousarray(self.half[:, order][:, :, order]),
            np.ascontiguousarray(self.push[:, order]),
            self.lapse,
            self.durations_s[order],
            np.ascontiguousarray(costs[:, order]),
            highest + 1e-9 * np.abs(highest),
            np.array([len(must), _code(objective)], dtype=np.int64),
            best,
            found,
        )
        if best[0] < 0:
            return None
        chosen = tuple(sorted(int(k) for k in order[best]))
        return chosen, self.score(chosen, objective), int(found[1])

    def pair_errors(self) -> Array:
        """Share (n, n) of presentations of one of a pair, either, that land nearer the other: symmetric, at most 2."""
        n = len(self)
        weight = 1.0 - self.lapse
        errors = np.zeros((n, n))
        for share, half, push in zip(weight, self.half, self.push, strict=True):
            over = np.array([(push - push[i] > half[i][:, None]).mean(axis=-1) for i in range(n)])
            errors += share * (over + over.T)
        errors /= len(weight)
        np.fill_diagonal(errors, 0.0)
        return errors


def _code(objective: Objective) -> int:
    return OBJECTIVES.index(objective)
