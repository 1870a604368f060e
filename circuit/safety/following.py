"""Plays that follow another closely: the rate of skin temperature right after a play, before the cycle is steady.

The bounds of `repetition` hold for temperatures; a rate depends on differences between nodes, and no bound on each node
is one on it. It is taken in plays instead: each drive after a play of each from rest, and after one of its steady
cycle. After its own play the pause may also be longer than the shortest by each of LONGER_S, since the display returns
to rest sooner than the skin.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..rig.rules import Limits
from ..solver.batch_inputs import State
from .checks import Before, Scenario
from .repetition import Cycle
from .tally import Tally

LONGER_S = (1.0, 4.0, 15.0)


def following_tallies(
    cycles: Sequence[Cycle],
    starts: Sequence[State],
    steady: Sequence[State],
    begun_C: Array,
    limits: Limits,
    which: int,
) -> list[Tally]:
    """Tallies of one of the cycles after each of them, in all corners; sums over time are not taken.

    Parameters
    ----------
    cycles
        The drives that may follow each other, with the shortest pause.
    starts, steady
        States before a first play of each, and before each play of its own steady cycle.
    begun_C
        Skin temperature (corners,) from which changes count.
    limits
        The rules.
    which
        Number of the cycle that is played.

    """
    cycle = cycles[which]
    ensemble, corners = cycle.ensemble, cycle.ensemble.corners
    before = list(_before(cycles, starts, steady, which))
    states = State(*(np.concatenate([getattr(state, part) for state, _ in before]) for part in ("nodes_C", "sink")))
    tallies = [Tally(limits, corners, Scenario(before=what), begun_C=begun_C) for _, what in before]
    count = len(corners)
    for (rows, values), _ in ensemble.play(cycle.drive, states, np.tile(ensemble.lanes, len(before))):
        for k, tally in enumerate(tallies):
            tally.add(rows, values[:, k * count : (k + 1) * count], sums=False)
    return tallies


def _before(
    cycles: Sequence[Cycle], starts: Sequence[State], steady: Sequence[State], which: int
) -> Iterator[tuple[State, Before]]:
    """States before a play that follows another, and what that is."""
    for number, (cycle, start, settled) in enumerate(zip(cycles, starts, steady, strict=True)):
        if number == which:
            for more_s in (0.0, *LONGER_S):
                longer = replace(cycle, pause_s=cycle.pause_s + more_s)
                yield longer.after(start), Before("once", longer.pause_s)
        else:
            yield cycle.after(start), Before("another", cycle.pause_s)
            yield cycle.after(settled), Before("others", cycle.pause_s)
