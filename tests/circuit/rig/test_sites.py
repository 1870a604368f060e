"""Shipped sites at rest."""

import math

import numpy as np
import pytest

from thermicon.circuit import Rig, simulate
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.skin import Layer, Skin, column_of
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current
from thermicon.icons import load_library

THENAR, SHANI = Rig.load("thenar"), Rig.load("shani2021")
SITES = ("thenar", "fingertip", "forearm", "hand-dorsum")
BLOOD = 1060 * 3770


def coldest_display_C(rig: Rig) -> float:
    """What a display settles at on resting skin with the greatest current held."""
    network = network_of(rig)
    return network.read(state_under_current(network, rig.driver.current_max_A), "display_C")


def _deep_C(layers: tuple[Layer, ...], surface_C: float, loss_W_per_m2: float) -> float:
    """Deep and blood temperature over which a surface rests: a 2 × 2 Pennes matrix for each layer."""
    chain = np.eye(2)
    for layer in layers:
        m = math.sqrt(layer.perfusion_per_s * BLOOD / layer.conductivity_W_per_mK)
        h, k = layer.thickness_m, layer.conductivity_W_per_mK
        step = (
            [[1, h / k], [0, 1]]
            if m == 0
            else [[math.cosh(m * h), math.sinh(m * h) / (k * m)], [k * m * math.sinh(m * h), math.cosh(m * h)]]
        )
        chain = np.array(step) @ chain
    return float(surface_C + chain[0, 1] * loss_W_per_m2 / chain[0, 0])


@pytest.mark.parametrize("name", SITES)
def test_rest_at_every_site_is_the_layered_closed_form(name: str) -> None:
    rig = Rig.load(name)
    assert rig.deep_C == pytest.approx(_deep_C(rig.skin.layers, 32.0, 80.0), abs=2e-3)
    assert rig.resting_flux_W_per_m2 == pytest.approx(-80.0, abs=1e-9)
    assert (rig.site, rig.warnings) == (name, ())
    assert {"hand-dorsum": "back of the hand"}.get(name, name) in rig.title


def test_two_perfused_layers_rest_where_the_closed_form_says() -> None:
    layers = (Layer("dermis", 1.6e-3, 0.45, 1116, 3300, 1.1e-3), Layer("muscle", 15e-3, 0.49, 1090, 3421, 6e-4))
    column = column_of(Skin("forearm", 32.0, 0.15e-3, 0.3e-3, layers), BLOOD)
    assert 32.0 - column.steady_drop_K(-80.0) == pytest.approx(_deep_C(layers, 32.0, 80.0), abs=1e-3)


def test_a_limb_that_is_colder_than_the_skin_over_it_is_no_error() -> None:
    assert "taken up by bare skin" in THENAR.with_(**{"skin.deep_C": 30.0}).about()


@pytest.mark.parametrize("name", [*SITES, "from the base"])
def test_receptors_are_nodes_of_the_mesh(name: str) -> None:
    rig = THENAR.with_(**{"skin.depth_from": "stratum corneum"}) if name == "from the base" else Rig.load(name)
    network = network_of(rig)
    for depth, probe in ((rig.skin.cold_receptor_m, 3), (rig.skin.warm_receptor_m, 4)):
        assert np.abs(rig.column.depth_m - depth).min() < 1e-12
        assert sorted(network.probe_weight[probe]) == [0.0, 0.0, 1.0]


def test_receptor_depths_in_both_conventions() -> None:
    below, base = "cold 0.27 mm, warm 0.38 mm below the surface", "the base of the stratum corneum"
    assert THENAR.skin.receptor_words() == f"{below}; cold 0.1 mm below, warm 0.21 mm below {base}"
    surface = THENAR.with_(**{"skin.depth_from": "surface"}).skin.receptor_words()
    assert surface == f"cold 0.1 mm, warm 0.21 mm below the surface; cold 0.07 mm above, warm 0.04 mm below {base}"
    assert THENAR.skin.cold_receptor_m == pytest.approx(0.27e-3)
    assert SHANI.skin.receptor_words() == "cold 0.15 mm, warm 0.3 mm below the surface"


def test_what_shani2021_says_of_itself_is_so() -> None:
    said = " ".join(SHANI.notes)
    cue = load_library("cooling-step-skin")["cooling-step"]
    slab = 0.081e-3 / 0.24 + 2e-3 / 0.45
    low, high = ((37 / slab + film * 24) / (1 / slab + film) for film in (12, 8))
    hot, hotter = (
        network_of(rig).read(state_under_current(network_of(rig), -0.5), "skin_C") for rig in (SHANI, THENAR)
    )
    cools = simulate(cue, SHANI.with_(**{"driver.current_min_A": 0})).outcome
    both = simulate(cue, SHANI).outcome
    enough_A = next(
        limit
        for limit in np.arange(1.0, 3.0, 0.05).round(2)
        if simulate(
            cue, SHANI.with_(**{"driver.current_limit_A": limit, "driver.voltage_limit_V": 1000.0}), rate_Hz=10
        ).reachable
    )
    assert cools is not None and both is not None
    for words in (
        f"lets {-SHANI.resting_flux_W_per_m2:.0f} W/m² flow",
        f"(film 12 to 8 W/m²K) it would rest at {low:.1f} to {high:.1f} °C",
        f"misses by about {abs(cools.largest_miss_K):.0f} K",
        f"-0.5 A held brings the skin to {hot:.0f} °C here and to {hotter:.0f} °C on the thenar rig",
        f"at 1 A it is missed by {abs(both.largest_miss_K):.2f} K on the skin",
        f"takes ±{enough_A:g} A here",
        f"this display settles at {coldest_display_C(SHANI):.1f} °C on resting skin",
        f"At 1.5 A it would settle at {coldest_display_C(SHANI.with_(**{'driver.current_limit_A': 1.5})):.1f} °C",
    ):
        assert words in said


@pytest.mark.parametrize("name", rig_names())
def test_a_rig_tells_about_itself_in_plain_text(name: str) -> None:
    rig = Rig.load(name)
    lines = rig.about().splitlines()
    assert lines[0] == f"{name}: {rig.title}"
    assert all(len(line) <= 118 for line in lines)
    told = " ".join(rig.about().split())
    words = [f"site {rig.site}", f"{rig.deep_C:.2f} °C", rig.skin.receptor_words()]
    words.append(rig.module_source if rig.thermode is None else "0.1 … 60 °C at up to 300 K/s")
    for text in (*words, *(f"warning {text}" for text in rig.warnings), *(f"note {text}" for text in rig.notes)):
        assert text in told
    assert "\n" not in repr(rig)
