r"""What answers say of the pairs of a laboratory, given its constants.

The pooled answers to an icon are multinomial. Their ln odds against its own name are those of the laboratory's people,
plus τz of the pair, plus what J participants happen to be:

    θ = ln odds(ℓ) + w,   w ~ N(0, K)
    K[ab, cd] = τ²·[{a, b} = {c, d}] + R[ab, cd]·Σ_j n_ja n_jc / (Σ_j n_ja Σ_j n_jc)

R is the relative covariance of people, the mean over laboratories. The posterior of w is taken as normal about its mode
(Laplace), whose z is then drawn; with w integrated, it is the likelihood of the laboratory.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array

from ..identification.pairs import pair_scores
from .playing import Confusions

MOST_PAIRS = 45
"""Pairs that answers may move: of sets of more than 10 icons those that are confused most, or were."""
PASSES, STEPS, LONGEST = 3, 6, 1.0
"""Passes with the people's own odds, Newton steps in each, and the longest step (ln)."""
LEAST = 1e-9


@dataclass(frozen=True, slots=True)
class PairPosterior:
    """Normal posterior of the scores (laboratories, pairs) of `pairs`, and ln likelihood (laboratories,).

    `root` (laboratories, pairs, pairs) is the lower root of the covariance.
    """

    pairs: tuple[NDArray[np.int64], NDArray[np.int64]]
    mode: Array
    root: Array
    log_likelihood: Array

    @classmethod
    def of(cls, played: Confusions, counts: Array) -> PairPosterior:
        """By answers (participants, icons, icons) to icons that are named as `played` where all pairs are usual.

        A LinAlgError where a covariance cannot be factorised.
        """
        answers, pooled = counts.sum(axis=0), played.pooled
        total = answers.sum(axis=1)
        first, second = pairs = _chosen(total[:, None] * pooled.mean(axis=0) + answers)
        row, column = np.concatenate([first, second]), np.concatenate([second, first])
        same, spread = row[:, None] == row, played.spread
        tied = np.tile(np.eye(len(first)), (2, 2))
        people = _relative(played, pooled, row, column) * _shared(counts.sum(axis=2))[np.ix_(row, row)]
        prior = np.square(spread)[:, None, None] * tied + people
        scores, off = np.zeros(pooled.shape), np.zeros((len(pooled), len(row)))
        for _ in range(PASSES):
            shown = np.log(played.with_scores(scores).pooled)
            usual = shown - np.diagonal(shown, axis1=1, axis2=2)[:, :, None] - spread[:, None, None] * scores
            for _ in range(STEPS):
                odds = usual.copy()
                odds[:, row, column] += off
                share = np.exp(odds - np.logaddexp.reduce(odds, axis=2)[:, :, None])
                chance = share[:, row, column]
                steep = np.where(same, -(total[row] * chance)[:, :, None] * chance[:, None, :], 0.0)
                steep[:, range(len(row)), range(len(row))] += total[row] * chance
                slope = answers[row, column] - total[row] * chance
                inner = np.eye(len(row)) + steep @ prior
                force = np.linalg.solve(inner, steep @ off[:, :, None] + slope[:, :, None])[:, :, 0]
                off = off + np.clip((prior @ force[:, :, None])[:, :, 0] - off, -LONGEST, LONGEST)
            mode = spread[:, None] * (force[:, : len(first)] + force[:, len(first) :])
            scores[:, first, second] = scores[:, second, first] = mode
        logs = (answers * np.log(share)).sum(axis=(1, 2)) - 0.5 * (force * off).sum(axis=1)
        gained = np.linalg.solve(inner, steep)
        halves = gained[:, :, : len(first)] + gained[:, :, len(first) :]
        left = np.square(spread)[:, None, None] * (halves[:, : len(first)] + halves[:, len(first) :])
        covariance = np.eye(len(first)) - 0.5 * (left + np.swapaxes(left, 1, 2))
        root = np.linalg.cholesky(covariance + LEAST * np.eye(len(first)))
        return cls(pairs, mode, root, np.asarray(logs - 0.5 * np.linalg.slogdet(inner)[1]))

    def drawn(self, icons: tuple[str, ...], rng: np.random.Generator) -> tuple[Array, Array]:
        """Scores (laboratories, icons, icons) of all pairs, and by how much less likely they are a priori (ln)."""
        chance = rng.standard_normal(self.mode.shape)
        own = self.mode + (self.root @ chance[:, :, None])[:, :, 0]
        scores, (first, second) = pair_scores(icons, len(own), int(rng.integers(2**31))), self.pairs
        scores[:, first, second] = scores[:, second, first] = own
        wider = np.log(np.diagonal(self.root, axis1=1, axis2=2)).sum(axis=1)
        return scores, np.asarray(0.5 * (np.square(chance) - np.square(own)).sum(axis=1) + wider)


def _chosen(expected: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The pairs of the most answers (icons, icons)."""
    all_pairs = np.array(list(combinations(range(len(expected)), 2)))
    often = expected + expected.T
    most = np.sort(np.argsort(-often[all_pairs[:, 0], all_pairs[:, 1]], kind="stable")[:MOST_PAIRS])
    return all_pairs[most, 0], all_pairs[most, 1]


def _relative(played: Confusions, pooled: Array, row: NDArray[np.int64], column: NDArray[np.int64]) -> Array:
    """Covariance (cells, cells) of people's odds over those of all."""
    cells, own = pooled[:, row, column], pooled[:, row, row]
    people = played.probability
    apart = people[:, :, row, column] - people[:, :, row, row] * (cells / own)[:, None]
    flat = apart.reshape(-1, len(row))
    size = np.sqrt(np.square(cells).mean(axis=0))
    return np.asarray(flat.T @ flat / (len(people) * (people.shape[1] - 1)) / np.outer(size, size))


def _shared(shown: Array) -> Array:
    """Share (icons, icons) of people's effects left in the sum, by presentations (participants, icons)."""
    total = np.maximum(shown.sum(axis=0), 1.0)
    return np.asarray(shown.T @ shown / np.outer(total, total))


def known_scores(names: tuple[str, ...], scores: Array, of: tuple[str, ...], laboratories: int, seed: int) -> Array:
    """Scores (laboratories, icons, icons) of another set: its pairs of known names keep theirs, others are by chance.

    >>> own = known_scores(("a", "b"), np.array([[[0.0, 3.0], [3.0, 0.0]]]), ("b", "c", "a"), 1, 0)
    >>> float(own[0, 0, 2]), bool(own[0, 0, 1] == own[0, 1, 0] != 0.0)
    (3.0, True)
    """
    found = pair_scores(of, laboratories, seed)
    if scores.size:
        both = [name for name in names if name in of]
        here, there = ([places.index(name) for name in both] for places in (names, of))
        found[:, np.array(there)[:, None], there] = scores[:, np.array(here)[:, None], here]
    return found
