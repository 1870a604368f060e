"""Skin under a thermode whose surface is prescribed: the exact response at any depth, as a sum of modes.

With lumps of capacity C and conductances K (perfusion included), C·dT/dt = −K·T + g·T_display has the
solution T(t) = Σ w_m·(1 − e^(−λ_m·t)) for a unit step of the display, where λ and the orthogonal modes come
from the symmetric matrix C^(−1/2)·K·C^(−1/2). Ramps are the integral of steps and holds are sums of ramps, so
that a stimulus with corners costs one look-up a corner.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from thermicon.circuit import Rig
from thermicon.circuit.rig.skin import STRATUM_CORNEUM, Skin, column_of

from ..arrays import Array
from ..observer.channels import Variable

Corner = tuple[float, float]
"""A corner of a stimulus: time in s and change of the display from the baseline in K."""


@dataclass(frozen=True, slots=True)
class SkinModes:
    """The skin of one site under one thermode: arrays read-only, n lumps and as many modes.

    `resistance_m2K_per_W` (n − 1,) is the thermal resistance between neighbouring lumps, `steady` (n,) the steady
    response of each lump to a unit change of the display, `rate_per_s` (n,) and `weight` (n lumps, n modes) the modes.
    """

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
        return self.resting(display_C, self.at(depth_m, variable)[0], variable)

    def resting(self, display_C: float, steady: float, variable: Variable = "temperature") -> float:
        """The same where the steady response at the depth is known."""
        change = steady * (display_C - self.deep_C)
        return self.deep_C + change if variable == "temperature" else change

    def ramp_response(self, depth_m: float, dt_s: float, rows: int, variable: Variable = "temperature") -> Array:
        """Change (rows,) in K or W/m² at a depth every `dt_s` s, for a display that rises by 1 K/s from time 0 on.

        >>> skin_modes("forearm", 2.5e-4).ramp_response(0.15e-3, 0.5, 3).round(2)
        array([0.  , 0.11, 0.33])
        """
        from ..kernels import kernels

        steady, weight = self.at(depth_m, variable)
        response = np.empty(rows)
        kernels.ramp_response(steady, weight, self.rate_per_s, dt_s, response)
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
        unit = self.ramp_response(depth_m, dt_s, rows, variable)
        return course_of(unit, self.baseline(baseline_C, depth_m, variable), corners, dt_s, rows)


def course_of(ramp_response: Array, baseline: float, corners: Sequence[Corner], dt_s: float, rows: int) -> Array:
    """A course (rows,) from a baseline by corners of the display, for skin with a `ramp_response` of `rows` or more.

    It is a sum of ramps, one from every corner on, by how much the slope changes there.
    """
    course, row, known = np.full(rows, baseline), np.arange(rows), np.arange(ramp_response.size)
    slope, start = 0.0, (0.0, 0.0)
    for corner in (*corners, None):
        rate = 0.0 if corner is None else (corner[1] - start[1]) / (corner[0] - start[0])
        if rate != slope:
            course += (rate - slope) * np.interp(row - start[0] / dt_s, known, ramp_response)
        if corner is not None:
            slope, start = rate, corner
    return course


@lru_cache(maxsize=64)
def skin_modes(site_rig: str, contact_m2K_per_W: float, effusivity: float = 1.0) -> SkinModes:
    """Modes of a shipped rig's skin; `effusivity` multiplies that of living tissue.

    Effusivity √(k·ρ·c) is raised with conductivity and heat capacity alike, so that diffusivity stays.

    >>> round(skin_modes("forearm", 2.5e-4).at(0.15e-3)[0], 3)
    0.975
    """
    from scipy.linalg import eigh_tridiagonal

    rig = _rig(site_rig)
    column = column_of(_with_living(rig.skin, effusivity), rig.column.blood_capacity_J_per_m3K)
    between = column.resistance_m2K_per_W.copy()
    between[0] += contact_m2K_per_W
    conductance, root = 1.0 / between, np.sqrt(column.capacity_J_per_m2K)
    # Perfusion and the deep node pull every lump towards the same temperature, so that they enter as one.
    diagonal = (conductance[:-1] + conductance[1:] + column.perfusion_W_per_m2K) / root**2
    rate, mode = eigh_tridiagonal(diagonal, -conductance[1:-1] / (root[1:] * root[:-1]), check_finite=False)
    weight = mode * (mode[0] * conductance[0] / root[0] / rate)[None, :] / root[:, None]
    outermost = rig.skin.layers[0]
    return SkinModes(
        outermost.thickness_m if outermost.name == STRATUM_CORNEUM else 0.0,
        rig.deep_C,
        column.depth_m,
        between[1:-1],
        weight.sum(axis=1),
        np.asarray(rate, dtype=np.float64),
        weight,
    )


@lru_cache(maxsize=16)
def _rig(name: str) -> Rig:
    return Rig.load(name)


def _with_living(skin: Skin, effusivity: float) -> Skin:
    """Skin whose living layers have so many times their effusivity."""
    layers = [
        layer
        if layer.name == STRATUM_CORNEUM
        else replace(
            layer,
            conductivity_W_per_mK=effusivity * layer.conductivity_W_per_mK,
            heat_capacity_J_per_kgK=effusivity * layer.heat_capacity_J_per_kgK,
        )
        for layer in skin.layers
    ]
    return replace(skin, layers=tuple(layers))
