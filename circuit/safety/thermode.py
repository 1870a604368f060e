"""The gate for a device with its own control loop: skin under the display temperatures that it produces.

Module, driver and heat sink of the rig are not involved. Uncertain are the contact, the room (and with it deep tissue)
and how closely the device follows: at once, which is the worst case for the rate, or with its lag. A play ends with the
last set-point held or with control lost, when the display conducts no heat.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..rig.corner import perturbed
from ..rig.rig import Rig
from ..rig.rules import Limits
from ..solver.prescribed import FELT, SkinModes, modes_of
from .checks import Scenario
from .corners import Corner
from .endings import ENDING_ROWS_S, ENDING_S, LATE_S
from .playmap import PlayMap, least_bound
from .repeated import RECOVERED_K, RECOVERY_ROWS_S, back_after_s
from .tally import WATCHED, Tally

LAST, LOST = "last set-point held", "control lost"
DISPLAY_ENDINGS = (LAST, LOST)

INSTANTS = 24
"""Instants of a play, besides the last of its extreme, at which states are compared."""

_PLACE = {name: FELT.index(name) for name in WATCHED if name in FELT}


@dataclass(frozen=True, slots=True, eq=False)
class DisplayCourse:
    """A display (rows,) in °C, `step_s` apart and linear between: what a device shows if it follows in a certain `way`.

    The last `settling_s` come after the end of the drive, until the display has arrived, and are part of the pause.
    """

    way: str
    step_s: float
    display_C: Array
    settling_s: float = 0.0

    @property
    def rows_s(self) -> Array:
        """Times in s of the rows."""
        return np.arange(len(self.display_C), dtype=np.float64) * self.step_s

    @property
    def end_s(self) -> float:
        """Time in s of the last row."""
        return self.step_s * (len(self.display_C) - 1)

    def left_s(self, pause_s: float) -> float:
        """Remaining time in s of a pause after the last row."""
        return max(0.0, pause_s - self.settling_s)


def limits_without_module(limits: Limits) -> Limits:
    """The rules for a device that does not use the rig's hot plate."""
    return replace(limits, rules=tuple(rule for rule in limits.rules if rule.quantity != "hot plate"))


def contact_corners(rig: Rig) -> tuple[Corner, ...]:
    """The rig as given, then all combinations of contact and ambient at either end of their uncertainty."""
    contact, ambient = rig.uncertainty.contact_resistance_relative, rig.uncertainty.ambient_K
    spans = [(-most, most) if most else (0.0,) for most in (contact, ambient)]
    corners = [Corner(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, rig)]
    for share, shift in itertools.product(*spans):
        if share or shift:
            there = perturbed(rig, contact_resistance_relative=share, ambient_K=shift)
            corners.append(Corner(share, shift, 0.0, 0.0, 0.0, 0.0, 0.0, there))
    return tuple(corners)


@dataclass(frozen=True, slots=True, eq=False)
class Under:
    """Skin in the corners of contact and room, under displays that are prescribed."""

    corners: tuple[Corner, ...]
    modes: tuple[SkinModes, ...]
    insulated: tuple[SkinModes, ...]

    @staticmethod
    def of(rig: Rig) -> Under:
        """All corners of a rig's contact and room."""
        corners = contact_corners(rig)
        rigs = [corner.rig for corner in corners]
        return Under(
            corners,
            tuple(modes_of(rig_corner) for rig_corner in rigs),
            tuple(modes_of(rig_corner, insulated=True) for rig_corner in rigs),
        )

    def steady(self, display_C: float) -> list[Array]:
        """Modes of every corner under a display held."""
        return [modes.steady(display_C) for modes in self.modes]

    def play(self, course: DisplayCourse, states: Sequence[Array]) -> tuple[Array, list[Array]]:
        """Return WATCHED (4, corners, rows) of a play from states, and the states at its end."""
        runs = [
            modes.run(course.display_C, course.step_s, state) for modes, state in zip(self.modes, states, strict=True)
        ]
        return watched([felt for felt, _ in runs]), [end for _, end in runs]

    def hold(self, display_C: float, states: Sequence[Array], times_s: Array) -> Array:
        """WATCHED (4, corners, times) under a display held, at times from now."""
        pairs = zip(self.modes, states, strict=True)
        return watched([modes.relax(times_s, display_C, state) for modes, state in pairs])

    def let_go(self, states: Sequence[Array], times_s: Array) -> Array:
        """WATCHED (4, corners, times) under a display that conducts no heat and is as warm as the skin below."""
        tallies = []
        for modes, free, state in zip(self.modes, self.insulated, states, strict=True):
            felt = free.relax(times_s, free.deep_C, free.unlumps @ (modes.lumps @ state))
            felt[_PLACE["display_C"]] = felt[_PLACE["cold_receptor_C"]]
            tallies.append(felt)
        return watched(tallies)

    def after(self, course: DisplayCourse, pause_s: float, states: Sequence[Array]) -> list[Array]:
        """States after a play and a pause with the last set-point held."""
        last = float(course.display_C[-1])
        _, ended = self.play(course, states)
        left = course.left_s(pause_s)
        return [modes.after(left, last, end) for modes, end in zip(self.modes, ended, strict=True)]

    def cycle(self, course: DisplayCourse, pause_s: float) -> list[Array]:
        """States before each play of a steady cycle: each mode decays by the same share in every cycle."""
        none = [np.zeros_like(modes.rate_per_s) for modes in self.modes]
        forced = self.after(course, pause_s, none)
        length = course.end_s + course.left_s(pause_s)
        return [end / -np.expm1(-modes.rate_per_s * length) for modes, end in zip(self.modes, forced, strict=True)]

    def bound(self, shows: Sequence[DisplayCourse], pause_s: float, warm: bool) -> list[Array]:
        """States warmer (or colder), lump by lump, than those before any play of a sequence in any order."""
        rests = [self.steady(float(course.display_C[0])) for course in shows]
        starts = [self._lumps(states) for states in (*rests, *(self.cycle(course, pause_s) for course in shows))]
        bounded = least_bound([self._map(course, pause_s) for course in shows], starts, 1.0 if warm else -1.0)
        return [modes.unlumps @ lumps for modes, lumps in zip(self.modes, bounded, strict=True)]

    def farthest(self, shows: Sequence[DisplayCourse], states: Sequence[Array], warm: bool) -> list[Array]:
        """States warmer (or colder), lump by lump, than at instants of plays from states, and before them."""
        side, found = 1.0 if warm else -1.0, self._lumps(states)
        for course in shows:
            last, now = len(course.display_C) - 1, list(states)
            ends = {int((side * course.display_C[::-1]).argmax()), *range(0, last, -(-last // INSTANTS))}
            for begin, end in itertools.pairwise(sorted({0, last, *(last - k for k in ends)})):
                _, now = self.play(replace(course, display_C=course.display_C[begin : end + 1]), now)
                found = side * np.maximum(side * found, side * self._lumps(now))
        return [modes.unlumps @ lumps for modes, lumps in zip(self.modes, found, strict=True)]

    def _lumps(self, states: Sequence[Array]) -> Array:
        """Lumps (corners, n) above the deep node's temperature, for modes."""
        return np.array([modes.lumps @ state for modes, state in zip(self.modes, states, strict=True)])

    def _map(self, course: DisplayCourse, pause_s: float) -> PlayMap:
        """A play and its pause as a map of lumps, whose entries, unlike those of modes, are never negative."""
        length = course.end_s + course.left_s(pause_s)
        forced = self.after(course, pause_s, [np.zeros_like(modes.rate_per_s) for modes in self.modes])
        decays = [(modes.lumps * np.exp(-modes.rate_per_s * length)) @ modes.unlumps for modes in self.modes]
        return PlayMap(np.array(decays), self._lumps(forced))

    def recovery_s(self, course: DisplayCourse, ended: Sequence[Array]) -> float | None:
        """Time in s after the end of a drive until the skin is within 0.1 K of where it began, in every corner."""
        last, first = float(course.display_C[-1]), float(course.display_C[0])
        skin = self.hold(last, ended, RECOVERY_ROWS_S)[0]
        began = self.hold(first, self.steady(first), np.array([0.0]))[0]
        away = (np.abs(skin - began).max(axis=0) > RECOVERED_K) | (abs(last - first) > RECOVERED_K)
        back_s = back_after_s(away)
        return None if back_s is None else round(course.settling_s + back_s, 1)


def watched(felt: Sequence[Array]) -> Array:
    """WATCHED (4, corners, rows) of FELT; the missing hot plate is as warm as the display."""
    return np.stack([[each[_PLACE.get(name, _PLACE["display_C"])] for each in felt] for name in WATCHED])


def tally_once(
    under: Under, course: DisplayCourse, limits: Limits, rates: bool = True
) -> tuple[list[Tally], list[Array]]:
    """Every rule over one play and its endings, and the states at the end of the play."""
    values, ended = under.play(course, under.steady(float(course.display_C[0])))
    played = Tally(limits, under.corners, Scenario(way=course.way))
    played.add(course.rows_s, values, rates=rates)
    tallies = [played.fork(ending) for ending in DISPLAY_ENDINGS]
    add_endings(under, course, ended, tallies, rates=rates)
    return [played, *tallies], ended


def add_endings(
    under: Under,
    course: DisplayCourse,
    ended: Sequence[Array],
    tallies: Sequence[Tally],
    *,
    sums: bool = True,
    rates: bool = True,
) -> None:
    """Add what follows a play to the tally of each ending; without `rates` where a jump is an idealisation."""
    last, end = float(course.display_C[-1]), course.end_s
    tallies[0].add(end + ENDING_ROWS_S, under.hold(last, ended, ENDING_ROWS_S), sums=sums, rates=rates)
    tallies[1].add(end + ENDING_ROWS_S[1:], under.let_go(ended, ENDING_ROWS_S[1:]), rates=False, sums=sums, drift=True)
    tallies[1].add(end + LATE_S, under.let_go(ended, LATE_S), rates=False, sums=sums, drift=True)


def time_to_limit_s(under: Under, limits: Limits, level_C: float, start: Sequence[Array]) -> float:
    """Time in s for which a display may be held at a level before a hard temperature limit is exceeded, 60 at most."""
    tally = Tally(limits, under.corners)
    tally.add(ENDING_ROWS_S, under.hold(level_C, start, ENDING_ROWS_S), rates=False, sums=False)
    broken = [check.since_s for check in tally.checks() if check.severity == "hard" and check.since_s is not None]
    return min(broken, default=ENDING_S)
