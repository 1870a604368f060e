"""The command line in this process (quick) or in one of its own (true)."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from typer.testing import CliRunner

from thermicon.circuit import Rig
from thermicon.notebooks.cli.main import app

posix = pytest.mark.skipif(sys.platform == "win32", reason="signals, pipes and paths work differently there")
TWO_ICONS = """cue 1

set two "Two for a test" {
  site thenar
  control display
  baseline 32 °C
}

icon cool-step { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }
icon warm-step { warm by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
"""


@dataclass(frozen=True)
class Said:
    """What a command left behind."""

    exit_code: int
    stdout: str
    stderr: str


class Cli:
    """``cli("check", "a.cue")`` runs a command, ``cli.good("check", "a.cue")`` one that has to end well."""

    def __init__(self, run: Callable[..., Said]) -> None:
        self.run = run

    def __call__(self, *arguments: object, **more: Path) -> Said:
        return self.run(*(str(each) for each in arguments), **more)

    def good(self, *arguments: object, **more: Path) -> Said:
        said = self(*arguments, **more)
        assert said.exit_code == 0, said.stderr
        return said


@pytest.fixture
def cli() -> Cli:
    """Runs commands in this process."""

    def run(*arguments: str) -> Said:
        result = CliRunner(env={"COLUMNS": "80", "NO_COLOR": "1"}).invoke(app, arguments)
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return Said(result.exit_code, result.stdout, result.stderr)

    return Cli(run)


@pytest.fixture
def process() -> Cli:
    """Runs commands as a person would, each in a process of its own."""

    def run(*arguments: str, cwd: Path | None = None) -> Said:
        command = [sys.executable, "-m", "thermicon.notebooks.cli.main", *arguments]
        done = subprocess.run(command, capture_output=True, encoding="utf-8", cwd=cwd, timeout=120, check=False)
        return Said(done.returncode, done.stdout, done.stderr)

    return Cli(run)


@pytest.fixture(scope="session")
def rig() -> Rig:
    """The default rig."""
    return Rig.load("thenar")


@pytest.fixture
def two(tmp_path: Path) -> Path:
    """A file with two icons that the default rig plays with ease."""
    path = tmp_path / "two.cue"
    path.write_text(TWO_ICONS, encoding="utf-8")
    return path
