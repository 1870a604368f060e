"""Corners of a rig beyond the values of its file."""

import json

import pytest

from tests.builders import messages
from thermicon.circuit import Rig
from thermicon.circuit.rig.corner import perturbed, with_gain
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.safety.corners import contact_corners, corners_of
from thermicon.circuit.solver.network import network_of, skin_network_of
from thermicon.circuit.solver.steady import state_under_current

THENAR = Rig.load("thenar")


@pytest.mark.parametrize("name", rig_names())
def test_inside_the_bounds_of_a_file_a_corner_is_what_with_gives(name: str) -> None:
    rig = Rig.load(name)
    corners = corners_of(rig) if rig.thermode is None else contact_corners(rig)
    assert len(corners) == (65 if rig.thermode is None else 5)
    for corner in (corners[1], corners[-1]):
        changes = {
            "contact.resistance_m2K_per_W": rig.contact.resistance_m2K_per_W * (1 + corner.contact_resistance_relative),
            "ambient.temperature_C": rig.ambient.temperature_C + corner.ambient_K,
        }
        if rig.thermode is None:
            module = rig.module
            changes |= {
                "heat_sink.temperature_C": rig.heat_sink.temperature_C + corner.heat_sink_K,
                "module.seebeck_V_per_K": module.seebeck_V_per_K * (1 + corner.seebeck_relative),
                "module.thermal_resistance_K_per_W": module.thermal_resistance_K_per_W
                / (1 + corner.conductance_relative),
                "module.hot_plate_J_per_K": module.hot_plate_J_per_K * (1 + corner.plates_relative),
                "module.cold_plate_J_per_K": module.cold_plate_J_per_K * (1 + corner.plates_relative),
            }
        network = skin_network_of if rig.thermode is not None else network_of
        ours, theirs = network(corner.rig), network(rig.with_(**changes))
        for field in ("capacity_J_per_K", "conductance_W_per_K", "perfusion_W_per_K", "plates", "deep_C"):
            assert getattr(ours, field) == pytest.approx(getattr(theirs, field), rel=1e-12, nan_ok=True)


def test_a_corner_is_another_rig_and_nothing_perturbed_the_rig_itself() -> None:
    assert perturbed(THENAR) is with_gain(THENAR, 0.0) is THENAR
    assert perturbed(THENAR, seebeck_relative=0.1) != THENAR  # caches are keyed by the rig
    # without a current the display moves with the heat sink by the share of the skin's path to it
    rest, warm = (state_under_current(network_of(rig), 0.0) for rig in (THENAR, perturbed(THENAR, heat_sink_K=2.0)))
    assert 0 < (warm - rest).max() <= 2.0


def test_a_source_of_another_gain_saturates_at_other_currents() -> None:
    driver = with_gain(THENAR, 0.1).driver
    assert (driver.current_min_A, driver.current_max_A) == pytest.approx((-1.65, 1.65))
    assert driver.transconductance_A_per_V == THENAR.driver.transconductance_A_per_V


def test_a_corner_may_lie_beyond_what_a_file_may_say() -> None:
    thin = THENAR.with_(**{"contact.resistance_m2K_per_W": 1.2e-6})
    with pytest.raises(RigError, match="must be at least 1e-06"):
        thin.with_(**{"contact.resistance_m2K_per_W": 1.2e-6 * 0.7})
    assert perturbed(thin, contact_resistance_relative=-0.3).contact.resistance_m2K_per_W == 1.2e-6 * 0.7
    cold = THENAR.with_(**{"ambient.temperature_C": -19.0})
    assert perturbed(cold, ambient_K=-3.0).ambient.temperature_C == -22.0


def test_a_module_given_by_name_is_perturbed_too() -> None:
    named = THENAR.with_(**{"module.name": "TEC1-12706"})
    there = perturbed(named, seebeck_relative=-0.05)
    assert there.module.seebeck_V_per_K == pytest.approx(0.95 * named.module.seebeck_V_per_K)


def test_blood_is_solved_again_unless_the_rig_fixes_it() -> None:
    shani = Rig.load("shani2021")
    assert perturbed(shani, ambient_K=3.0).deep_C == shani.deep_C == 37.0
    assert perturbed(THENAR, ambient_K=8.0).deep_C == pytest.approx(32.0)  # air as warm as the resting skin


@pytest.mark.parametrize(("factors", "words"), messages(__file__)["corner"].items())
def test_what_is_physically_impossible_is_said_in_words(factors: str, words: str) -> None:
    with pytest.raises(RigError, match=words):
        perturbed(THENAR, **json.loads(factors))
