"""A thermistor on skin under a round insulating pad, computed as a field in depth and radius.

Around the pad the skin touches the display, as the rig's own does; under it, the same layers see the display through
the pad. Heat flows sideways in every layer. The display's temperature is given, so that the field is linear and its
modes are exact; no heat flows back into the display.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from thermicon.base.files.records import load_records
from thermicon.base.numbers.arrays import Array, Index
from thermicon.base.numbers.cores import quiet_blas
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.skin import SkinColumn, column_of
from thermicon.circuit.solver.modes import SkinModes
from thermicon.circuit.solver.probes import reading_of
from thermicon.circuit.solver.trace import Trace

DEPTH_MESH = 8e-5, 0.25
"""First cell in m and growth of the mesh in depth, coarser than the rig's own: pad and distance smooth every onset."""

RIM_CELLS, GROWTH = 8, 1.45
"""Cells under the pad, finest at its rim, each larger than its neighbour by this factor; so they go on outside."""

LEAST_REACH_M, REACH = 4e-3, 3.0
"""The field ends this far outside the rim, or this many radii of the pad: within 1 % of one of twice that size."""

SMALL = 1e-5
"""Modes with less than this share of the reading are taken as settled."""


@dataclass(frozen=True, slots=True)
class Pad:
    """A thermistor under a round pad: distance to skin in contact m, diameter m, depth m, insulation m²·K/W."""

    lateral_m: float
    width_m: float
    depth_m: float
    insulation_m2K_per_W: float

    @staticmethod
    def of(lateral_m: float | None = None, depth_m: float = 0.0) -> Pad:
        """The pad of the records, with the thermistor in its middle, at a distance or the assumed one."""
        records = load_records(Path(__file__).with_name("insulated-probe.toml"))
        lateral = records.one("lateral distance").central * 1e-3 if lateral_m is None else lateral_m
        insulation = records.one("aerogel thickness").central * 1e-3 / records.one("aerogel conductivity").central
        return Pad(lateral, 2 * lateral, depth_m, insulation)

    def reads(self, trace: Trace, rig: Rig) -> Array:
        """What it reads in °C in a trace of the rig, whose rows are 10 ms apart or less."""
        return patch_under(rig, self).at(trace.time_s, trace.display_C)


@lru_cache(maxsize=16)
def patch_under(rig: Rig, pad: Pad) -> SkinModes:
    """Return the modes of what a thermistor under a pad reads, each with weight 1."""
    column, radius = column_of(rig.skin, rig.column.blood_capacity_J_per_m3K, *DEPTH_MESH), 0.5 * pad.width_m
    edges = _edges(radius)
    area, centre = np.pi * np.diff(edges**2), 0.5 * (edges[1:] + edges[:-1])
    lumps, cells = len(column.depth_m), len(centre)
    through = np.where(centre < radius, pad.insulation_m2K_per_W, rig.contact.resistance_m2K_per_W)
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
    weight, direct = _reading(rig, column, pad, centre)
    residue = (weight / root) @ vectors * ((drive / root) @ vectors)
    share = np.abs(residue / rates)
    slow = share > SMALL * share.sum()
    return reading_of(rig.deep_C, rates[slow], residue[slow], direct + float((residue / rates)[~slow].sum()))


def _edges(radius_m: float) -> Array:
    """Radii of the faces between cells, from the middle to the end of the field."""
    sizes = GROWTH ** np.arange(RIM_CELLS)
    rim = radius_m / sizes.sum()
    inside = np.concatenate([[0.0], np.cumsum(rim * sizes[::-1])])
    reach = max(LEAST_REACH_M, REACH * radius_m)
    count = int(np.ceil(np.log1p(reach / rim * (GROWTH - 1.0)) / np.log(GROWTH)))
    outside = np.cumsum(rim * GROWTH ** np.arange(count))
    return np.concatenate([inside[:-1], [radius_m], radius_m + outside])


def _reading(rig: Rig, column: SkinColumn, pad: Pad, centre: Array) -> tuple[Array, float]:
    """Weights in a reading of all cells, and of the display: linear in thermal resistance and in r²."""
    resistance = column.resistance_m2K_per_W.copy()
    resistance[0] += pad.insulation_m2K_per_W
    place = np.concatenate([[0.0], np.cumsum(resistance)])  # of display, lumps, deep node
    at = pad.insulation_m2K_per_W + rig.skin.resistance_to_m2K_per_W(pad.depth_m)
    upper = min(max(int(np.searchsorted(place, at * (1 + 1e-12))) - 1, 0), len(place) - 2)
    low = min((at - place[upper]) / (place[upper + 1] - place[upper]), 1.0)
    depth = np.zeros(len(place))
    depth[upper], depth[upper + 1] = 1.0 - low, low
    squared, wanted = centre**2, max(0.5 * pad.width_m - pad.lateral_m, 0.0) ** 2
    inner = min(max(int(np.searchsorted(squared, wanted)) - 1, 0), len(centre) - 2)
    out = (wanted - squared[inner]) / (squared[inner + 1] - squared[inner])
    radial = np.zeros(len(centre))
    radial[inner], radial[inner + 1] = 1.0 - out, out
    return np.outer(depth[1:-1], radial).ravel(), float(depth[0])


def _conductance_along(rig: Rig, column: SkinColumn) -> Array:
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
