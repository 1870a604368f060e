"""Single faults of a drive played open loop.

They do not make a drive unsafe by themselves, since hardware prevents them. Simulating them in the worst corners gives
what the hardware must do. With a given current a play that begins warmer stays warmer at every node, so a hang in any
play lies between hangs from the warm and from the cold bound of all plays. A driver may be stuck at any current up to
its limits; where the display then stays inside the cut-off is in `held.py`. Rates depend on differences between nodes,
for which bounds mean nothing: they are those of a driver that gets stuck in a play from rest.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from ..rig.rules import Limits
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from .demands import CutOff, Harm, SingleFault
from .ensemble import Ensemble, between
from .fault_limits import FaultLimits
from .tally import WATCHED

HANG_S, INSTANTS = 60.0, 8
"""How long a fault is followed, and of how many stretches of a drive the end and the extreme currents may get stuck."""
WAITED_S = (0.0, 1.0, 4.0, 15.0)
"""Times after a play at which the current of the pause may get stuck."""
HANGS_S = (*(float(f"{10 ** (k / 20):.2g}") for k in range(-26, 36)), HANG_S)
"""Times of watchdogs that are tried. One below 0.05 s is not demanded, but a cut-off: assumed, a host is no quicker."""
REACTIONS_S = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
"""Reaction times of cut-offs that are tried."""
MARGIN = 0.8
"""A watchdog or a cut-off acts after this share of the time that is safe."""
STUCK_ROWS_S = np.concatenate([np.arange(250) * 0.01, 2.5 + np.arange(75) * 0.1, 10.0 + np.arange(51) * 1.0])
HANG_ROWS_S = np.concatenate([np.arange(50) * 0.1, 5.0 + np.arange(56) * 1.0])
AFTER_ROWS_S = np.concatenate([np.arange(40) * 0.025, 1.0 + np.arange(30)])
"""Rows of a driver at its limit, of a stuck current, and of 30 s without any after it was cut."""
LIMITS_TRIED = 6
"""Current limits between the driver's own and the peak of the drive."""
STUCK_SHARES = (1.0, 0.5, 0.25)
"""Shares of the driver's limits at which it may be stuck: beyond what holds the display at the cut-off."""
RATE_ROWS_S: Array = np.arange(151, dtype=np.float64) * 0.01
"""Rows in which the rate of skin is highest after a driver got stuck."""


@dataclass(frozen=True, slots=True, eq=False)
class Moments:
    """Instants of a play and its pause in lanes, with a command in A each; `stuck_A`: of a driver at its limit."""

    state: State
    command_A: Array
    rigs: Index
    instants: tuple[int, ...]
    stuck_A: float | None = None

    def take(self, lanes: Index) -> Moments:
        """Some of the lanes, of any instants."""
        return Moments(self.state.take(lanes), self.command_A[lanes], self.rigs[lanes], (), self.stuck_A)

    def stuck_at(self, current_A: float) -> Moments:
        """The same with the driver stuck at a current."""
        return replace(self, command_A=np.full_like(self.command_A, current_A), stuck_A=current_A)


@dataclass(frozen=True, slots=True, eq=False)
class Faulty:
    """A drive in its worst corners with its rest in `start`; begun between `bounds` if any, at `instants` or all.

    `may` is what a single fault may lead to; `limit_A`: between which currents a driver stays, None: its own.
    """

    ensemble: Ensemble
    drive: Drive
    rest_A: float
    start: State
    limits: Limits
    may: FaultLimits
    bounds: tuple[State, ...] = ()
    instants: tuple[int, ...] | None = None
    limit_A: tuple[float, float] | None = None

    def at(self, corners: list[int]) -> Faulty:
        """The same in some of the corners."""
        which = np.array(corners)
        start, *bounds = (state.take(which) for state in (self.start, *self.bounds))
        few = self.ensemble if len(corners) == len(self.ensemble.corners) else self.ensemble.only(corners)
        return replace(self, ensemble=few, start=start, bounds=tuple(bounds))

    def moments(self) -> Moments:
        """When the current may get stuck: at instants of a play and after it."""
        starts, count = self.bounds or (self.start,), len(self.ensemble.corners)
        rigs = np.tile(np.arange(count, dtype=np.int64), len(starts))
        found = list(instants(self.ensemble, self.drive, self.rest_A, side_by_side(starts), rigs))
        which = tuple(range(len(found))) if self.instants is None else self.instants
        states, commands = zip(*(found[k] for k in which), strict=True)
        return Moments(side_by_side(states), np.repeat(commands, len(rigs)), np.tile(rigs, len(which)), which)

    def resting(self, unpowered: Sequence[tuple[State, float]]) -> Moments:
        """Before a play: between the bounds, and without power, each state with the current in A that flows then."""
        states = [*((state, self.rest_A) for state in self.bounds), *unpowered]
        count = len(self.ensemble.corners)
        return Moments(
            side_by_side([state for state, _ in states]),
            np.repeat([current_A for _, current_A in states], count),
            np.tile(np.arange(count, dtype=np.int64), len(states)),
            (0,),
        )

    def hardest(self, ends_C: tuple[float, float], within_s: float) -> list[int]:
        """Corners that are worst in some fault at a few instants, if a watchdog and a cut-off act within a time."""
        few = np.linspace(1, len(stuck_at(self.drive)) - 1, 4).astype(int)
        moments = replace(self, instants=tuple(few.tolist())).moments()
        far_K = self.beyond_K(moments, within_s, CutOff(*ends_C, within_s))
        lanes = far_K.reshape(len(far_K), len(few), -1).argmax(axis=2)
        return [int(corner) for corner in np.unique(moments.rigs[lanes])]

    def watchdog_s(self, moments: Moments | None = None) -> tuple[float, SingleFault]:
        """The longest time before a stuck current must be cut, and the effect of a little longer."""
        moments = moments or self.moments()
        safe = bisect_left(HANGS_S, 1, key=lambda time_s: int(self._hung_K(moments, time_s)[1].max() > 0.0))
        after, tried_s = (0.0, *HANGS_S)[safe], HANGS_S[min(safe, len(HANGS_S) - 1)]
        harm, far_K = self._hung_K(moments, tried_s)
        told = {"lasts_s": min(HANG_S, tried_s / MARGIN), "harm": harm, "watchdog_s": after}
        return after, SingleFault("hang", "red" if far_K.max() > 0.0 else "green", told)

    def _hung_K(self, moments: Moments, watchdog_s: float) -> tuple[Harm | None, Array]:
        """The worst of currents that hang until a watchdog cuts them, and how far each lane passes a limit."""
        return self._cut_K(moments, np.full(len(moments.rigs), min(HANG_S, watchdog_s / MARGIN)))

    def _cut_K(self, moments: Moments, cut_s: Array, late_s: float = 0.0) -> tuple[Harm | None, Array]:
        """The worst while currents are stuck until `cut_s` (lanes,) and for 30 s after; lanes with 0 do not count.

        A cut-off was `late_s` late: for so long the skin counts as being as warm as it gets.
        """
        which = np.flatnonzero(cut_s)
        rigs, state, cut_s = moments.rigs[which], moments.state.take(which), cut_s[which]
        if moments.stuck_A is not None:  # the driver's limit leads one way until it is cut
            nodes = self.ensemble.modes(moments.stuck_A).after(rigs, state.nodes_C, cut_s)
            rows_s, values = AFTER_ROWS_S, self.ensemble.watch(0.0, State(nodes), AFTER_ROWS_S, rigs)
        else:
            rows_s = np.unique(np.concatenate([HANG_ROWS_S[cut_s.max() > HANG_ROWS_S], cut_s]))
            on = rows_s[:-1, np.newaxis] < cut_s - 1e-9
            until, then = self.ensemble.step(on * moments.command_A[which], state, rows_s, rigs)
            after = self.ensemble.watch(0.0, then, AFTER_ROWS_S, rigs)
            rows_s, values = np.append(rows_s, rows_s[-1] + AFTER_ROWS_S), np.concatenate([until, after], axis=2)
            late_s = 0.0
        far_K = np.full(len(moments.rigs), -np.inf)
        harm, far_K[which] = self.may.passed(values, rows_s, late_s)
        return harm, far_K

    def beyond_K(self, moments: Moments, watchdog_s: float, cut: CutOff) -> Array:
        """How far lanes pass a limit if a watchdog and a cut-off act in time, in each fault that these prevent."""
        kept = [self._hung_K(moments, watchdog_s)[1]] if watchdog_s else []
        kept += [self._late_K(moments, full_A, cut) for full_A in self.ends_A if cut.react_within_s]
        return np.array(kept or [np.full(len(moments.rigs), -np.inf)])

    def _late_K(self, moments: Moments, full_A: float, cut: CutOff) -> Array:
        """How far lanes pass a limit if a cut-off acts in time on a driver that is stuck at a current."""
        stuck = moments.stuck_at(full_A)
        display = self.ensemble.watch(full_A, moments.state, STUCK_ROWS_S, moments.rigs, ("display_C",))[0]
        late_s = cut.react_within_s / MARGIN
        return self._cut_K(stuck, _cut_s(display, cut.low, cut.high, late_s), late_s)[1]

    def cut_off(
        self,
        ends_C: tuple[float, float],
        moments: Moments | None = None,
        *,
        hangs: bool = False,
        shares: tuple[float, ...] = (1.0,),
    ) -> tuple[CutOff, SingleFault]:
        """A cut-off at both ends and its effect, for a driver at `shares` of its limit, or a current that hangs."""
        low, high = ends_C
        moments, harms, slowest = moments or self.moments(), [], REACTIONS_S[-1]
        for full_A, share in product(self.ends_A, shares):
            current_A = share * full_A
            stuck = moments.stuck_at(current_A)
            values = self.ensemble.watch(current_A, moments.state, STUCK_ROWS_S, moments.rigs)
            slowest = min(slowest, self._reaction_s(stuck, values, low, high))
            harm, _ = self.may.passed(values, STUCK_ROWS_S, 0.0)
            if harm is not None and current_A in self.ends_A:
                harms.append((harm, current_A))
        if hangs:
            commands = np.broadcast_to(moments.command_A, (len(STUCK_ROWS_S) - 1, len(moments.rigs)))
            values = self.ensemble.step(commands, moments.state, STUCK_ROWS_S, moments.rigs)[0]
            slowest = min(slowest, self._reaction_s(moments, values, low, high))
        driver, cut = self.ensemble.rig.driver, CutOff(low, high, slowest)
        most_A = max(driver.current_max_A, -driver.current_min_A)
        limit_A = self._slower_A(moments, low, high, most_A) if slowest == 0.0 else None
        told = {"harms": tuple(harms), "cut_off": cut, "most_A": most_A, "limit_A": limit_A}
        return cut, SingleFault("stuck", "red" if harms else "green", told)

    @property
    def ends_A(self) -> tuple[float, float]:
        """The least and the greatest current in A of the driver, or of the bridge."""
        driver, bridge_A = self.ensemble.rig.driver, self.ensemble.bridge_A
        ends = (driver.current_min_A, driver.current_max_A) if bridge_A is None else (-bridge_A, bridge_A)
        return ends if self.limit_A is None else self.limit_A

    def rates_K_per_s(self, moments: Moments, current_A: float) -> Array:
        """How fast the skin moves at most (lanes,) where a driver gets stuck at a current."""
        skin = self.ensemble.watch(current_A, moments.state, RATE_ROWS_S, moments.rigs, ("skin_C",))[0]
        return np.asarray(np.abs(np.diff(skin, axis=1)).max(axis=1) / RATE_ROWS_S[1])

    def _slower_A(self, moments: Moments, low: float, high: float, full: float) -> float | None:
        """A current limit that prevents harm where no cut-off is quick enough, and still plays the drive."""
        driver, cut = self.ensemble.rig.driver, CutOff(low, high, REACTIONS_S[0])
        shares = driver.current_min_A / full, driver.current_max_A / full

        def holds(most_A: float) -> bool:
            return bool(max(self._late_K(moments, share * most_A, cut).max() for share in shares) <= 0.0)

        tried = np.linspace(full, float(np.abs(self.drive.current_A).max()), LIMITS_TRIED)[1:].tolist()
        place = bisect_left(tried, True, key=holds)
        return float(tried[place]) if place < len(tried) else None

    def _reaction_s(self, moments: Moments, values: Array, low: float, high: float) -> float:
        """The longest reaction time of a cut-off that is safe for currents that would give `values`; 0 for none."""
        display = values[WATCHED.index("display_C")]

        def harms(reaction_s: float) -> bool:
            late_s = reaction_s / MARGIN
            return bool(self._cut_K(moments, _cut_s(display, low, high, late_s), late_s)[1].max() > 0.0)

        safe = bisect_left(REACTIONS_S, 1, key=lambda reaction_s: int(harms(reaction_s)))
        return (0.0, *REACTIONS_S)[safe]


def instants(
    ensemble: Ensemble, drive: Drive, rest_A: float, state: State, rigs: Index
) -> Iterator[tuple[State, float]]:
    """States, each with the command in A, when a play from states may be stopped, or its current get stuck."""
    before = 0.0
    for instant, command in stuck_at(drive):
        state = ensemble.end_of(between(drive, before, instant), state, rigs)
        before = instant
        yield state, command
    for waited_s in WAITED_S:
        state = ensemble.hold(rest_A, state, np.array([0.0, waited_s]), rigs)[1]
        yield state, rest_A


def stuck_at(drive: Drive) -> list[tuple[float, float]]:
    """Instants in s and commands that are stuck there: at the end of each stretch and after its extremes."""
    times = drive.time_s[1:]
    if len(times) < INSTANTS:
        times = np.union1d(times, np.linspace(0.0, times[-1], INSTANTS + 1)[1:])
    times = times[np.diff(times, prepend=0.0) > 1e-9]  # equal but for rounding
    commands, chosen = drive.at(times - 1e-6), set()
    for part in np.array_split(np.arange(len(times))[::-1], INSTANTS):  # the last of equals comes first
        chosen |= {int(part[0]), int(part[commands[part].argmin()]), int(part[commands[part].argmax()])}
    return [(float(times[k]), float(commands[k])) for k in sorted(chosen)]


def side_by_side(states: Sequence[State]) -> State:
    """States of lanes next to each other."""
    return State(np.concatenate([state.nodes_C for state in states]))


def _cut_s(display: Array, low: float, high: float, late_s: float) -> Array:
    """When a cut-off at two temperatures of the display (lanes, STUCK_ROWS_S) has acted in each lane, so late in s."""
    out = ~((display > low) & (display < high))
    crossed_s = np.where(out.any(axis=1), STUCK_ROWS_S[out.argmax(axis=1)], HANG_S)
    return np.minimum(HANG_S, crossed_s + late_s)
