"""Probes: what a thermistor reads while a cue plays. A probe is recorded in addition to the trace's own columns.

`display`: the cold plate, under an insulating layer. `interface`: halfway through the contact resistance. `skin`: the
tissue at a depth, linear in thermal resistance between lumps. `insulated skin`: skin under a round pad, as under a
thermistor below aerogel, as a field in depth and radius. Around the pad it touches the display, as the rig's own skin
does; under it, the same layers see the display through the pad. Heat flows sideways in every layer. The display's
temperature is given, so that the field is linear and its modes are exact; no heat flows back into the display.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from ..arrays import Array, Index
from ..cores import quiet_blas
from ..rig.parts import Probe
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..rig.skin import Column, column_of
from .modes import SkinModes
from .network import COLD, places_of, stacked, temperature_weights

SLOWEST_ROWS_S = 0.01
"""A probe with memory (a lag, or skin of its own) is stepped at least this finely, whatever the rows."""

MOST_VALUES = 200_000_000
"""Values of all probes at most: 1.6 GB while they are computed."""

INSULATED_VALUES = 48
"""A probe on insulated skin takes about as long as this many others: it has some 200 modes."""

DEPTH_MESH = 8e-5, 0.25
"""First cell in m and growth of the mesh in depth, coarser than the rig's own: pad and distance smooth every onset."""

RIM_CELLS, GROWTH = 8, 1.45
"""Cells under the pad, finest at its rim, each larger than its neighbour by this factor; so they go on outside."""

LEAST_REACH_M, REACH = 4e-3, 3.0
"""The field ends this far outside the rim, or this many radii of the pad: within 1 % of one of twice that size."""

SMALL = 1e-5
"""Modes with less than this share of the reading are taken as settled."""


def between(rows_s: Array, rig: Rig) -> int:
    """Number of parts into which the rows of a run are divided, so that no probe with memory steps over 10 ms."""
    if not any(probe.lag_s or probe.place == "insulated skin" for probe in rig.probes):
        return 1
    parts = max(1, math.ceil(float(np.diff(rows_s).max(initial=0.0)) / SLOWEST_ROWS_S - 1e-9))
    insulated = sum(probe.place == "insulated skin" for probe in rig.probes)
    values = len(rows_s) * parts * (len(rig.probes) + INSULATED_VALUES * insulated)
    if values > MOST_VALUES:
        raise RigError(
            f"rig {rig.name}: its probes need {values:.2g} values over {rows_s[-1]:g} s; the limit is "
            f"{MOST_VALUES:.2g}: shorten the run, lower the rate or remove probes"
        )
    return parts


def divided(rows_s: Array, parts: int) -> Array:
    """Times in s with every gap between rows in equal parts; every `parts`-th is a row."""
    if parts == 1:
        return rows_s
    inside = rows_s[:-1, np.newaxis] + np.diff(rows_s)[:, np.newaxis] * (np.arange(parts) / parts)
    return np.append(inside.ravel(), rows_s[-1])


def readings_of(rig: Rig) -> tuple[Index, Array] | None:
    """Return the readings that a run must record for a rig's probes, one each; None where it has none."""
    if not rig.probes:
        return None
    place, contact = places_of(rig), rig.contact.resistance_m2K_per_W
    rows = []
    for probe in rig.probes:
        if probe.place == "interface":
            rows.append(temperature_weights(0.5 * contact, place))
        elif probe.place == "skin":
            rows.append(temperature_weights(contact + rig.skin.resistance_to_m2K_per_W(probe.depth_m), place))
        else:
            rows.append((COLD, (1.0, 0.0, 0.0)))
    return stacked(rows)


def sensed(rig: Rig, time_s: Array, recorded: Array, parts: int) -> tuple[tuple[str, Array], ...]:
    """Return (name, °C) of every probe at every `parts`-th time, from the readings (k, times) of `readings_of`."""
    readings = []
    for probe, read in zip(rig.probes, recorded, strict=True):
        value = np.ascontiguousarray(read)
        if probe.place == "insulated skin":
            value = patch_under(rig, probe).at(time_s, value)
        if probe.lag_s:
            rate = np.array([1.0 / probe.lag_s])
            value = reading_of(0.0, rate, rate, 0.0).at(time_s, value)
        readings.append((probe.name, value[::parts].copy()))
    return tuple(readings)


def reading_of(deep_C: float, rate_per_s: Array, drive_per_s: Array, direct: float) -> SkinModes:
    """Modes whose sum is a reading, with `direct` · u of the display u in K above `deep_C`."""
    ones, none = np.ones((1, len(rate_per_s))), np.empty((0, 0))
    return SkinModes(deep_C, rate_per_s, drive_per_s, ones, np.array([direct]), np.array([deep_C]), none, none)


@lru_cache(maxsize=16)
def patch_under(rig: Rig, probe: Probe) -> SkinModes:
    """Return the modes of what a probe on insulated skin reads, each with weight 1."""
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
