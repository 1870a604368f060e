"""A block of metal or air in place of skin: closed forms, refusals, and what is judged on it for people: nothing."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Device, Drive, Rig, design, fit, gate, netlist, simulate, simulate_current
from thermicon.circuit.delivery.deliver import deliver
from thermicon.circuit.fitting.keys import FitError, fittable
from thermicon.circuit.fitting.laboratory import synthetic_log
from thermicon.circuit.rig.parts import AIR_J_PER_M2K
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.safety.verdict import judge_safety
from thermicon.icons import load_library

THENAR = Rig.load("thenar")
BLOCK = {"capacity_J_per_K": 20.0, "conductance_W_per_K": 0.4}
ONLY_JOULE: dict[str, Any] = {
    "module.seebeck_V_per_K": 1e-15,
    "module.thermal_resistance_K_per_W": 1e15,
    "module.resistance_ohm": 2.0,
}
"""A module that puts half of I²R into the display and does nothing else."""
AREA_M2 = 9e-4


def heated(rig: Rig, seconds: float) -> Any:
    """Temperatures after 2 A begin at 1 s; 0 A before, so that all rests at the room."""
    rig = rig.with_(**{"driver.current_limit_A": 3.0, "driver.voltage_limit_V": 50.0})
    drive = Drive([0.0, 1.0, seconds], [0.0, 2.0, 2.0], held=True)
    return simulate_current(drive, rig, rate_Hz=20.0)


def test_a_block_warms_as_its_closed_form_says() -> None:
    rig = THENAR.with_(load=BLOCK, **ONLY_JOULE, **{"module.cold_plate_J_per_K": 0.01})
    trace = heated(rig, 200.0)
    power = 0.5 * 2.0 * 2.0**2
    late = np.maximum(trace.time_s - 1.0, 0.0)
    block = 24.0 + power / 0.4 * -np.expm1(-late * 0.4 / 20.0)
    np.testing.assert_allclose(trace.skin_C, block, atol=0.01)
    after = trace.time_s > 1.2
    drop = power * THENAR.contact.resistance_m2K_per_W / AREA_M2
    np.testing.assert_allclose((trace.display_C - trace.skin_C)[after], drop, rtol=1e-3)
    np.testing.assert_allclose(trace.heat_flow_skin_W_per_m2[after], power / AREA_M2, rtol=1e-3)


def test_a_display_in_air_warms_as_its_closed_form_says() -> None:
    film = 25.0
    trace = heated(THENAR.with_(load={"film_W_per_m2K": film}, **ONLY_JOULE), 300.0)
    power, conductance = 4.0, film * AREA_M2
    # Display and half of the film's air: two bodies, of which the air is far the smaller.
    a = np.array([[-2.0 * conductance / 2.6, 2.0 * conductance / 2.6],
                  [2.0 / (AIR_J_PER_M2K / film), -4.0 / (AIR_J_PER_M2K / film)]])  # fmt: skip
    rates, vectors = np.linalg.eig(a)
    steady = -np.linalg.solve(a, [power / 2.6, 0.0])
    weights = np.linalg.solve(vectors, -steady)
    for seconds in (5.0, 50.0, 300.0):
        expected = 24.0 + (steady + vectors @ (weights * np.exp(rates * (seconds - 1.0))))[0]
        found = float(np.interp(seconds, trace.time_s, trace.display_C))
        assert found == pytest.approx(expected, abs=5e-3)
    whole = 24.0 + power / conductance * -math.expm1(-299.0 * conductance / 2.6)
    assert float(trace.display_C[-1]) == pytest.approx(whole, rel=0.01)


@pytest.mark.parametrize("load", [BLOCK, {"film_W_per_m2K": 10.0}], ids=["block", "air"])
def test_nothing_is_judged_for_people_on_a_load(load: dict[str, float]) -> None:
    rig = THENAR.with_(load=load)
    icon = load_library("six-icons")["warming-step"]
    trace = simulate(icon, rig)
    words = r"in place of skin \(\[load\]\): safety for people cannot be judged; use the rig without \[load\]"
    with pytest.raises(RigError, match=words):
        gate(design(icon, rig, 8.0).drive, rig)
    with pytest.raises(RigError, match=words):
        judge_safety(trace)
    with pytest.raises(RigError, match=words):
        deliver(icon, rig, Device.load("dac-16"))


@pytest.mark.slow
def test_a_log_of_a_block_is_fitted_and_says_nothing_of_contact_with_skin() -> None:
    truth = THENAR.with_(load=BLOCK, **{"contact.resistance_m2K_per_W": 2e-4})
    log = synthetic_log(truth, seed=3)
    keys = ["contact.resistance_m2K_per_W", "load.capacity_J_per_K", "module.seebeck_V_per_K"]
    fitted = fit(log, THENAR.with_(load={**BLOCK, "capacity_J_per_K": 30.0}), free=keys)
    assert fitted["load.capacity_J_per_K"].value == pytest.approx(20.0, rel=0.01)
    assert fitted["contact.resistance_m2K_per_W"].value == pytest.approx(2e-4, rel=0.02)
    shipped = THENAR.uncertainty
    assert fitted.rig.uncertainty.contact_resistance_relative == shipped.contact_resistance_relative
    assert fitted.rig.uncertainty.seebeck_relative < shipped.seebeck_relative
    assert "skin.rest_C" not in fittable(truth)
    with pytest.raises(FitError, match=r"load.capacity_J_per_K: rig thenar has no load with this key"):
        fit(log, THENAR, free=["load.capacity_J_per_K"])


def test_a_rig_with_a_load_says_so_and_is_written_and_read() -> None:
    rig = THENAR.with_(load=BLOCK)
    assert repr(rig).startswith("Rig('thenar', metal block, 9 cm², room 24.0 °C")
    assert "load       a metal block in place of skin: 20 J/K, 0.4 W/K to a room of 24 °C" in rig.about()
    assert rig.warnings == ()
    assert rig.site == "metal block"
    text = netlist(rig, Drive([0.0, 1.0], [0.1, 0.2]))
    assert "metal block in place of skin" in text
    assert "blood that perfuses" not in text
