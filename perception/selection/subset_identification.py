"""Who is named what in every subset of a pool: the same persons, points and noise for all subsets.

A presented icon is felt as its point plus noise and named after the nearest point of the subset, as in `confuse`, but
the points stay those of the whole pool.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

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
    projected on the points, `lapse` (people,), `durations_s` (n,). A subset scores what the `share` of people reaches,
    or for None their mean.
    """

    half: Array
    push: Array
    lapse: Array
    durations_s: Array
    share: float | None = None

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
        share: float | None = None,
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
        return cls(half, np.concatenate([push, -push], axis=2) + favoured, np.asarray(lapse[:most]), durations_s, share)

    def __len__(self) -> int:
        return int(self.half.shape[1])

    def score(self, chosen: Sequence[int], objective: Objective) -> float:
        """Proportion correct, bits, or bits a second of the chosen: mean over people, or what the share reaches."""
        from . import subset_kernels as subsetkernels

        index = np.asarray(chosen, dtype=np.int64)
        # The last is "replaced" by itself; of equally near ones it wins no more often than where it stands.
        each = subsetkernels.swapped(self.half, self.push, self.lapse, index, len(index) - 1, index[-1:])[:, 0]
        return float(self._valued(each, self.durations_s[index].mean(), objective))

    def swapped(self, chosen: Sequence[int], objective: Objective, allowed: NDArray[np.bool_]) -> Array:
        """Scores (k, n) with one chosen icon replaced by another; −inf where `allowed` (k, n) says no."""
        from . import subset_kernels as subsetkernels

        index = np.asarray(chosen, dtype=np.int64)
        found = np.full((len(chosen), len(self)), -math.inf)
        for place in range(len(chosen)):
            others = np.flatnonzero(allowed[place])
            if others.size:
                each = subsetkernels.swapped(self.half, self.push, self.lapse, index, place, others)
                trials = np.repeat(index[None], others.size, axis=0)
                trials[:, place] = others
                found[place, others] = self._valued(each, self.durations_s[trials].mean(axis=1), objective)
        return found

    def _valued(self, each: Array, duration_s: Any, objective: Objective) -> Array:
        """Values of an objective from correct and bits (2, …, people): the mean, or what the share of them reaches."""
        if self.share is None:
            # A running sum, as over all subsets, so that equal choices have equal scores there and here.
            correct, bits = np.add.accumulate(each, axis=-1)[..., -1] / each.shape[-1]
        else:
            correct, bits = np.quantile(each, 1.0 - self.share, axis=-1)
        values: Array = {"correct": correct, "bits": bits}.get(objective, bits / duration_s)
        return values

    def enumerated(
        self, count: int, objective: Objective, must: Sequence[int], costs: Array, most: Sequence[float]
    ) -> tuple[tuple[int, ...], float, int] | None:
        """The best of all subsets that hold `must` and keep the limits, its score, and how many were looked at.

        It is that of the people's mean, whatever `share` is.
        """
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
