"""A rig in all corners of its uncertainty side by side.

A drive is played in stretches, so that the memory needed depends neither on its length nor on its updates. Rows are
no farther apart than 10 ms, over which the rate of skin temperature is taken, nor than the drive's own updates.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..solver.batch_inputs import Bank, Intervals, State, cut, run_on
from ..solver.drive import Drive, DriveError
from ..solver.modes import ConstantCurrent
from ..solver.network import RECORDED, Network, network_of
from ..solver.steady import state_under_current, steady_of
from .corners import Corner, corners_of
from .plant import Stretch
from .tally import HOTTEST_C, WATCHED

ROW_S, FINEST_S = 0.01, 1e-4
"""The longest and the shortest distance of rows; in 0.1 ms no plate moves by more than a few millikelvins."""

AT_ONCE = 400_000
"""Rows times lanes of a stretch: about 13 MB of what is watched."""


@dataclass(frozen=True, slots=True, eq=False)
class LaneDrives:
    """Currents (lanes, k) at times in s (k,), each held until the next: every lane plays its own."""

    time_s: Array
    current_A: Array
    held: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Ensemble:
    """Corners of a rig, ready to simulate; the first is the rig as given.

    `bridge_A`: a bridge switches between this current and none, so that constant currents are means; None: it does not.
    `averaged`: so are the currents of drives, since the bridge switches too fast for a plate to follow.
    """

    rig: Rig
    corners: tuple[Corner, ...]
    networks: tuple[Network, ...]
    bank: Bank
    gain: Array
    bridge_A: float | None
    averaged: bool = False
    _modes: dict[float, ConstantCurrent] = field(default_factory=dict)

    @staticmethod
    def of(rig: Rig, bridge_A: float | None = None, averaged: bool = False) -> Ensemble:
        """All corners of a rig; raises DriveError for an impossible bridge."""
        if bridge_A is not None and not (0 < bridge_A < np.inf):
            raise DriveError(f"a bridge of {bridge_A:g} A is not possible; its current must be above 0 A")
        return Ensemble.on(rig, corners_of(rig), bridge_A, averaged)

    @staticmethod
    def on(rig: Rig, corners: tuple[Corner, ...], bridge_A: float | None, averaged: bool = False) -> Ensemble:
        """Some corners of a rig."""
        networks = tuple(network_of(corner.rig) for corner in corners)
        gain = np.array([1.0 + corner.gain_relative for corner in corners])
        return Ensemble(rig, corners, networks, Bank.of(networks), gain, bridge_A, averaged)

    def only(self, which: list[int]) -> Ensemble:
        """A copy with some of the corners."""
        few = Ensemble.on(self.rig, tuple(self.corners[k] for k in which), self.bridge_A, self.averaged)
        few._modes.update({current: modes.only(which) for current, modes in self._modes.items()})
        return few

    @property
    def lanes(self) -> Index:
        """One lane per corner."""
        return np.arange(len(self.corners), dtype=np.int64)

    def at_rest(self, rest_A: float | Array) -> State:
        """Steady states under a current, or each lane's; hottest where a corner has none."""
        rests = np.broadcast_to(rest_A, len(self.corners)).tolist()
        states = self.bank.states(list(map(self._steady, self.corners, rests)))
        return State(states)

    def _steady(self, corner: Corner, rest_A: float) -> Array:
        network, gain = network_of(corner.rig), 1.0 + corner.gain_relative
        try:
            if self.bridge_A is not None:
                return steady_of(corner.rig, rest_A / self.bridge_A, self.bridge_A * gain)
            return state_under_current(network, rest_A * gain)
        except ArithmeticError as problem:
            if corner.nominal:
                raise RigError(f"rig {corner.rig.name}: {problem}; begin the drive with a smaller current") from None
            hottest = np.full(network.nodes, HOTTEST_C)
            hottest[-1] = network.deep_C
            return hottest

    def read(self, state: State) -> Array:
        """WATCHED (4, corners) of states."""
        which = [RECORDED.index(name) for name in WATCHED]
        nodes = np.delete(state.nodes_C, -2, axis=1) if self.bank.passive else state.nodes_C  # without the heat sink
        places = self.bank.probe_start[:, which, np.newaxis] + np.arange(3)
        near_C = np.take_along_axis(nodes[:, np.newaxis], places, axis=2)
        return np.asarray((self.bank.probe_weight[:, which] * near_C).sum(axis=2).T)

    def play(
        self, drive: Drive | LaneDrives, state: State, rigs: Index | None = None
    ) -> Iterator[tuple[Stretch, State]]:
        """Play a drive from states, in stretches, each with the states at its end; `rigs` (lanes,): a lane's corner."""
        which = self.lanes if rigs is None else rigs
        switched = self.bridge_A is not None and not self.averaged
        row_s = ROW_S if switched else row_of(drive)
        end, most = float(drive.time_s[-1]), max(2, AT_ONCE // len(which))
        count = max(1, int(np.ceil(end / row_s - 1e-9)))
        for first in range(0, count, most):
            last = min(first + most, count)
            rows: Array = np.arange(first, last + 1, dtype=np.float64) * row_s
            rows[-1] = min(rows[-1], end)
            part = between(drive, float(rows[0]), float(rows[-1]))
            intervals = self._cut(rows - rows[0], part)
            values, state = run_on(self.bank, which, which, intervals, state, WATCHED)
            yield (rows, values), state

    def end_of(self, drive: Drive | LaneDrives, state: State, rigs: Index | None = None) -> State:
        """States at the end of a drive."""
        which = self.lanes if rigs is None else rigs
        end = float(drive.time_s[-1])
        intervals = self._cut(np.array([0.0, end]), drive)
        return run_on(self.bank, which, which, intervals, state, WATCHED[:1])[1]

    def _cut(self, rows_s: Array, drive: Drive | LaneDrives) -> Intervals:
        """A drive cut into intervals, scaled in each corner; where it has means, with the heat of what switches."""
        intervals = cut(rows_s, drive.time_s, self.gain[:, np.newaxis] * drive.current_A, drive.held)
        if self.bridge_A is None or not self.averaged:
            return intervals
        start, end = switching(intervals.start_A, self.bridge_A * self.gain)
        return Intervals(intervals.edges_s, intervals.row_of, start, end)

    def hold(
        self, current_A: float | Array, state: State, times_s: Array, rigs: Index | None = None
    ) -> tuple[Array, State]:
        """WATCHED at times from 0 on under a constant current, or one of each corner, and the last states."""
        which = self.lanes if rigs is None else rigs
        after = self.modes(current_A).after(which, state.nodes_C, float(times_s[-1]))
        return self.watch(current_A, state, times_s, which), State(after)

    def watch(
        self, current_A: float | Array, state: State, times_s: Array, rigs: Index, columns: Sequence[str] = WATCHED
    ) -> Array:
        """The first result of `hold`, or some of its columns, where the last states are not needed."""
        return self.modes(current_A).run(rigs, state.nodes_C, times_s, columns)

    def rest(self, current_A: float | Array, state: State, time_s: float) -> State:
        """States after a constant current has been held for a time in s."""
        return State(self.modes(current_A).after(self.lanes, state.nodes_C, time_s))

    def modes(self, current_A: float | Array) -> ConstantCurrent:
        """Modes of all corners under a constant current, or the mean of a bridge's."""
        if isinstance(current_A, float) and current_A in self._modes:
            return self._modes[current_A]
        mean = self.gain * current_A
        square = mean**2 if self.bridge_A is None else np.abs(mean) * self.bridge_A * self.gain
        modes = ConstantCurrent.of(self.networks, mean, square)
        if isinstance(current_A, float):
            self._modes[current_A] = modes
        return modes

    def step(self, current_A: Array, state: State, times_s: Array, rigs: Index) -> tuple[Array, State]:
        """WATCHED at times from now under currents (intervals, lanes), of a bridge their means, and the last states."""
        mean = self.gain[rigs] * current_A
        begin, end = (mean, mean) if self.bridge_A is None else switching(mean, self.bridge_A * self.gain[rigs])
        intervals = Intervals(times_s, np.arange(len(times_s)), np.ascontiguousarray(begin), np.ascontiguousarray(end))
        lanes = np.arange(len(rigs), dtype=np.int64)
        return run_on(self.bank, rigs, lanes, intervals, state, WATCHED)


def row_of(drive: Drive | LaneDrives) -> float:
    """Distance in s of rows: the shortest update of a drive or a whole part of it, from FINEST_S to ROW_S."""
    shortest = round(float(np.diff(drive.time_s).min()), 9)  # differences of times are off by rounding
    return float(max(FINEST_S, shortest / max(1.0, np.ceil(shortest / ROW_S - 1e-9))))


def between(drive: Drive | LaneDrives, begin_s: float, end_s: float) -> Drive | LaneDrives:
    """A drive from one time to another, on its own clock."""
    inside = (drive.time_s > begin_s + 1e-12) & (drive.time_s < end_s - 1e-12)
    times = np.concatenate([[begin_s], drive.time_s[inside], [end_s]])
    if drive.held:
        at = np.clip(np.searchsorted(drive.time_s, times + 1e-12, side="right") - 1, 0, len(drive.time_s) - 1)
        if isinstance(drive, LaneDrives):
            return LaneDrives(times - begin_s, drive.current_A[:, at])
        currents = drive.current_A[at]
    else:
        currents = np.interp(times, drive.time_s, drive.current_A)
    return Drive(times - begin_s, currents, drive.held)


def switching(mean_A: Array, bridge_A: Array) -> tuple[Array, Array]:
    """Currents at both ends of intervals (intervals, lanes) that heat as a bridge of these means does.

    A bridge of mean m and peak p heats with m·p instead of m²: a triangle about m has that mean square too. It leans
    the other way from interval to interval, so that there is no jump where the mean stays.
    """
    swing = np.sqrt(3.0 * np.maximum(np.abs(mean_A) * bridge_A - mean_A**2, 0.0))
    sign = np.where(np.arange(len(mean_A)) % 2 == 0, 1.0, -1.0)[:, np.newaxis]
    return mean_A + sign * swing, mean_A - sign * swing
