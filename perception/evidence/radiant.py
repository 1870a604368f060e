"""Whole-body warmth: bare skin under radiant heat, for published thresholds in W/m² that no display was used for.

The skin is the column of a rig without its display, still air above it; the flux is absorbed at
the surface, from t = 0 on. Changes from rest are stepped exactly for a flux that is constant.
"""

from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from thermicon.circuit import Rig

from ..arrays import Array
from ..observer.channels import Variable
from ..observer.observer import Observer, load_thresholds
from .baseline import noticed_K
from .predicted import DRAWS, Asked, Predicted, predict

RADIANT_S, DT_S = 3.0, 0.01


@dataclass(frozen=True, slots=True)
class Warming:
    """Changes (rows,) every DT_S for a flux of 1 W/m²: K at the surface and at the warm receptor, W/m² there."""

    surface_K: Array
    warm_receptor_K: Array
    warm_receptor_W_per_m2: Array


def radiant_warming(rig: Rig) -> Warming:
    """Warming of a rig's bare skin by 1 W/m² that is absorbed at its surface for RADIANT_S; it rises with the flux.

    A ValueError names a rig whose column has no lump in the surface.
    """
    from scipy.linalg import expm

    column = rig.column
    if column.resistance_m2K_per_W[0] > 0.0:
        raise ValueError(f"rig {rig.name} has no lump in the surface: leave out skin.elements for radiant heat")
    link = 1.0 / column.resistance_m2K_per_W[1:]
    lumps = column.capacity_J_per_m2K.size
    leak = column.perfusion_W_per_m2K + link
    leak[1:] += link[:-1]
    leak[0] += rig.ambient.film_W_per_m2K
    matrix = np.diag(-leak) + np.diag(link[:-1], 1) + np.diag(link[:-1], -1)
    # The flux is a state that stays 1.
    joint = np.zeros((lumps + 1, lumps + 1))
    joint[:lumps, :lumps] = matrix / column.capacity_J_per_m2K[:, None]
    joint[0, lumps] = 1.0 / column.capacity_J_per_m2K[0]
    step = expm(joint * DT_S)
    state = np.zeros((round(RADIANT_S / DT_S) + 1, lumps + 1))
    state[:, lumps] = 1.0
    for k in range(1, state.shape[0]):
        state[k] = step @ state[k - 1]
    change = np.concatenate([state[:, :lumps], np.zeros((state.shape[0], 1))], axis=1)
    place = np.concatenate([[0.0], np.cumsum(column.resistance_m2K_per_W[1:])])
    receptor = rig.skin.resistance_to_m2K_per_W(rig.skin.warm_receptor_m)
    return Warming(change[:, 0].copy(), _at(change, place, receptor), _flow(change, place, receptor))


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
    on_a_lump = k > 0 and abs(place[k] - here) < 1e-9
    flow: Array = faces[:, k - 1 : k + 1].mean(axis=1) if on_a_lump else faces[:, k]
    return flow


def whole_body_warmth(
    variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0
) -> tuple[Predicted, ...]:
    """Radiant flux (W/m²) on the whole body for 3 s that is just felt as warm (d′ = 1), as Hardy & Oppel 1937 had it.

    Skin and site are the forearm's, to stand for the body. Twice: with spatial summation carried on from
    a thermode to the whole body, far beyond the areas it was measured on, and without any. The rise of the
    surface that goes with a flux is given beside, to set the published 6.3 W/m² against 0.003 °C.
    """
    rig, warmed = _forearm()
    body = load_thresholds().one("area of the body").central
    factor = 1.0 / Observer.load(variable=variable).sensitivity("warm", None, rig.site)
    said = (
        f"{RADIANT_S:g} s of radiant heat on bare skin of the forearm, absorbed at the surface, d′ = 1, "
        f"thresholds {factor:.3g} times those of the thenar"
    )
    whole = f"{said}, summed over {body:g} m²"
    skin = noticed_K("warm") / float(warmed.surface_K[-1])
    asked = [
        Asked("flux just felt, full summation", "warm", "W/m²", whole, partial(_flux_felt, body), skin),
        Asked("flux just felt, no summation", "warm", "W/m²", said, partial(_flux_felt, None), skin),
        Asked("rise of the surface per W/m²", "warm", "K m²/W", said, lambda _: float(warmed.surface_K[-1])),
    ]
    return predict("whole-body warmth", asked, variable, draws, seed)


def _flux_felt(area_m2: float | None, observer: Observer) -> float:
    """Flux whose largest warm sensation is 1, by bisection of its logarithm."""
    rig, warmed = _forearm()
    rest, change = rig.skin.rest_C, warmed.warm_receptor_K
    if observer.variable == "heat flow":
        rest, change = rig.resting_flux_W_per_m2, warmed.warm_receptor_W_per_m2
    low, high = 1e-4, 1e6
    for _ in range(60):
        middle = float(np.sqrt(low * high))
        drive = observer.drive(rest + middle * change, DT_S, "warm")
        felt = observer.sensation(drive, "warm", area_m2=area_m2, site=rig.site).max() >= 1.0
        low, high = (low, middle) if felt else (middle, high)
    return float(np.sqrt(low * high))


@lru_cache(maxsize=1)
def _forearm() -> tuple[Rig, Warming]:
    rig = Rig.load("forearm")
    return rig, radiant_warming(rig)
