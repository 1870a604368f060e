"""Conditions that no experiment had are said once on the first screen of each command that predicts."""

from pathlib import Path

import pytest

from tests.notebooks.conftest import Cli

SET = """cue 1
set rested {{ site thenar; control skin; baseline {baseline_C} °C }}
icon warmer {{ warm by 4 °C at 1 °C/s; hold for 1 s; return at 1 °C/s }}
icon colder {{ cool by 2 °C at 1 °C/s; hold for 1 s; return at 1 °C/s }}
"""
SAID = "the skin rests at 28 °C (the evidence: 30 to 34 °C)"
FEW = ("--people", 4, "--intervals", 0)
COMMANDS = {
    "rank": (*FEW,),
    "simulate": (),
    "improve": ("--up-to", 2, *FEW),
    "sweep": ("--vary", "contact.area_cm2=4,9", "-o", "sweep.csv"),
    "export": ("--to", "csv", "-o", "drives", "--icon", "colder"),
    "compare": ("{file}",),
    "pilot": (),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_says_it_once_for_skin_at_28_and_nothing_at_32(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.chdir(tmp_path)
    for baseline_C, times in ((28, 1), (32, 0)):
        file = tmp_path / f"rested{baseline_C}.cue"
        file.write_text(SET.format(baseline_C=baseline_C), encoding="utf-8")
        words = [word.format(file=file) if isinstance(word, str) else word for word in COMMANDS[command]]
        said = cli(command, file, *words)
        assert said.exit_code == 0, said.stderr
        assert (said.stdout + said.stderr).count(SAID) == times, said.stderr
        for made in ("sweep.csv", "drives"):
            (tmp_path / made).rename(tmp_path / f"{made}.{baseline_C}") if (tmp_path / made).exists() else None


def test_a_sweep_says_which_of_its_values_lie_outside(cli: Cli, two: Path, tmp_path: Path) -> None:
    def noted(vary: str, *more: object) -> str:
        said = cli("sweep", two, "--vary", vary, "-o", tmp_path / f"{vary[:6]}.csv", *more)
        assert said.exit_code == 0, said.stderr
        return str(said.stderr)

    areas = noted("contact.area_cm2=1.9,2,9,12")
    assert "outside the data: 2 of 4 values of contact.area_cm2; the first: the contact is 1.9 cm²" in areas
    ages = noted("people.age_years=30,85", "--measure", "detected", "--people", 4, "--intervals", 0)
    assert "outside the data: 1 of 2 values of people.age_years; the first: people are aged 85 years" in ages
