"""Versions, requirements and extras, read from the metadata of distributions that these tests write."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from thermicon.notebooks.doctor import packages
from thermicon.notebooks.doctor.finding import Finding

ROOT = Path(__file__).resolve().parents[3]
ONLY_FOR_DEVELOPERS = {"test", "docs"}

Distribution = Callable[..., None]


@pytest.fixture
def distribution(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Distribution:
    """``distribution("a", "1.0", "b>=2")`` puts a distribution on the path that hides an installed one of that name."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def write(name: str, version: str, *requires: str, python: str = ">=3.11", extras: tuple[str, ...] = ()) -> None:
        info = tmp_path / f"{name}-{version}.dist-info"
        info.mkdir()
        lines = ["Metadata-Version: 2.1", f"Name: {name}", f"Version: {version}", f"Requires-Python: {python}"]
        lines += [f"Provides-Extra: {extra}" for extra in extras] + [f"Requires-Dist: {each}" for each in requires]
        (info / "METADATA").write_text("\n".join(lines) + "\n", encoding="utf-8")

    return write


def test_a_finding_is_one_line_with_its_cure() -> None:
    with pytest.raises(ValueError, match="state 'bad' is not one of ok, note, fault"):
        Finding("x", "bad", "y")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="x: fault without a cure"):
        Finding("x", "fault", "y")
    with pytest.raises(ValueError, match="x: ok with a cure"):
        Finding("x", "ok", "y", "z")
    with pytest.raises(ValueError, match="x: a finding is one line"):
        Finding("x", "ok", "y\nz")


def test_missing_and_old_packages_are_faults_with_the_command_that_cures_them(distribution: Distribution) -> None:
    distribution("thermicon", "9", "warm-lib>=2", "cold_lib>=1.5", "thermicon-none>=3; extra == 'page'")
    distribution("cold_lib", "1.4")
    missing, old = packages.check_required()
    assert (missing.state, missing.text) == ("fault", "thermicon needs warm-lib>=2, not installed")
    assert missing.cure == f'{sys.executable} -m pip install "warm-lib>=2"'
    assert old.text == "thermicon needs cold_lib>=1.5, 1.4 is installed"


def test_packages_that_do_not_fit_each_other_are_faults(distribution: Distribution) -> None:
    distribution("thermicon", "9", "cold_lib>=1", "warm_lib[fast]>=1")
    distribution("cold_lib", "1.4", "warm_lib<2")
    distribution("warm_lib", "2.1", "quick_lib; extra == 'fast'", "slow_lib; extra == 'slow'", extras=("fast", "slow"))
    texts = [finding.text for finding in packages.check_required()]
    assert texts == ["cold_lib needs warm_lib<2, 2.1 is installed", "warm_lib needs quick_lib, not installed"]


def test_a_circle_of_requirements_ends(distribution: Distribution) -> None:
    distribution("thermicon", "9", "cold_lib")
    distribution("cold_lib", "1", "warm_lib")
    distribution("warm_lib", "1", "cold_lib")
    (finding,) = packages.check_required()
    assert finding.state == "ok"


def test_an_extra_that_is_missing_is_a_note_with_what_it_is_for(
    distribution: Distribution, monkeypatch: pytest.MonkeyPatch
) -> None:
    distribution("thermicon", "9", "no_lib>=3; extra == 'page'", "cold_lib>=1; extra == 'study'", "other_lib")
    distribution("cold_lib", "0.9")
    monkeypatch.setattr(packages, "EXTRAS", {"page": "pages", "study": "studies", "parquet": "nothing at all"})
    page, study, parquet = packages.check_extras()
    assert (page.state, page.text) == ("note", "not installed, for pages")
    assert page.cure == f'{sys.executable} -m pip install "thermicon[page]"'
    assert (study.state, study.text) == ("note", "thermicon needs cold_lib>=1, 0.9 is installed, for studies")
    assert parquet.state == "ok"


def test_every_extra_has_a_purpose() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(project["optional-dependencies"]) - ONLY_FOR_DEVELOPERS == set(packages.EXTRAS)


def test_a_python_that_is_too_old_or_too_new_is_a_fault(distribution: Distribution) -> None:
    distribution("thermicon", "9", python=">=3.98,<3.99")
    (finding,) = packages.check_python()
    assert finding.state == "fault"
    assert "but thermicon requires <3.99,>=3.98" in finding.text or "requires >=3.98,<3.99" in finding.text
    assert finding.cure is not None
    assert "make an environment with a Python" in finding.cure


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


def test_a_second_installation_is_noted(distribution: Distribution) -> None:
    distribution("thermicon", "9")
    (finding,) = packages.check_program()
    assert finding.state == "note"
    assert "installed " in finding.text
