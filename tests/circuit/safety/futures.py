"""Every scenario of a drive row by row."""

from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.safety.corners import Corner
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.safety.plant import ENDING_ROWS_S
from thermicon.circuit.safety.spans import ENDING_S
from thermicon.circuit.solver.drive import Drive


@dataclass(frozen=True, slots=True)
class Futures:
    """One drive in all scenarios: `time_s` (rows,), `values` (WATCHED, endings, corners, rows) in °C; ends at `end_s`.

    The first corner is the rig as given. A run that diverges is not finite.
    """

    end_s: float
    corners: tuple[Corner, ...]
    time_s: Array
    values: Array


def play_out(drive: Drive, rig: Rig, *, rest_A: float | None = None, bridge_A: float | None = None) -> Futures:
    """Play a drive in every corner and follow it through every ending.

    `rest_A` holds the steady state before; None: the drive's first current. `bridge_A` says that the current comes from
    a bridge that switches between this current and none: `rest_A` and the drive's last current are then means.
    """
    rest = float(drive.current_A[0]) if rest_A is None else rest_A
    ensemble = Ensemble.of(rig, bridge_A)
    times: list[Array] = []
    parts: list[Array] = []
    state = ensemble.at_rest(rest)
    for (rows, values), then in ensemble.play(drive, state):
        state = then
        skip = 1 if times else 0
        times.append(rows[skip:])
        parts.append(values[:, :, skip:])
    after = np.append(ENDING_ROWS_S[ENDING_S - 1e-9 > ENDING_ROWS_S], ENDING_S)
    cue, end = np.concatenate(parts, axis=2), float(drive.time_s[-1])
    endings = [ensemble.hold(float(drive.current_A[-1]), state, after)[0], ensemble.hold(0.0, state, after)[0]]
    endings.append(endings[1])  # without power
    values = np.stack([np.concatenate([cue, ending[:, :, 1:]], axis=2) for ending in endings], axis=1)
    values.setflags(write=False)
    return Futures(end, ensemble.corners, np.concatenate([*times, end + after[1:]]), values)
