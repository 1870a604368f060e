"""The module of a rig, given by parameters, by data sheets or by name: three ways, never two at once."""

from pathlib import Path

import pytest

from thermicon.circuit import Rig
from thermicon.circuit.rig.module import Datasheet, Extraction, Peltier, at_mean_C
from thermicon.circuit.rig.modules import build_of, load_module, module_names
from thermicon.circuit.rig.rigfile import RigError

THENAR = Rig.load("thenar")
TEC = {"i_max_A": 6.4, "v_max_V": 14.4, "dt_max_K": 66, "t_hot_C": 25, "q_max_W": 50}
TEC_WARM = {"i_max_A": 6.4, "v_max_V": 16.4, "dt_max_K": 75, "t_hot_C": 50, "q_max_W": 57}
GIVEN = "seebeck_V_per_K = 0.0521\nresistance_ohm = 6.35\nthermal_resistance_K_per_W = 6.56\n"


def _parameters(rig: Rig) -> tuple[float, float, float]:
    return (rig.module.seebeck_V_per_K, rig.module.resistance_ohm, rig.module.thermal_resistance_K_per_W)


def made(found: Extraction) -> Peltier:
    """The module of an extraction with the plates of the thenar rig."""
    return Peltier(found.seebeck_V_per_K, found.resistance_ohm, found.thermal_resistance_K_per_W, 2.6, 2.6)


def _without(*keys: str) -> dict[str, float]:
    return {key: value for key, value in TEC.items() if key not in keys}


def _file(tmp_path: Path, module: str) -> Path:
    text = (Path(__file__).parents[3] / "circuit/rigs/thenar.toml").read_text("utf-8")
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(GIVEN, module), "utf-8")
    return path


def test_a_data_sheet_in_a_rig_file(tmp_path: Path) -> None:
    sheet = "[[module.datasheet]]\ni_max_A = 6.4\nv_max_V = 14.4\ndt_max_K = 66\nt_hot_C = 25\nq_max_W = 50\n"
    path = _file(tmp_path, "")
    text = path.read_text("utf-8").replace("[heat_sink]", sheet + "\n[heat_sink]")
    path.write_text(text, "utf-8")
    rig, found = Rig.load(path), Datasheet(**TEC).four_figures()
    assert rig.module == made(found)
    assert rig.module_source.startswith("data sheet given in the rig (TE-127-1.0-2.5, derived")
    assert rig.warnings == ()


def test_a_whole_list_of_sheets_replaces_the_parameters() -> None:
    rig = THENAR.with_(**{"module.datasheet": [TEC]})
    assert rig.module == made(Datasheet(**TEC).four_figures())
    assert rig.module_source == (
        "data sheet given in the rig (no source stated): four figures with the hot side at 25 °C, Qmax reproduced."
    )
    assert rig.with_(**{"module.datasheet.0.q_max_W": 48}).module == (
        made(Datasheet(**{**TEC, "q_max_W": 48}).four_figures())
    )
    assert rig.with_(**{"module.hot_plate_J_per_K": 9}).module.hot_plate_J_per_K == 9
    assert THENAR.module_source.startswith("parameters given: TE-127-1.0-2.5, derived from its leg geometry")
    changed = THENAR.with_(**{"module.resistance_ohm": 6.0})
    assert (changed.module.resistance_ohm, changed.module_source) == (6.0, "parameters given: no source stated")
    assert THENAR.with_(**{"module.resistance_ohm": 6.35}) == THENAR


def test_without_qmax_three_figures() -> None:
    three = made(Datasheet(**TEC).three_figures())
    silent = THENAR.with_(**{"module.datasheet": [_without("q_max_W")]})
    assert silent.module == three
    assert silent.module_source.endswith("three figures with the hot side at 25 °C, no Qmax to check them against.")
    assert silent.warnings == ()
    mixed = THENAR.with_(**{"module.datasheet": [_without("q_max_W"), TEC_WARM]})
    assert "three figures with the hot side at 25 and 50 °C" in mixed.module_source


def test_two_sheets_are_taken_between_heat_sink_and_resting_skin() -> None:
    found = [Datasheet(**sheet).four_figures() for sheet in (TEC, TEC_WARM)]
    rig = THENAR.with_(**{"module.datasheet": [TEC, TEC_WARM], "heat_sink.temperature_C": 25})
    assert _parameters(rig) == pytest.approx(at_mean_C(found, 28.5))
    assert found[0].seebeck_V_per_K < rig.module.seebeck_V_per_K < found[1].seebeck_V_per_K
    assert rig.module_source.endswith("Qmax reproduced, taken at a mean module temperature of 28.5 °C.")
    assert rig.warnings == ()
    warm = rig.with_(**{"heat_sink.temperature_C": 40})
    assert _parameters(warm) == pytest.approx(at_mean_C(found[1:], 0.0))
    assert warm.warnings == (
        "module: the mean of heat sink and resting skin, 36.0 °C, lies above the 8.5 … 31.2 °C that its two data "
        "sheets stand for; the parameters at 31.2 °C are used, from which the trend of both sheets leads away by up to "
        "2.3 %: where that matters, give a [[module.datasheet]] of a hotter side in place of one of the two, or fit "
        "the module to a log (thermicon fit)",
    )
    named = THENAR.with_(**{"module.name": "TEC1-12706"}).warnings[0]
    assert "by up to 2.3 %: where that matters, fit the module to a log" in named
    assert "lies below the 8.5" in rig.with_(**{"heat_sink.temperature_C": -20}).warnings[0]


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


def test_a_sheet_that_is_not_there_is_answered_with_those_that_are() -> None:
    rig = THENAR.with_(**{"module.datasheet": [TEC]})
    with pytest.raises(RigError, match=r"no such data sheet; there are 0 \(hot side at 25 °C\)"):
        rig.with_(**{"module.datasheet.1.i_max_A": 3})


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
