"""The states from which plays begin.

A later play begins between the warm and the cold bound of all plays after the shortest pause. A first play follows a
rest. Before that rest the display was without power, or a play was stopped at any instant and no current has flowed
since; the polarity check may have run. A state that is warmer than all of these in every node stays warmer during the
rest, since the circuit preserves order. The rest lasts until its end is as near to the bounds as a display counts as
recovered; the bounds are then widened by the remainder, so that no play begins outside.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from itertools import product
from typing import Generic

import numpy as np

from .checks import Before, Check, Scenario, findings_of, hard_of, worst_of
from .plant import RECOVERED_K, Played, States
from .repeated import Repeating
from .tally import Tally

LONGEST_REST_S = 600.0
"""A rest that is not long enough by then is none."""
LONGER = 1.5
"""Factor between rests that are tried where one leaves too much."""


@dataclass(frozen=True, slots=True, eq=False)
class Starts(Generic[States]):
    """The states (warm, cold) between which every play begins, where `rest_s` or more of rest precede a first one."""

    rest_s: float
    bounds: tuple[States, States]


@dataclass(frozen=True, slots=True, eq=False)
class Beginning(Generic[Played, States]):
    """Possible starts of drives: after a rest from `left` (warm, cold), or after other plays.

    The rest takes `recovery_s` at most, and at least until a display is where it may stay (`least_s`).
    """

    repeating: Repeating[Played, States]
    left: tuple[States, States]
    recovery_s: float
    least_s: float = 0.0

    @staticmethod
    def of(repeating: Repeating[Played, States], pause_s: float, recovery_s: float) -> Beginning[Played, States]:
        """For pauses from one in s on: after a shorter one plays would go farther."""
        _, warm, cold = repeating.bounds(pause_s)
        return Beginning(repeating, repeating.plant.stopped(repeating.plays, (warm, cold)), recovery_s)

    def after(self, pause_s: float) -> Starts[States]:
        """The starts with a pause between plays, after the shortest rest that leaves next to nothing to be joined."""
        plant, plays = self.repeating.plant, self.repeating.plays
        steady, *later = self.repeating.bounds(pause_s)

        def recovered(rest_s: int) -> bool:
            """Whether display, skin, receptors and hot plate are as near to the bounds of later plays."""
            away_K = [
                side * (plant.now(play, plant.rested(play, begun, rest_s)) - plant.now(play, bound))
                for (side, begun, bound), play in product(zip((1.0, -1.0), self.left, later, strict=True), plays)
            ]
            return bool(np.max(away_K) <= RECOVERED_K)

        longest_s = math.ceil(self.recovery_s)
        rest_s = max(self.least_s, float(bisect_left(range(longest_s), 1, key=lambda rest_s: int(recovered(rest_s)))))
        warm, cold = ([plant.rested(play, state, rest_s) for play in plays] for state in self.left)
        joined = (
            plant.bound(plays, pause_s, [*steady, *states], side) for states, side in ((warm, True), (cold, False))
        )
        return Starts(rest_s, (next(joined), next(joined)))

    def kept_s(self, starts: Starts[States], pause_s: float) -> float | None:
        """The rest in s after which no play that may begin passes a hard limit; None where the longest is too short."""
        drives, rest_s = self.repeating.drives, starts.rest_s
        ends = zip((Before("warm", pause_s), Before("cold", pause_s)), starts.bounds, strict=True)
        for (before, state), play in product(ends, self.repeating.plays):
            between = self.repeating.judged(play, before, state, None, endings=False)
            if not all(tally.passes() for tally in between):
                return None
        while any(hard_of(self.unpowered(number, rest_s)) for number in range(len(drives))):
            if rest_s >= LONGEST_REST_S:
                return None
            rest_s = min(LONGEST_REST_S, float(np.ceil(LONGER * max(1.0, rest_s))))
        return rest_s

    def unpowered(self, number: int, rest_s: float) -> tuple[Check, ...]:
        """The worst excess of a drive after a rest on a display that was without power."""
        plant, checks = self.repeating.plant, []
        for play in self.repeating.drives[number]:
            tally = Tally(self.repeating.limits, plant.corners, Scenario(way=play.way))
            state = plant.rested(play, plant.unpowered(), rest_s)
            for (rows, values), _ in plant.play(play, state):
                tally.add(rows, values, rates=plant.rates)
            checks.append(tally.checks())
        return findings_of(worst_of(checks))
