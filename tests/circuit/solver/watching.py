"""Readings of the circuit's states while a drive plays."""

import numpy as np

from thermicon.base.numbers.arrays import Array, Index
from thermicon.circuit import Drive, Rig, Trace, simulate_current
from thermicon.circuit.solver.batch_inputs import bank_of, cut, run_forward
from thermicon.circuit.solver.network import RECORDED, network_of
from thermicon.circuit.solver.steady import state_under_current


def watch(
    drive: Drive, rig: Rig, readings: tuple[Index, Array], *, rate_Hz: float = 100.0, start_C: Array | None = None
) -> tuple[Trace, Array]:
    """The trace of a drive on a rig, and further readings (starts, weights) of the state (k, rows)."""
    trace = simulate_current(drive, rig, rate_Hz=rate_Hz, start_C=start_C)
    bank, lane = bank_of(rig), np.zeros(1, dtype=np.int64)
    state = state_under_current(network_of(rig), float(drive.current_A[0])) if start_C is None else start_C
    intervals = cut(trace.time_s, drive.time_s, drive.current_A[np.newaxis], drive.held)
    recorded = run_forward(bank, lane, lane, intervals, bank.states([state]), extra=readings)[:, 0]
    return trace, recorded[len(RECORDED) :]
