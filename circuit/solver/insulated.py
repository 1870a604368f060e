"""Skin that a round pad insulates from the display: a field in depth and radius, as under a thermistor below aerogel.

Around the pad the skin touches the display, as the rig's own skin does; under it, the same layers see the display
through the pad. Heat flows sideways in every layer. The display's temperature is given, so that the field is linear and
its modes are exact for a display that is linear between rows; no heat flows back into the display.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from ..arrays import Array, Index
from ..cores import quiet_blas
from ..rig.parts import Probe
from ..rig.rig import Rig
from ..rig.skin import Column, column_of
from .prescribed import step_weights

DEPTH_MESH = 8e-5, 0.25
"""First cell in m and growth of the mesh in depth, coarser than the rig's own: pad and distance smooth every onset."""

RIM_CELLS, GROWTH = 8, 1.45
"""Cells under the pad, finest at its rim, each larger than its neighbour by this factor; so they go on outside."""

LEAST_REACH_M, REACH = 4e-3, 3.0
"""The field ends this far outside the rim, or this many radii of the pad: within 1 % of one of twice that size."""

SMALL = 1e-5
"""Modes with less than this share of the reading are taken as settled."""


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A reading under a pad as modes: `rate_per_s` (m,), `drive_per_s` (m,) of a display of 1 K, all with weight 1.

    The reading is `direct` · u + Σ modes, with the display u in K above the deep node of `deep_C`.
    """

    deep_C: float
    rate_per_s: Array
    drive_per_s: Array
    direct: float

    def run(self, time_s: Array, display_C: Array) -> Array:
        """Reading (rows,) in °C under a display (rows,) linear between rows, from a steady state."""
        from scipy.signal import lfilter

        above, steps = display_C - self.deep_C, np.round(np.diff(time_s), 12)
        modes, value = self.drive_per_s / self.rate_per_s * above[0], np.zeros(len(above))
        value[0] = modes.sum()
        breaks = np.flatnonzero(np.diff(steps)) + 1  # equal steps are filtered together
        for begin, end in pairwise([0, *breaks.tolist(), len(steps)]):
            keep, now, then = step_weights(self.rate_per_s, float(steps[begin]))
            early, late = above[begin:end], above[begin + 1 : end + 1]
            for k in range(len(modes)):
                forcing = self.drive_per_s[k] * (now[k] * early + then[k] * late)
                mode, _ = lfilter([1.0], [1.0, -keep[k]], forcing, zi=[keep[k] * modes[k]])
                value[begin + 1 : end + 1] += mode
                modes[k] = mode[-1]
        return np.asarray(value + self.direct * above + self.deep_C)


def insulated_C(rig: Rig, probe: Probe, time_s: Array, display_C: Array) -> Array:
    """Temperature (rows,) in °C in insulated skin, from the display's (rows,), which was held before at its first."""
    return patch_under(rig, probe).run(time_s, display_C)


@lru_cache(maxsize=16)
def patch_under(rig: Rig, probe: Probe) -> Patch:
    """Return the modes of what a probe on insulated skin reads."""
    column, radius = column_of(rig.skin, rig.column.blood_capacity_J_per_m3K, *DEPTH_MESH), 0.5 * probe.width_m
    edges = _edges(radius)
    area, centre = np.pi * np.diff(edges**2), 0.5 * (edges[1:] + edges[:-1])
    lumps, cells = len(column.depth_m), len(centre)
    through = np.where(centre < radius, probe.insulation_m2K_per_W, rig.contact.resistance_m2K_per_W)
    down = area / (column.resistance_m2K_per_W[0] + through)
    place = np.arange(lumps * cells).reshape(lumps, cells)
    matrix, drive = np.zeros((lumps * cells, lumps * cells)), np.zeros(lumps * cells)

    def join(one: Index, other: Index, conductance: Array) -> None:
        matrix[one, one] += conductance
        matrix[other, other] += conductance
        matrix[one, other] -= conductance
        matrix[other, one] -= conductance

    for i in range(lumps):
        if i < lumps - 1:
            join(place[i], place[i + 1], area / column.resistance_m2K_per_W[i + 1])
        matrix[place[i], place[i]] += column.perfusion_W_per_m2K[i] * area
    along = _conductance_along(rig, column)
    for j in range(cells - 1):
        join(place[:, j], place[:, j + 1], along * 2 * np.pi * edges[j + 1] / (centre[j + 1] - centre[j]))
    matrix[place[-1], place[-1]] += area / column.resistance_m2K_per_W[-1]
    matrix[place[0], place[0]] += down
    drive[place[0]] = down
    root = np.sqrt(np.outer(column.capacity_J_per_m2K, area).ravel())
    with quiet_blas():
        rates, vectors = np.linalg.eigh(matrix / np.outer(root, root))
    weight, direct = _reading(rig, column, probe, centre)
    residue = (weight / root) @ vectors * ((drive / root) @ vectors)
    share = np.abs(residue / rates)
    slow = share > SMALL * share.sum()
    return Patch(rig.deep_C, rates[slow], residue[slow], direct + float((residue / rates)[~slow].sum()))


def _edges(radius_m: float) -> Array:
    """Radii of the faces between cells, from the middle to the end of the field."""
    sizes = GROWTH ** np.arange(RIM_CELLS)
    rim = radius_m / sizes.sum()
    inside = np.concatenate([[0.0], np.cumsum(rim * sizes[::-1])])
    reach = max(LEAST_REACH_M, REACH * radius_m)
    count = int(np.ceil(np.log1p(reach / rim * (GROWTH - 1.0)) / np.log(GROWTH)))
    outside = np.cumsum(rim * GROWTH ** np.arange(count))
    return np.concatenate([inside[:-1], [radius_m], radius_m + outside])


def _reading(rig: Rig, column: Column, probe: Probe, centre: Array) -> tuple[Array, float]:
    """Weights of all cells in the reading of a probe, and of the display: linear in thermal resistance and in r²."""
    resistance = column.resistance_m2K_per_W.copy()
    resistance[0] += probe.insulation_m2K_per_W
    place = np.concatenate([[0.0], np.cumsum(resistance)])  # of display, lumps, deep node
    at = probe.insulation_m2K_per_W + rig.skin.resistance_to_m2K_per_W(probe.depth_m)
    upper = min(max(int(np.searchsorted(place, at * (1 + 1e-12))) - 1, 0), len(place) - 2)
    low = min((at - place[upper]) / (place[upper + 1] - place[upper]), 1.0)
    depth = np.zeros(len(place))
    depth[upper], depth[upper + 1] = 1.0 - low, low
    squared, wanted = centre**2, max(0.5 * probe.width_m - probe.lateral_m, 0.0) ** 2
    inner = min(max(int(np.searchsorted(squared, wanted)) - 1, 0), len(centre) - 2)
    out = (wanted - squared[inner]) / (squared[inner + 1] - squared[inner])
    radial = np.zeros(len(centre))
    radial[inner], radial[inner + 1] = 1.0 - out, out
    return np.outer(depth[1:-1], radial).ravel(), float(depth[0])


def _conductance_along(rig: Rig, column: Column) -> Array:
    """Conductivity times height, k·dz in W/K, of the tissue of each lump."""
    depth, layers = column.depth_m, rig.skin.layers
    if rig.skin.elements is None:
        edges = np.concatenate([[0.0], (depth[:-1] + depth[1:]) / 2, [(depth[-1] + rig.skin.thickness_m) / 2]])
    else:
        heights = [np.full(n, layer.thickness_m / n) for n, layer in zip(rig.skin.elements, layers, strict=True)]
        edges = np.concatenate([[0.0], np.cumsum(np.concatenate(heights))])
    bottom = np.concatenate([[0.0], np.cumsum([layer.thickness_m for layer in layers])])
    so_far = np.concatenate([[0.0], np.cumsum([layer.thickness_m * layer.conductivity_W_per_mK for layer in layers])])
    return np.asarray(np.diff(np.interp(edges, bottom, so_far)), dtype=np.float64)
