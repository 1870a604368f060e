"""Bare skin under radiant heat, for published thresholds in W/m² that no display was used for.

The skin is the column of a rig without its display, still air above it; the flux is absorbed at
the surface, from t = 0 on. Changes from rest are stepped exactly for a flux that is constant.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array

if TYPE_CHECKING:
    from thermicon.circuit import Rig


@dataclass(frozen=True, slots=True)
class Warming:
    """Changes (rows,) in K at the surface and at both receptors, and heat flow at the warm one (W/m²)."""

    dt_s: float
    surface_K: Array
    cold_receptor_K: Array
    warm_receptor_K: Array
    warm_receptor_W_per_m2: Array


def radiant_warming(rig: Rig, flux_W_per_m2: float, duration_s: float, *, rate_Hz: float = 100.0) -> Warming:
    """Warming of a rig's bare skin by a flux absorbed at its surface for `duration_s`.

    >>> from thermicon.circuit import Rig
    >>> warmed = radiant_warming(Rig.load("forearm"), 100.0, 3.0)
    >>> bool(0.1 < warmed.surface_K[-1] < 0.2)
    True
    """
    from scipy.linalg import expm

    if not duration_s > 1.0 / rate_Hz:
        raise ValueError(f"radiant heat for {duration_s:g} s is shorter than a step")
    column, film = rig.column, rig.ambient.film_W_per_m2K
    if column.resistance_m2K_per_W[0] > 0.0:
        raise ValueError(f"rig {rig.name} has no lump in the surface: leave out skin.elements for radiant heat")
    link = 1.0 / column.resistance_m2K_per_W[1:]
    lumps = column.capacity_J_per_m2K.size
    leak = column.perfusion_W_per_m2K + link
    leak[1:] += link[:-1]
    leak[0] += film
    matrix = np.diag(-leak) + np.diag(link[:-1], 1) + np.diag(link[:-1], -1)
    rate = matrix / column.capacity_J_per_m2K[:, None]
    source = np.zeros(lumps)
    source[0] = flux_W_per_m2 / column.capacity_J_per_m2K[0]
    joint = np.zeros((lumps + 1, lumps + 1))
    joint[:lumps, :lumps], joint[:lumps, lumps] = rate, source
    step = expm(joint / rate_Hz)
    state = np.zeros((round(duration_s * rate_Hz) + 1, lumps + 1))
    state[:, lumps] = 1.0
    for k in range(1, state.shape[0]):
        state[k] = step @ state[k - 1]
    change = np.concatenate([state[:, :lumps], np.zeros((state.shape[0], 1))], axis=1)
    place = np.concatenate([[0.0], np.cumsum(column.resistance_m2K_per_W[1:])])
    at = [rig.skin.resistance_to_m2K_per_W(d) for d in (rig.skin.cold_receptor_m, rig.skin.warm_receptor_m)]
    temperature = [_at(change, place, here) for here in at]
    flow = _flow(change, place, at[1])
    return Warming(1.0 / rate_Hz, change[:, 0].copy(), temperature[0], temperature[1], flow)


def _at(change: Array, place: Array, here: float) -> Array:
    """Temperature change at a thermal resistance below the surface, linear between lumps."""
    k = min(int(np.searchsorted(place, here, side="right")) - 1, place.size - 2)
    share = (here - place[k]) / (place[k + 1] - place[k])
    found: Array = (1.0 - share) * change[:, k] + share * change[:, k + 1]
    return found


def _flow(change: Array, place: Array, here: float) -> Array:
    """Heat flow into the skin there: the mean of both faces of a lump, else that of the face between lumps."""
    faces = (change[:, :-1] - change[:, 1:]) / np.diff(place)
    k = min(int(np.searchsorted(place, here + 1e-12, side="right")) - 1, place.size - 2)
    if k > 0 and abs(place[k] - here) < 1e-9:
        mean: Array = 0.5 * (faces[:, k - 1] + faces[:, k])
        return mean
    face: Array = faces[:, k]
    return face
