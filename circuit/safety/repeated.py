"""Repeated plays of a drive: verdict, recovery time, and the shortest pause that is safe."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Literal

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..inputs import InputError
from ..rig.rules import Limits
from ..solver.batch_inputs import State
from .checks import Before, Check, Scenario, colour_of, findings_of
from .endings import ENDINGS, follow_endings
from .ensemble import Ensemble
from .following import following_tallies
from .repetition import Cycle, bound, steady_cycle
from .tally import WATCHED, Tally

RECOVERED_K = 0.1
LONGEST_PAUSE_S = 600.0
"""Display and skin have recovered within 0.1 K of rest; a pause longer than 10 min is another session."""

RECOVERY_ROWS_S = np.concatenate([np.arange(1200) * 0.1, 120.0 + np.arange(481) * 1.0])
"""Times at which recovery is checked, up to the longest pause."""

PAUSE_STEP_S = 0.1
"""Safe pauses are searched, and reported, in steps of this."""

PRACTICAL_S = 0.1
"""A watchdog and a cut-off this quick are demanded rather than a longer pause, quicker ones are not: assumed."""


class PauseError(InputError):
    """An impossible pause between plays.

    Examples
    --------
    >>> try:
    ...     check_pause(-1.0)
    ... except PauseError as problem:
    ...     print(problem)
    a pause of -1 s between plays is not possible; give 0 to 600 s
    """


@dataclass(frozen=True, slots=True)
class Repeated:
    """The verdict on a drive that is played repeatedly, with its resting current held in the pauses.

    `recovery_s`: from the end of a play until display and skin are back within 0.1 K in every corner; None: later than
    10 min. `shortest_pause_s` is the shortest that is safe, also with a single fault that the hardware prevents as
    demanded, None where none is; `faultless_pause_s` is the shortest that is safe without faults. `plays` fit into a
    session of `session_s`, over which doses add up. `checks` has every rule in the steady cycle, or between bounds on
    the states that any number of plays, in any order of a set, can reach.
    """

    pause_s: float
    recovery_s: float | None
    shortest_pause_s: float | None
    plays: int
    session_s: float
    checks: tuple[Check, ...]
    faultless_pause_s: float | None = None

    def __repr__(self) -> str:
        return f"Repeated({self.colour}: {self.plays} plays with {self.pause_s:g} s between them)"

    @property
    def findings(self) -> tuple[Check, ...]:
        """The limits that repetition exceeds, the hard ones first."""
        return findings_of(self.checks)

    @property
    def colour(self) -> str:
        """Green, amber or red."""
        return "red" if self.too_soon else colour_of(self.findings)

    @property
    def too_soon(self) -> bool:
        """Whether the pause is safe without faults only, since no hardware is quick enough in practice."""
        if self.shortest_pause_s is None or self.faultless_pause_s is None:
            return False
        return self.faultless_pause_s <= self.pause_s < self.shortest_pause_s

    @property
    def reason(self) -> str | None:
        """The first hard limit passed, in one sentence with its cure; None where there is none."""
        from .words import repeated_reason

        return repeated_reason(self)

    def to_dict(self) -> dict[str, object]:
        """All of it, as a sidecar holds it."""
        return {
            "colour": self.colour,
            "reason": self.reason,
            "pause_s": self.pause_s,
            "plays": self.plays,
            "session_s": self.session_s,
            "findings": [check.to_dict() for check in self.findings],
        }


def check_pause(pause_s: float | None) -> None:
    """Raise PauseError for a pause that is not between 0 and 10 min."""
    if pause_s is not None and not 0.0 <= pause_s <= LONGEST_PAUSE_S:
        raise PauseError(f"a pause of {pause_s:g} s between plays is not possible; give 0 to {LONGEST_PAUSE_S:g} s")


@dataclass(frozen=True, slots=True, eq=False)
class Repeating:
    """Drives on one rig that may follow each other in any order, each in all corners and from its own resting state."""

    ensemble: Ensemble
    drives: Sequence[Cycle]
    starts: Sequence[State]
    limits: Limits
    _known: dict[tuple[float, bool], list[list[Tally]]] = field(default_factory=dict)

    def tallies(self, pause_s: float, endings: bool = True) -> list[list[Tally]]:
        """Tallies of each drive with a pause between plays: steady, after another one, between the bounds of all."""
        if (pause_s, endings) not in self._known:
            self._known[pause_s, endings] = list(self._tallies(pause_s, endings))
        return self._known[pause_s, endings]

    def bounds(self, pause_s: float) -> tuple[list[Cycle], list[State], State, State]:
        """The cycles with a pause between plays, their steady states, and the warm and the cold bound of all plays."""
        cycles = [replace(cycle, pause_s=pause_s) for cycle in self.drives]
        steady = [steady_cycle(cycle, start)[0] for cycle, start in zip(cycles, self.starts, strict=True)]
        warm, cold = (bound(cycles, self.starts, steady, warm=warm) for warm in (True, False))
        return cycles, steady, warm, cold

    def _tallies(self, pause_s: float, endings: bool) -> Iterator[list[Tally]]:
        cycles, steady, warm, cold = self.bounds(pause_s)
        for number, (cycle, start, state) in enumerate(zip(cycles, self.starts, steady, strict=True)):
            begun = skin_C(self.ensemble, start)
            drive_tallies = [self._tally(cycle, state, begun, "cycle")[0]]
            drive_tallies += following_tallies(cycles, self.starts, steady, begun, self.limits, number)
            sides: tuple[tuple[State, Literal["warm", "cold"]], ...] = (warm, "warm"), (cold, "cold")
            for bounding, what in sides:
                tally, ended = self._tally(cycle, bounding, begun, what)
                drive_tallies += [tally, *(self._endings(cycle, ended, begun, tally.run) if endings else ())]
            yield drive_tallies

    def safe(self, pause_s: float, endings: bool = True) -> bool:
        """Whether no hard limit is passed with a pause between plays."""
        known = self._known.get((pause_s, endings)) or self._tallies(pause_s, endings)
        return all(tally.passes() for drive_tallies in known for tally in drive_tallies)

    def _tally(
        self, cycle: Cycle, state: State, begun: Array, what: Literal["cycle", "warm", "cold"]
    ) -> tuple[Tally, State]:
        """The tally of a play from a state with its pause, without rates from a bound, and the state at its end."""
        plays, again = plays_in(cycle, self.limits.session_s), Scenario(before=Before(what, cycle.pause_s))
        tally, now = Tally(self.limits, self.ensemble.corners, again, plays=plays, begun_C=begun), state
        for (rows, values), then in self.ensemble.play(cycle.drive, state):
            tally.add(rows, values, rates=what == "cycle")
            now = then
        pause = np.append(0.0, pause_rows(cycle.pause_s))
        if len(pause) > 1:
            rested, _ = self.ensemble.hold(cycle.rest_A, now, pause)
            tally.add(float(cycle.drive.time_s[-1]) + pause, rested, rates=False)
        return tally, now

    def _endings(self, cycle: Cycle, ended: State, begun: Array, run: Scenario) -> list[Tally]:
        corners = self.ensemble.corners
        endings = {
            ending: Tally(self.limits, corners, replace(run, ending=ending), begun_C=begun) for ending in ENDINGS
        }
        end, last = float(cycle.drive.time_s[-1]), float(cycle.drive.current_A[-1])
        follow_endings(self.ensemble, ended, last, end, endings, sums=False)
        return list(endings.values())


def plays_in(cycle: Cycle, session_s: float) -> int:
    """Number of plays of a drive that fit into a session; at least one."""
    length = float(cycle.drive.time_s[-1])
    return max(1, math.floor((session_s + cycle.pause_s) / (length + cycle.pause_s) + 1e-9))


def pause_rows(pause_s: float) -> Array:
    """Times in s of the rows of a pause after its beginning, its end the last."""
    if pause_s <= 0:
        return np.empty(0)
    inside = (RECOVERY_ROWS_S > 0) & (pause_s - 1e-6 > RECOVERY_ROWS_S)
    return np.append(RECOVERY_ROWS_S[inside], pause_s)


def recovery_s(ensemble: Ensemble, rest_A: float, start: State, ended: State) -> float | None:
    """Time in s after a play until display and skin are within 0.1 K of where they began, in every corner."""
    values, _ = ensemble.hold(rest_A, ended, RECOVERY_ROWS_S)
    began, _ = ensemble.hold(rest_A, start, np.array([0.0, 1e-3]))
    which = [WATCHED.index("display_C"), WATCHED.index("skin_C")]
    away = np.abs(values[which] - began[which][:, :, :1]).max(axis=(0, 1)) > RECOVERED_K
    back_s = back_after_s(away) if np.isfinite(values[which]).all() else None
    return None if back_s is None else round(back_s, 1)


def back_after_s(away: npt.NDArray[np.bool_]) -> float | None:
    """Time in s of the row of RECOVERY_ROWS_S from which on nothing is away any more; None where something still is.

    >>> back_after_s(RECOVERY_ROWS_S < 0.25)
    0.3...
    """
    if away[-1]:
        return None
    late = np.flatnonzero(away)
    return float(RECOVERY_ROWS_S[late[-1] + 1]) if len(late) else 0.0


def skin_C(ensemble: Ensemble, state: State) -> Array:
    """Skin (corners,) in °C of states."""
    return np.array([net.read(nodes, "skin_C") for net, nodes in zip(ensemble.networks, state.nodes_C, strict=True)])


def shortest_pause_s(repeating: Repeating) -> float | None:
    """The shortest pause in s, in steps of 0.1 s, with which no hard limit is passed; None up to 10 min.

    Searched in the corners that are worst without a pause; the result is checked in all corners, and any that exceed a
    limit are added to the search.
    """
    tallies = [tally for drive_tallies in repeating.tallies(0.0) for tally in drive_tallies]
    if all(tally.passes() for tally in tallies):
        return 0.0
    count = len(repeating.ensemble.corners)
    deciding = {lane % count for tally in tallies for lane in tally.worst_lanes()}
    while True:
        few = _with(repeating, sorted(deciding))
        pause_s = shortest_of(partial(few.safe, endings=False))
        if pause_s is None:
            return None
        after = [tally for drive_tallies in repeating.tallies(pause_s) for tally in drive_tallies]
        if all(tally.passes() for tally in after):
            return pause_s
        more = {lane % count for tally in after for lane in tally.worst_lanes()}
        if more <= deciding:
            return _later(repeating, pause_s)
        deciding |= more


def lengthened_s(shortest_s: float, longest_s: float, safe: Callable[[float], bool]) -> float:
    """The shortest pause in s from one to another that is safe, within 15 % on the safe side, or the longer one.

    >>> lengthened_s(2.0, 50.0, lambda pause_s: pause_s >= 7.0), lengthened_s(2.0, 5.0, lambda pause_s: False)
    (7.9, 5.0)
    """
    if shortest_s >= longest_s or safe(shortest_s):
        return min(shortest_s, longest_s)
    begin_s = shortest_s + PAUSE_STEP_S
    pauses = np.geomspace(begin_s, longest_s, 2 + max(0, math.ceil(math.log(longest_s / begin_s, 1.15))))
    tried = [math.ceil(pause / PAUSE_STEP_S - 1e-9) * PAUSE_STEP_S for pause in pauses[:-1]]
    place = bisect_left(tried, 1, key=lambda pause_s: int(safe(pause_s)))
    return min(longest_s, round(tried[place], 1)) if place < len(tried) else longest_s


def _later(repeating: Repeating, pause_s: float) -> float | None:
    """A longer pause that is safe in all corners and with all endings; steps grow from 2 %."""
    added = max(PAUSE_STEP_S, 0.02 * pause_s)
    while pause_s < LONGEST_PAUSE_S:
        pause_s = min(math.ceil((pause_s + added) / PAUSE_STEP_S) * PAUSE_STEP_S, LONGEST_PAUSE_S)
        if repeating.safe(pause_s):
            return round(pause_s, 1)
        added *= 3
    return None


def _with(repeating: Repeating, corners: list[int]) -> Repeating:
    few, starts = repeating.ensemble.only(corners), [start.take(np.array(corners)) for start in repeating.starts]
    cycles = [
        replace(cycle, ensemble=few, played=None if cycle.played is None else cycle.played.only(corners))
        for cycle in repeating.drives
    ]
    return Repeating(few, cycles, starts, repeating.limits)


def shortest_of(safe: Callable[[float], bool]) -> float | None:
    """The shortest pause in s above 0 that is safe, in steps of 0.1 s and within 2 % on the safe side; None to 10 min.

    >>> shortest_of(lambda pause_s: pause_s >= 7.0), shortest_of(lambda pause_s: False)
    (7.0, None)
    """
    low, high, longest = 0, 100, round(LONGEST_PAUSE_S / PAUSE_STEP_S)
    while not safe(high * PAUSE_STEP_S):
        if high >= longest:
            return None
        low, high = high, min(4 * high, longest)
    while high - low > max(1, low // 50):
        middle = (low + high) // 2
        low, high = (low, middle) if safe(middle * PAUSE_STEP_S) else (middle, high)
    return round(high * PAUSE_STEP_S, 1)
