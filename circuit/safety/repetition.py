"""Repeated plays that are simulated: the steady cycle of a drive, and bounds for any number of plays in any order.

With a given current the circuit is linear in its temperatures, and a node never gets colder because another is warmer:
a play with its pause is a map x → Φ·x + g with Φ ≥ 0. The state before a play therefore tends to a fixed point, the
*steady cycle*, which Anderson's acceleration finds in a few plays. A state u that is warmer than rest, and that no
drive of a set makes warmer (F(u) ≤ u for each), is warmer than the state before any play in any order: the *warm
bound*. The *cold bound* is its mirror image. Where the map is known, `playmap` solves for both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..solver.batch_inputs import State
from .playmap import NEAR_K
from .tally import COLDEST_C, HOTTEST_C

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
    """Return states that are warmer (or colder) than those before any play of a sequence in any order.

    `known` are those before a first play of each drive, and before each play of its own repetition.
    """
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
    """Largest change of a lane in K."""
    return np.asarray(np.abs(np.nan_to_num(moved, nan=HOTTEST_C)).max(axis=1))
