"""Rigs stacked as the inputs of kernels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermicon.base.numbers.arrays import Array, Index
from thermicon.base.numbers.cores import cores

from ..rig.rig import Rig
from ..rig.rigfile import RigError
from .network import RECORDED, Network, network_of


@dataclass(frozen=True, slots=True)
class Bank:
    """Networks of r rigs, padded to the most lumps n: `count` (r,), the rest (r, …) as in Network."""

    count: Index
    plates: Array
    capacity: Array
    conductance: Array
    perfusion: Array
    probe_start: Index
    probe_weight: Array
    face_share: Array
    passive: bool = False

    @staticmethod
    def of(networks: Sequence[Network]) -> Bank:
        """Stack networks; RigError where only some have a passive heat sink."""
        if len({network.passive for network in networks}) > 1:
            raise RigError(
                "rigs of one batch must all have a passive heat sink (heat_sink.air_resistance_K_per_W) or none"
            )
        count = np.array([len(network.capacity_J_per_K) for network in networks], dtype=np.int64)
        most = int(count.max())

        def padded(name: str, extra: int) -> Array:
            rows = np.ones((len(networks), most + extra))
            for row, network in zip(rows, networks, strict=True):
                values = getattr(network, name)
                row[: len(values)] = values
            return rows

        return Bank(
            count,
            np.array([network.plates for network in networks]),
            padded("capacity_J_per_K", 0),
            padded("conductance_W_per_K", 1),
            padded("perfusion_W_per_K", 0),
            np.array([network.probe_start for network in networks]),
            np.array([network.probe_weight for network in networks]),
            np.array([network.face_share for network in networks]),
            networks[0].passive,
        )

    @property
    def arrays(self) -> tuple[Index, Array, Array, Array, Array]:
        """The arrays of a bank for the kernels."""
        return self.count, self.plates, self.capacity, self.conductance, self.perfusion

    def states(self, states: Sequence[Array]) -> Array:
        """Stack starting states, one per lane, padded to (lanes, nodes)."""
        rows = np.zeros((len(states), self.capacity.shape[1] + self.passive + 3))
        for row, state in zip(rows, states, strict=True):
            row[: len(state)] = state
        return rows


def bank_of(rig: Rig) -> Bank:
    """A bank of one rig."""
    return Bank.of([network_of(rig)])


@dataclass(frozen=True, slots=True)
class Intervals:
    """Time cut where a current changes or a row is written: `row_of` (e,) is that row, or −1; (e − 1, cues) A."""

    edges_s: Array
    row_of: Index
    start_A: Array
    end_A: Array


def cut(rows_s: Array, times_s: Array, currents_A: Array, held: bool) -> Intervals:
    """Cut time for currents (cues, k) given at times (k,), held or linear between, ending at the last row."""
    insert_at = np.searchsorted(rows_s, times_s)
    after, before = np.minimum(insert_at, len(rows_s) - 1), np.maximum(insert_at - 1, 0)
    near = np.minimum(np.abs(rows_s[after] - times_s), np.abs(times_s - rows_s[before]))
    new = (near > 1e-9) & (times_s < rows_s[-1])  # a row and a change a rounding error apart are one
    where, extra = insert_at[new], int(new.sum())
    edges, row_of = np.empty(len(rows_s) + extra), np.full(len(rows_s) + extra, -1)
    is_row = np.ones(len(edges), dtype=bool)
    is_row[where + np.arange(extra)] = False
    edges[is_row], edges[~is_row], row_of[is_row] = rows_s, times_s[new], np.arange(len(rows_s))
    if held:
        now = np.clip(np.searchsorted(times_s, edges[:-1] + 1e-9, side="right") - 1, 0, len(times_s) - 1)
        start = end_ = currents_A[:, now]
    else:
        at = np.array([np.interp(edges, times_s, row) for row in currents_A])
        start, end_ = at[:, :-1], at[:, 1:]
    return Intervals(edges, row_of, np.ascontiguousarray(start.T), np.ascontiguousarray(end_.T))


def run_forward(
    bank: Bank, rig_of: Index, cue_of: Index, intervals: Intervals, state: Array, probes: Sequence[str] = RECORDED,
    extra: tuple[Index, Array] | None = None,
) -> Array:  # fmt: skip
    """Probes (probes, lanes, rows) of lanes from `state` (lanes, nodes), then `extra`: starts (k,), weights (k, 3)."""
    return run_on(bank, rig_of, cue_of, intervals, State(state), probes, extra)[0]


@dataclass(frozen=True, slots=True)
class State:
    """The state of lanes: `nodes_C` (lanes, nodes) as in `Network`."""

    nodes_C: Array

    def take(self, lanes: Index) -> State:
        """The states of some lanes, in that order."""
        return State(self.nodes_C[lanes])


def run_on(
    bank: Bank, rig_of: Index, cue_of: Index, intervals: Intervals, state: State, probes: Sequence[str] = RECORDED,
    extra: tuple[Index, Array] | None = None, *, alone: int = 0,
) -> tuple[Array, State]:  # fmt: skip
    """`run_forward` from any states, also returns those at the end; the last `alone` lanes have their own steps."""
    from .kernel import forward

    which = [RECORDED.index(probe) for probe in probes]
    places = np.ascontiguousarray(bank.probe_start[:, which])
    weights = np.ascontiguousarray(bank.probe_weight[:, which])
    if extra is not None:
        rigs = len(places)
        places = np.concatenate([places, np.repeat(extra[0][np.newaxis], rigs, axis=0)], axis=1)
        weights = np.concatenate([weights, np.repeat(extra[1][np.newaxis], rigs, axis=0)], axis=1)
    out = np.empty((places.shape[1], len(rig_of), int(intervals.row_of.max()) + 1))
    final = np.zeros_like(state.nodes_C)

    def work(wide: tuple[int, ...], blocks: Index) -> None:
        forward(
            wide, blocks, rig_of, cue_of, intervals.edges_s, intervals.start_A, intervals.end_A, intervals.row_of,
            bank.arrays, places, weights, state.nodes_C, out, final,
        )  # fmt: skip

    _in_blocks(work, len(rig_of), len(intervals.edges_s), alone)
    return out, State(final)


def run_follow(
    bank: Bank, rig_of: Index, cue_of: Index, period_s: float, target_C: Array, skin_control: bool, state: Array
) -> tuple[Array, Array, Index]:
    """Return (current A, reached °C, limit code), each (lanes, periods), that follow targets (cues, periods)."""
    from .kernel_follow import follow

    share = bank.face_share if skin_control else np.ones_like(bank.face_share)
    return _run_periods(follow, bank, rig_of, state, (cue_of, period_s, target_C, share))


def run_regulate(
    bank: Bank,
    rig_of: Index,
    cue_of: Index,
    period_s: float,
    setpoint_C: Array,
    gains: Array,
    bias_A: Array,
    state: Array,
) -> tuple[Array, Array, Index]:
    """Return (current A, display °C, limit code), each (lanes, periods), of a PID loop; `gains` (rigs, 5)."""
    from .kernel_regulate import regulate

    return _run_periods(regulate, bank, rig_of, state, (cue_of, period_s, setpoint_C, gains, bias_A))


def _run_periods(
    kernel: Callable[..., None], bank: Bank, rig_of: Index, state: Array, given: tuple[Any, ...]
) -> tuple[Array, Array, Index]:
    """Run a kernel that finds the current of each period of its third argument, a target."""
    shape = (len(rig_of), given[2].shape[1])
    current, reached, why = np.empty(shape), np.empty(shape), np.empty(shape, dtype=np.int64)

    def work(wide: tuple[int, ...], blocks: Index) -> None:
        kernel(wide, blocks, rig_of, *given, bank.arrays, state, current, reached, why)

    _in_blocks(work, len(rig_of))
    return current, reached, why


FEWEST = 4
"""Fewer lanes than this run one at a time, more in padded blocks, where a lane's steps are the same in any batch."""

SHORT = 100_000
"""Lanes times intervals below which starting a thread takes longer than the work."""


def left_over(lanes: int) -> int:
    """How many lanes after the last whole block are quicker alone, since a block takes as long as eight of them."""
    from .kernel import MANY

    beyond = lanes % len(MANY)
    return beyond if beyond < len(MANY) // 2 else 0


def _in_blocks(
    work: Callable[[tuple[int, ...], Index], None], lanes: int, intervals: int = SHORT, alone: int = 0
) -> None:
    """Run lanes in padded blocks that do not depend on the number of cores; the last `alone`, or a few, one by one."""
    from .kernel import MANY, ONE

    together, width = 0 if lanes < FEWEST else lanes - alone, len(MANY)
    if together:
        padded = np.minimum(np.arange(-(-together // width) * width, dtype=np.int64), together - 1)
        used = None if lanes * intervals >= SHORT else 1
        on_all_cores(lambda blocks: work(MANY, blocks), padded.reshape(-1, width), used)
    if together < lanes:
        work(ONE, np.arange(together, lanes, dtype=np.int64)[:, np.newaxis])


def on_all_cores(work: Callable[[Index], None], lanes: Index, most: int | None = None) -> None:
    """Call `work` on lanes, or blocks of them, in a thread for each core; each is computed by itself."""
    used = min(most or cores(), len(lanes))
    if used == 1:
        work(lanes)
        return
    pool = ThreadPoolExecutor(used)
    try:
        list(pool.map(work, np.array_split(lanes, used)))
    finally:
        pool.shutdown(wait=False)  # who interrupts waits for no lane
