"""Temperature at any depth while a cue plays, and the depth that a probe resembles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.circuit.arrays import Array
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.solver.drive import Drive
from thermicon.circuit.solver.network import places_of, stacked, temperature_weights
from thermicon.circuit.solver.probes import lump_rows
from thermicon.circuit.solver.simulate import watch
from thermicon.circuit.solver.trace import Trace
from thermicon.icons import Icon


@dataclass(frozen=True, slots=True)
class Depths:
    """A run at k depths: `depth_m` (k,), temperature in °C (k, rows), its trace."""

    depth_m: Array
    temperature_C: Array
    trace: Trace


def probe_depths(
    cue: Icon | Drive, rig: Rig, depths_m: Sequence[float] | Array, *, rate_Hz: float = 100.0, tail_s: float = 0.0
) -> Depths:
    """Simulate a cue or a drive and record the temperature at depths in m; linear in resistance between lumps."""
    depths = np.array(depths_m, dtype=np.float64)
    place, contact = places_of(rig), rig.contact.resistance_m2K_per_W
    at = [contact + rig.skin.resistance_to_m2K_per_W(float(depth)) for depth in depths]
    rows = stacked([temperature_weights(here, place) for here in at])
    trace, values = watch(cue, rig, rows, rate_Hz=rate_Hz, tail_s=tail_s)
    return Depths(depths, values.copy(), trace)


@dataclass(frozen=True, slots=True)
class Likeness:
    """The depth in m of skin in contact whose change a probe resembles most, and the rms residual in K."""

    probe: str
    depth_m: float
    residual_K: float
    largest_change_K: float

    def __repr__(self) -> str:
        return (
            f"Likeness(probe {self.probe!r} is most like {self.depth_m * 1e3:.2f} mm, "
            f"residual {self.residual_K:.3f} K rms of {abs(self.largest_change_K):.2f} K)"
        )


def resembles(cue: Icon | Drive, rig: Rig, name: str, *, rate_Hz: float = 100.0, tail_s: float = 0.0) -> Likeness:
    """Return the depth in the skin under the display whose course a probe on insulated skin resembles most.

    The depth with the least rms difference of the changes from the first row; changes, since the start of a trace does
    not depend on depth. A lag of the probe is part of its reading. The insulated skin is that under a round pad, with
    heat flowing sideways; the skin under the display has depth alone.
    """
    trace, lumps = watch(cue, rig, stacked(lump_rows(rig)), rate_Hz=rate_Hz, tail_s=tail_s)
    deep = np.full((1, lumps.shape[1]), rig.deep_C)
    nodes = np.concatenate([trace.skin_C[np.newaxis], lumps, deep])
    depth = np.concatenate([[0.0], rig.column.depth_m, [rig.skin.thickness_m]])
    read = trace.probe(name)
    best = _nearest(rig, depth, nodes - nodes[:, :1], read - read[0])
    return Likeness(name, best[0], best[1], float((read - read[0])[np.argmax(np.abs(read - read[0]))]))


def _nearest(rig: Rig, depth_m: Array, change_K: Array, wanted_K: Array) -> tuple[float, float]:
    """Return (depth m, rms K) of the nearest course; between two lumps the best share has a closed form."""
    best = (0.0, np.inf)
    for k in range(len(depth_m) - 1):
        high, low = depth_m[k], depth_m[k + 1]
        if low - high < 1e-9:
            continue
        step = change_K[k + 1] - change_K[k]
        square = float(step @ step)
        share = 0.0 if square == 0 else min(max(float((wanted_K - change_K[k]) @ step) / square, 0.0), 1.0)
        rms = float(np.sqrt(np.mean((wanted_K - change_K[k] - share * step) ** 2)))
        if rms < best[1]:
            best = (_depth_at(rig, float(high), float(low), share), rms)
    return best


def _depth_at(rig: Rig, high_m: float, low_m: float, share: float) -> float:
    """Depth in m at a share of the thermal resistance between two depths."""
    edges = [high_m, *(edge for edge in _edges(rig) if high_m < edge < low_m), low_m]
    resistance = [rig.skin.resistance_to_m2K_per_W(edge) for edge in edges]
    return float(np.interp(resistance[0] + share * (resistance[-1] - resistance[0]), resistance, edges))


def _edges(rig: Rig) -> list[float]:
    return [float(edge) for edge in np.cumsum([layer.thickness_m for layer in rig.skin.layers])]
