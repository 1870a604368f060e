"""Steady cycles and bounds of plays by repeated simulation on a heat sink with its own controller.

Such a play is no map of its nodes, since the controller has a state and a greatest power. On an ideal heat sink it is,
and nearly the same one: the bound of these maps is played, and their constants are moved until no play leads out of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .ensemble import Ensemble, row_of
from .playmap import NEAR_K, NO_BOUND, PlayMap, UnjudgedError, least_bound
from .tally import HOTTEST_C

MOST_STEPS = 20_000
"""A drive of more steps is not judged: so many already take a minute of processor time."""

CLOSE_K = 2e-5
"""A cycle is steady when it returns to its start within this."""

MOST_PLAYS, REMEMBERED = 40, 6
"""Most plays in a search, and the number of past plays that the acceleration uses."""

PLAIN_PLAYS = 10
"""So many plays from rest come nearer to a cycle that plays lead to; another one may return to itself, too."""

After = Callable[[State], State]
"""States before the next play, for those before this one."""


def check_length(ensemble: Ensemble, drives: Sequence[Drive]) -> None:
    """Raise UnjudgedError for the first drive that is too long to be simulated again and again, if that is needed."""
    for number, drive in enumerate(drives, 1):
        steps = round(float(drive.time_s[-1]) / row_of(drive))
        if steps > MOST_STEPS and not ensemble.ideal:
            raise UnjudgedError(
                f"not judged: too long: drive {number} of {len(drives)} is {drive.time_s[-1]:.4g} s in {steps:,} "
                f"steps; at most {MOST_STEPS:,} are simulated on rig {ensemble.rig.name}, whose heat sink has a "
                f"controller of its own: use a shorter icon, a lower driver.update_Hz, or no heat_sink.kp_W_per_K"
            )


def steady_cycle(after: After, played: PlayMap, start: State) -> State:
    """Return the states before each play of a cycle that repeats itself; a lane that has none is as hot as can be.

    Each play is followed by the fixed point of its map `played` on an ideal heat sink, moved to what came out. That is
    repeated with Anderson's acceleration, one lane at a time: the next guess is the mean of the last results whose
    changes cancel best. A lane heats without limit where its map does; raises UnjudgedError where another one does not
    settle, or on what plays from rest do not approach, as on a heat sink that is too weak.
    """
    free = start.nodes_C.shape[1] - 1
    heats = ~played.fixed_point()[1]
    plain = start
    for _ in range(PLAIN_PLAYS):
        plain = after(plain)
    guess = np.where(heats[:, np.newaxis], _joined(start), _joined(plain))
    guesses, results = list[Array](), list[Array]()
    for _ in range(MOST_PLAYS):
        result = _joined(after(_parted(guess, start)))
        unsettled = np.flatnonzero(~heats & (_change(result - guess) > CLOSE_K))
        if not len(unsettled):
            before, later = (_change((_joined(state) - result)[:, :free]) for state in (start, plain))
            if (later > before + CLOSE_K)[~heats].any():
                break
            result[:, :free] = np.where(heats[:, np.newaxis], HOTTEST_C, np.minimum(result[:, :free], HOTTEST_C))
            return _parted(result, start)
        moved = result.copy()
        moved[:, :free] = played.through(guess[:, :free], result[:, :free]).fixed_point()[0]
        guesses, results = [*guesses[-REMEMBERED:], guess], [*results[-REMEMBERED:], moved]
        guess = result.copy()
        for lane in unsettled:
            guess[lane] = _mixed([g[lane] for g in guesses], [r[lane] for r in results])
        guess[heats] = _joined(start)[heats]
        if not np.isfinite(guess).all():
            break
    raise UnjudgedError(NO_BOUND)


def bound(afters: Sequence[After], maps: Sequence[PlayMap], known: Sequence[State], warm: bool) -> State:
    """States warmer (or colder) than before any play in any order; `known`: before first plays and in steady cycles.

    `maps` are those of the plays on ideal heat sinks. A lane that heats without limit is as hot as can be; raises
    UnjudgedError where no bound is found.
    """
    side, like = (1.0 if warm else -1.0), known[0]
    starts = [state.nodes_C[:, :-1] for state in known]
    heats = np.max(starts, axis=(0, 2)) >= HOTTEST_C
    for _ in range(MOST_PLAYS):
        nodes = least_bound(maps, starts, side)
        heats |= np.isnan(nodes).any(axis=1)
        nodes = np.where(heats[:, np.newaxis], HOTTEST_C, nodes)
        begun = State(np.concatenate([nodes, like.nodes_C[:, -1:]], axis=1), like.sink)
        ended = [np.where(heats[:, np.newaxis], nodes, after(begun).nodes_C[:, :-1]) for after in afters]
        if (np.max([side * (end - nodes) for end in ended], axis=0) <= NEAR_K).all():
            return begun
        maps = [played.through(nodes, end) for played, end in zip(maps, ended, strict=True)]
    raise UnjudgedError(NO_BOUND)


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
