"""Steady states and rest against pencil and paper."""

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.circuit.rig.module import ZERO_C_IN_K
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.network import RECORDED, network_of
from thermicon.circuit.solver.steady import state_under_current, steady_state

THENAR, SHANI = Rig.load("thenar"), Rig.load("shani2021")


def test_the_printed_slab_loses_1046_watts() -> None:
    resistance = 0.081e-3 / 0.24 + 2e-3 / 0.45
    assert SHANI.resting_flux_W_per_m2 == pytest.approx(-5 / resistance)
    assert SHANI.ambient.film_W_per_m2K * 8 == pytest.approx(5 / resistance, rel=1e-3)


@pytest.mark.parametrize("current", [-0.4, 0.0, 0.13, 0.9])
def test_steady_state_of_the_printed_model_by_series_resistances(current: float) -> None:
    # Two unknowns, hot and cold plate; the slab and the contact are one resistance to 37 °C.
    rig, module = SHANI, SHANI.module
    a, r, theta = module.seebeck_V_per_K, module.resistance_ohm, module.thermal_resistance_K_per_W
    skin = 9e-4 / (5.4e-4 + 0.081e-3 / 0.24 + 2e-3 / 0.45)
    matrix = [[1 / 0.2 + 1 / theta - a * current, -1 / theta], [-1 / theta, 1 / theta + a * current + skin]]
    joule, lift = r * current**2 / 2, a * current * ZERO_C_IN_K
    hot, cold = np.linalg.solve(matrix, [40 / 0.2 + lift + joule, -lift + joule + skin * 37])
    state = state_under_current(network_of(rig), current)
    assert state[:2] == pytest.approx([hot, cold], abs=1e-9)
    flux = (cold - 37) * skin / 9e-4
    network = network_of(rig)
    for probe in RECORDED[5:]:
        assert network.read(state, probe) == pytest.approx(flux, abs=1e-6)
    face = cold - flux * 5.4e-4
    assert network.read(state, "skin_C") == pytest.approx(face, abs=1e-9)
    depth = 0.081e-3 / 0.24 + (0.15e-3 - 0.081e-3) / 0.45
    assert network.read(state, "cold_receptor_C") == pytest.approx(face - flux * depth, abs=1e-9)


@pytest.mark.parametrize("control", ["skin", "display"])
@pytest.mark.parametrize("rig", [THENAR, SHANI], ids=lambda rig: rig.name)
def test_the_baseline_is_held(rig: Rig, control: str) -> None:
    current, state = steady_state(rig, control, 31.0)
    assert network_of(rig).read(state, f"{control}_C") == pytest.approx(31.0, abs=1e-9)
    assert rig.driver.current_min_A < current < rig.driver.current_max_A


def test_holding_currents_of_the_shipped_rigs() -> None:
    assert steady_state(THENAR, "skin", 32.0)[0] == pytest.approx(0.083, abs=1e-3)
    assert steady_state(SHANI, "skin", 32.0)[0] == pytest.approx(0.148, abs=1e-3)


def test_current_that_holds_nothing() -> None:
    # Zero current is not the baseline, and −0.5 A held burns: why safety never assumes 40 °C.
    network = network_of(THENAR)
    assert network.read(state_under_current(network, 0.0), "skin_C") == pytest.approx(39.1, abs=0.1)
    assert network.read(state_under_current(network, -0.5), "skin_C") == pytest.approx(96.4, abs=0.1)
    with pytest.raises(ArithmeticError, match=r"-4 A has no steady state on this rig"):
        state_under_current(network, -4.0)


def test_a_baseline_that_no_current_holds_is_refused() -> None:
    with pytest.raises(RigError, match=r"a baseline of -60 °C on the skin cannot be held: the module cools it to"):
        steady_state(THENAR, "skin", -60.0)
    with pytest.raises(RigError, match=r"cannot be held: it needs 0\.083 A, the driver gives -0\.05 … 0\.05 A"):
        steady_state(THENAR.with_(**{"driver.current_limit_A": 0.05}), "skin", 32.0)
    with pytest.raises(RigError, match=r"it needs 0\.95 V, the driver gives at most 0\.5 V"):
        steady_state(THENAR.with_(**{"driver.voltage_limit_V": 0.5}), "skin", 32.0)
