"""``thermicon cite``: a paragraph for the methods, and the sources."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from thermicon.circuit import Rig

Cli = Callable[..., Any]


def test_a_paragraph(cli: Cli) -> None:
    said = cli("cite", "cooling-step-skin")
    assert (said.exit_code, said.stderr) == (0, "")
    assert said.stdout.startswith("One thermal icon of the set “A cooling step at the skin surface” was used.")
    assert said.stdout.count("\n") == 1


def test_a_paragraph_with_a_rig(cli: Cli) -> None:
    said = cli("cite", "cooling-step-skin", "--rig", "forearm")
    assert said.exit_code == 0
    assert "The rig was modelled as follows: forearm: 30 mm module on the forearm" in said.stdout
    assert "warning: cooling-step-skin is for the site thenar, the rig forearm is for forearm" in said.stderr


def test_bibtex(cli: Cli) -> None:
    said = cli("cite", "--bibtex", "cooling-step-skin")
    assert (said.exit_code, said.stderr) == (0, "")
    assert said.stdout.startswith("@inproceedings{shani-lineykin-2021,\n")
    assert said.stdout.endswith("}\n")
    assert "note = {details unverified: name of the conference}" in said.stdout


def test_bibtex_has_no_rig(cli: Cli) -> None:
    said = cli("cite", "--bibtex", "six-icons", "--rig", "thenar")
    assert said.exit_code == 2
    assert "'--rig': applies to the paragraph; BibTeX" in " ".join(said.stderr.split())


def test_a_file_that_is_wrong(cli: Cli, two: Path) -> None:
    two.write_text("cue 1; icon a { hold for 1 }", encoding="utf-8")
    said = cli("cite", two)
    assert (said.exit_code, said.stdout) == (1, "")
    assert "E102 missing unit" in said.stderr


def test_a_rig_in_a_paragraph_has_its_driver_and_no_warnings(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "hand.toml"
    Rig.load("fingertip").with_(module={"name": "TEC1-12706"}, driver={"current_limit_A": 2.0}).save(path)
    said = cli("cite", "cooling-step-skin", "--rig", path)
    assert "; driver −2 … 2 A, 15 V at most, updated at 100 Hz. The icons" in said.stdout
    assert "follows: fingertip; site fingertip" in said.stdout
    assert "30 mm module" not in said.stdout
    assert "warning" not in said.stdout
    assert "data sheets" not in said.stderr
