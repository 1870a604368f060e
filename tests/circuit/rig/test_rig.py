"""Rigs at the door: what is shipped, what can be changed, and how a bad rig is refused."""

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

from thermicon.circuit import Rig
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rigfile import RigError

THENAR = Rig.load("thenar")


def test_shipped_rigs_load_and_the_default_comes_first() -> None:
    assert rig_names() == ("thenar", "fingertip", "forearm", "hand-dorsum", "shani2021", "tcs2")
    assert [Rig.load(name).name for name in rig_names()] == list(rig_names())


@pytest.mark.parametrize("name", rig_names())
def test_every_number_of_a_shipped_rig_has_a_source(name: str) -> None:
    document = json.loads(Rig.load(name).document)
    sources = document["source"]

    def has_source(*keys: str) -> bool:
        return any(key in sources for key in keys)

    for table in ("module", "heat_sink", "driver", "thermode", "contact", "ambient", "blood"):
        for key in document.get(table, {}):
            assert has_source(table, f"{table}.{key}"), f"{table}.{key} has no source"
    for key in document["skin"]:
        assert key in ("site", "layer") or has_source(f"skin.{key}"), f"skin.{key} has no source"
    for layer in document["skin"]["layer"]:
        assert has_source(f"skin.layer.{layer['name']}")


def test_repr_is_one_line_with_units() -> None:
    assert repr(THENAR) == ("Rig('thenar', thenar, 9 cm², skin rests at 32.0 °C, blood 34.58 °C, driver -1.5 … 1.5 A)")


def test_a_rig_from_a_file_equals_the_shipped_one(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text((Path(__file__).parents[3] / "circuit/rigs/thenar.toml").read_text("utf-8"), "utf-8")
    assert Rig.load(path) == THENAR
    assert Rig.load(str(path)).column.depth_m.tolist() == THENAR.column.depth_m.tolist()


def test_with_changes_one_key_and_keeps_the_rest() -> None:
    small = THENAR.with_(**{"contact.area_cm2": 4})
    assert small.contact.area_m2 == pytest.approx(4e-4)
    assert small != THENAR
    assert THENAR.contact.area_m2 == pytest.approx(9e-4)
    assert small.with_(**{"contact.area_cm2": 9.0}) == THENAR
    assert THENAR.with_(**{"skin.layer.dermis.thickness_mm": 2}).skin.layers[2].thickness_m == pytest.approx(2e-3)
    assert THENAR.with_(**{"driver.current_min_A": 0}).driver.current_min_A == 0
    assert THENAR.with_(**{"skin.deep_C": 37}).blood_C == 37


def test_settings_from_the_command_line_are_toml_values() -> None:
    rig = THENAR.with_set(["contact.area_cm2=4", "skin.site = forearm", "skin.layer.0.thickness_mm=0.022"])
    assert (rig.contact.area_m2, rig.site) == (pytest.approx(4e-4), "forearm")
    assert THENAR.with_set([]) is THENAR


def test_another_site_alone_leaves_the_skin_and_says_so() -> None:
    (warning,) = THENAR.with_set(["skin.site=forearm"]).warnings
    assert warning.startswith("skin.site = forearm changes the name of the site")
    assert (
        "layers and receptor depths are still those of rig thenar: use --rig forearm or --rig tcs2, or set" in warning
    )
    (unknown,) = THENAR.with_set(["skin.site=sole"]).warnings
    assert "use a rig file of that site, or set skin.layer" in unknown
    assert THENAR.with_set(["skin.site=forearm", "skin.layer.0.thickness_mm=0.022"]).warnings == ()
    assert THENAR.with_set(["skin.site=thenar"]).warnings == ()
    assert Rig.load("shani2021").with_set(["contact.area_cm2=4"]).warnings == Rig.load("shani2021").warnings


@pytest.mark.parametrize("setting", ["contact.area_cm2", "=4", "contact.area_cm2="])
def test_a_setting_has_a_form(setting: str) -> None:
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


def test_files_that_are_no_rig(tmp_path: Path) -> None:
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
    with pytest.raises(RigError, match="this is a directory, not a rig file"):
        Rig.load(tmp_path)
    with pytest.raises(RigError, match="no such rig file"):
        Rig.load(tmp_path / "absent.toml")
    with pytest.raises(RigError, match=r"thena: no such rig; did you mean thenar\?"):
        Rig.load("thena")


def test_an_unusual_rig_warns() -> None:
    assert THENAR.warnings == ()
    assert Rig.load("shani2021").warnings == (
        "skin at rest loses 1046 W/m², over the 150 W/m² that bare skin in room air can lose",
    )
    warm_air = THENAR.with_(**{"ambient.temperature_C": 36.0})
    assert "is colder than the resting surface at 32 °C" in warm_air.warnings[0]


def test_a_changed_rig_knows_what_was_changed() -> None:
    assert THENAR.changes == ()
    once = THENAR.with_(**{"contact.area_cm2": 4, "driver.current_limit_A": 1.0})
    assert once.changes == ("contact.area_cm2=4", "driver.current_limit_A=1.0")
    assert once.with_(**{"contact.area_cm2": 5}).changes == ("contact.area_cm2=5", "driver.current_limit_A=1.0")


def test_blood_that_no_limb_has_is_told() -> None:
    hot = THENAR.with_(**{"skin.rest_C": 38.0})
    assert hot.warnings[-1].endswith("of living limbs; check skin.rest_C and the ambient")
    assert "blood at 42.5" in hot.warnings[-1]


MESSAGES = tomllib.loads(Path(__file__).with_name("messages.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", MESSAGES["refused"], ids=lambda case: case["words"][:40])
def test_a_change_that_cannot_be_is_refused_in_words(case: dict[str, Any]) -> None:
    with pytest.raises(RigError, match=case["words"]):
        Rig.load(case.get("rig", "thenar")).with_(**case["changes"])


@pytest.mark.parametrize("case", MESSAGES["warned"], ids=lambda case: case["words"][:40])
def test_limits_that_make_no_sense_together_are_warned_of(case: dict[str, Any]) -> None:
    assert THENAR.with_(**case["changes"]).warnings == (case["words"],)


def test_a_key_that_is_taken_away_is_missed() -> None:
    with pytest.raises(RigError, match=r"^rig thenar: module\.resistance_ohm is missing; add it, in Ω$"):
        THENAR.with_(**{"module.resistance_ohm": None})
