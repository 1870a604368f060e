"""Rigs written to files read back as equal rigs, and changes may be given as nested tables."""

from pathlib import Path

import pytest

from thermicon.circuit import Rig
from thermicon.circuit.rig.corner import perturbed
from thermicon.circuit.rig.rig import rig_names
from thermicon.circuit.rig.rigfile import RigError

THENAR = Rig.load("thenar")


@pytest.mark.parametrize("name", rig_names())
def test_a_saved_rig_reads_back_as_an_equal_rig(name: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    Rig.load(name).save(path)
    assert Rig.load(path).document == Rig.load(name).document
    assert Rig.load(path) == Rig.load(name)


def test_changes_probes_sheets_and_odd_texts_survive(tmp_path: Path) -> None:
    sheets = [{"i_max_A": 6.4, "v_max_V": 14.4, "dt_max_K": 66.0, "t_hot_C": 25.0}]
    probe = [{"name": "pad", "place": "insulated skin", "lag_s": 0.1}]
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
    with pytest.raises(RigError, match=r"ambient\.temperature_C"):
        perturbed(THENAR, ambient_K=200.0).save(tmp_path / "rig.toml")
    assert list(tmp_path.iterdir()) == []


def test_nested_tables_change_the_keys_that_they_name() -> None:
    nested = THENAR.with_(skin={"layer": {"dermis": {"thickness_mm": 1.2}}}, contact={"area_cm2": 4})
    assert nested == THENAR.with_(**{"skin.layer.dermis.thickness_mm": 1.2, "contact.area_cm2": 4})
    assert nested.changes == ("skin.layer.dermis.thickness_mm=1.2", "contact.area_cm2=4")
    assert THENAR.with_(controller={"kp_A_per_K": 1.0}).controller is not None
    with pytest.raises(RigError, match=r"contact\.area: unknown key; did you mean contact\.area_cm2"):
        THENAR.with_(contact={"area": 4})


def test_a_folder_does_not_hide_a_shipped_rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "thenar").mkdir()
    (tmp_path / "mine").mkdir()
    assert Rig.load("thenar") == THENAR
    with pytest.raises(RigError, match="is a directory"):
        Rig.load("mine")
