"""Temperature at any depth while a cue plays, with the depth that a probe resembles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit.rig.parts import Probe
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.solver.drive import Drive
from thermicon.circuit.solver.simulate import simulate, simulate_current
from thermicon.circuit.solver.trace import Trace
from thermicon.icons import Icon

from .insulated import Pad


def probe_depths(
    cue: Icon | Drive, rig: Rig, depths_m: Sequence[float] | Array, *, tail_s: float = 0.0
) -> tuple[Array, Trace]:
    """Temperature in °C (depths, rows) at depths in m while a cue or a drive plays, and the trace of the run.

    Between lumps it is linear in resistance.
    """
    depths = np.array(depths_m, dtype=np.float64)
    own = tuple(Probe(f"depth-{k}", "skin", float(depth), 0.0) for k, depth in enumerate(depths))
    count, probed = len(rig.probes), replace(rig, probes=(*rig.probes, *own))
    if isinstance(cue, Icon):
        trace = simulate(cue, probed, rate_Hz=100.0, tail_s=tail_s)
    else:
        trace = simulate_current(cue, probed, rate_Hz=100.0)
    values = np.array([value for _, value in trace.probes[count:]])
    return values, replace(trace, probes=trace.probes[:count])


@dataclass(frozen=True, slots=True)
class Likeness:
    """The depth in m of skin in contact whose change a thermistor resembles most, and the rms residual in K."""

    depth_m: float
    residual_K: float


def resembles(cue: Icon | Drive, rig: Rig, pad: Pad, *, tail_s: float = 0.0) -> Likeness:
    """Return the depth in the skin under the display whose changes a thermistor on insulated skin resembles most."""
    depth = np.concatenate([[0.0], rig.column.depth_m, [rig.skin.thickness_m]])
    at_C, trace = probe_depths(cue, rig, depth, tail_s=tail_s)
    read = pad.reads(trace, rig)
    change_K, wanted_K = at_C - at_C[:, :1], read - read[0]
    layers, best = np.cumsum([layer.thickness_m for layer in rig.skin.layers]), Likeness(0.0, np.inf)
    for k in range(len(depth) - 1):
        if depth[k + 1] - depth[k] < 1e-9:
            continue
        step = change_K[k + 1] - change_K[k]
        square = float(step @ step)  # between two lumps the best share has a closed form
        share = 0.0 if square == 0 else min(max(float((wanted_K - change_K[k]) @ step) / square, 0.0), 1.0)
        rms = float(np.sqrt(np.mean((wanted_K - change_K[k] - share * step) ** 2)))
        if rms < best.residual_K:
            # The depth at this share of the thermal resistance between the two.
            edges = [depth[k], *(edge for edge in layers if depth[k] < edge < depth[k + 1]), depth[k + 1]]
            resistance = [rig.skin.resistance_to_m2K_per_W(float(edge)) for edge in edges]
            at = resistance[0] + share * (resistance[-1] - resistance[0])
            best = Likeness(float(np.interp(at, resistance, edges)), rms)
    return best
