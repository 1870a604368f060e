"""The Peltier module against closed forms and published data sheets."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from tests.builders import missing
from tests.peltier import coldest_C, greatest_difference_A, heat_absorbed_W, heat_rejected_W
from thermicon.circuit import Rig
from thermicon.circuit.rig.module import ZERO_C_IN_K, Datasheet, Extraction, Peltier, at_mean_C
from thermicon.circuit.rig.modules import build_of, load_module, module_names
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.plates import current_for_heat_A, greatest_cooling_A, hot_plate_C

MODULE = Peltier(0.0521, 6.35, 1 / 0.1524, 2.6, 2.6)
TC, TH = 300 - ZERO_C_IN_K, 313.15 - ZERO_C_IN_K


def sheet_of(current: float, voltage: float, span: float, hot: float, heat: float | None = None) -> Datasheet:
    return Datasheet(i_max_A=current, v_max_V=voltage, dt_max_K=span, t_hot_C=hot, q_max_W=heat)


def made(found: Extraction) -> Peltier:
    """The module of an extraction with the plates of the thenar rig."""
    return Peltier(found.seebeck_V_per_K, found.resistance_ohm, found.thermal_resistance_K_per_W, 2.6, 2.6)


def greatest_W(module: Peltier, cold_C: float, hot_C: float) -> float:
    """Most heat at fixed plate temperatures: (αTc)²/(2R) − ΔT/Θ."""
    pumped = (module.seebeck_V_per_K * (cold_C + ZERO_C_IN_K)) ** 2 / (2 * module.resistance_ohm)
    return pumped - (hot_C - cold_C) / module.thermal_resistance_K_per_W


def test_most_heat_is_the_closed_form() -> None:
    # α²Tc²/(2R) − ΔT/Θ at I = αTc/R; 17.2319 W at 2.4614 A for this module
    best = 0.0521 * 300 / 6.35
    assert best == pytest.approx(2.4614, abs=1e-4)
    assert greatest_W(MODULE, TC, TH) == pytest.approx(17.2319, abs=1e-4)
    assert heat_absorbed_W(MODULE, best, TC, TH) == pytest.approx(17.2319, abs=1e-4)


def test_best_coefficient_of_performance_is_the_closed_form() -> None:
    currents = np.linspace(0.05, 1.0, 200_001)
    power = MODULE.voltage_V(currents, TC, TH) * currents
    assert power == pytest.approx(heat_rejected_W(MODULE, currents, TC, TH) - heat_absorbed_W(MODULE, currents, TC, TH))
    ratio = heat_absorbed_W(MODULE, currents, TC, TH) / power
    assert ratio.max() == pytest.approx(3.08797, abs=1e-5)
    assert currents[ratio.argmax()] == pytest.approx(0.29658, abs=1e-5)


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
    peak = currents[np.argmax(heat_absorbed_W(MODULE, currents, TC, hot))]
    assert greatest_cooling_A(TC, base, total, 0.0521, 6.35, 0.1524) == pytest.approx(peak, abs=2e-5)
    assert peak < 2.4614


@pytest.mark.parametrize("heat", [-20.0, -1.0, 0.0, 3.0, 14.0])
def test_current_for_heat_absorbs_that_heat_at_the_low_root(heat: float) -> None:
    base, total = _plates(TC, 5.0)
    greatest = greatest_cooling_A(TC, base, total, 0.0521, 6.35, 0.1524)
    current = current_for_heat_A(heat, TC, base, total, 0.0521, 6.35, 0.1524, greatest, 0.0, 1e-13)
    assert current < greatest
    assert heat_absorbed_W(MODULE, current, TC, hot_plate_C(current, base, total, 0.0521, 6.35)) == pytest.approx(heat)
    too_much = current_for_heat_A(50.0, TC, base, total, 0.0521, 6.35, 0.1524, greatest, 0.0, 1e-13)
    assert too_much == greatest


def test_greatest_difference_is_where_no_heat_is_absorbed_any_more() -> None:
    coldest = coldest_C(MODULE, TH)
    current = greatest_difference_A(MODULE, TH)
    assert greatest_W(MODULE, coldest, TH) == pytest.approx(0.0, abs=1e-9)
    for other in (0.98 * current, current, 1.02 * current):
        assert heat_absorbed_W(MODULE, other, coldest, TH) <= 1e-9
    assert heat_absorbed_W(MODULE, current, coldest, TH) == pytest.approx(0.0, abs=1e-9)


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
    assert heat_absorbed_W(module, sheet.i_max_A, sheet.t_hot_C, sheet.t_hot_C) == pytest.approx(sheet.q_max_W)
    assert heat_absorbed_W(module, sheet.i_max_A, cold, sheet.t_hot_C) == pytest.approx(0.0, abs=1e-9)
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


THENAR = Rig.load("thenar")
TEC = {"i_max_A": 6.4, "v_max_V": 14.4, "dt_max_K": 66, "t_hot_C": 25, "q_max_W": 50}
TWO_STAGE = {"i_max_A": 6.1, "v_max_V": 15.5, "dt_max_K": 83.0, "t_hot_C": 27.0, "q_max_W": 30.8}
TEC_WARM = {"i_max_A": 6.4, "v_max_V": 16.4, "dt_max_K": 75, "t_hot_C": 50, "q_max_W": 57}
GIVEN = "seebeck_V_per_K = 0.0521\nresistance_ohm = 6.35\nthermal_resistance_K_per_W = 6.56\n"


def _parameters(rig: Rig) -> tuple[float, float, float]:
    return (rig.module.seebeck_V_per_K, rig.module.resistance_ohm, rig.module.thermal_resistance_K_per_W)


def _file(tmp_path: Path, module: str) -> Path:
    text = (Path(__file__).parents[3] / "circuit/rigs/thenar.toml").read_text("utf-8")
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(GIVEN, module), "utf-8")
    return path


def test_a_whole_list_of_sheets_replaces_the_parameters() -> None:
    rig = THENAR.with_(**{"module.datasheet": [TEC]})
    assert rig.module == made(Datasheet(**TEC).four_figures())
    with pytest.raises(RigError, match=r"no such data sheet; there are 0 \(hot side at 25 °C\)"):
        rig.with_(**{"module.datasheet.1.i_max_A": 3})
    assert rig.module_source.startswith("data sheet given in the rig (no source stated): four figures with the hot")
    weaker = Datasheet(**{**TEC, "q_max_W": 48}).four_figures()
    assert rig.with_(**{"module.datasheet.0.q_max_W": 48}).module == made(weaker)
    assert rig.with_(**{"module.hot_plate_J_per_K": 9}).module.hot_plate_J_per_K == 9
    assert THENAR.module_source.startswith("parameters given: TE-127-1.0-2.5, derived from its leg geometry")
    changed = THENAR.with_(**{"module.resistance_ohm": 6.0})
    assert (changed.module.resistance_ohm, changed.module_source) == (6.0, "parameters given: no source stated")
    assert THENAR.with_(**{"module.resistance_ohm": 6.35}) == THENAR


def test_without_qmax_three_figures() -> None:
    sheet = {key: value for key, value in TEC.items() if key != "q_max_W"}
    silent = THENAR.with_(**{"module.datasheet": [sheet]})
    assert silent.module == made(Datasheet(**TEC).three_figures())
    assert silent.module_source.endswith("three figures with the hot side at 25 °C, no Qmax to check them against.")
    assert silent.warnings == ()
    mixed = THENAR.with_(**{"module.datasheet": [sheet, TEC_WARM]})
    assert "three figures with the hot side at 25 and 50 °C" in mixed.module_source


@pytest.mark.parametrize(
    ("figures", "said"), [(TEC | {"q_max_W": 42}, False), (TEC | {"q_max_W": 41}, True), (TWO_STAGE, True)]
)
def test_figures_that_are_not_those_of_one_stage_are_said(figures: dict[str, float], said: bool) -> None:
    rig = THENAR.with_(**{"module.datasheet": [figures]})
    warned = [text for text in rig.warnings if "not that of one stage" in text]
    assert bool(warned) == said
    if said:
        hot_C = figures["t_hot_C"]
        span, current = hot_C - coldest_C(rig.module, hot_C), greatest_difference_A(rig.module, hot_C)
        assert f"{span:.3g} K at {current:.2g} A, and it prints {figures['dt_max_K']:g} K at " in warned[0]
    without = {key: value for key, value in figures.items() if key != "q_max_W"}
    assert not any("one stage" in text for text in THENAR.with_(**{"module.datasheet": [without]}).warnings)


@pytest.mark.parametrize(("plates", "source", "said"), [
    ((2.6, 2.6), "", True), ((4.6, 2.6), "", True), ((3.8, 5.4), "", False), ((2.6, 2.6), "weighed", False),
])  # fmt: skip
def test_plates_of_another_module_are_said_unless_their_source_is(
    tmp_path: Path, plates: tuple[float, float], source: str, said: bool
) -> None:
    text = THENAR.with_(module={"name": "TEC1-12706"}, contact={"area_cm2": 16.0}).toml
    for key, value in zip(("hot", "cold"), plates, strict=True):
        text = text.replace(f"{key}_plate_J_per_K = 4.6", f"{key}_plate_J_per_K = {value}")
        text = text.replace(
            "[source]", f'[source]\n"module.{key}_plate_J_per_K" = "{source}"' if source else "[source]"
        )
    (tmp_path / "mine.toml").write_text(text, "utf-8")
    assert (
        any("those on record for it 4.6 J/K each" in text for text in Rig.load(tmp_path / "mine.toml").warnings) == said
    )


def test_two_sheets_are_taken_between_heat_sink_and_resting_skin() -> None:
    found = [Datasheet(**sheet).four_figures() for sheet in (TEC, TEC_WARM)]
    rig = THENAR.with_(**{"module.datasheet": [TEC, TEC_WARM], "heat_sink.temperature_C": 25})
    assert _parameters(rig) == pytest.approx(at_mean_C(found, 28.5))
    assert found[0].seebeck_V_per_K < rig.module.seebeck_V_per_K < found[1].seebeck_V_per_K
    assert rig.module_source.endswith("Qmax reproduced, taken at a mean module temperature of 28.5 °C.")
    assert rig.warnings == ()
    warm = rig.with_(**{"heat_sink.temperature_C": 40})
    assert _parameters(warm) == pytest.approx(at_mean_C(found[1:], 0.0))
    (said,) = warm.warnings
    words = ["36.0 °C it is used above the 8.5 … 31.2 °C", "by up to 2.3 %", "[[module.datasheet]] of a hotter"]
    assert not missing(words, said)
    named = THENAR.with_(**{"module.name": "TEC1-12706"}).warnings[0]
    assert "by up to 2.3 %: where that matters, fit it to a log" in named
    assert "used below the 8.5" in rig.with_(**{"heat_sink.temperature_C": -20}).warnings[0]


@pytest.mark.parametrize("name", module_names())
def test_every_shipped_module_serves_a_rig_by_name(name: str) -> None:
    rig = THENAR.with_(**{"module.name": name})
    found = [sheet.four_figures() for sheet in load_module(name)]
    assert _parameters(rig) == pytest.approx(at_mean_C(found, 36.0))
    assert rig.module_source.startswith(f"{name}, ")
    assert "Qmax reproduced" in rig.module_source
    derived = [text for text in rig.warnings if "no datasheet was seen" in text]
    assert bool(derived) == (name == "TE-127-1.0-2.5")


def test_a_module_by_name_brings_its_plates_unless_others_are_set_with_it() -> None:
    named = THENAR.with_(**{"module.name": "TEC1-12706"})
    assert (named.module.hot_plate_J_per_K, named.module.cold_plate_J_per_K) == (4.6, 4.6)
    assert "plates of 4.6 J/K a side (assumed from its footprint)" in named.module_source
    own = THENAR.with_(**{"module.name": "TEC1-12706", "module.cold_plate_J_per_K": 5.5})
    assert (own.module.hot_plate_J_per_K, own.module.cold_plate_J_per_K) == (4.6, 5.5)
    assert "plates of" not in own.module_source
    assert named.with_(**{"module.datasheet": [TEC]}).module.hot_plate_J_per_K == 4.6


def test_plates_on_record_are_alumina_over_the_footprint_with_half_the_legs() -> None:
    alumina = 3.9 * 0.88 * 0.065  # J/(K·cm²) of a plate of 0.65 mm
    legs = 2 * 127 * 0.1 * 0.1 * 0.25 * 7.7 * 0.154 / 2 / 9.0  # Bi2Te3 of the shipped rigs' module, half of it a side
    for name in module_names():
        build = build_of(name)
        if build.face_cm2 is None:
            assert build.plate_J_per_K is None
            continue
        assert build.plate_J_per_K == pytest.approx(0.29 * build.face_cm2, rel=0.02)
        assert alumina + legs < build.plate_J_per_K / build.face_cm2 < 1.2 * (alumina + legs)  # the rest is copper


def test_a_file_that_names_no_module_or_one_twice(tmp_path: Path) -> None:
    with pytest.raises(RigError, match=r"module: no module is stated; give seebeck_V_per_K, .* shipped module"):
        Rig.load(_file(tmp_path, ""))
    with pytest.raises(RigError, match=r"seebeck_V_per_K and name are two ways of giving it; keep one"):
        Rig.load(_file(tmp_path, GIVEN + 'name = "CP60340"\n'))
    with pytest.raises(RigError) as caught:
        Rig.load(_file(tmp_path, "seebeck_V_per_K = 0.0521\n"))
    assert [line.partition(": ")[2] for line in str(caught.value).splitlines()] == [
        "module.resistance_ohm is missing; add it, in Ω",
        "module.thermal_resistance_K_per_W is missing; add it, in K/W",
    ]


def test_more_contact_than_the_face_of_a_module_that_stays_is_warned_of(tmp_path: Path) -> None:
    THENAR.with_(module={"name": "TEC1-12706"}, contact={"area_cm2": 16.0}).save(tmp_path / "hand.toml")
    own = Rig.load(tmp_path / "hand.toml")
    larger = own.with_(**{"contact.area_cm2": 18.0})
    assert any("contact.area_cm2 = 18 cm² is more than its face of 16 cm²" in text for text in larger.warnings)
    assert not any("more than its face" in text for text in own.warnings)
