"""``thermicon simulate -o OUT.cir``: the file as a lab gets it, and what the command says."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

Cli = Callable[..., Any]


def test_it_says_what_it_wrote_and_how_to_run_it(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "cool.cir"
    said = cli("simulate", two, "--icon", "cool-step", "-o", out)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr.splitlines() == [
        "cool-step: 8 s, reached (everywhere within 1 mK)",
        f"wrote {out}; open it in LTspice, or run ngspice -b -r cool.raw cool.cir",
    ]
    text = out.read_text(encoding="ascii")
    assert text.startswith("* cool-step of two.cue on rig thenar, written by thermicon ")
    assert ".control" not in text
    assert not list(tmp_path.glob(".*"))


def test_the_clock_of_a_hand_that_lands_is_named(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "cool.cir"
    said = cli("simulate", two, "--icon", "cool-step", "--set", "contact.lands_s=-2", "-o", out)
    assert said.exit_code == 0
    assert "the netlist's clock begins when the hand lands; the cue begins at 2 s\n" in said.stderr
    text = out.read_text(encoding="ascii")
    assert "Bcontact cold skin I=V(landed)*" in text
    assert "Rcontact" not in text
    assert ".tran 0.01 10.0 0 " in text  # 2 s and the icon's 8 s


def test_a_set_with_one_icon_needs_no_name_(cli: Cli, tmp_path: Path) -> None:
    out = tmp_path / "step.cir"
    assert cli("simulate", "cooling-step-skin", "-o", out).exit_code == 0


def test_several_icons_are_listed(cli: Cli, two: Path, tmp_path: Path) -> None:
    said = cli("simulate", two, "-o", tmp_path / "a.cir")
    assert said.exit_code == 2
    assert "has 2 icons; name one of cool-step, warm-step" in said.stderr


@pytest.mark.parametrize(
    ("arguments", "words", "code"),
    [
        (("two.cue", "--icon", "cool-stp", "-o", "a.cir"), "did you mean cool-step?", 1),
        (
            ("two.cue", "--icon", "cool-step", "-o", "a.cir", "--tail", "nan"),
            "'--tail': nan s is outside 0 to 86400 s",
            2,
        ),
        (("two.cue", "--icon", "cool-step", "-o", "a.lib"), "a netlist is written as .cir or .net or .sp, not .lib", 1),
        (("two.cue", "-o", "a.cir", "--figure", "a.png"), "'--figure': belongs to a trace, not to a circuit", 2),
    ],
)
def test_what_cannot_be(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str, code: int
) -> None:
    monkeypatch.chdir(two.parent)
    said = cli("simulate", *arguments)
    assert (said.exit_code, said.stdout) == (code, "")
    assert words in " ".join(said.stderr.split())
    assert not Path("a.cir").exists()


@pytest.mark.slow
def test_ngspice_plays_what_simulate_writes(
    cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tool: Callable[[str], str]
) -> None:
    ngspice = tool("ngspice")
    options = ("--icon", "cool-step", "--tail", "2", "--set", "contact.area_cm2=4")
    monkeypatch.chdir(tmp_path)
    said = cli("simulate", two, *options, "-o", "Cool.sp")
    assert said.exit_code == 0, said.stderr
    assert said.stderr.endswith("wrote Cool.sp; ngspice -b Cool.sp writes the probes into Cool.txt\n")
    assert cli("simulate", two, *options, "-o", "trace.csv").exit_code == 0
    run = subprocess.run([ngspice, "-b", "Cool.sp"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    theirs = pd.read_csv(tmp_path / "Cool.txt", sep=r"\s+").add_prefix("/")
    ours = pd.read_csv(tmp_path / "trace.csv")
    for column in ("hot_plate_C", "display_C", "skin_C", "cold_receptor_C", "warm_receptor_C"):
        played = np.interp(ours["time_s"], theirs["/time"], theirs[f"/v({column})"])
        assert np.abs(played - ours[column]).max() < 2e-3, column
    behind = np.interp(ours["time_s"][:-1] + 1.01e-6, theirs["/time"], theirs["/v(plus)"])
    assert np.abs(behind - ours["voltage_V"][:-1]).max() < 1e-3


def test_a_library_of_subcircuits_holds_the_rig_alone(cli: Cli, tmp_path: Path) -> None:
    out = tmp_path / "thenar.lib"
    said = cli("simulate", "--set", "contact.area_cm2=4", "-o", out)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == (f"wrote {out}: thermicon_module and thermicon_skin; in a schematic, .include thenar.lib\n")
    text = out.read_text(encoding="ascii")
    assert "+ area_cm2=4.0\n" in text
    assert ".tran" not in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--icon", "a", "-o", "a.lib"), "'--icon': belongs to a cue FILE; without one, the circuit of the rig is"),
        (("-o", "a.csv"), "give either a cue FILE or --current"),
    ],
)
def test_a_file_is_played_and_subcircuits_play_nothing(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    said = cli("simulate", *arguments)
    assert said.exit_code == 2
    assert words in " ".join(said.stderr.split())
    assert not list(tmp_path.iterdir())
