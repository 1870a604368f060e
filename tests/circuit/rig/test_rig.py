"""Shipped rigs and refusals of bad ones."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests.builders import messages
from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.rig.corner import perturbed
from thermicon.circuit.rig.modules import module_names
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rig_words import STEP_S
from thermicon.circuit.rig.rigfile import RigError, rig_keys
from thermicon.circuit.rig.usual import unusual_values, usual_values
from thermicon.circuit.solver.kernel import LONGEST_STEP_S

THENAR = Rig.load("thenar")


def test_the_default_rig_comes_first() -> None:
    assert rig_names() == ("thenar", "fingertip", "forearm", "hand-dorsum", "shani2021", "tcs2")


@pytest.mark.parametrize("name", rig_names())
def test_every_number_of_a_shipped_rig_has_a_source(name: str) -> None:
    document = json.loads(Rig.load(name).document)
    sources = document["source"]

    for table in ("module", "heat_sink", "driver", "thermode", "contact", "ambient", "blood"):
        for key in document.get(table, {}):
            assert {table, f"{table}.{key}"} & set(sources), f"{table}.{key} has no source"
    for key in document["skin"]:
        assert key in ("site", "layer") or f"skin.{key}" in sources, f"skin.{key} has no source"
    for layer in document["skin"]["layer"]:
        assert f"skin.layer.{layer['name']}" in sources


def test_with_changes_one_key_and_keeps_the_rest() -> None:
    small = THENAR.with_(**{"contact.area_cm2": 4})
    assert small.contact.area_m2 == pytest.approx(4e-4)
    assert small != THENAR
    assert THENAR.contact.area_m2 == pytest.approx(9e-4)
    assert small.with_(**{"contact.area_cm2": 9.0}) == THENAR
    assert THENAR.with_(**{"skin.layer.dermis.thickness_mm": 2}).skin.layers[2].thickness_m == pytest.approx(2e-3)
    assert THENAR.with_(**{"driver.current_min_A": 0}).driver.current_min_A == 0
    assert THENAR.with_(**{"skin.deep_C": 37}).deep_C == 37
    with pytest.raises(RigError, match=r"^rig thenar: module\.resistance_ohm is missing; add it, in Ω$"):
        THENAR.with_(**{"module.resistance_ohm": None})


def test_settings_from_the_command_line_are_toml_values() -> None:
    rig = THENAR.with_set(["contact.area_cm2=4", "skin.site = forearm", "skin.layer.0.thickness_mm=0.022"])
    assert (rig.contact.area_m2, rig.site) == (pytest.approx(4e-4), "forearm")
    assert THENAR.with_set([]) is THENAR
    for setting in ("contact.area_cm2", "=4", "contact.area_cm2="):
        with pytest.raises(RigError, match="a setting has the form KEY=VALUE"):
            THENAR.with_set([setting])


def test_all_faults_of_a_file_are_told_at_once(tmp_path: Path) -> None:
    text = (Path(__file__).parents[3] / "circuit/rigs/thenar.toml").read_text("utf-8")
    text = text.replace("area_cm2 = 9.0", "area_cm2 = -9.0").replace("rest_C = 32.0", "rest = 32.0")
    path = tmp_path / "faulty.toml"
    path.write_text(text.replace("voltage_limit_V = 15.0\n", ""), "utf-8")
    with pytest.raises(RigError) as caught:
        Rig.load(path)
    lines = str(caught.value).splitlines()
    assert [line.removeprefix(f"{path}: ") for line in lines] == [
        "driver.voltage_limit_V is missing; add it, in V",
        "contact.area_cm2 = -9.0 cm²: must be at least 0.01 cm²",
        "skin.rest_C is missing; add it, in °C",
        "skin.rest: unknown key; did you mean skin.rest_C?",
    ]


def test_files_that_are_no_rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cases = {
        "empty.toml": (b"", "the file is empty; a rig file was expected"),
        "binary.toml": (b"a = 1\0", "this is a binary file, not a rig file"),
        "latin.toml": ("title = 'é'".encode("latin-1"), "not UTF-8 text"),
        "broken.toml": (b"a = = 1", "not a valid TOML file"),
        "huge.toml": (b"#" * 2_000_000, "2 MB is too large for a rig file; the limit is 1 MB"),
    }
    for name, (data, words) in cases.items():
        path = tmp_path / name
        path.write_bytes(data)
        with pytest.raises(RigError, match=words):
            Rig.load(path)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "thenar").mkdir()
    assert Rig.load("thenar") == THENAR, "a folder does not hide a shipped rig"
    with pytest.raises(RigError, match="this is a folder, not a rig file"):
        Rig.load(tmp_path)
    with pytest.raises(RigError, match="no such rig file"):
        Rig.load(tmp_path / "absent.toml")
    with pytest.raises(RigError, match=r"thena: no such rig; did you mean thenar\?"):
        Rig.load("thena")


MESSAGES = messages(__file__)


def changed(given: str) -> Rig:
    """A shipped rig with changes: its name, and these as JSON."""
    name, _, changes = given.partition(" ")
    return Rig.load(name).with_(**json.loads(changes))


@pytest.mark.parametrize(("given", "words"), MESSAGES["refused"].items())
def test_a_change_that_cannot_be_is_refused_in_words(given: str, words: str) -> None:
    with pytest.raises(RigError, match=words):
        changed(given)


@pytest.mark.parametrize(("given", "words"), MESSAGES["warned"].items())
def test_an_unusual_rig_warns(given: str, words: list[str]) -> None:
    warnings = changed(given).warnings
    assert len(warnings) == len(words), warnings
    for said, pattern in zip(warnings, words, strict=True):
        assert re.search(pattern, said), said


@pytest.mark.parametrize("name", rig_names())
def test_a_saved_rig_reads_back_as_an_equal_rig(name: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    Rig.load(name).save(path)
    assert Rig.load(path).document == Rig.load(name).document
    assert Rig.load(path) == Rig.load(name)


def test_changes_probes_sheets_and_odd_texts_survive(tmp_path: Path) -> None:
    sheets = [{"i_max_A": 6.4, "v_max_V": 14.4, "dt_max_K": 66.0, "t_hot_C": 25.0}]
    probe = [{"name": "pad", "place": "skin", "lag_s": 0.1}]
    rig = THENAR.with_(
        title='"quotes", \\ and µ',
        notes=["two\nlines"],
        probe=probe,
        contact={"area_cm2": 0.1},
        module={"datasheet": sheets},
    )
    rig.save(tmp_path / "mine.toml")
    again = Rig.load(tmp_path / "mine.toml")
    assert again == rig
    assert again.title == '"quotes", \\ and µ'
    assert again.contact.area_m2 == rig.contact.area_m2


def test_a_changed_copy_is_saved_by_a_name_of_its_own(tmp_path: Path) -> None:
    THENAR.with_(contact={"area_cm2": 4}).save(tmp_path / "mine.toml", name="bench")
    again = Rig.load(tmp_path / "mine.toml")
    assert again.name == "bench" and again.contact.area_m2 == pytest.approx(4e-4)
    with pytest.raises(RigError, match="name"):
        THENAR.save(tmp_path / "other.toml", name="two\nlines")
    assert not (tmp_path / "other.toml").exists()


def test_what_cannot_be_saved_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RigError, match=r"ends in \.toml; call it rig\.json\.toml"):
        THENAR.save(tmp_path / "rig.json")
    with pytest.raises(RigError, match="cannot write"):
        THENAR.save(tmp_path / "no-folder" / "rig.toml")
    with pytest.raises(RigError, match="corner: unknown key"):
        perturbed(THENAR, ambient_K=200.0).save(tmp_path / "rig.toml")
    assert list(tmp_path.iterdir()) == []


def test_nested_tables_change_the_keys_that_they_name() -> None:
    nested = THENAR.with_(skin={"layer": {"dermis": {"thickness_mm": 1.2}}}, contact={"area_cm2": 4})
    assert nested == THENAR.with_(**{"skin.layer.dermis.thickness_mm": 1.2, "contact.area_cm2": 4})
    assert nested.changes == ("skin.layer.dermis.thickness_mm=1.2", "contact.area_cm2=4")
    again = nested.with_(**{"skin.layer.dermis.thickness_mm": 1.3})
    assert again.changes == ("skin.layer.dermis.thickness_mm=1.3", "contact.area_cm2=4")
    assert THENAR.with_(controller={"kp_A_per_K": 1.0}).controller is not None
    with pytest.raises(RigError, match=r"contact\.area: unknown key; did you mean contact\.area_cm2"):
        THENAR.with_(contact={"area": 4})


def test_a_plate_that_is_warned_of_is_off_in_a_drive_and_not_with_short_steps() -> None:
    def display_C(rig: Rig, rows_Hz: float) -> np.ndarray:
        times = np.arange(0.0, 2.0 + 1e-9, 1.0 / rows_Hz)
        coarse = np.arange(0.0, 2.0 + 1e-9, 0.01)
        amperes = np.interp(times, coarse, 0.5 * np.sin(2.0 * np.pi * coarse) + 0.3 * (coarse > 0.5))
        return simulate_current(Drive(times, amperes), rig, rate_Hz=100.0).display_C

    assert STEP_S == LONGEST_STEP_S
    for stored, least, most in ((0.01, 0.1, 0.3), (0.037, 0.0, 0.03)):
        rig = THENAR.with_(**{"module.cold_plate_J_per_K": stored})
        assert least < np.abs(display_C(rig, 100.0) - display_C(rig, 5000.0)).max() < most


def told_of(key: str, value: float) -> list[str]:
    """What is said of a document that holds this number alone, in a layer of the name that the key has."""
    general, _, layer = key.partition(" of the ")
    inner: object = value
    for part in reversed(general.split(".")):
        if part == "0":
            inner = [inner | {"name": layer or "dermis"} if isinstance(inner, dict) else inner]
        else:
            inner = {part: inner}
    assert isinstance(inner, dict)
    return [each.text for each in unusual_values(inner)]


@pytest.mark.parametrize("key", usual_values())
def test_a_number_is_told_just_outside_of_what_is_usual_and_not_just_inside(key: str) -> None:
    low, high, source = usual_values()[key]
    assert key.partition(" of ")[0] in rig_keys() and (" " in source)
    slack = 1e-6 * (high - low)
    assert not told_of(key, low) + told_of(key, high)
    for value in (low - slack, high + slack):
        (told,) = told_of(key, value)
        assert told.startswith(key.partition(" of ")[0]) and f"usual are {low:g} to {high:g} " in told


@pytest.mark.parametrize(
    ("key", "slip", "likely"),
    [
        ("heat_sink.temperature_C", 104.0, "104 looks like °F, 40 °C"),
        ("contact.resistance_m2K_per_W", 0.54, "0.54 looks like m²·K/kW, 0.00054 m²·K/W"),
        ("contact.area_cm2", 900.0, "900 looks like mm², 9 cm²"),
        ("heat_sink.resistance_K_per_W", 0.0002, "0.0002 looks like K/mW, 0.2 K/W"),
        ("driver.current_limit_A", 0.0015, "check its unit"),
        ("module.hot_plate_J_per_K", 2600.0, "2600 looks like mJ/K, 2.6 J/K"),
        ("ambient.film_W_per_m2K", 0.01, "0.01 looks like kW/(m²·K), 10 W/(m²·K)"),
        ("blood.density_kg_per_m3", 1.06, "1.06 looks like g/cm³, 1060 kg/m³"),
        ("skin.layer.0.thickness_mm", 0.00017, "0.00017 looks like m, 0.17 mm"),
        ("skin.layer.1.perfusion_per_s", 0.075, "0.075 looks like 1/min, 0.00125 1/s"),
        ("skin.cold_receptor_mm", 0.02, "0.02 looks like cm, 0.2 mm"),
        ("skin.warm_receptor_mm", 10.0, "check its unit"),
    ],
)
def test_a_number_in_another_unit_is_taken_and_told_with_that_unit(key: str, slip: float, likely: str) -> None:
    told = [text for text in THENAR.with_(**{key: slip}).warnings if "usual are" in text]
    assert len(told) == 1 and told[0].startswith(key) and told[0].endswith(f"; {likely}")


@pytest.mark.parametrize(
    ("key", "slip", "ends"),
    [
        ("skin.rest_C", 89.6, "at most 45 °C; 89.6 looks like °F, 32 °C"),
        ("driver.current_limit_A", 1500.0, "at most 1000 A; 1500 looks like mA, 1.5 A"),
        ("skin.rest_C", 45.5, "at most 45 °C"),
    ],
)
def test_a_number_that_cannot_be_is_refused_with_the_unit_that_it_may_have(key: str, slip: float, ends: str) -> None:
    with pytest.raises(RigError) as refused:
        THENAR.with_(**{key: slip})
    assert str(refused.value).endswith(ends)


def test_no_number_of_a_shipped_rig_or_module_is_unusual() -> None:
    rigs = [Rig.load(name) for name in rig_names()]
    rigs += [THENAR.with_(**{"module.name": name}) for name in module_names()]
    assert len(rigs) > 10 and not [text for rig in rigs for text in rig.warnings if "usual are" in text]
