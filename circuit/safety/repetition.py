"""Repeated plays: the steady cycle of a drive, and bounds that hold for any number of plays in any order.

With a given current the circuit is linear in its temperatures, and a node never gets colder because another is warmer:
a play with its pause is a map x → Φ·x + g with Φ ≥ 0. The state before a play therefore tends to a fixed point, the
*steady cycle*, which Anderson's acceleration finds in a few plays. A state u that is warmer than rest, and that no
drive of a set makes warmer (F(u) ≤ u for each), is warmer than the state before any play in any order: the *warm
bound*. The *cold bound* is its mirror image.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .ensemble import Ensemble, row_of
from .playmap import MOST_STEPS, NEAR_K, PlayMap, least_bound
from .tally import COLDEST_C, HOTTEST_C

CLOSE_K = 2e-5
"""A cycle is steady when it returns to its start within this."""
MOST_PLAYS, REMEMBERED = 40, 6
"""Most plays in the search for a steady cycle, and the number of past plays that the acceleration uses."""
BOUND_K = 1e-3
"""Added to a bound that grows by less than this in one more play, so that it grows no further."""


@dataclass(frozen=True, slots=True, eq=False)
class Cycle:
    """A drive on an ensemble with the current that is held in the pause after it, for `pause_s`.

    `played` is its play as a map; None where it is simulated instead: a long drive, or a heat sink with a controller.
    """

    ensemble: Ensemble
    drive: Drive
    rest_A: float
    pause_s: float
    played: PlayMap | None = None

    def after(self, state: State) -> State:
        """States before the next play, for those before this one."""
        if self.played is not None:
            played = State(self.played.after(state.nodes_C), state.sink)
        else:
            played = self.ensemble.end_of(self.drive, state)
        if self.pause_s <= 0:
            return played
        return self.ensemble.rest(self.rest_A, played, self.pause_s)

    def whole(self, played: PlayMap) -> PlayMap:
        """A play as a map, and the pause after it."""
        if self.pause_s <= 0:
            return played
        return played.then(PlayMap(*self.ensemble.modes(self.rest_A).passage(self.pause_s)))


def mapped(cycle: Cycle, start: State) -> Cycle:
    """The same cycle with its play as a map, where that is quicker."""
    steps = float(cycle.drive.time_s[-1]) / row_of(cycle.drive)
    if not cycle.ensemble.ideal or steps > MOST_STEPS or cycle.played is not None:
        return cycle
    return replace(cycle, played=PlayMap.of(cycle.ensemble, cycle.drive, start))


def steady_cycle(cycle: Cycle, start: State) -> tuple[State, npt.NDArray[np.bool_]]:
    """Return the states before each play of a cycle that repeats itself, and whether each lane has one (lanes,).

    Anderson's acceleration of x ← F(x), one lane at a time: the next guess is the mean of the last plays' results whose
    changes cancel best. A lane without a steady cycle heats from play to play without limit. Where the play is a map,
    its fixed point is solved for.
    """
    if cycle.played is not None:
        nodes, settles = cycle.whole(cycle.played).fixed_point()
        nodes = np.where(settles[:, np.newaxis], np.clip(nodes, COLDEST_C, HOTTEST_C), HOTTEST_C)
        return State(np.concatenate([nodes, start.nodes_C[:, -1:]], axis=1), start.sink), settles
    first = cycle.after(start)  # the controller of a heat sink has begun here
    here, there = _joined(first), _joined(cycle.after(first))
    guesses, results = [here], [there]
    settled = _change(there - here) <= CLOSE_K
    for _ in range(MOST_PLAYS):
        if settled.all():
            break
        guess = results[-1].copy()
        for lane in np.flatnonzero(~settled):
            guess[lane] = _mixed([g[lane] for g in guesses], [r[lane] for r in results])
        guess = np.clip(np.nan_to_num(guess, nan=HOTTEST_C), COLDEST_C, HOTTEST_C)
        result = _joined(cycle.after(_parted(guess, start)))
        guesses, results = [*guesses[-REMEMBERED:], guess], [*results[-REMEMBERED:], result]
        settled = _change(result - guess) <= CLOSE_K
    state = results[-1].copy()
    state[~settled] = np.where(np.isfinite(state[~settled]), state[~settled], HOTTEST_C)
    return _parted(state, start), settled


def bound(cycles: Sequence[Cycle], starts: Sequence[State], steady: Sequence[State], warm: bool) -> State:
    """Return states that are warmer (or colder) than those before any play of a sequence of the cycles, in any order.

    `starts` are those before a first play of each cycle, `steady` those before each play of its own repetition.
    """
    side, start = 1.0 if warm else -1.0, starts[0]
    farthest = HOTTEST_C if warm else COLDEST_C
    maps = [cycle.whole(cycle.played) for cycle in cycles if cycle.played is not None]
    if len(maps) == len(cycles):
        free = least_bound(maps, [state.nodes_C[:, :-1] for state in (*starts, *steady)], side)
        nodes = np.concatenate([np.nan_to_num(free, nan=farthest), start.nodes_C[:, -1:]], axis=1)
        return State(nodes, start.sink)
    now = np.max([side * state.nodes_C for state in (*starts, *steady)], axis=0)
    before = np.zeros(len(now))
    for _ in range(MOST_PLAYS):
        at = State(side * now, start.sink)
        then = np.max([side * cycle.after(at).nodes_C for cycle in cycles], axis=0)
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
    return State(np.full_like(now, farthest), start.sink)


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
