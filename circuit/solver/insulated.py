"""Skin that a pad insulates from the display: a second column beside the first, as under a thermistor below aerogel.

A 1-D substitute for a 3-D field. The second column has the same layers; the display reaches its face through the
pad, and at every depth it is joined to the first column by a conductance k·dz / (L·w) per unit area, where L is the
distance to skin in contact and w the width of the patch. No heat flows back: the patch is assumed small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..rig.parts import Probe
from ..rig.rig import Rig


@dataclass(frozen=True, slots=True)
class LateralColumn:
    """The second column per unit area, face first: `conductance_W_per_m2K` (n + 1,) from the display down to deep.

    `across_W_per_m2K` (n,) joins each lump to its neighbour in the first column; `place_m2K_per_W` (n + 2,) is the
    resistance from the display to itself, to every lump and to the deep node.
    """

    capacity_J_per_m2K: Array
    conductance_W_per_m2K: Array
    perfusion_W_per_m2K: Array
    across_W_per_m2K: Array
    place_m2K_per_W: Array
    deep_C: float

    def steady_C(self, display_C: float, lumps_C: Array) -> Array:
        """Temperatures (n + 2,) in °C of display, lumps and deep node in steady state."""
        g, across, perfused = self.conductance_W_per_m2K, self.across_W_per_m2K, self.perfusion_W_per_m2K
        matrix = np.diag(g[:-1] + g[1:] + across + perfused) - np.diag(g[1:-1], 1) - np.diag(g[1:-1], -1)
        source = across * lumps_C + perfused * self.deep_C
        source[0] += g[0] * display_C
        source[-1] += g[-1] * self.deep_C
        return np.concatenate([[display_C], np.linalg.solve(matrix, source), [self.deep_C]])


def lateral_column(rig: Rig, probe: Probe) -> LateralColumn:
    """Return the second column under a probe on insulated skin."""
    column = rig.column
    resistance = column.resistance_m2K_per_W.copy()
    resistance[0] += probe.insulation_m2K_per_W
    return LateralColumn(
        column.capacity_J_per_m2K,
        1 / resistance,
        column.perfusion_W_per_m2K,
        _conductance_along(rig) / (probe.lateral_m * probe.width_m),
        np.concatenate([[0.0], np.cumsum(resistance)]),
        rig.deep_C,
    )


def _conductance_along(rig: Rig) -> Array:
    """Conductivity times height, k·dz in W/K, of the tissue of each lump."""
    depth, layers = rig.column.depth_m, rig.skin.layers
    if rig.skin.elements is None:
        edges = np.concatenate([[0.0], (depth[:-1] + depth[1:]) / 2, [(depth[-1] + rig.skin.thickness_m) / 2]])
    else:
        heights = [np.full(n, layer.thickness_m / n) for n, layer in zip(rig.skin.elements, layers, strict=True)]
        edges = np.concatenate([[0.0], np.cumsum(np.concatenate(heights))])
    bottom = np.concatenate([[0.0], np.cumsum([layer.thickness_m for layer in layers])])
    so_far = np.concatenate([[0.0], np.cumsum([layer.thickness_m * layer.conductivity_W_per_mK for layer in layers])])
    return np.asarray(np.diff(np.interp(edges, bottom, so_far)), dtype=np.float64)


def insulated_C(rig: Rig, probe: Probe, time_s: Array, display_C: Array, lumps_C: Array) -> Array:
    """Temperature (rows,) in °C in insulated skin, from the display's (rows,) and the first column's lumps' (n, rows).

    Steps from row to row by the trapezoidal rule, from a steady state.
    """
    from . import kernel_probes

    column = lateral_column(rig, probe)
    at = probe.insulation_m2K_per_W + rig.skin.resistance_to_m2K_per_W(probe.depth_m)
    upper = min(max(int(np.searchsorted(column.place_m2K_per_W, at * (1 + 1e-12))) - 1, 0), len(lumps_C))
    low, high = column.place_m2K_per_W[upper : upper + 2]
    out = np.empty(len(time_s))
    kernel_probes.step_lateral_column(
        time_s, display_C, np.ascontiguousarray(lumps_C), column.capacity_J_per_m2K, column.conductance_W_per_m2K,
        column.perfusion_W_per_m2K, column.across_W_per_m2K, column.deep_C,
        column.steady_C(float(display_C[0]), lumps_C[:, 0]), upper, min((at - low) / (high - low), 1.0), out,
    )  # fmt: skip
    return out
