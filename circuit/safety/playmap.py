"""The steady cycle of a drive, with bounds for any number of plays in any order.

With a given current the circuit is linear in its temperatures, and a node never gets colder because another is warmer:
a play with its pause is a map x → Φ·x + g with Φ ≥ 0. The state before a play therefore tends to a fixed point, the
*steady cycle*. A state u that is warmer than rest, and that no drive of a set makes warmer (Φ·u + g ≤ u for each), is
warmer than the state before any play in any order: the *warm bound*; the *cold bound* is its mirror image.

A few runs determine a map: one lane per node starts 1 K warmer there, and one starts unchanged. Repetition then costs
products of small matrices. The least u with u = max(start, Φ₁·u + g₁, Φ₂·u + g₂ …), node by node, comes from Howard's
iteration: which of them is the largest in each node, solve with those, again until none changes. Long drives, and heat
sinks with a controller, are simulated instead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .ensemble import Ensemble, LaneDrives
from .tally import COLDEST_C, HOTTEST_C

MOST_STEPS = 20_000
"""A drive of more steps is simulated repeatedly instead: a map takes some 50 runs, a search for a cycle about ten."""

MOST_CHOICES = 60
"""Most iterations of Howard's method; a handful is usual."""

POWERS = 40
"""Products that distinguish an eigenvalue below 1 from one above; where they fail, all are computed."""

ROUNDING_K = 1e-11
"""Howard's method has arrived when no node moves by more than this."""

NEAR_K = 1e-6
"""Tolerance for the growth of a bound in one more play: rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class PlayMap:
    """Nodes above the deep one (rigs, m) at the end of something, from those before: `matrix @ nodes + constant`."""

    matrix: Array
    constant: Array

    @staticmethod
    def of(ensemble: Ensemble, drive: Drive | LaneDrives, start: State) -> PlayMap:
        """The map of a drive in every corner of an ensemble whose heat sinks are ideal."""
        corners, nodes = start.nodes_C.shape
        free = nodes - 1
        warmer = np.zeros((free + 1, nodes))
        warmer[1:, :free] = np.eye(free)
        begun = (start.nodes_C[:, np.newaxis] + warmer).reshape(-1, nodes)
        rigs = np.repeat(np.arange(corners, dtype=np.int64), free + 1)
        ended = ensemble.end_of(drive, State.settled(begun), rigs).nodes_C
        ended = ended.reshape(corners, free + 1, nodes)[:, :, :free]
        matrix = np.swapaxes(ended[:, 1:] - ended[:, :1], 1, 2)
        return PlayMap(matrix, ended[:, 0] - np.einsum("cij,cj->ci", matrix, start.nodes_C[:, :free]))

    def after(self, nodes_C: Array) -> Array:
        """Nodes (rigs, m + 1) afterwards; the last, which is deep, stays."""
        moved = np.einsum("cij,cj->ci", self.matrix, nodes_C[:, :-1]) + self.constant
        return np.concatenate([moved, nodes_C[:, -1:]], axis=1)

    def then(self, other: PlayMap) -> PlayMap:
        """First this map, then another."""
        constant = np.einsum("cij,cj->ci", other.matrix, self.constant) + other.constant
        return PlayMap(other.matrix @ self.matrix, constant)

    def only(self, corners: list[int]) -> PlayMap:
        """The map of some rigs."""
        return PlayMap(self.matrix[corners], self.constant[corners])

    def fixed_point(self) -> tuple[Array, npt.NDArray[np.bool_]]:
        """Nodes (rigs, m) that come back to themselves, and whether all others tend to them (rigs,)."""
        point = _solved(self.matrix, self.constant)
        return point, np.array([_settles(matrix) for matrix in self.matrix]) & np.isfinite(point).all(axis=1)


def _settles(matrix: Array) -> bool:
    """Whether all eigenvalues of a matrix without negative entries lie inside the unit circle.

    For any v > 0 the largest lies between the least and the greatest of (P·v)/v, which powers of P bring together.
    """
    if not np.isfinite(matrix).all():
        return False
    v = np.ones(len(matrix))
    for _ in range(POWERS):
        grown = np.maximum(matrix @ v, 1e-12)
        ratio = grown / v
        if ratio.max() < 1.0 or ratio.min() >= 1.0:
            return bool(ratio.max() < 1.0)
        v = grown / grown.max()
    return bool(np.abs(np.linalg.eigvals(matrix)).max() < 1.0)


def least_bound(maps: Sequence[PlayMap], starts_C: Sequence[Array], side: float) -> Array:
    """Nodes (rigs, m) that starts and plays never exceed, by `side` 1 above or −1 below; checked, NaN for none."""
    most = np.max([side * start for start in starts_C], axis=0)
    matrices = np.stack([np.zeros_like(maps[0].matrix), *(each.matrix for each in maps)])
    constants = np.stack([most, *(side * each.constant for each in maps)])
    now, chosen = most, np.full(most.shape, -1)
    rig, node = np.ogrid[: most.shape[0], : most.shape[1]]
    for _ in range(MOST_CHOICES):
        options = np.einsum("kcij,cj->kci", matrices, now) + constants
        best = np.argmax(np.nan_to_num(options, nan=-np.inf), axis=0)
        if (best == chosen).all():
            break
        chosen, before = best, now
        now = _solved(matrices[chosen, rig, node], constants[chosen, rig, node])
        if (np.abs(now - before) <= ROUNDING_K).all():  # two that are equally large may go on changing places
            break
    after = (np.einsum("kcij,cj->kci", matrices, now) + constants).max(axis=0)
    holds = (after <= now + NEAR_K).all(axis=1)
    return side * np.where(holds[:, np.newaxis], now, np.nan)


def _solved(matrix: Array, constant: Array) -> Array:
    """Solutions (rigs, m) of x = matrix·x + constant; NaN where there is none."""
    systems, solution = np.eye(constant.shape[1]) - matrix, np.full_like(constant, np.nan)
    try:
        return np.asarray(np.linalg.solve(systems, constant[..., np.newaxis])[..., 0], dtype=np.float64)
    except np.linalg.LinAlgError:  # of one rig at least: the others have theirs
        for rig, (system, offset) in enumerate(zip(systems, constant, strict=True)):
            with suppress(np.linalg.LinAlgError):
                solution[rig] = np.linalg.solve(system, offset)
    return solution


CLOSE_K = 2e-5
"""A cycle is steady when it returns to its start within this."""
MOST_PLAYS, REMEMBERED = 40, 6
"""Most plays in the search for a steady cycle, and the number of past plays that the acceleration uses."""
BOUND_K = 1e-3
"""Added to a bound that grows by less than this in one more play, so that it grows no further."""

After = Callable[[State], State]
"""States before the next play, for those before this one."""


def steady_cycle(after: After, start: State) -> tuple[State, npt.NDArray[np.bool_]]:
    """Return the states before each play of a cycle that repeats itself, and whether each lane has one (lanes,).

    Anderson's acceleration of x ← F(x), one lane at a time: the next guess is the mean of the last plays' results whose
    changes cancel best. A lane without a steady cycle heats from play to play without limit.
    """
    first = after(start)  # the controller of a heat sink has begun here
    here, there = _joined(first), _joined(after(first))
    guesses, results = [here], [there]
    settled = _change(there - here) <= CLOSE_K
    for _ in range(MOST_PLAYS):
        if settled.all():
            break
        guess = results[-1].copy()
        for lane in np.flatnonzero(~settled):
            guess[lane] = _mixed([g[lane] for g in guesses], [r[lane] for r in results])
        guess = np.clip(np.nan_to_num(guess, nan=HOTTEST_C), COLDEST_C, HOTTEST_C)
        result = _joined(after(_parted(guess, start)))
        guesses, results = [*guesses[-REMEMBERED:], guess], [*results[-REMEMBERED:], result]
        settled = _change(result - guess) <= CLOSE_K
    state = results[-1].copy()
    state[~settled] = np.where(np.isfinite(state[~settled]), state[~settled], HOTTEST_C)
    return _parted(state, start), settled


def bound(afters: Sequence[After], known: Sequence[State], warm: bool) -> State:
    """States warmer (or colder) than before any play in any order; `known`: before first plays and in steady cycles."""
    side, start = 1.0 if warm else -1.0, known[0]
    now = np.max([side * state.nodes_C for state in known], axis=0)
    before = np.zeros(len(now))
    for _ in range(MOST_PLAYS):
        at = State(side * now, start.sink)
        then = np.max([side * after(at).nodes_C for after in afters], axis=0)
        grown = np.nan_to_num(then - now, nan=HOTTEST_C)
        grown = np.where(grown > NEAR_K, grown, 0.0)
        change = grown.max(axis=1)
        if not change.any():
            return State(side * now, start.sink)
        if (change <= BOUND_K).all():
            now[:, :-1] += np.where(change > 0, BOUND_K, 0.0)[:, np.newaxis]
            continue
        share = np.clip(change / np.where(before > 0, before, np.inf), 0.0, 0.95)
        now = np.minimum(now + grown / (1.0 - share)[:, np.newaxis], HOTTEST_C)
        before = change
    return State(np.full_like(now, HOTTEST_C if warm else COLDEST_C), start.sink)


def _mixed(guesses: list[Array], results: list[Array]) -> Array:
    """The mean of results, with weights that sum to 1, for which the same mean of results − guesses is smallest."""
    left = np.array(results) - np.array(guesses)
    if len(left) < 2 or not np.isfinite(left).all():
        return results[-1]
    steps = np.diff(left, axis=0).T
    weights, *_ = np.linalg.lstsq(steps, left[-1], rcond=1e-10)
    return np.asarray(results[-1] - np.diff(np.array(results), axis=0).T @ weights)


def _joined(state: State) -> Array:
    """Nodes and heat sinks side by side, (lanes, nodes + 4)."""
    return np.concatenate([state.nodes_C, np.nan_to_num(state.sink)], axis=1)


def _parted(joined: Array, like: State) -> State:
    nodes = like.nodes_C.shape[1]
    return State(np.ascontiguousarray(joined[:, :nodes]), np.ascontiguousarray(joined[:, nodes:]))


def _change(moved: Array) -> Array:
    return np.asarray(np.abs(np.nan_to_num(moved, nan=HOTTEST_C)).max(axis=1))
