"""``thermicon list`` and ``convert``: shipped files with copies to start from, icons in other forms."""

import re
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.notebooks.conftest import Cli
from thermicon.circuit import Device, Rig
from thermicon.icons import load_library, read_cue, to_json
from thermicon.notebooks.study.study_file import study_text


@pytest.mark.parametrize("what", ["icons", "rigs", "modules", "devices", "formats"])
def test_each_kind_is_listed_within_80_columns(cli: Cli, what: str) -> None:
    said = cli("list", what)
    assert (said.exit_code, said.stderr) == (0, "")
    one = {"icons": "six-icons", "rigs": "thenar", "modules": "CP60340", "devices": "qst-tcs2", "formats": "csv"}[what]
    assert one in said.stdout
    assert said.stdout in cli("list").stdout
    assert max(len(line) for line in said.stdout.splitlines()) <= 80


def test_ports_have_maker_and_number_and_are_listed_when_asked_for(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    from serial.tools import list_ports
    from serial.tools.list_ports_common import ListPortInfo

    board = ListPortInfo("/dev/ttyACM0")
    board.manufacturer, board.serial_number = "Arduino", "7553"
    monkeypatch.setattr(list_ports, "comports", lambda: [board])
    assert re.search(r"/dev/ttyACM0 +Arduino +– +7553\n", cli("list", "ports").stdout)
    monkeypatch.setattr(list_ports, "comports", list)
    assert cli("list", "ports").stdout == "no serial port; a board is one once it is plugged in\n"
    monkeypatch.setitem(sys.modules, "serial.tools.list_ports", None)
    said = cli("list", "ports")
    assert (said.exit_code, "pip install pyserial" in said.stderr) == (1, True)
    assert "ttyACM0" not in cli("list").stdout


def test_the_figures_of_a_module_stand_below_their_names(cli: Cli) -> None:
    """CP60340 as its data sheet has it: 6 A, 8.6 V, 30 W and 75 K with the hot side at 50 °C."""
    head, *rows = cli("list", "modules").stdout.splitlines()
    (row,) = (row for row in rows if row.startswith("CP60340"))
    assert head.endswith("hot °C   Imax A   Vmax V   Qmax W   ΔTmax K")
    assert row.split()[-5:] == ["50", "6", "8.6", "30", "75"]


@pytest.mark.parametrize(
    ("name", "ending"), [("six-icons", ".cue"), ("forearm", ".toml"), ("dac-16", ".toml"), ("study", ".toml")]
)
def test_a_copy_reads_as_what_was_copied_and_replaces_nothing(cli: Cli, tmp_path: Path, name: str, ending: str) -> None:
    path = tmp_path / f"mine{ending}"
    said = cli("list", "--copy", name, path)
    written, following = said.stderr.splitlines()
    assert (said.exit_code, said.stdout, written) == (0, "", f"wrote {path}")
    assert following.startswith("Next: ") and str(path) in following
    if ending == ".cue":
        assert read_cue(path).content_hash == load_library(name).content_hash
    elif name == "study":
        assert study_text(path) == study_text("example")
    else:
        kind: Any = Rig if name == "forearm" else Device
        assert kind.load(path) == kind.load(name)
    before = path.read_bytes()
    again = cli("list", "--copy", name, path)
    assert (again.exit_code, again.stderr) == (1, f"{path} already exists and was kept; give another name\n")
    assert path.read_bytes() == before


def test_a_set_is_written_as_json_and_as_cue_text_over_what_was_there(cli: Cli, tmp_path: Path) -> None:
    as_json, as_cue = tmp_path / "six.json", tmp_path / "six.cue"
    as_json.write_text("old")
    said = cli("convert", "six-icons", "-o", as_json)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == f"wrote {as_json}: 6 icons (replaced what was there)\n"
    assert as_json.read_text(encoding="utf-8") == to_json(load_library("six-icons"))
    cli.good("convert", "six-icons", "-o", as_cue)
    assert as_cue.read_text(encoding="utf-8") == str(load_library("six-icons"))


def test_a_recording_becomes_an_icon(cli: Cli, tmp_path: Path) -> None:
    path, out = tmp_path / "dip.csv", tmp_path / "dip.cue"
    path.write_text("time_s,a,b\n0,32.1,9\n2,26,9\n4,26.04,9\n6,25.97,9\n8,32.1,9\n", encoding="utf-8")
    options = ("--tolerance", "0.2", "--name", "cold", "--column", "a", "--control", "skin")
    said = cli("convert", path, "-o", out, *options)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == f"cold: 4 corners, 8 s\nwrote {out}: 1 icon\n"
    (icon,) = read_cue(out)
    assert (icon.name, icon.context.control) == ("cold", "skin")
    assert min(icon.corners().value) == pytest.approx(26, abs=0.2)
    cli.good("convert", path, "-o", tmp_path / "dip.json", *options)
    assert (tmp_path / "dip.json").read_text(encoding="utf-8") == to_json(read_cue(out))
