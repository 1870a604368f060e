"""One play in every corner, and what follows it: the first half of the gate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

import numpy as np

from ..arrays import Array
from ..rig.rules import Limits
from .checks import Check, Scenario, worst_of
from .ensemble import Ensemble, LaneDrives
from .plant import Plant, Played, States, follow
from .tally import WATCHED, Tally, worst_of_lanes

RECOVERED_K = 0.1
"""Display and skin have recovered within 0.1 K of rest."""

RECOVERY_ROWS_S = np.concatenate([np.arange(1200) * 0.1, 120.0 + np.arange(481) * 1.0])
"""Times at which recovery is checked, up to the longest pause."""


@dataclass(frozen=True, slots=True, eq=False)
class Single(Generic[Played, States]):
    """A play from rest: every rule in every scenario, and the states it starts from and ends with.

    The first of `tallies` is that of the play alone; `after_C` (corners,) is the skin 60 s later for each ending.
    """

    plant: Plant[Played, States]
    play: Played
    start: States
    end: States
    tallies: tuple[Tally, ...]
    after_C: dict[str, Array]

    @staticmethod
    def of(
        plant: Plant[Played, States],
        play: Played,
        limits: Limits,
        *,
        before_s: float = 0.0,
        sums: Tally | None = None,
        watch: Callable[[float], None] | None = None,
    ) -> Single[Played, States]:
        """Play from rest; raises RigError where the rig as given has no steady state to start from.

        `before_s` is how long other plays took, whose doses `sums` has; `watch` is called with the seconds played.
        """
        start = state = plant.rest(play)
        played = sums or Tally(limits, plant.corners, Scenario(way=play.way))
        for (rows, values), then in plant.play(play, start):
            played.add(before_s + rows, values, rates=plant.rates)
            state = then
            if watch is not None:
                watch(before_s + float(rows[-1]))
        endings, end_s = [played.fork(ending) for ending in plant.endings], before_s + play.end_s
        after = follow(plant, play, state, end_s, endings)
        more = plant.alone(limits, end_s, plant.now(play, start)[0])
        return Single(plant, play, start, state, (played, *endings, *more), after)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every rule in its worst scenario."""
        return worst_of(tally.checks() for tally in self.tallies)

    @property
    def safe(self) -> bool:
        """Whether one play exceeds no hard limit."""
        return all(tally.passes() for tally in self.tallies)

    @property
    def recovery_s(self) -> float | None:
        """Time in s after a play until display and skin are within 0.1 K of where they began, in every corner."""
        return recovery_s(self.plant, self.play, self.start, self.end)


def recovery_s(plant: Plant[Played, States], play: Played, start: States, ended: States) -> float | None:
    """Time in s from the end of a play until display and skin are within 0.1 K of a start, in every corner; None: later
    than 10 min.
    """
    which = [WATCHED.index("display_C"), WATCHED.index("skin_C")]
    values = plant.hold(play, ended, RECOVERY_ROWS_S)[which]
    away = np.abs(values - plant.now(play, start)[which][:, :, np.newaxis]).max(axis=(0, 1)) > RECOVERED_K
    if away[-1] or not np.isfinite(values).all():
        return None
    late = np.flatnonzero(away)
    return round(play.settling_s + (float(RECOVERY_ROWS_S[late[-1] + 1]) if len(late) else 0.0), 1)


def checks_of_lanes(ensemble: Ensemble, drives: LaneDrives, limits: Limits) -> tuple[Check, ...]:
    """Every rule in its worst scenario where each corner plays a drive of its own, from rest at its first current."""
    from .current import CurrentPlant, CurrentPlay

    play = CurrentPlay(drives, drives.current_A[:, 0])
    return worst_of_lanes(Single.of(CurrentPlant.of(ensemble), play, limits).tallies)
