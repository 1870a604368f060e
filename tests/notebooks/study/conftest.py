"""A small study on a rig that is known exactly."""

import csv
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.circuit.surerig import SURE
from thermicon.notebooks.cli.main import app

CUES = """cue 1
set two { site thenar; control display; baseline 32 °C }
icon dip means "a dip" { cool by 2 °C at 2 °C/s; hold for 1 s; return at 2 °C/s }
icon glow means "a glow" { warm by 2 °C at 2 °C/s; hold for 1 s; return at 2 °C/s }
icon burn means "a burn" { warm by 9 °C at 3 °C/s; hold for 20 s; return at 3 °C/s }
"""
CHANGES = "rig_changes = [" + ", ".join(f"'{change}'" for change in SURE[1::2]) + "]"
QUICK = f"""format = 1
name = "quick"
[stimuli]
set = "two.cue"
icons = ["dip", "glow"]
{CHANGES}
[participants]
labels = ["A", "B"]
[trials]
repetitions = 2
blocks = 2
[timing]
gap_s = 10
landing_s = 30
break_s = 40
"""

Runner = Callable[..., subprocess.CompletedProcess[str]]


def write_study(folder: Path, text: str) -> Path:
    """A study file with its icons beside it."""
    (folder / "two.cue").write_text(CUES, encoding="utf-8")
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


def make(folder: Path, text: str) -> Path:
    """The folder of a study."""
    out = folder / "out"
    result = CliRunner().invoke(app, ["study", str(write_study(folder, text)), "-o", str(out)])
    assert result.exit_code == 0, result.output
    return out


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the small study."""
    return make(tmp_path_factory.mktemp("quick"), QUICK)


def run_script(folder: Path, output: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the script of a study in a process of its own."""
    command = [sys.executable, folder / "run_study.py", "--output", output, *arguments]
    return subprocess.run(list(map(str, command)), capture_output=True, encoding="utf-8", timeout=120, check=False)


def rows_of(path: Path, delimiter: str = ",") -> list[dict[str, str]]:
    """Rows of a table."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file, delimiter=delimiter))


@pytest.fixture
def script(quick: Path, tmp_path: Path) -> Runner:
    """``script("--participant", "A", "--simulate")`` runs the script of the small study."""
    return lambda *arguments, output=tmp_path: run_script(quick, output, *arguments)
