"""Skin under a thermode whose surface is prescribed: the exact response at any depth, as a sum of modes.

With lumps of capacity C and conductances K (perfusion included), C·dT/dt = −K·T + g·T_display has the
solution T(t) = Σ w_m·(1 − e^(−λ_m·t)) for a unit step of the display, where λ and the orthogonal modes come
from the symmetric matrix C^(−1/2)·K·C^(−1/2). Ramps are the integral of steps and holds are sums of ramps, so
that a stimulus with corners costs one look-up a corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from thermicon.circuit import Rig
from thermicon.circuit.rig.skin import STRATUM_CORNEUM, Skin, column_of

from ..arrays import Array
from ..observer.variants import Variable

Corner = tuple[float, float]
"""A corner of a stimulus: time in s and change of the display from the baseline in K."""


@dataclass(frozen=True, slots=True)
class SkinModes:
    """The skin of one site under one thermode: arrays read-only, n lumps and as many modes.

    `resistance_m2K_per_W` (n − 1,) is the thermal resistance between neighbouring lumps, `steady` (n,) the steady
    response of each lump to a unit change of the display, `rate_per_s` (n,) and `weight` (n lumps, n modes) the modes.
    """

    site: str
    contact_m2K_per_W: float
    corneum_m: float
    deep_C: float
    depth_m: Array
    resistance_m2K_per_W: Array
    steady: Array
    rate_per_s: Array
    weight: Array

    def at(self, depth_m: float, variable: Variable = "temperature") -> tuple[float, Array]:
        """Steady response and mode weights (n,) at a depth below the face in m.

        Temperature is linear between lumps; heat flow, W/m² into the skin, between the middles of cells.
        """
        depths, steady, weight = self.depth_m, self.steady, self.weight
        if variable == "heat flow":
            depths = 0.5 * (depths[:-1] + depths[1:])
            steady = -np.diff(steady) / self.resistance_m2K_per_W
            weight = -np.diff(weight, axis=0) / self.resistance_m2K_per_W[:, None]
        k = int(np.clip(np.searchsorted(depths, depth_m) - 1, 0, depths.size - 2))
        share = (depth_m - depths[k]) / (depths[k + 1] - depths[k])
        modes: Array = (1.0 - share) * weight[k] + share * weight[k + 1]
        return float((1.0 - share) * steady[k] + share * steady[k + 1]), modes

    def baseline(self, display_C: float, depth_m: float, variable: Variable = "temperature") -> float:
        """Steady temperature in °C, or heat flow in W/m², at a depth while the display rests at `display_C`."""
        change = self.at(depth_m, variable)[0] * (display_C - self.deep_C)
        return self.deep_C + change if variable == "temperature" else change

    def ramp_response(self, depth_m: float, time_s: Array, variable: Variable = "temperature") -> Array:
        """Change in K or W/m² at a depth, shape of `time_s`, for a display that rises by 1 K/s from time 0 on."""
        steady, weight = self.at(depth_m, variable)
        after = np.maximum(time_s, 0.0)
        decayed = -np.expm1(-self.rate_per_s[:, None] * after[None, :]) / self.rate_per_s[:, None]
        response: Array = steady * after - weight @ decayed
        return response

    def course(
        self,
        depth_m: float,
        baseline_C: float,
        corners: Sequence[Corner],
        dt_s: float,
        rows: int,
        variable: Variable = "temperature",
    ) -> Array:
        """What a receptor at a depth goes by, (rows,) in °C or W/m², while the display goes from corner to corner.

        >>> skin_modes("forearm", 2.5e-4).course(0.15e-3, 32.0, [(1.0, -5.0)], 1.0, 3).round(2)
        array([32.06, 30.4 , 29.18])
        """
        time: Array = dt_s * np.arange(rows, dtype=np.float64)
        unit = self.ramp_response(depth_m, time, variable)
        course = np.full(rows, self.baseline(baseline_C, depth_m, variable))
        slope, start = 0.0, (0.0, 0.0)
        for corner in (*corners, None):
            rate = 0.0 if corner is None else (corner[1] - start[1]) / (corner[0] - start[0])
            if rate != slope:
                course += (rate - slope) * np.interp(time - start[0], time, unit, left=0.0)
            if corner is not None:
                slope, start = rate, corner
        return course


def skin_modes(site_rig: str, contact_m2K_per_W: float, effusivity: float = 1.0, corneum: float = 1.0) -> SkinModes:
    """Modes of a shipped rig's skin; `effusivity` multiplies that of living tissue, `corneum` the outermost layer.

    Effusivity √(k·ρ·c) is raised with conductivity and heat capacity alike, so that diffusivity stays.

    >>> modes = skin_modes("forearm", 2.5e-4)
    >>> round(float(modes.ramp_response(0.15e-3, np.array([0.0, 1.0]))[1]), 2)
    0.33
    """
    rig = _rig(site_rig)
    skin = _scaled(rig.skin, effusivity, corneum)
    column = column_of(skin, rig.column.blood_capacity_J_per_m3K)
    between = column.resistance_m2K_per_W.copy()
    between[0] += contact_m2K_per_W
    conductance = 1.0 / between
    # Perfusion and the deep node pull every lump towards the same temperature, so that they enter as one.
    matrix = np.diag(conductance[:-1] + conductance[1:] + column.perfusion_W_per_m2K)
    matrix -= np.diag(conductance[1:-1], 1) + np.diag(conductance[1:-1], -1)
    root = np.sqrt(column.capacity_J_per_m2K)
    rate, mode = np.linalg.eigh(matrix / np.outer(root, root))
    drive = mode[0] * conductance[0] / root[0] / rate
    weight = mode * drive[None, :] / root[:, None]
    return SkinModes(
        rig.site,
        contact_m2K_per_W,
        skin.layers[0].thickness_m if skin.layers[0].name == STRATUM_CORNEUM else 0.0,
        rig.deep_C,
        column.depth_m,
        between[1:-1],
        weight.sum(axis=1),
        rate,
        weight,
    )


def _scaled(skin: Skin, effusivity: float, corneum: float) -> Skin:
    layers = [
        replace(layer, thickness_m=corneum * layer.thickness_m)
        if layer.name == STRATUM_CORNEUM
        else replace(
            layer,
            conductivity_W_per_mK=effusivity * layer.conductivity_W_per_mK,
            heat_capacity_J_per_kgK=effusivity * layer.heat_capacity_J_per_kgK,
        )
        for layer in skin.layers
    ]
    return replace(skin, layers=tuple(layers))


@lru_cache(maxsize=16)
def _rig(name: str) -> Rig:
    return Rig.load(name)
