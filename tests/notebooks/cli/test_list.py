"""``thermicon list``: what is shipped, a paragraph for the methods with its sources, and copies to start from."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.circuit import Device, Rig
from thermicon.icons import read_cue
from thermicon.icons.files.shipped import load_library

Cli = Callable[..., Any]


def test_a_paragraph(cli: Cli) -> None:
    said = cli("list", "--cite", "cooling-step-skin")
    assert (said.exit_code, said.stderr) == (0, "")
    assert said.stdout.startswith("One thermal icon of the set “A cooling step at the skin surface” was used.")
    assert said.stdout.count("\n") == 1


def test_a_paragraph_with_a_rig(cli: Cli) -> None:
    said = cli("list", "--cite", "cooling-step-skin", "--rig", "forearm")
    assert said.exit_code == 0
    assert "The rig was modelled as follows: forearm: 30 mm module on the forearm" in said.stdout
    assert "warning: cooling-step-skin is for the site thenar, the rig forearm is for forearm" in said.stderr


def test_bibtex(cli: Cli) -> None:
    said = cli("list", "--bibtex", "--cite", "cooling-step-skin")
    assert (said.exit_code, said.stderr) == (0, "")
    assert said.stdout.startswith("@inproceedings{shani-lineykin-2021,\n")
    assert said.stdout.endswith("}\n")
    assert "note = {details unverified: name of the conference}" in said.stdout


def test_bibtex_has_no_rig(cli: Cli) -> None:
    said = cli("list", "--bibtex", "--cite", "six-icons", "--rig", "thenar")
    assert said.exit_code == 2
    assert "'--rig': applies to the paragraph of --cite; BibTeX" in " ".join(said.stderr.split())


def test_a_file_that_is_wrong(cli: Cli, two: Path) -> None:
    two.write_text("cue 1; icon a { hold for 1 }", encoding="utf-8")
    said = cli("list", "--cite", two)
    assert (said.exit_code, said.stdout) == (1, "")
    assert "E102 missing unit" in said.stderr


def test_a_rig_in_a_paragraph_has_its_driver_and_no_warnings(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "hand.toml"
    Rig.load("fingertip").with_(module={"name": "TEC1-12706"}, driver={"current_limit_A": 2.0}).save(path)
    said = cli("list", "--cite", "cooling-step-skin", "--rig", path)
    assert "; driver −2 … 2 A, 15 V at most, updated at 100 Hz. The icons" in said.stdout
    assert "follows: fingertip; site fingertip" in said.stdout
    assert "30 mm module" not in said.stdout
    assert "warning" not in said.stdout
    assert "data sheets" not in said.stderr


@pytest.mark.parametrize("what", ["icons", "rigs", "devices", "formats"])
def test_each_kind_is_listed(cli: Cli, what: str) -> None:
    said = cli("list", what)
    assert (said.exit_code, said.stderr) == (0, "")
    one = {"icons": "six-icons", "rigs": "thenar", "devices": "qst-tcs2", "formats": "csv"}[what]
    assert one in said.stdout
    assert said.stdout in cli("list").stdout


@pytest.mark.parametrize(("name", "ending"), [("six-icons", ".cue"), ("forearm", ".toml"), ("dac-16", ".toml")])
def test_a_copy_reads_as_what_was_copied_and_replaces_nothing(cli: Cli, tmp_path: Path, name: str, ending: str) -> None:
    path = tmp_path / f"mine{ending}"
    said = cli("list", "--copy", name, path)
    assert (said.exit_code, said.stdout, said.stderr) == (0, "", f"wrote {path}\n")
    if ending == ".cue":
        assert read_cue(path).content_hash == load_library(name).content_hash
    else:
        kind: Any = Rig if name == "forearm" else Device
        assert kind.load(path) == kind.load(name)
    before = path.read_bytes()
    again = cli("list", "--copy", name, path)
    assert (again.exit_code, again.stderr) == (1, f"{path} already exists and was kept; give another name\n")
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (("cakes",), 2, "'cakes' is not one of icons, rigs, devices, formats"),
        (("--bibtex",), 2, "'--bibtex': belongs to --cite FILE"),
        (("rigs", "--cite", "six-icons"), 2, "ask for one of them"),
        (("--copy", "thenr", "a.toml"), 2, "'thenr' is not shipped; did you mean thenar?"),
        (("--copy", "thenar", "a.cue"), 1, "a copy of it is written as .toml, not .cue"),
    ],
)
def test_what_cannot_be_listed(cli: Cli, words: tuple[str, ...], code: int, told: str) -> None:
    said = cli("list", *words)
    assert (said.exit_code, said.stdout) == (code, "")
    assert told in " ".join(said.stderr.split())


def test_help_names_what_can_be_listed(cli: Cli) -> None:
    assert "--copy" in cli("list", "--help").stdout
