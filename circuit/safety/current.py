"""A module under a given current as a plant of the gate.

The bounds of repetition hold for temperatures only, not for rates, which depend on differences between nodes. Rates
are therefore checked by simulation: each drive is played after every other drive, starting from rest and from its
steady cycle. After its own play, pauses longer by each value of LONGER_S are tried too, since the display returns to
rest sooner than the skin.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.rules import Limits
from ..solver.batch_inputs import State
from ..solver.drive import Drive
from ..solver.steady import state_under_current
from .checks import Before, Scenario
from .demanded import demanded
from .demands import Demanded
from .ensemble import Ensemble, LaneDrives
from .plant import ENDING_ROWS_S, LATE_S, OFF_ROWS_S, Future, Plant, Single, Stretch
from .playmap import PlayMap, least_bound
from .polarity import TEST_S, testing_A
from .repeated import Repeating
from .single_faults import instants, side_by_side
from .spans import LATER_S
from .tally import COLDEST_C, HOTTEST_C, WATCHED, Tally

ENDINGS = ("last value held", "zero current", "power off")
IN_THE_END = "zero current in the end"

LONGER_S = (1.0, 4.0, 15.0)


@dataclass(frozen=True, slots=True, eq=False)
class CurrentPlay:
    """A drive, or one for each corner, with the current in A that is held before it and in the pauses after it."""

    drive: Drive | LaneDrives
    rest_A: float | Array
    way: ClassVar[str] = ""
    settling_s: ClassVar[float] = 0.0

    @property
    def end_s(self) -> float:
        """Time in s of the last row."""
        return float(self.drive.time_s[-1])


@dataclass(frozen=True, eq=False)
class CurrentPlant(Plant[CurrentPlay, State]):
    """An ensemble as a plant: its plays are maps of the nodes."""

    ensemble: Ensemble
    _rests: dict[CurrentPlay, State] = field(default_factory=dict)
    _maps: dict[CurrentPlay, PlayMap] = field(default_factory=dict)
    _passed: dict[CurrentPlay, tuple[float, PlayMap]] = field(default_factory=dict)
    endings = ENDINGS
    quick = False

    @staticmethod
    def of(ensemble: Ensemble) -> CurrentPlant:
        """The plant of an ensemble."""
        return CurrentPlant(ensemble.rig, ensemble.corners, True, ensemble)

    @property
    def drift_C(self) -> float:
        """Steady skin temperature in °C under zero current on the rig as given."""
        return float(zero_current_C(self.ensemble)[WATCHED.index("skin_C"), 0])

    def only(self, corners: list[int]) -> CurrentPlant:
        """The plant in some of the corners."""
        rests = {play: state.take(np.array(corners)) for play, state in self._rests.items()}
        maps = {play: played.only(corners) for play, played in self._maps.items()}
        few = self.ensemble.only(corners)
        return CurrentPlant(self.rig, few.corners, True, few, rests, maps)

    def rest(self, play: CurrentPlay) -> State:
        """Steady states under the resting current."""
        if play not in self._rests:
            self._rests[play] = self.ensemble.at_rest(play.rest_A)
        return self._rests[play]

    def now(self, play: CurrentPlay, state: State) -> Array:
        """WATCHED (4, corners) of states."""
        return self.ensemble.read(state)

    def play(self, play: CurrentPlay, state: State) -> Iterator[tuple[Stretch, State]]:
        """The drive in stretches."""
        return self.ensemble.play(play.drive, state)

    def hold(self, play: CurrentPlay, state: State, times_s: Array) -> Array:
        """The resting current held."""
        return self.ensemble.watch(play.rest_A, state, times_s, self.ensemble.lanes)

    def let_go(self, play: CurrentPlay, state: State) -> Iterator[tuple[Future, ...]]:
        """The last current held, zero current, and power off, which is the same."""
        last_A, lanes = play.drive.current_A[..., -1], self.ensemble.lanes
        held = self.ensemble.watch(last_A if last_A.ndim else float(last_A), state, ENDING_ROWS_S, lanes)
        yield (Future((ENDING_ROWS_S, held)),)
        zero = Future((ENDING_ROWS_S, self.ensemble.watch(0.0, state, ENDING_ROWS_S, lanes)))
        yield zero, Future((LATE_S, self.ensemble.watch(0.0, state, LATE_S, lanes)), drift=True)
        yield (zero,)

    def after(self, play: CurrentPlay, pause_s: float, state: State) -> State:
        """States before the next play, for those before this one."""
        ended = State(self._map(play).after(state.nodes_C))
        return ended if pause_s <= 0 else self.ensemble.rest(play.rest_A, ended, pause_s)

    def map(self, play: CurrentPlay, pause_s: float) -> PlayMap:
        """A play and its pause as a map of the nodes."""
        if pause_s <= 0:
            return self._map(play)
        if self._passed.get(play, (0.0, None))[0] != pause_s:  # of one pause: those of all would take memory
            passed = self._map(play).then(PlayMap(*self.ensemble.modes(play.rest_A).passage(pause_s)))
            self._passed[play] = pause_s, passed
        return self._passed[play][1]

    def _map(self, play: CurrentPlay) -> PlayMap:
        if play not in self._maps:
            self._maps[play] = PlayMap.of(self.ensemble, play.drive, self.rest(play))
        return self._maps[play]

    def cycle(self, play: CurrentPlay, pause_s: float) -> State:
        """The fixed point of the map; a corner that has none is as hot as can be."""
        start, whole = self.rest(play), self.map(play, pause_s)
        nodes, settles = whole.fixed_point()
        return _at(start, np.where(settles[:, np.newaxis], np.clip(nodes, COLDEST_C, HOTTEST_C), HOTTEST_C))

    def bound(self, plays: Sequence[CurrentPlay], pause_s: float, steady: Sequence[State], warm: bool) -> State:
        """Nodes that no play in any order takes the state beyond; as hot as can be where one heats without limit."""
        known = [*map(self.rest, plays), *steady]
        maps = [self.map(play, pause_s) for play in plays]
        free = least_bound(maps, [state.nodes_C[:, :-1] for state in known], 1.0 if warm else -1.0)
        return _at(known[0], np.nan_to_num(free, nan=HOTTEST_C))

    def rested(self, play: CurrentPlay, state: State, rest_s: float) -> State:
        """The resting current held."""
        return state if rest_s <= 0 else self.ensemble.rest(play.rest_A, state, rest_s)

    def unpowered(self) -> State:
        """Zero current held without limit of time."""
        return self.ensemble.at_rest(0.0)

    def stopped(self, plays: Sequence[CurrentPlay], bounds: tuple[State, State]) -> tuple[State, State]:
        """Node by node: no power, instants of plays, zero current since, and the test of the polarity then."""
        off, test_A = self.unpowered(), testing_A(self.ensemble)
        found = []
        for begun, most in zip(bounds, (np.maximum, np.minimum), strict=True):
            nodes = most(off.nodes_C, begun.nodes_C)
            for play in plays:
                assert isinstance(play.drive, Drive)
                for state, _ in instants(self.ensemble, play.drive, float(play.rest_A), begun, self.ensemble.lanes):
                    nodes = most(nodes, state.nodes_C)
            zero = [self.ensemble.rest(0.0, replace(off, nodes_C=nodes), time_s).nodes_C for time_s in OFF_ROWS_S]
            nodes = most.reduce([nodes, *zero])
            tested = self.ensemble.rest(test_A, replace(off, nodes_C=nodes), TEST_S)
            found.append(replace(off, nodes_C=most(nodes, tested.nodes_C)))
        return found[0], found[1]

    def alone(self, limits: Limits, end_s: float, begun_C: Array) -> list[Tally]:
        """The steady state under zero current, checked against the limits of temperature."""
        tally = Tally(limits, self.corners, Scenario(ending=IN_THE_END), begun_C=begun_C)
        levels = np.repeat(zero_current_C(self.ensemble)[:, :, np.newaxis], 2, axis=2)
        tally.add(np.array([end_s + LATER_S, end_s + 2 * LATER_S]), levels, rates=False, sums=False, drift=True)
        return [tally]

    def following(
        self,
        plays: Sequence[CurrentPlay],
        pause_s: float,
        steady: Sequence[State],
        begun_C: Array,
        limits: Limits,
        of: int,
    ) -> list[Tally]:
        """Tallies of one of the plays after each of them; sums over time are not taken."""
        before = list[tuple[State, Before]]()
        for number, (play, settled) in enumerate(zip(plays, steady, strict=True)):
            start = self.rest(play)
            if number == of:
                waits = (pause_s, *(pause_s + more_s for more_s in LONGER_S))
                before += [(self.after(play, wait_s, start), Before("once", wait_s)) for wait_s in waits]
            else:
                before.append((self.after(play, pause_s, start), Before("another", pause_s)))
                before.append((self.after(play, pause_s, settled), Before("others", pause_s)))
        states = side_by_side([state for state, _ in before])
        tallies = [Tally(limits, self.corners, Scenario(before=what), begun_C=begun_C) for _, what in before]
        rigs, count = np.tile(self.ensemble.lanes, len(before)), len(self.corners)
        for (rows, values), _ in self.ensemble.play(plays[of].drive, states, rigs):
            for k, tally in enumerate(tallies):
                tally.add(rows, values[:, k * count : (k + 1) * count], sums=False)
        return tallies

    def demanded(
        self,
        singles: Sequence[Sequence[Single[CurrentPlay, State]]],
        recovered_s: Sequence[float],
        repeating: Repeating[CurrentPlay, State],
        tallies: Sequence[list[Tally]],
        shortest_s: float | None,
    ) -> Demanded:
        """Demands against a host that stops, a driver that is stuck, and faults of a first play."""
        return demanded(self, [single for (single,) in singles], recovered_s, repeating, tallies, shortest_s)


def _at(like: State, free_C: Array) -> State:
    """States with other nodes but for the last, which is deep."""
    return State(np.concatenate([free_C, like.nodes_C[:, -1:]], axis=1))


def single_of_lanes(ensemble: Ensemble, drives: LaneDrives, limits: Limits) -> Single[CurrentPlay, State]:
    """A play in which each corner has a drive of its own, from rest at its first current."""
    return Single.of(CurrentPlant.of(ensemble), CurrentPlay(drives, drives.current_A[:, 0]), limits)


def zero_current_C(ensemble: Ensemble) -> Array:
    """WATCHED (4, corners) that zero current leads to without limit of time."""
    steady = [state_under_current(network, 0.0, in_the_end=True) for network in ensemble.networks]
    return ensemble.read(State(ensemble.bank.states(steady)))
