"""Export in one call: files as bytes, refusals as data, and a folder that gets all files or none."""

from pathlib import Path

import pytest

from tests.circuit.delivery.one_drive import prepare
from thermicon.circuit import Device, InputError, Rig, export
from thermicon.circuit.delivery.export import ExportError
from thermicon.circuit.delivery.formats import load_format
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library, parse

WARM = load_library("six-icons")["warming-step"]
HOT = parse("cue 1\nicon hot { warm by 16 °C at 3 °C/s; hold for 30 s; return at 3 °C/s }")["hot"]
FAST = parse("cue 1\nset { control skin }\nicon fast { cool by 6 °C at 30 °C/s; return at 3 °C/s }")["fast"]
NAMES = ("contact_resistance", "gain", "seebeck", "conductance", "plates")
RIG = Rig.load("thenar").with_(
    uncertainty={**{f"{name}_relative": 0 for name in NAMES}, "reason": "fewer corners, for a quick test only"}
)


def test_it_gives_the_files_of_prepare_and_pack() -> None:
    result = export(WARM, RIG, "dac-16")
    ready = prepare(WARM, RIG, Device.load("dac-16"), load_format("csv"))
    assert dict(result.files) == pack([ready], load_format("csv"))
    assert result.refused == ()
    assert repr(result).startswith("Export(1 icon on thenar for dac-16 as csv: 2 files, ")


def test_a_set_is_exported_for_the_usual_device_of_a_format(tmp_path: Path) -> None:
    two = list(load_library("six-icons"))[:2]
    result = export(two, RIG, format="setpoint-csv", pause_s=60.0, folder=tmp_path / "new" / "run")
    assert {path.name: path.read_bytes() for path in (tmp_path / "new" / "run").iterdir()} == dict(result.files)
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["run"]
    assert result.device.name == load_format("setpoint-csv").device


def test_refusals_are_data_and_nothing_is_written(tmp_path: Path) -> None:
    result = export([WARM, HOT], RIG, "dac-16")
    assert result.files == {}
    assert {(name, cause.kind) for name, cause in result.refused} >= {("hot", "unsafe")}
    causes = "1 cause" if len(result.refused) == 1 else f"{len(result.refused)} causes"
    assert repr(result).endswith(f": REFUSED: {causes})")
    with pytest.raises(ExportError, match="hot: NOT SAFE"):
        export([WARM, HOT], RIG, "dac-16", folder=tmp_path / "run")
    assert list(tmp_path.iterdir()) == []


def test_force_packs_what_misses_its_target_but_never_what_is_unsafe() -> None:
    assert export(FAST, RIG, "dac-16").files == {}
    forced = export(FAST, RIG, "dac-16", force=True)
    assert {cause.kind for _, cause in forced.refused} == {"unreachable"}
    assert b'"forced": true' in forced.files["fast.json"]
    assert export(HOT, RIG, "dac-16", force=True).files == {}


def test_a_folder_with_files_in_it_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(ExportError, match=r"notes\.txt already exists and was kept; give a new or empty folder"):
        export(WARM, RIG, "dac-16", folder=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
    with pytest.raises(ExportError, match="cannot write"):
        export(WARM, RIG, "dac-16", folder=tmp_path / "notes.txt" / "run")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"icons": []}, "no icon to export"),
        ({"format": "cvs"}, "did you mean csv"),
        ({"device": "dac-61"}, "did you mean"),
    ],
)
def test_what_cannot_be_played_is_an_input_error(changes: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        export(**{"icons": WARM, "rig": "thenar", **changes})  # type: ignore[arg-type]
