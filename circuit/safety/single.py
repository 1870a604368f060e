"""One play of a drive in every corner, and what follows it: the first half of the gate."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import repeat

import numpy as np

from ..arrays import Array
from ..rig.rules import Limits
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .checks import Check, worst_of
from .demands import CutOff, Demands
from .endings import ENDINGS, dose_time_s, follow_endings, judge_the_end, zero_current_C
from .ensemble import Ensemble, LaneDrives
from .first_plays import polarity_check, rest_before
from .repeated import LONGEST_PAUSE_S, PAUSE_STEP_S, PRACTICAL_S, Repeating, lengthened_s, recovery_s, skin_C
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

    def shown_C(self, bounds: Sequence[State]) -> tuple[float, float]:
        """Between which temperatures in °C the display is in plays that begin between bounds."""
        shown = [
            values[WATCHED.index("display_C")]
            for one in bounds
            for (_, values), _ in self.ensemble.play(self.drive, one)
        ]
        return float(min(np.nanmin(one) for one in shown)), float(max(np.nanmax(one) for one in shown))

    def faulty(self, corners: list[int], bounds: Sequence[State], instants: tuple[int, ...] | None = None) -> Faulty:
        """Its single faults in some corners, in plays that begin between bounds."""
        which = np.array(corners)
        start, *between = (state.take(which) for state in (self.start, *bounds))
        few = self.ensemble if len(corners) == len(self.ensemble.corners) else self.ensemble.only(corners)
        return Faulty(few, self.drive, self.rest_A, start, self.limits, tuple(between), instants)

    def demands(
        self,
        corners: list[int],
        hardest: list[int],
        bounds: Sequence[State],
        reach_C: tuple[float, float],
        pause_s: float | None,
    ) -> Demands:
        """What the hardware must prevent; `reach_C` are extremes of displays.

        The numbers of watchdog and cut-off are found in the `hardest` corners, tried in all at the instants that
        decided, and found again in those where they are too slow; the rest in `corners`.
        """
        every = list(range(len(self.ensemble.corners)))
        for current_A in self.faulty(every, bounds).ends_A if self.ensemble.ideal else ():
            self.ensemble.modes(current_A)  # once for all corners and icons
        faulty = self.faulty(hardest, bounds)
        moments = faulty.moments()
        watchdog_s, hangs = faulty.watchdog_s(moments)
        cut_off, stuck = faulty.cut_off(reach_C, moments, hangs=not watchdog_s)
        far_K = faulty.beyond_K(moments, watchdog_s, cut_off)
        worst = far_K.reshape(len(far_K), len(moments.instants), -1).max(axis=2).argmax(axis=1)
        everywhere = self.faulty(every, bounds, tuple(np.unique(worst).tolist()))
        moments = everywhere.moments()
        too_slow = (everywhere.beyond_K(moments, watchdog_s, cut_off) > 0.0).any(axis=0)
        if too_slow.any():
            there = self.faulty(np.unique(moments.rigs[too_slow]).tolist(), bounds)
            moments = there.moments()
            watchdog_s, hangs = min((watchdog_s, hangs), there.watchdog_s(moments), key=lambda found: found[0])
            cut_off, stuck = min(
                (cut_off, stuck),
                there.cut_off(reach_C, moments, hangs=not watchdog_s),
                key=lambda found: found[0].react_within_s,
            )
        faulty = self.faulty(corners, ())
        rest, begins = rest_before(faulty)
        polarity, swapped = polarity_check(faulty)
        zero = None
        if self.ensemble.ideal:
            dose = self.tallies[0].summed("thermal dose")
            zero = dose_time_s(self.ensemble, self.limits, self.end, dose, self.limits.session_s)
            zero = None if zero >= self.limits.session_s else round(zero, 0)
        return Demands(watchdog_s, cut_off, polarity, rest, pause_s, zero, (hangs, begins, swapped, stuck))

    def farthest(self, tallies: list[Tally]) -> list[int]:
        """Corners that are worst by some hard rule, the rig as given first."""
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


def demanded(
    singles: Sequence[Single],
    repeating: Repeating,
    tallies: Sequence[list[Tally]],
    reach_C: tuple[float, float],
    shortest_s: float | None,
) -> tuple[float | None, list[Demands]]:
    """The shortest pause after which faults can be prevented in practice, and what prevents them in any play after it.

    `reach_C` are extremes of displays in first plays and after them. Shorter pauses need a quicker watchdog and a
    quicker cut-off. Where these would be quicker than PRACTICAL_S, and are not with a pause in which display and skin
    recover, the pause is lengthened instead. A set that no pause makes safe is judged in its first plays.
    """
    corners = [single.farthest([*single.tallies, *own]) for single, own in zip(singles, tallies, strict=True)]
    if shortest_s is None:
        return None, [single.demands(few, few, (), reach_C, None) for single, few in zip(singles, corners, strict=True)]
    bounds_of = cache(lambda pause_s: repeating.bounds(pause_s)[2:])
    reach_of = cache(lambda pause_s: _joined([reach_C, *(s.shown_C(bounds_of(pause_s)) for s in singles)]))
    every = list(range(len(repeating.ensemble.corners)))
    hardest = [single.faulty(every, bounds_of(shortest_s)).hardest(reach_C, PRACTICAL_S) for single in singles]

    def holds(number: int, pause_s: float, within_s: tuple[float, float]) -> bool:
        if not any(within_s):
            return True
        faulty = singles[number].faulty(hardest[number], bounds_of(pause_s))
        cut = CutOff(*faulty.around_C(reach_of(pause_s)), within_s[1])
        return bool(faulty.beyond_K(faulty.moments(), within_s[0], cut).max() <= 0.0)

    recovered = [LONGEST_PAUSE_S if single.recovery_s is None else single.recovery_s for single in singles]
    longest_s, numbers, practical = max(shortest_s, *recovered), range(len(singles)), (PRACTICAL_S, PRACTICAL_S)
    needed = [(0.0, 0.0) if holds(k, shortest_s, practical) else practical for k in numbers]
    for number, single in enumerate(singles):
        if not holds(number, longest_s, needed[number]):
            found = single.demands(
                hardest[number], hardest[number], bounds_of(longest_s), reach_of(longest_s), None
            ).within_s
            needed[number] = min(PRACTICAL_S, found[0]), min(PRACTICAL_S, found[1])
    pause_s = lengthened_s(shortest_s, longest_s, lambda longer_s: all(map(holds, numbers, repeat(longer_s), needed)))
    added_s = max(PAUSE_STEP_S, 0.02 * pause_s)
    while True:
        bounds, reach, demands = bounds_of(pause_s), reach_of(pause_s), {}
        for number in sorted(numbers, key=lambda number: not any(needed[number])):  # what may not suffice first
            one = singles[number].demands(corners[number], hardest[number], bounds, reach, pause_s)
            if pause_s < longest_s and np.less(one.within_s, needed[number]).any():
                break
            demands[number] = one
        else:
            return pause_s, [demands[number] for number in numbers]
        pause_s, added_s = min(longest_s, math.ceil((pause_s + added_s) / PAUSE_STEP_S) * PAUSE_STEP_S), 2.0 * added_s


def _joined(spans: Sequence[tuple[float, float]]) -> tuple[float, float]:
    return min(low for low, _ in spans), max(high for _, high in spans)


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
    tallies = {ending: played.fork(ending) for ending in ENDINGS}
    end_s, last_A = float(drive.time_s[-1]), drive.current_A[..., -1]
    after = follow_endings(ensemble, state, last_A if last_A.ndim else float(last_A), end_s, tallies)
    begun = skin_C(ensemble, start)
    return start, state, (played, *tallies.values(), judge_the_end(ensemble, limits, end_s, begun)), after
