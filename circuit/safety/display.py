"""A display with its own control loop as a plant of the gate.

Module, driver and heat sink of the rig are not involved. Uncertain are the contact, the room (and with it deep tissue)
and how closely the device follows: at once, which is the worst case for the rate, or with its lag. A play ends with the
last set-point held or with control lost, when the display conducts no heat.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.rig import Rig
from ..rig.rules import Limits
from ..solver.modes import FELT, SkinModes, modes_of
from .checks import Check, colour_of, worst_of
from .corners import contact_corners
from .demands import CutOff, Demanded, Demands, SingleFault
from .fault_limits import COLUMN_OF, FELT_COLUMNS
from .held import INSIDE_K, Span, around_C, stays
from .plant import ENDING_ROWS_S, LATE_S, OFF_ROWS_S, Future, Plant, Single, Stretch, left_s
from .playmap import PlayMap, least_bound
from .repeated import LONGEST_PAUSE_S, Repeating, lengthened_s
from .single_faults import MARGIN
from .spans import ENDING_S, PRACTICAL_S
from .starts import Beginning, Starts
from .tally import WATCHED, Tally

DISPLAY_ENDINGS = ("last set-point held", "control lost")

INSTANTS = 24
"""Instants of a play, besides the last of its extreme, at which states are compared."""

FOR_GOOD = (
    "beyond it the skin under a display that stays there passes its own limit, so that no cut-off both lets this play "
    "pass and stops a display that gets stuck: use a smaller or shorter change"
)
"""Why a thermode is refused that goes where it may not stay: its own cut-off knows no time."""

_PLACE = {name: FELT.index(name) for name in WATCHED if name in FELT}


@dataclass(frozen=True, slots=True, eq=False)
class DisplayCourse:
    """A display (rows,) in °C, `step_s` apart, in a certain `way`; its last `settling_s` are part of the pause."""

    way: str
    step_s: float
    display_C: Array
    settling_s: float = 0.0

    @property
    def end_s(self) -> float:
        """Time in s of the last row."""
        return self.step_s * (len(self.display_C) - 1)

    @property
    def first_C(self) -> float:
        """The display at rest."""
        return float(self.display_C[0])

    @property
    def last_C(self) -> float:
        """The display in the pause."""
        return float(self.display_C[-1])


@dataclass(frozen=True, eq=False)
class DisplayPlant(Plant[DisplayCourse, list[Array]]):
    """Skin in the corners of contact and room; states are modes (n,) of each, in contact and under no display.

    A single fault may leave the display at one of `stuck_C`, in °C. No rate is judged where a jump of the display is an
    idealisation; that of another one is decided by the display, and nothing is to be added right after a play.
    """

    modes: tuple[SkinModes, ...]
    insulated: tuple[SkinModes, ...]
    stuck_C: tuple[float, float]
    endings = DISPLAY_ENDINGS
    quick = True

    @staticmethod
    def of(rig: Rig, stuck_C: tuple[float, float], rates: bool = True) -> DisplayPlant:
        """All corners of a rig's contact and room."""
        corners = contact_corners(rig)
        modes, insulated = (tuple(modes_of(corner.rig, insulated=free) for corner in corners) for free in (False, True))
        return DisplayPlant(rig, corners, rates, modes, insulated, stuck_C)

    def rest(self, play: DisplayCourse) -> list[Array]:
        """The first temperature held."""
        return self.steady(play.first_C)

    def steady(self, display_C: float) -> list[Array]:
        """States under a display held."""
        return [modes.steady(display_C) for modes in self.modes]

    def now(self, play: DisplayCourse, state: Sequence[Array]) -> Array:
        """WATCHED (4, corners) under the first temperature."""
        return self.held(play.first_C, state, np.array([0.0]))[:, :, 0]

    def begun_C(self, plays: Sequence[DisplayCourse]) -> list[Array]:
        """Skin at the rest of the first play, which is that of all."""
        return [self.now(plays[0], self.rest(plays[0]))[WATCHED.index("skin_C")]] * len(plays)

    def play(self, play: DisplayCourse, state: Sequence[Array]) -> Iterator[tuple[Stretch, list[Array]]]:
        """A whole play as one stretch."""
        pairs = zip(self.modes, state, strict=True)
        runs = [modes.run(play.display_C, play.step_s, begun) for modes, begun in pairs]
        rows: Array = np.arange(len(play.display_C), dtype=np.float64) * play.step_s
        yield (rows, watched([felt for felt, _ in runs])), [end for _, end in runs]

    def hold(self, play: DisplayCourse, state: Sequence[Array], times_s: Array) -> Array:
        """The last temperature held."""
        return self.held(play.last_C, state, times_s)

    def held(self, display_C: float, state: Sequence[Array], times_s: Array) -> Array:
        """WATCHED (4, corners, times) under a display held, at times from now."""
        pairs = zip(self.modes, state, strict=True)
        return watched([modes.relax(times_s, display_C, begun) for modes, begun in pairs])

    def let_go(self, play: DisplayCourse, state: Sequence[Array]) -> Iterator[tuple[Future, ...]]:
        """The last temperature held, and control lost."""
        yield (Future((ENDING_ROWS_S, self.hold(play, state, ENDING_ROWS_S)), self.rates),)
        lost = (ENDING_ROWS_S[1:], LATE_S)
        yield tuple(Future((rows, self.under_none(state, rows)), rates=False, drift=True) for rows in lost)

    def under_none(self, state: Sequence[Array], times_s: Array) -> Array:
        """WATCHED (4, corners, times) under a display that conducts no heat and is as warm as the skin below."""
        corners = []
        for modes, free, begun in zip(self.modes, self.insulated, state, strict=True):
            felt = free.relax(times_s, free.deep_C, free.unlumps @ (modes.lumps @ begun))
            felt[_PLACE["display_C"]] = felt[_PLACE["cold_receptor_C"]]
            corners.append(felt)
        return watched(corners)

    def after(self, play: DisplayCourse, pause_s: float, state: Sequence[Array]) -> list[Array]:
        """States after a play and a pause with the last set-point held."""
        ((_, ended),) = self.play(play, state)
        left = left_s(play, pause_s)
        return [modes.after(left, play.last_C, end) for modes, end in zip(self.modes, ended, strict=True)]

    def cycle(self, play: DisplayCourse, pause_s: float) -> list[Array]:
        """Each mode decays by the same share in every cycle."""
        forced = self.after(play, pause_s, self.unpowered())
        length = play.end_s + left_s(play, pause_s)
        return [end / -np.expm1(-modes.rate_per_s * length) for modes, end in zip(self.modes, forced, strict=True)]

    def bound(
        self, plays: Sequence[DisplayCourse], pause_s: float, steady: Sequence[list[Array]], warm: bool
    ) -> list[Array]:
        """Lump by lump: temperatures of lumps, unlike modes, only rise with each other."""
        starts = [self._lumps(state) for state in (*map(self.rest, plays), *steady)]
        bounded = least_bound([self.map(play, pause_s) for play in plays], starts, 1.0 if warm else -1.0)
        return self._modes(bounded)

    def map(self, play: DisplayCourse, pause_s: float) -> PlayMap:
        """A play and its pause as a map of lumps, whose entries are never negative."""
        length = play.end_s + left_s(play, pause_s)
        forced = self.after(play, pause_s, self.unpowered())
        decays = [(modes.lumps * np.exp(-modes.rate_per_s * length)) @ modes.unlumps for modes in self.modes]
        return PlayMap(np.array(decays), self._lumps(forced))

    def rested(self, play: DisplayCourse, state: Sequence[Array], rest_s: float) -> list[Array]:
        """The first temperature held."""
        return [modes.after(rest_s, play.first_C, begun) for modes, begun in zip(self.modes, state, strict=True)]

    def unpowered(self) -> list[Array]:
        """Skin as warm as deep tissue, under a display that conducts no heat."""
        return [np.zeros_like(modes.rate_per_s) for modes in self.modes]

    def stopped(
        self, plays: Sequence[DisplayCourse], bounds: tuple[list[Array], list[Array]]
    ) -> tuple[list[Array], list[Array]]:
        """Lump by lump: no power, instants of plays, and control lost since."""
        bounding = []
        for bound, warm in zip(bounds, (True, False), strict=True):
            most = np.maximum if warm else np.minimum
            lumps = most(self._lumps(self.farthest(plays, bound, warm)), self._lumps(self.unpowered()))
            lost = [
                [modes.lumps @ (np.exp(-modes.rate_per_s * time_s) * (modes.unlumps @ each))
                 for modes, each in zip(self.insulated, lumps, strict=True)]
                for time_s in OFF_ROWS_S
            ]  # fmt: skip
            bounding.append(self._modes(most.reduce([lumps, *map(np.array, lost)])))
        return bounding[0], bounding[1]

    def farthest(self, plays: Sequence[DisplayCourse], state: Sequence[Array], warm: bool) -> list[Array]:
        """States warmer (or colder), lump by lump, than at instants of plays from states, and before them."""
        side, extreme = 1.0 if warm else -1.0, self._lumps(state)
        for play in plays:
            last, now = len(play.display_C) - 1, list(state)
            ends = {int((side * play.display_C[::-1]).argmax()), *range(0, last, -(-last // INSTANTS))}
            for begin, end in itertools.pairwise(sorted({0, last, *(last - k for k in ends)})):
                ((_, now),) = self.play(replace(play, display_C=play.display_C[begin : end + 1]), now)
                extreme = side * np.maximum(side * extreme, side * self._lumps(now))
        return self._modes(extreme)

    def demanded(
        self,
        singles: Sequence[Sequence[Single[DisplayCourse, list[Array]]]],
        recovered_s: Sequence[float],
        repeating: Repeating[DisplayCourse, list[Array]],
        tallies: Sequence[list[Tally]],
        shortest_s: float | None,
    ) -> Demanded:
        """Demands against set-points that hang, and a loop that runs to an end of its range or stays within it."""
        pause_s = LONGEST_PAUSE_S if shortest_s is None else shortest_s
        beginning = Beginning.of(repeating, pause_s, max(recovered_s))
        starts = cache(beginning.after)

        def quickest(pause_s: float) -> Array:
            """How quickly a watchdog and a cut-off must act for each drive, in s."""
            pairs = [(each.hangs, each.stuck) for each in self._faults(repeating, starts(pause_s))]
            return MARGIN * np.array([[min(time for _, time in levels) for levels in pair] for pair in pairs])

        if shortest_s is not None:
            longest_s = max(shortest_s, *recovered_s)
            needed = np.minimum(PRACTICAL_S, quickest(longest_s))
            pause_s = lengthened_s(shortest_s, longest_s, lambda longer_s: bool((quickest(longer_s) >= needed).all()))
        groups = [single.checks for single in itertools.chain.from_iterable(singles)]
        groups += [worst_of(tally.checks() for tally in own) for own in tallies]
        checks = itertools.chain.from_iterable(groups)
        shown = [check.value for check in checks if check.quantity == "display"]
        around, held = (min(shown), max(shown)), (-np.inf, np.inf)
        if self.rates:  # a controller around the module is judged for itself
            held = for_good_C(self.modes, repeating.limits)
        cut = around_C(repeating.limits, around, held)
        failed = () if shortest_s is None else stays(around, held, FOR_GOOD)
        demanded_s, first = None if shortest_s is None else pause_s, starts(pause_s)
        rest_s = None if shortest_s is None else beginning.kept_s(first, pause_s)
        demands = [
            faults.demands(cut, demanded_s, rest_s, beginning.unpowered(number, 0.0))
            for number, faults in enumerate(self._faults(repeating, first))
        ]
        return Demanded(demanded_s, demands, failed)

    def _faults(self, repeating: Repeating[DisplayCourse, list[Array]], starts: Starts[list[Array]]) -> list[_Faults]:
        faults = []
        for ways in repeating.drives:
            warm, cold = (
                self.farthest(ways, bound, side) for bound, side in zip(starts.bounds, (True, False), strict=True)
            )
            levels = [float(level) for play in ways for level in (play.display_C.min(), play.display_C.max())]
            ends = (min(levels), max(levels)), self.stuck_C
            hangs, stuck = (
                [(low, self._held_s(repeating.limits, low, cold)), (high, self._held_s(repeating.limits, high, warm))]
                for low, high in ends
            )
            faults.append(_Faults(hangs, stuck))
        return faults

    def _held_s(self, limits: Limits, level_C: float, state: Sequence[Array]) -> float:
        """Time in s for which a display may be held at a level until a hard temperature limit is passed, 60 at most."""
        tally = Tally(limits, self.corners)
        tally.add(ENDING_ROWS_S, self.held(level_C, state, ENDING_ROWS_S), rates=False, sums=False)
        broken = [check.since_s for check in tally.checks() if check.severity == "hard" and check.since_s is not None]
        return min(broken, default=ENDING_S)

    def _lumps(self, state: Sequence[Array]) -> Array:
        """Lumps (corners, n) above the deep node's temperature, for modes."""
        return np.array([modes.lumps @ begun for modes, begun in zip(self.modes, state, strict=True)])

    def _modes(self, lumps: Array) -> list[Array]:
        return [modes.unlumps @ each for modes, each in zip(self.modes, lumps, strict=True)]


@dataclass(frozen=True, slots=True)
class _Faults:
    """Set-points that hang, and ends of a range at which a loop is stuck: level in °C, time in s to a limit."""

    hangs: list[tuple[float, float]]
    stuck: list[tuple[float, float]]

    def demands(self, ends_C: Span, pause_s: float | None, rest_s: float | None, at_once: Sequence[Check]) -> Demands:
        """Demands on the device itself, with a cut-off at two temperatures."""
        watchdog, react = (min(time for _, time in each) for each in (self.hangs, self.stuck))
        watchdog = watchdog if watchdog >= ENDING_S else math.floor(100.0 * MARGIN * watchdog) / 100.0
        cut = CutOff(*ends_C, math.floor(1000.0 * MARGIN * react) / 1000.0)
        levels, ends = ([level for level, _ in each] for each in (self.hangs, self.stuck))
        hang = {"levels_C": levels, "watchdog_s": watchdog}
        stuck = {"levels_C": ends, "passed_s": react, "cut_off": cut}
        begins = {"finding": next(iter(at_once), None), "rest_s": rest_s}
        faults = (
            SingleFault("set-point hang", "red" if watchdog < ENDING_S else "green", hang),
            SingleFault("unpowered", colour_of(at_once), begins),
            SingleFault("loop stuck", "red" if react < ENDING_S else "green", stuck),
        )
        return Demands(watchdog, cut, None, rest_s, pause_s, None, faults)


def for_good_C(corners: Sequence[SkinModes], limits: Limits) -> Span:
    """Between which temperatures in °C a thermode may stay without limit of time, in all corners."""
    low, high = -math.inf, math.inf
    for modes in corners:
        at_0, at_1 = (modes.relax(np.zeros(1), level, modes.steady(level))[:, 0] for level in (0.0, 1.0))
        for rule in limits.rules:
            column = COLUMN_OF.get(rule.quantity, "")
            if rule.always_hard and column in FELT_COLUMNS:
                row = FELT.index(column)
                side = -INSIDE_K if rule.upper else INSIDE_K
                level = float((rule.limit + side - at_0[row]) / (at_1[row] - at_0[row]))
                low, high = (low, min(high, level)) if rule.upper else (max(low, level), high)
    return low, high


def watched(felt: Sequence[Array]) -> Array:
    """WATCHED (4, corners, rows) of FELT; the missing hot plate is as warm as the display."""
    return np.stack([[each[_PLACE.get(name, _PLACE["display_C"])] for each in felt] for name in WATCHED])
