"""The Peltier module against its closed forms."""

import dataclasses

import numpy as np
import pytest

from tests.peltier import coldest_C, greatest_difference_A, heat_rejected_W
from thermicon.circuit.rig.module import ZERO_C_IN_K, Peltier
from thermicon.circuit.solver.network import current_for_heat_A, greatest_cooling_A, hot_plate_C

MODULE = Peltier(0.0521, 6.35, 1 / 0.1524, 2.6, 2.6)
TC, TH = 300 - ZERO_C_IN_K, 313.15 - ZERO_C_IN_K


def test_most_heat_is_the_closed_form() -> None:
    # α²Tc²/(2R) − ΔT/Θ at I = αTc/R; 17.2319 W at 2.4614 A for this module
    best = 0.0521 * 300 / 6.35
    assert best == pytest.approx(2.4614, abs=1e-4)
    assert MODULE.heat_absorbed_W(best, TC, TH) == pytest.approx(17.2319, abs=1e-4)


def test_best_coefficient_of_performance_is_the_closed_form() -> None:
    currents = np.linspace(0.05, 1.0, 200_001)
    power = MODULE.voltage_V(currents, TC, TH) * currents
    ratio = MODULE.heat_absorbed_W(currents, TC, TH) / power
    assert ratio.max() == pytest.approx(3.08797, abs=1e-5)
    assert currents[ratio.argmax()] == pytest.approx(0.29658, abs=1e-5)


def test_electrical_power_is_the_difference_of_the_heats() -> None:
    current = 0.7
    power = MODULE.voltage_V(current, TC, TH) * current
    assert power == pytest.approx(heat_rejected_W(MODULE, current, TC, TH) - MODULE.heat_absorbed_W(current, TC, TH))


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(Peltier)[:5]])
def test_a_module_proves_itself(field: str) -> None:
    with pytest.raises(ValueError, match=rf"module\.{field} = 0\.0: must be a positive number"):
        dataclasses.replace(MODULE, **{field: 0.0})


@pytest.mark.parametrize("capacity", [0.0, -1.0, float("nan")])
def test_legs_with_nodes_prove_their_capacity(capacity: float) -> None:
    with pytest.raises(ValueError, match=r"module\.leg_capacity_J_per_K = .*: must be a positive number"):
        dataclasses.replace(MODULE, leg_nodes=3, leg_capacity_J_per_K=capacity)


def _plates(cold: float, out: float) -> tuple[float, float]:
    return out * 40.0 + 0.1524 * cold, out + 0.1524


def test_greatest_cooling_is_where_the_heat_peaks_behind_a_heat_sink() -> None:
    base, total = _plates(TC, 5.0)
    currents = np.linspace(1.0, 4.0, 300_001)
    hot = hot_plate_C(currents, base, total, 0.0521, 6.35)
    peak = currents[np.argmax(MODULE.heat_absorbed_W(currents, TC, hot))]
    assert greatest_cooling_A(TC, base, total, 0.0521, 6.35, 0.1524) == pytest.approx(peak, abs=2e-5)
    assert peak < 2.4614


@pytest.mark.parametrize("heat", [-20.0, -1.0, 0.0, 3.0, 14.0])
def test_current_for_heat_absorbs_that_heat_at_the_low_root(heat: float) -> None:
    base, total = _plates(TC, 5.0)
    greatest = greatest_cooling_A(TC, base, total, 0.0521, 6.35, 0.1524)
    current = current_for_heat_A(heat, TC, base, total, 0.0521, 6.35, 0.1524, greatest, 0.0, 1e-13)
    assert current < greatest
    assert MODULE.heat_absorbed_W(current, TC, hot_plate_C(current, base, total, 0.0521, 6.35)) == pytest.approx(heat)


def test_more_heat_than_the_module_can_absorb_gives_the_current_of_greatest_cooling() -> None:
    base, total = _plates(TC, 5.0)
    assert current_for_heat_A(50.0, TC, base, total, 0.0521, 6.35, 0.1524, 2.2, 0.0, 1e-13) == 2.2


def test_greatest_difference_is_where_no_heat_is_absorbed_any_more() -> None:
    coldest, current = coldest_C(MODULE, TH), greatest_difference_A(MODULE, TH)
    for other in (0.98 * current, current, 1.02 * current):
        assert MODULE.heat_absorbed_W(other, coldest, TH) <= 1e-9
    assert MODULE.heat_absorbed_W(current, coldest, TH) == pytest.approx(0.0, abs=1e-9)
