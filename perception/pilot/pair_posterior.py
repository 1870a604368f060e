r"""The posterior of the pairs of a laboratory from its answers for known constants.

The pooled answers to an icon are multinomial. Their ln odds against its own name are those of the laboratory's people,
plus τz − τ²/2 of the pair, what a smooth prediction misses, and what J participants happen to be:

    θ = ln odds(ℓ) − τ²/2 + w,   w ~ N(0, K)
    K[ab, cd] = τ²·[{a, b} = {c, d}] + M[ab, cd] + R[ab, cd]·Σ_j n_ja n_jc / (Σ_j n_ja Σ_j n_jc)

R is the relative covariance of people, the mean over laboratories. The posterior of w is taken as normal about its mode
(Laplace), from which z and what was missed are drawn; with w integrated, it is the likelihood of the laboratory.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array

from ..identification.pairs import pair_log_odds, pair_scores
from .playing import Confusions

MOST_PAIRS = 45
"""Pairs that answers may move: of sets of more than 10 icons those that are confused most, or were."""
PASSES, STEPS, LONGEST = 3, 8, 1.0
"""Passes with the people's own odds, Newton steps in each, and the longest step (ln)."""
LEAST = 1e-9
Places = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class PairPosterior:
    """Normal posterior of the scores (laboratories, pairs) of some pairs, and ln likelihood (laboratories,).

    With what a prediction misses, `mode` and lower `root` are of scores and of the ln odds missed in both cells of
    every pair, (laboratories, 3 pairs).
    """

    played: Confusions
    first: Places
    second: Places
    mode: Array
    root: Array
    log_likelihood: Array

    @classmethod
    def of(cls, played: Confusions, missed: Array | None, counts: Array) -> PairPosterior:
        """By answers (participants, icons, icons) to icons that are named as `played` where all pairs are usual.

        `missed` (laboratories, icons, icons) are ln odds by which such predictions were wrong, if they were. A
        LinAlgError where a covariance cannot be factorised.
        """
        answers, pooled = counts.sum(axis=0), played.pooled
        total, count = answers.sum(axis=1), len(pooled)
        first, second = _chosen(total[:, None] * pooled.mean(axis=0) + answers)
        row, column = np.concatenate([first, second]), np.concatenate([second, first])
        same, spread, cells, pairs = row[:, None] == row, played.spread[:, None, None], len(row), len(first)
        people = _relative(played, pooled, row, column) * _shared(counts.sum(axis=2))[np.ix_(row, row)]
        # Effects: scores, and what is missed; `acts` leads from them to cells, `held` is their covariance.
        off = None if missed is None else missed[:, row, column]
        held = np.eye(pairs) if off is None else _block(np.eye(pairs), off.T @ off / count)
        acts = np.broadcast_to(np.tile(np.eye(pairs), (2, 1)), (count, cells, pairs)) * spread
        if off is not None:
            acts = np.concatenate([acts, np.broadcast_to(np.eye(cells), (count, cells, cells))], axis=2)
        reach = acts @ held
        prior = reach @ np.swapaxes(acts, 1, 2) + people
        usual_pairs = pair_log_odds(spread, np.zeros(pooled.shape))
        # From the people's own odds, to which answers are nearer than to what is usual of pairs that differ much.
        log_odds, moved = np.zeros(pooled.shape), -usual_pairs[:, row, column]
        for _ in range(PASSES):
            shown = np.log(played.with_log_odds(log_odds).pooled)
            usual = shown - np.diagonal(shown, axis1=1, axis2=2)[:, :, None] - log_odds + usual_pairs
            for _ in range(STEPS):
                odds = usual.copy()
                odds[:, row, column] += moved
                share = np.exp(odds - np.logaddexp.reduce(odds, axis=2)[:, :, None])
                chance = share[:, row, column]
                steep = np.where(same, -(total[row] * chance)[:, :, None] * chance[:, None, :], 0.0)
                steep[:, range(cells), range(cells)] += total[row] * chance
                slope = answers[row, column] - total[row] * chance
                inner = np.eye(cells) + steep @ prior
                force = np.linalg.solve(inner, steep @ moved[:, :, None] + slope[:, :, None])
                moved = moved + np.clip((prior @ force)[:, :, 0] - moved, -LONGEST, LONGEST)
            mode = np.swapaxes(reach, 1, 2) @ force
            log_odds[:, row, column] = usual_pairs[:, row, column] + (acts @ mode)[:, :, 0]
        logs = (answers * np.log(share)).sum(axis=(1, 2)) - 0.5 * (force[:, :, 0] * moved).sum(axis=1)
        known = np.swapaxes(reach, 1, 2) @ np.linalg.solve(inner, steep @ reach)
        covariance = held - 0.5 * (known + np.swapaxes(known, 1, 2)) + LEAST * np.eye(len(held))
        likelihood = np.asarray(logs - 0.5 * np.linalg.slogdet(inner)[1])
        root = np.asarray(np.linalg.cholesky(covariance))
        return cls(played, first, second, mode[:, :, 0], root, likelihood)

    def drawn(self, rng: np.random.Generator) -> tuple[Array, Confusions, Array]:
        """Scores (laboratories, icons, icons) of all pairs, confusions with them, and how much likelier they are.

        The last, for scores alone, is the ln of their probability by chance over that by the answers.
        """
        chance, (first, second), played = rng.standard_normal(self.mode.shape), (self.first, self.second), self.played
        own = self.mode + (self.root @ chance[:, :, None])[:, :, 0]
        scores = pair_scores(len(played.icons), len(own), int(rng.integers(2**31)))
        scores[:, first, second] = scores[:, second, first] = own[:, : len(first)]
        log_odds = pair_log_odds(played.spread[:, None, None], scores)
        if own.shape[1] > len(first):
            log_odds[:, first, second] += own[:, len(first) : 2 * len(first)]
            log_odds[:, second, first] += own[:, 2 * len(first) :]
        wider = np.log(np.diagonal(self.root, axis1=1, axis2=2)).sum(axis=1)
        likelier = np.asarray(0.5 * (np.square(chance) - np.square(own)).sum(axis=1) + wider)
        return scores, played.with_log_odds(log_odds), likelier


def known_scores(names: tuple[str, ...], scores: Array, of: tuple[str, ...], laboratories: int, seed: int) -> Array:
    """Scores (laboratories, icons, icons) of another set: its pairs of known names keep theirs, others are by chance.

    >>> own = known_scores(("a", "b"), np.array([[[0.0, 3.0], [3.0, 0.0]]]), ("b", "c", "a"), 1, 0)
    >>> float(own[0, 0, 2]), bool(own[0, 0, 1] == own[0, 1, 0] != 0.0)
    (3.0, True)
    >>> bool((known_scores(("a", "b"), np.ones((1, 2, 2)), ("c", "d"), 1, 0) == pair_scores(2, 1, 0)).all())
    True
    """
    found = pair_scores(len(of), laboratories, seed)
    if scores.size:
        both = [name for name in names if name in of]
        here, there = (np.array([places.index(name) for name in both], dtype=np.int64) for places in (names, of))
        found[:, there[:, None], there] = scores[:, here[:, None], here]
    return found


def _chosen(expected: Array) -> tuple[Places, Places]:
    """The pairs of the most answers (icons, icons)."""
    all_pairs = np.array(list(combinations(range(len(expected)), 2)))
    often = expected + expected.T
    most = np.sort(np.argsort(-often[all_pairs[:, 0], all_pairs[:, 1]], kind="stable")[:MOST_PAIRS])
    return all_pairs[most, 0], all_pairs[most, 1]


def _block(first: Array, second: Array) -> Array:
    whole = np.zeros((len(first) + len(second),) * 2)
    whole[: len(first), : len(first)] = first
    whole[len(first) :, len(first) :] = second
    return whole


def _relative(played: Confusions, pooled: Array, row: Places, column: Places) -> Array:
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
