"""The Peltier module against its closed forms, and its parameters from data sheets against published extractions."""

from dataclasses import fields, replace

import numpy as np
import pytest

from tests.peltier import coldest_C, greatest_difference_A, heat_rejected_W
from thermicon.circuit.rig.module import ZERO_C_IN_K, Datasheet, Extraction, Peltier, at_mean_C
from thermicon.circuit.rig.modules import load_module, module_names, module_table
from thermicon.circuit.solver.network import current_for_heat_A, greatest_cooling_A, hot_plate_C

MODULE = Peltier(0.0521, 6.35, 1 / 0.1524, 2.6, 2.6)
TC, TH = 300 - ZERO_C_IN_K, 313.15 - ZERO_C_IN_K


def sheet_of(current: float, voltage: float, span: float, hot: float, heat: float | None = None) -> Datasheet:
    return Datasheet(i_max_A=current, v_max_V=voltage, dt_max_K=span, t_hot_C=hot, q_max_W=heat)


def made(found: Extraction) -> Peltier:
    return Peltier(found.seebeck_V_per_K, found.resistance_ohm, found.thermal_resistance_K_per_W, 1.0, 1.0)


def greatest_W(module: Peltier, cold_C: float, hot_C: float) -> float:
    """Most heat at fixed plate temperatures: (αTc)²/(2R) − ΔT/Θ."""
    pumped = (module.seebeck_V_per_K * (cold_C + ZERO_C_IN_K)) ** 2 / (2 * module.resistance_ohm)
    return pumped - (hot_C - cold_C) / module.thermal_resistance_K_per_W


def test_most_heat_is_the_closed_form() -> None:
    # α²Tc²/(2R) − ΔT/Θ at I = αTc/R; 17.2319 W at 2.4614 A for this module
    best = 0.0521 * 300 / 6.35
    assert best == pytest.approx(2.4614, abs=1e-4)
    assert greatest_W(MODULE, TC, TH) == pytest.approx(17.2319, abs=1e-4)
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


@pytest.mark.parametrize("field", [field.name for field in fields(Peltier)])
def test_a_module_proves_itself(field: str) -> None:
    with pytest.raises(ValueError, match=rf"module\.{field} = 0\.0: must be a positive number"):
        replace(MODULE, **{field: 0.0})


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
    coldest = coldest_C(MODULE, TH)
    current = greatest_difference_A(MODULE, TH)
    assert greatest_W(MODULE, coldest, TH) == pytest.approx(0.0, abs=1e-9)
    for other in (0.98 * current, current, 1.02 * current):
        assert MODULE.heat_absorbed_W(other, coldest, TH) <= 1e-9
    assert MODULE.heat_absorbed_W(current, coldest, TH) == pytest.approx(0.0, abs=1e-9)


EVERY_SHEET = [(name, sheet) for name in module_names() for sheet in load_module(name)]
IDS = [f"{name} at {sheet.t_hot_C:g}" for name, sheet in EVERY_SHEET]


@pytest.mark.parametrize(
    ("sheet", "ohm", "seebeck", "theta"),
    [  # Tan & Fok 2008, modules A1, B1, D1; they take 0 °C for 273 K and cut, not round, the last digit
        (sheet_of(6.0, 15.4, 67, 25), 1.9896, 0.0517, 1.8708),
        (sheet_of(6.1, 15.9, 70, 25), 1.9943, 0.0534, 1.8866),
        (sheet_of(5.6, 14.7, 66, 27), 2.0475, 0.0490, 2.0558),
    ],
    ids=["A1", "B1", "D1"],
)
def test_three_figures_reproduce_published_extractions(
    sheet: Datasheet, ohm: float, seebeck: float, theta: float
) -> None:
    found = sheet.model_copy(update={"t_hot_C": sheet.t_hot_C + 273.0 - ZERO_C_IN_K}).three_figures()
    assert found.resistance_ohm == pytest.approx(ohm, abs=6e-5)
    assert found.seebeck_V_per_K == pytest.approx(seebeck, abs=6e-5)
    assert found.thermal_resistance_K_per_W == pytest.approx(theta, abs=6e-5)
    assert sheet.three_figures().resistance_ohm == pytest.approx(ohm, rel=1e-3)


@pytest.mark.parametrize(("name", "sheet"), EVERY_SHEET, ids=IDS)
def test_three_figures_give_back_their_three(name: str, sheet: Datasheet) -> None:
    module = made(sheet.three_figures())
    assert sheet.t_hot_C - coldest_C(module, sheet.t_hot_C) == pytest.approx(sheet.dt_max_K)
    assert greatest_difference_A(module, sheet.t_hot_C) == pytest.approx(sheet.i_max_A)
    assert module.voltage_V(sheet.i_max_A, sheet.t_hot_C - sheet.dt_max_K, sheet.t_hot_C) == pytest.approx(
        sheet.v_max_V
    )


@pytest.mark.parametrize(("name", "sheet"), EVERY_SHEET, ids=IDS)
def test_four_figures_reproduce_the_printed_heat_exactly(name: str, sheet: Datasheet) -> None:
    found = sheet.four_figures()
    module, cold = made(found), sheet.t_hot_C - sheet.dt_max_K
    assert module.heat_absorbed_W(sheet.i_max_A, sheet.t_hot_C, sheet.t_hot_C) == pytest.approx(sheet.q_max_W)
    assert module.heat_absorbed_W(sheet.i_max_A, cold, sheet.t_hot_C) == pytest.approx(0.0, abs=1e-9)
    assert module.voltage_V(sheet.i_max_A, cold, sheet.t_hot_C) == pytest.approx(sheet.v_max_V)
    # what they pay: the current of the greatest difference, and that difference by a little
    assert 0.89 < greatest_difference_A(module, sheet.t_hot_C) / sheet.i_max_A < 1.01
    assert sheet.t_hot_C - coldest_C(module, sheet.t_hot_C) == pytest.approx(sheet.dt_max_K, rel=0.01)


def test_two_sheets_are_interpolated_at_the_mean_module_temperature() -> None:
    cool, warm = (sheet.four_figures() for sheet in load_module("TEC1-12706"))
    assert (cool.mean_C, warm.mean_C) == (25 - 66 / 4, 50 - 75 / 4)
    third = cool.mean_C + (warm.mean_C - cool.mean_C) / 3
    for values in (at_mean_C((cool, warm), third), at_mean_C((warm, cool), third)):
        assert values[0] == pytest.approx((2 * cool.seebeck_V_per_K + warm.seebeck_V_per_K) / 3)
        assert values[1] == pytest.approx((2 * cool.resistance_ohm + warm.resistance_ohm) / 3)
        assert values[2] == pytest.approx((2 * cool.thermal_resistance_K_per_W + warm.thermal_resistance_K_per_W) / 3)
    for found, mean in ((cool, -40.0), (warm, 90.0)):
        parameters = (found.seebeck_V_per_K, found.resistance_ohm, found.thermal_resistance_K_per_W)
        assert at_mean_C((cool, warm), mean) == pytest.approx(parameters)
        assert at_mean_C((found,), 20.0) == parameters


def test_four_figures_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(ValueError, match=r"q_max_W = 5 W: must lie between 11\.5 and 416 W .* leave q_max_W out"):
        sheet_of(6.4, 14.4, 66, 25, 5.0).four_figures()
    for heat in (11.48, 416.0):  # both ends of the range are where Θ or R leaves the positive numbers
        found = sheet_of(6.4, 14.4, 66, 25, heat).four_figures()
        assert min(found.resistance_ohm, found.thermal_resistance_K_per_W) > 0


def test_every_shipped_module_has_its_source_and_one_is_no_data_sheet() -> None:
    assert len(module_names()) == 8
    assert len(EVERY_SHEET) == len(module_table()) == 9
    derived = {str(record.get("module")) for record in module_table() if record.get("origin") != "datasheet"}
    assert derived == {"TE-127-1.0-2.5"}
    (record,) = (record for record in module_table() if record.get("module") == "TE-127-1.0-2.5")
    assert "no datasheet was seen" in record.source
    assert record.confidence == "low"
