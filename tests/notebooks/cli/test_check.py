"""``thermicon check``: one line a file, and quick."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]
HEAVY = {"numba", "numpy", "pandas", "matplotlib", "scipy", "IPython", "ipywidgets", "rich", "tqdm"}


def test_one_line_a_file(cli: Cli, two: Path) -> None:
    said = cli("check", two)
    assert (said.exit_code, said.stderr) == (0, "")
    assert said.stdout == "two.cue: 2 icons, 6–8 s, 26–36 °C, steepest 3 °C/s\n"


def test_several_files_and_a_shipped_set(cli: Cli, two: Path) -> None:
    said = cli("check", two, "six-icons")
    assert said.exit_code == 0
    first, second = said.stdout.splitlines()
    assert first.startswith("two.cue: 2 icons")
    assert second.startswith("six-icons: 6 icons")


def test_a_set_by_current_is_told_in_amperes(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "amps.cue"
    path.write_text(
        "cue 1\nset amps { control current }\n"
        "icon a {\n  to 0.5 A at 1 A/s\n  hold for 1 s\n  to -0.25 A at 0.5 A/s\n  return at 0.5 A/s\n}\n",
        encoding="utf-8",
    )
    said = cli("check", path)
    assert said.exit_code == 0, said.stderr
    assert said.stdout == "amps.cue: 1 icon, 3.5 s, −0.25 to 0.5 A, steepest 1 A/s\n"


def test_a_rig_adds_its_limits(cli: Cli, two: Path) -> None:
    assert cli("check", two, "--rig", "thenar").exit_code == 0
    said = cli("check", two, "--rig", "thenar", "--set", "driver.current_limit_A=0.2")
    assert said.exit_code == 1
    assert "cool-step" in said.stderr
    assert "3 °C/s of cooling" in said.stderr


def test_a_set_for_another_site_is_only_warned_about(cli: Cli, two: Path) -> None:
    two.write_text(two.read_text(encoding="utf-8").replace("site thenar", "site forearm"), encoding="utf-8")
    said = cli("check", two, "--rig", "thenar")
    assert said.exit_code == 0
    assert "warning" in said.stderr
    assert "forearm" in said.stderr


def test_a_rest_that_the_language_does_not_know(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "free.cue"
    path.write_text("cue 1\nicon a { warm by 2 °C at 1 °C/s; return at 1 °C/s }\n", encoding="utf-8")
    assert cli("check", path, "--set", "skin.rest_C=30").stdout.startswith("free.cue: 1 icon, 4 s, 30–32 °C")
    said = cli("check", path, "--set", "skin.rest_C=70")
    assert said.exit_code == 1
    assert "70" in said.stderr


@pytest.mark.parametrize(
    ("more", "needed"), [((), set()), (("--rig", "thenar"), {"numpy"})], ids=["alone", "with a rig"]
)
def test_nothing_heavy_is_imported(two: Path, more: tuple[str, ...], needed: set[str]) -> None:
    program = (
        "import sys\nfrom thermicon.notebooks.cli.main import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "print(*sorted({name.partition('.')[0] for name in sys.modules}))\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", program, "check", str(two), *more], capture_output=True, encoding="utf-8", check=True
    )
    assert HEAVY & set(run.stdout.split()) == needed
