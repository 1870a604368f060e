"""Repeated plays and their shortest safe pause."""

import math
from bisect import bisect_left
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import chain
from typing import Generic

import numpy as np

from thermicon.base.files.inputs import InputError
from thermicon.base.numbers.arrays import Array

from ..rig.rules import Limits
from .checks import Before, Check, Judged, Scenario, colour_of, hard_reason
from .plant import RECOVERY_ROWS_S, GatePlay, Plant, Played, States, follow, left_s
from .playmap import UnjudgedError
from .tally import Tally

LONGEST_PAUSE_S = 600.0
"""A pause longer than 10 min is another session."""

PAUSE_STEP_S = 0.1
"""Safe pauses are searched, and reported, in steps of this."""


class PauseError(InputError):
    """An impossible pause between plays."""


@dataclass(frozen=True, slots=True)
class Repeated(Judged):
    """The verdict on a drive that is played repeatedly, with its resting current held in the pauses.

    `recovery_s`: until display and skin are back within 0.1 K in every corner; None: later than 10 min.
    `shortest_pause_s` is safe also with a single fault that the hardware prevents as demanded, `faultless_pause_s`
    without faults; None where none is. `plays` fit into a session of `session_s`, over which doses add up. `checks` has
    every rule in the steady cycle, or between bounds on the states that any number of plays, in any order of a set, can
    reach.
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

        return repeated_reason(self, hard_reason(self.findings))

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
class Repeating(Generic[Played, States]):
    """Drives on one plant that may follow each other in any order, each in all ways in which it may be followed."""

    plant: Plant[Played, States]
    drives: Sequence[Sequence[Played]]
    limits: Limits
    _known: dict[float, list[list[Tally]]] = field(default_factory=dict)
    _bounds: dict[float, tuple[list[States], States, States]] = field(default_factory=dict)

    @property
    def plays(self) -> list[Played]:
        """Every drive in every way."""
        return list(chain.from_iterable(self.drives))

    def tallies(self, pause_s: float) -> list[list[Tally]]:
        """Tallies of each drive with a pause between plays: steady, after another one, between the bounds of all."""
        if pause_s not in self._known:
            self._known[pause_s] = list(self._tallies(pause_s, endings=True))
        return self._known[pause_s]

    def bounds(self, pause_s: float) -> tuple[list[States], States, States]:
        """States before plays with a pause between them: of each steady cycle, and the warm and the cold bound."""
        if pause_s not in self._bounds:
            steady = [self.plant.cycle(play, pause_s) for play in self.plays]
            warm, cold = (self.plant.bound(self.plays, pause_s, steady, side) for side in (True, False))
            self._bounds[pause_s] = steady, warm, cold
        return self._bounds[pause_s]

    def _tallies(self, pause_s: float, endings: bool) -> Iterator[list[Tally]]:
        plant, plays = self.plant, self.plays
        steady, warm, cold = self.bounds(pause_s)
        begun, number = plant.begun_C(plays), 0
        bounds = (Before("warm", pause_s), warm), (Before("cold", pause_s), cold)
        for ways in self.drives:
            tallies: list[Tally] = []
            for play in ways:
                cycle = Before("cycle", pause_s)
                tallies += self.judged(play, cycle, steady[number], begun[number], plant.quick)
                tallies += plant.following(plays, pause_s, steady, begun[number], self.limits, number)
                for before, state in bounds:
                    tallies += self.judged(play, before, state, begun[number], endings or plant.quick)
                number += 1
            yield tallies

    def safe(self, pause_s: float, endings: bool = True) -> bool:
        """Whether plays with a pause between them are judged, and pass no hard limit."""
        known = self._known.get(pause_s) if endings else None
        try:
            drives = known or self._tallies(pause_s, endings)
            return all(tally.passes() for tally in chain.from_iterable(drives))
        except UnjudgedError:
            return False

    def judged(
        self, play: Played, before: Before, state: States, begun_C: Array | None, endings: bool
    ) -> Iterator[Tally]:
        """Tallies of a play from a state with its pause, of which a bound gives no rates, and of its endings."""
        plant, run = self.plant, Scenario(way=play.way, before=before)
        plays = plays_in(play, before.pause_s, self.limits.session_s)
        tally = Tally(self.limits, plant.corners, run, plays=plays, begun_C=begun_C)
        for (rows, values), then in plant.play(play, state):
            tally.add(rows, values, rates=plant.rates and before.plays == "cycle")
            state = then
        if (left := left_s(play, before.pause_s)) > 0.0:
            inside = (RECOVERY_ROWS_S > 0) & (left - 1e-6 > RECOVERY_ROWS_S)
            pause = np.concatenate([[0.0], RECOVERY_ROWS_S[inside], [left]])
            tally.add(play.end_s + pause, plant.hold(play, state, pause), rates=False)
        yield tally
        if endings:
            runs = [replace(run, ending=ending) for ending in plant.endings]
            tallies = [Tally(self.limits, plant.corners, each, begun_C=begun_C) for each in runs]
            follow(plant, play, state, play.end_s, tallies, sums=False)
            yield from tallies


def plays_in(play: GatePlay, pause_s: float, session_s: float) -> int:
    """Number of plays that fit into a session; at least one."""
    return max(1, math.floor((session_s + pause_s) / (play.end_s + left_s(play, pause_s)) + 1e-9))


def shortest_pause_s(repeating: Repeating[Played, States]) -> float | None:
    """The shortest safe pause in s, to 0.1 s; None up to 10 min. Searched in corners that fail, and checked in all."""
    known, safe_in, pause_s = set[int](), list[Callable[[float], bool]](), 0.0
    while True:
        failing = set(range(len(repeating.plant.corners)))
        with suppress(UnjudgedError):
            tallies = list(chain.from_iterable(repeating.tallies(pause_s)))
            if all(tally.passes() for tally in tallies):
                return pause_s
            failing = {corner for tally in tallies for corner in tally.worst_lanes()}
        if failing <= known:
            break
        few = Repeating(repeating.plant.only(sorted(failing - known)), repeating.drives, repeating.limits)
        safe_in.append(cache(partial(few.safe, endings=False)))
        known |= failing
        found_s = shortest_of(lambda pause_s: all(safe(pause_s) for safe in safe_in))
        if found_s is None:
            return None
        pause_s = found_s
    added = max(PAUSE_STEP_S, 0.02 * pause_s)
    while pause_s < LONGEST_PAUSE_S:  # a longer one, in steps that grow from 2 %
        pause_s = min(math.ceil((pause_s + added) / PAUSE_STEP_S) * PAUSE_STEP_S, LONGEST_PAUSE_S)
        if repeating.safe(pause_s):
            return round(pause_s, 1)
        added *= 3
    return None


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
