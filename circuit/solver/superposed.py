"""Receptor temperatures under a tracked display by superposition of ramp responses.

The full solution finds each rig's current and steps module and skin with it. Where no limit is met, the display is the
target to within a fraction of a millikelvin, and the skin under it is linear. Lanes that come near a limit are left to
the full solution, which is also what the tests compare with (0.5 mK at the receptors of every shipped set).
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from thermicon.base.numbers.arrays import Array, Index

from ..rig.rig import Rig
from .batch_inputs import Bank, on_all_cores
from .network import COLD, HOT, RECORDED, SKIN

PROBES = ("cold_receptor_C", "warm_receptor_C")
"""What is superposed: readings below the surface, which do not see how the current ripples within a period."""

MOST_CORNERS = 40
"""With more changes of slope than this, superposition is no faster than the full solution."""

SAME_K = 1e-9
"""Changes of slope in K per period that are rounding errors."""

LONGEST_PERIOD_S = 0.01
"""With a longer period the display is not linear between its ends."""


def is_linear(rigs: Sequence[Rig], nominal: Rig, probes: Sequence[str], rows_s: Array) -> bool:
    """Whether readings of rigs can be superposed at all: a plain module, short periods, and rows at their ends."""
    update_Hz = nominal.driver.update_Hz
    return (
        set(probes) <= set(PROBES)
        and nominal.controller is None
        and update_Hz * LONGEST_PERIOD_S >= 1.0 - 1e-9
        and float(np.abs(rows_s * update_Hz - np.rint(rows_s * update_Hz)).max()) < 1e-6
        and all(rig.heat_sink.passive is None for rig in (*rigs, nominal))
    )


def corners_of(display_C: Array) -> tuple[Index, Array] | None:
    """Places and changes of slope (cues, corners) of displays (cues, periods + 1); None where one has too many."""
    slope = np.diff(display_C, axis=1)
    change = np.diff(slope, axis=1, prepend=0.0)
    bent = np.abs(change) > SAME_K
    most = int(bent.sum(axis=1).max(initial=0))
    if most > MOST_CORNERS:
        return None
    at, by = np.full((len(display_C), max(most, 1)), -1, dtype=np.int64), np.zeros((len(display_C), max(most, 1)))
    for row, (where, values) in enumerate(zip(bent, change, strict=True)):
        places = np.flatnonzero(where)
        at[row, : len(places)], by[row, : len(places)] = places, values[places]
    return at, by


def superposed(
    bank: Bank, display_C: Array, corners: tuple[Index, Array], states: Array, probes: Sequence[str], period_s: float,
    rows_s: Array,
) -> tuple[Array, npt.NDArray[np.bool_]]:  # fmt: skip
    """Readings (readings, lanes, rows) of rigs under displays (cues, periods + 1) from steady states, rig by rig;
    and whether each lane (lanes,) is far from every limit.
    """
    from . import kernel_modes as kernel

    skins, cues = bank.skins, len(display_C)
    rigs = len(skins.count)
    rig_of, cue_of = (place.ravel() for place in np.indices((rigs, cues)))
    which = [RECORDED.index(probe) for probe in probes]
    places, weights = map(np.ascontiguousarray, (bank.probe_start[:, which], bank.probe_weight[:, which]))
    response = np.empty((rigs, len(which) + 1, display_C.shape[1]))

    def respond(part: Index) -> None:
        kernel.ramp_responses(
            skins.count[part], skins.capacity[part], skins.conductance[part], skins.perfusion[part], period_s,
            places[part], weights[part], response[part[0] : part[-1] + 1],
        )  # fmt: skip

    on_all_cores(respond, np.arange(rigs))
    lane = np.arange(rigs * cues)
    near = places[rig_of][:, :, np.newaxis] + np.arange(3)
    begin = np.empty((len(lane), len(which) + 1))
    begin[:, :-1] = (weights[rig_of] * states[lane[:, np.newaxis, np.newaxis], near]).sum(axis=2)
    begin[:, -1] = skins.conductance[rig_of, 0] * (states[:, SKIN] - states[:, COLD])
    row_at = np.rint(rows_s / period_s).astype(np.int64)
    out = np.empty((len(which), len(lane), len(row_at)))
    fine, hot_C = np.empty(len(lane), dtype=np.bool_), np.ascontiguousarray(states[:, HOT])

    def add(part: Index) -> None:
        kernel.superpose(
            part, rig_of, cue_of, *corners, response, begin, row_at, display_C, hot_C, bank.plates, period_s, out, fine
        )  # fmt: skip

    on_all_cores(add, lane)
    return out, fine
