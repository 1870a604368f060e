"""One play of a drive in every corner, and what follows it: the first half of the gate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..rig.rules import Limits
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .checks import Check, worst_of
from .demands import Demands
from .endings import ENDINGS, dose_time_s, follow_endings, judge_the_end, zero_current_C
from .ensemble import Ensemble, LaneDrives
from .repeated import Repeated, recovery_s, skin_C
from .single_faults import Faulty
from .tally import WATCHED, Tally, worst_of_lanes

MOST_CORNERS = 6
"""Corners in which single faults are simulated: the rig as given, and the worst ones."""


@dataclass(frozen=True, slots=True, eq=False)
class Single:
    """A drive played once from its rest: every rule in every scenario, and the states it starts from and ends with.

    The first of `tallies` is that of the play alone; `after_C` (corners,) is the skin 60 s later for each of ENDINGS.
    """

    ensemble: Ensemble
    drive: Drive
    rest_A: float
    limits: Limits
    start: State
    end: State
    tallies: tuple[Tally, ...]
    after_C: dict[str, Array]
    recovery_s: float | None

    @staticmethod
    def of(ensemble: Ensemble, drive: Drive, rest_A: float, limits: Limits) -> Single:
        """Play a drive; raises RigError where the rig as given has no steady state to start from."""
        start, state, judged, after = _played(ensemble, drive, rest_A, limits)
        recovery = recovery_s(ensemble, rest_A, start, state)
        return Single(ensemble, drive, rest_A, limits, start, state, judged, after, recovery)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every rule in its worst scenario."""
        return worst_of(tally.checks() for tally in self.tallies)

    @property
    def safe(self) -> bool:
        """Whether one play exceeds no hard limit."""
        return all(tally.passes() for tally in self.tallies)

    def demands(self, repeated: Repeated, played: list[Tally], reach_C: tuple[float, float]) -> Demands:
        """What the hardware must prevent; `played` are the tallies of repetition, `reach_C` extremes of displays."""
        corners = self._farthest([*self.tallies, *played])
        few = self.ensemble.only(corners)
        faulty = Faulty(few, self.drive, self.rest_A, self.start.take(np.array(corners)), self.limits)
        watchdog, hangs = faulty.watchdog_s()
        rest, begins = faulty.rest_before()
        polarity, swapped = faulty.polarity()
        cut_off, stuck = faulty.cut_off(reach_C)
        zero = None
        if self.ensemble.ideal:
            dose = self.tallies[0].summed("thermal dose")
            zero = dose_time_s(self.ensemble, self.limits, self.end, dose, self.limits.session_s)
            zero = None if zero >= self.limits.session_s else round(zero, 0)
        return Demands(
            watchdog, cut_off, polarity, rest, repeated.shortest_pause_s, zero, (hangs, begins, swapped, stuck)
        )

    def _farthest(self, tallies: list[Tally]) -> list[int]:
        count = len(self.ensemble.corners)
        rows: dict[int, None] = {0: None}
        for tally in tallies:
            for lane in tally.worst_lanes():
                rows.setdefault(lane % count)
        return sorted(list(rows)[:MOST_CORNERS])

    @property
    def drift_C(self) -> float:
        """Steady skin temperature in °C under zero current on the rig as given."""
        return float(zero_current_C(self.ensemble)[WATCHED.index("skin_C"), 0])


def checks_of_lanes(ensemble: Ensemble, drives: LaneDrives, limits: Limits) -> tuple[Check, ...]:
    """Every rule in its worst scenario where each corner plays a drive of its own, from rest at its first current."""
    return worst_of_lanes(_played(ensemble, drives, drives.current_A[:, 0], limits)[2])


def _played(
    ensemble: Ensemble, drive: Drive | LaneDrives, rest_A: float | Array, limits: Limits
) -> tuple[State, State, tuple[Tally, ...], dict[str, Array]]:
    """Play a drive: the states it starts from and ends with, its tallies, and the skin 60 s later for each ending."""
    start = ensemble.at_rest(rest_A)
    played, state = Tally(limits, ensemble.corners), start
    for (rows, values), then in ensemble.play(drive, start):
        played.add(rows, values)
        state = then
    tallies = {ending: played.fork(f"then {ending}") for ending in ENDINGS}
    end_s, last_A = float(drive.time_s[-1]), drive.current_A[..., -1]
    after = follow_endings(ensemble, state, last_A if last_A.ndim else float(last_A), end_s, tallies)
    begun = skin_C(ensemble, start)
    return start, state, (played, *tallies.values(), judge_the_end(ensemble, limits, end_s, begun)), after
