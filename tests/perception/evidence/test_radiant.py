import math

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception.evidence.radiant import radiant_warming

LAYER = {
    "name": "dermis",
    "thickness_mm": 30.0,
    "conductivity_W_per_mK": 0.4,
    "density_kg_per_m3": 1000.0,
    "heat_capacity_J_per_kgK": 3600.0,
    "perfusion_per_s": 0.0,
}


@pytest.fixture(scope="module")
def slab() -> Rig:
    """Uniform skin, thick enough to be endless for seconds, with hardly any loss to the air."""
    return Rig.load("thenar").with_(
        **{
            "skin.layer": [LAYER],
            "ambient.film_W_per_m2K": 1e-3,
            "skin.deep_C": 33.0,
            "skin.depth_from": "surface",
            "skin.warm_receptor_mm": 0.30,
        }
    )


def test_the_surface_warms_as_the_square_root_of_time(slab: Rig) -> None:
    """2q√(t/π)/√(kρc), conduction into a half space; q = 100 W/m²."""
    warmed = radiant_warming(slab, 100.0, 3.0)
    t = np.arange(301) * 0.01
    expected = 2.0 * 100.0 * np.sqrt(t / math.pi) / math.sqrt(0.4 * 1000.0 * 3600.0)
    assert warmed.surface_K[50:] == pytest.approx(expected[50:], rel=0.01)


def test_depth_follows_the_closed_form(slab: Rig) -> None:
    """Temperature 2q√(t/π)/e·e^(−x²/4αt) − (qx/k)·erfc(x/2√(αt)) and flow q·erfc(x/2√(αt)) at x = 0.30 mm, 3 s."""
    warmed, alpha, x, q = radiant_warming(slab, 100.0, 3.0), 0.4 / 3.6e6, 0.3e-3, 100.0
    near = x / (2.0 * math.sqrt(alpha * 3.0))
    effusivity = math.sqrt(0.4 * 3.6e6)
    expected = 2 * q * math.sqrt(3.0 / math.pi) / effusivity * math.exp(-near * near) - q * x / 0.4 * math.erfc(near)
    assert warmed.warm_receptor_K[-1] == pytest.approx(expected, rel=0.01)
    assert warmed.warm_receptor_W_per_m2[-1] == pytest.approx(q * math.erfc(near), rel=0.02)
    assert warmed.surface_K[-1] > warmed.warm_receptor_K[-1]


def test_the_flux_scales_it(slab: Rig) -> None:
    one, ten = radiant_warming(slab, 1.0, 1.0), radiant_warming(slab, 10.0, 1.0)
    assert ten.warm_receptor_K == pytest.approx(10.0 * one.warm_receptor_K, rel=1e-12)


def test_messages(slab: Rig) -> None:
    with pytest.raises(ValueError, match=r"radiant heat for 0.005 s is shorter than a step"):
        radiant_warming(slab, 1.0, 0.005)
    with pytest.raises(ValueError, match=r"rig shani2021 has no lump in the surface: leave out skin.elements"):
        radiant_warming(Rig.load("shani2021"), 1.0, 1.0)
