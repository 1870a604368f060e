"""The default rig of a set's site."""

import tomllib
from pathlib import Path

import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import read_cue
from thermicon.notebooks import Workbench
from thermicon.notebooks.loading import warn_of_rig
from thermicon.notebooks.messages import be_quiet
from thermicon.notebooks.study.build import read_materials
from thermicon.perception import rank

from ..conftest import TWO_ICONS, Cli

STUDY = 'format = 1\nname = "s"\n[stimuli]\nset = "tip.cue"\n[participants]\ncount = 1\n[trials]\nrepetitions = 1\n'


@pytest.fixture
def tip(tmp_path: Path) -> Path:
    """Two icons for the fingertip."""
    file = tmp_path / "tip.cue"
    file.write_text(TWO_ICONS.replace("thenar", "fingertip"), encoding="utf-8")
    return file


def test_a_set_is_played_on_the_rig_of_its_site(cli: Cli, tip: Path) -> None:
    (tip.parent / "study.toml").write_text(STUDY, encoding="utf-8")
    assert simulate(read_cue(tip)["cool-step"]).rig_name == "fingertip"
    assert rank(tip, people=2, parameters=0).to_json() == rank(tip, "fingertip", people=2, parameters=0).to_json()
    assert "on fingertip" in repr(Workbench(tip))
    assert read_materials(tip.parent / "study.toml").rig.name == "fingertip"
    said = cli.good("simulate", tip, "--icon", "cool-step")
    assert said.stderr.count("on the fingertip rig, since the set is for that site; --rig names another") == 1
    named = cli.good("simulate", tip, "--icon", "cool-step", "--rig", "fingertip").stdout
    assert said.stdout.partition("Next: ")[0] == named.partition("Next: ")[0]
    other = cli.good("rank", tip, "--rig", "thenar", "--people", 2, "--intervals", 0)
    assert "tip.cue is for the site fingertip, the rig thenar is for thenar" in other.stderr
    assert "--rig thenar" in other.stdout  # and stays in the command that comes next


def test_a_site_without_a_rig_is_played_on_the_thenar_with_a_warning(cli: Cli, tip: Path) -> None:
    tip.write_text(TWO_ICONS.replace("thenar", "cheek"), encoding="utf-8")
    said = cli.good("simulate", tip, "--icon", "cool-step")
    assert "is for the site cheek, the rig thenar is for thenar" in said.stderr


def test_a_copy_of_a_rig_with_changes_is_called_by_its_file(cli: Cli, tmp_path: Path) -> None:
    copy = tmp_path / "hand.toml"
    cli.good("list", "--copy", "fingertip", copy, "--set", "module.name=TEC1-12706", "--set", "contact.area_cm2=2")
    rig, said = Rig.load(copy), tomllib.loads(copy.read_text(encoding="utf-8"))
    assert (said["title"], "module" in said["source"]) == ("fingertip with other module.name, contact.area_cm2", False)
    assert (
        said["source"]["contact.area_cm2"]
        == "changed, not as in rig fingertip"
        != said["source"]["contact.resistance_m2K_per_W"]
    )
    assert (rig.name, rig.site, round(1e4 * rig.contact.area_m2, 6)) == ("hand", "fingertip", 2.0)
    assert "hand.toml already exists" in cli("list", "--copy", "fingertip", copy, "--set", "contact.area_cm2=3").stderr
    assert "six-icons is none" in cli("list", "--copy", "six-icons", tmp_path / "a.cue", "--set", "a.b=3").stderr


def test_on_a_terminal_a_rig_is_warned_of_once_and_briefly_but_for_safety(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("THERMICON_CACHE", str(tmp_path))
    large = Rig.load("thenar").with_set(["module.name=TEC1-12706", "contact.area_cm2=40", "skin.rest_C=41"])
    loose, brief = "itself above the soft limit", "the contact is larger than the module's face"

    def said(terminal: bool = True) -> str:
        monkeypatch.setattr("sys.stderr.isatty", lambda: terminal)
        warn_of_rig(large)
        return capsys.readouterr().err

    first, second = said(), said()
    assert first.count(brief) == 1 and "contact.area_cm2 = 40" not in first and "thermicon -v" in first
    assert brief not in second and loose in first and loose in second
    monkeypatch.chdir(tmp_path)  # another folder
    assert brief in said()
    assert "contact.area_cm2 = 40" in said(terminal=False)
    be_quiet(False, verbose=True)
    assert "contact.area_cm2 = 40" in said()
    be_quiet(False)
