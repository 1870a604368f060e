"""Versions, requirements and extras: what pip says, and what the metadata of distributions say."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from thermicon.notebooks.cli import packages

ROOT = Path(__file__).resolve().parents[3]
ONLY_FOR_DEVELOPERS = {"test", "docs"}


@pytest.mark.parametrize(
    ("said", "code", "states", "words"),
    [
        ("No broken requirements found.", 0, ["ok"], "every required package is there and fits the others (numpy "),
        ("thermicon 9 requires warm-lib, which is not installed.", 1, ["fault"], "requires warm-lib, which is not"),
        ("cold 1 has requirement b<2, but you have b 2.1.\nthermicon 9 requires c.", 1, ["note", "fault"], "b 2.1"),
        ("", 1, ["note"], "since pip check says: No module named pip"),
    ],
)
def test_packages_are_what_pip_says(
    said: str, code: int, states: list[str], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = subprocess.CompletedProcess([], code, said, "No module named pip\n")
    monkeypatch.setattr(packages, "run_program", lambda *_: run)
    found = list(packages.check_required())
    assert [each.state for each in found] == states
    assert words in found[0].text


def test_an_extra_that_is_missing_is_a_note_with_what_it_is_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packages, "EXTRAS", {"page": ("no-lib", "pages"), "study": ("numpy", "studies")})
    page, study = packages.check_extras()
    assert (page.state, page.text) == ("note", "not installed, for pages")
    assert page.cure == f'{sys.executable} -m pip install "thermicon[page]"'
    assert (study.state, study.text) == ("ok", "for studies")


def test_every_extra_has_its_package_and_a_purpose() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = {name: brings for name, brings in project["optional-dependencies"].items() if name in packages.EXTRAS}
    assert set(project["optional-dependencies"]) - ONLY_FOR_DEVELOPERS == set(packages.EXTRAS)
    assert all(brings[0].startswith(packages.EXTRAS[name][0]) for name, brings in extras.items())


def test_a_program_without_installation_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packages, "distributions", lambda **_: [])
    (finding,) = packages.check_program()
    assert (finding.state, finding.check) == ("fault", "thermicon")
    assert "is not installed" in finding.text
    assert finding.cure is not None
    assert finding.cure.endswith("-m pip install -e .")


def test_a_folder_that_hides_the_installed_program_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packages, "installed_folders", lambda: ["/elsewhere/thermicon/notebooks"])
    (finding,) = packages.check_program()
    assert finding.state == "fault"
    assert finding.text.endswith("which hides the installed /elsewhere/thermicon/notebooks")
    assert finding.cure == "start Python in another folder, or with -P"


def test_a_second_installation_is_noted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    info = tmp_path / "thermicon-9.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: thermicon\nVersion: 9\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    (finding,) = packages.check_program()
    assert finding.state == "note"
    assert "installed " in finding.text
