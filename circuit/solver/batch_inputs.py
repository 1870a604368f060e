"""Rigs stacked as the inputs of kernels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from thermicon.base.numbers.arrays import Array, Index
from thermicon.base.numbers.cores import cores

from ..rig.rig import Rig
from ..rig.rigfile import RigError
from .network import DEEP_C, RECORDED, SKIN, ModalRigs, Network, network_of

VECTOR = 16
"""Modes are padded to a multiple of this with modes that do nothing, since loops over whole vectors are quicker."""


@dataclass(frozen=True, eq=False)
class SkinsOfBank:
    """Skins of r rigs, padded to the most lumps n: `count` (r,), the rest (r, n or n + 1) as in `Network`."""

    count: Index
    capacity: Array
    conductance: Array
    perfusion: Array

    @cached_property
    def modes(self) -> tuple[Array, Array, Array, Array]:
        """Rates (r, n) in 1/s, weights of the modes in the first lump, and matrices from lumps to modes and back.

        Lumps are in K above the deep node. With C the capacities and K the conductances, C^(−1/2)·K·C^(−1/2) is
        symmetric. Its modes do not depend on the current, and what is padded has none of the weight.
        """
        from scipy.linalg import eigh_tridiagonal

        rigs, most = self.capacity.shape
        width = most + -most % VECTOR
        rates, to_modes, from_modes = (
            np.zeros((rigs, width)),
            np.zeros((rigs, width, most)),
            np.zeros((rigs, most, width)),
        )
        for rig, n in enumerate(self.count):
            g, root = self.conductance[rig, : n + 1], np.sqrt(self.capacity[rig, :n])
            diagonal = (g[:-1] + g[1:] + self.perfusion[rig, :n]) / self.capacity[rig, :n]
            between = -g[1:-1] / (root[1:] * root[:-1])
            rates[rig, :n], vectors = eigh_tridiagonal(diagonal, between, check_finite=False)
            to_modes[rig, :n, :n], from_modes[rig, :n, :n] = vectors.T * root, vectors / root[:, np.newaxis]
        return rates, from_modes[:, 0].copy(), to_modes, from_modes


@dataclass(frozen=True, eq=False)
class Bank:
    """Networks of r rigs: `plates`, `probe_start`, `probe_weight`, `face_share` (r, …) as in `Network`."""

    skins: SkinsOfBank
    plates: Array
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

        widths = (("capacity_J_per_K", 0), ("conductance_W_per_K", 1), ("perfusion_W_per_K", 0))
        return Bank(
            SkinsOfBank(count, *(padded(name, extra) for name, extra in widths)),
            np.array([network.plates for network in networks]),
            np.array([network.probe_start for network in networks]),
            np.array([network.probe_weight for network in networks]),
            np.array([network.face_share for network in networks]),
            networks[0].passive,
        )

    @property
    def modal(self) -> ModalRigs:
        """The rigs as the kernels step them."""
        skins = self.skins
        return ModalRigs(skins.count, *skins.modes, skins.conductance[:, 0].copy(), self.plates)

    @cached_property
    def recorded(self) -> Array:
        """The readings of RECORDED, see `readings`."""
        return self.readings(self.probe_start, self.probe_weight)

    def readings(self, start: Index, weight: Array) -> Array:
        """Weights (r, k, 3 + modes) of 1, both plates and the modes in readings that begin at `start` (r, k).

        `weight` (r, k, 3) are those of three neighbouring states, as in `Network`.
        """
        rigs, probes = start.shape
        states = np.zeros((rigs, probes, self.skins.capacity.shape[1] + SKIN + 1))
        places = (start[:, :, np.newaxis] + np.arange(3)).clip(max=states.shape[2] - 1)
        np.put_along_axis(states, places, weight, axis=2)
        lumps, deep_C = states[:, :, SKIN:], self.plates[:, DEEP_C, np.newaxis, np.newaxis]
        constant = lumps.sum(axis=2, keepdims=True) * deep_C
        return np.concatenate([constant, states[:, :, :SKIN], lumps[:, :, :-1] @ self.skins.modes[3]], axis=2)

    def states(self, states: Sequence[Array]) -> Array:
        """Stack starting states, one per lane, padded to (lanes, nodes)."""
        rows = np.zeros((len(states), self.skins.capacity.shape[1] + self.passive + SKIN + 1))
        for row, state in zip(rows, states, strict=True):
            row[: len(state)] = state
        return rows


@lru_cache(maxsize=64)
def bank_of(rig: Rig) -> Bank:
    """A bank of one rig, which is kept: fits, sliders and sets play one rig again and again."""
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
    extra: tuple[Index, Array] | None = None,
) -> tuple[Array, State]:  # fmt: skip
    """`run_forward` from any states; also returns those at the end."""
    from .kernel import forward

    readings = np.ascontiguousarray(bank.recorded[:, [RECORDED.index(probe) for probe in probes]])
    if extra is not None:
        start, weight = extra
        own = bank.readings(np.tile(start, (len(readings), 1)), np.tile(weight, (len(readings), 1, 1)))
        readings = np.concatenate([readings, own], axis=1)
    out = np.empty((readings.shape[1], len(rig_of), int(intervals.row_of.max()) + 1))
    final, rigs_of_bank = np.zeros_like(state.nodes_C), bank.modal

    def work(lanes: Index) -> None:
        forward(
            lanes, rig_of, cue_of, intervals.edges_s, intervals.start_A, intervals.end_A, intervals.row_of,
            rigs_of_bank, readings, state.nodes_C, out, final,
        )  # fmt: skip

    _every_lane(work, len(rig_of), len(intervals.edges_s))
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

    rigs = bank.modal

    def work(lanes: Index) -> None:
        kernel(lanes, rig_of, *given, rigs, state, current, reached, why)

    _every_lane(work, len(rig_of), SHORT)
    return current, reached, why


SHORT = 100_000
"""Lanes times intervals below which starting a thread takes longer than the work."""


def _every_lane(work: Callable[[Index], None], lanes: int, intervals: int) -> None:
    """Run lanes, each by itself, on all cores where that is worth it."""
    on_all_cores(work, np.arange(lanes, dtype=np.int64), None if lanes * intervals >= SHORT else 1)


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
