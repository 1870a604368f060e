"""Whole-body warmth: bare skin under radiant heat.

The skin is the column of a rig without its display; the flux is absorbed at the surface, from t = 0 on.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig
from thermicon.circuit.solver.modes import thermode_modes

from ..identification.skin_alone import noticed_K
from ..observer.channels import Variable
from ..observer.observer import Observer, load_thresholds
from .predicted import DRAWS, Predicted, Query, predict

RADIANT_S, DT_S = 3.0, 0.01


@dataclass(frozen=True, slots=True)
class Warming:
    """Changes (rows,) every DT_S for a flux of 1 W/m²: K at the surface and at the warm receptor, W/m² there."""

    surface_K: Array
    warm_receptor_K: Array
    warm_receptor_W_per_m2: Array


def radiant_warming(rig: Rig, depth_m: float) -> Warming:
    """Warming of a rig's bare skin, at `depth_m` too, by 1 W/m² that is absorbed at its surface for RADIANT_S.

    To the skin it is a display behind the film of air that became warmer by one over the film's conductance.
    """
    behind = 1.0 / rig.ambient.film_W_per_m2K
    skin = thermode_modes(rig, (0.0, depth_m), behind)
    times_s: Array = DT_S * np.arange(round(RADIANT_S / DT_S) + 1, dtype=np.float64)
    change = skin.relax(times_s, skin.deep_C + behind, skin.steady(skin.deep_C)) - skin.offset_C[:, np.newaxis]
    surface_K, receptor_K, _, receptor_W_per_m2 = change
    return Warming(surface_K, receptor_K, receptor_W_per_m2)


def whole_body_warmth(
    variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0
) -> tuple[Predicted, ...]:
    """Radiant flux (W/m²) on the whole body for 3 s that is just felt as warm (d′ = 1), as Hardy & Oppel 1937 had it.

    The forearm stands for the body; with spatial summation carried on far beyond measured areas, and without any. The
    rise of the surface is given beside, to set the published 6.3 W/m² against 0.003 °C.
    """
    rig, warmed = _forearm(Observer.load(variable=variable))
    body = load_thresholds().one("area of the body").central
    factor = 1.0 / Observer.load(variable=variable).sensitivity("warm", None, rig.site)
    said = (
        f"{RADIANT_S:g} s of radiant heat on bare skin of the forearm, absorbed at the surface, d′ = 1, "
        f"thresholds {factor:.3g} times those of the thenar"
    )
    whole = f"{said}, summed over {body:g} m²"
    skin = noticed_K("warm") / float(warmed.surface_K[-1])
    asked = [
        Query("flux just felt, full summation", "warm", "W/m²", whole, partial(_flux_felt, body), skin),
        Query("flux just felt, no summation", "warm", "W/m²", said, partial(_flux_felt, None), skin),
        Query("rise of the surface per W/m²", "warm", "K m²/W", said, lambda _: float(warmed.surface_K[-1])),
    ]
    return predict("whole-body warmth", asked, variable, draws, seed)


def _flux_felt(area_m2: float | None, observer: Observer) -> float:
    """Flux whose largest warm sensation is 1, by bisection of its logarithm."""
    rig, warmed = _forearm(observer)
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


def _forearm(observer: Observer) -> tuple[Rig, Warming]:
    rig = Rig.load("forearm")
    return rig, radiant_warming(rig, observer.depths_m(rig.skin.corneum_m).warm)
