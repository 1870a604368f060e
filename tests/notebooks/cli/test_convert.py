"""``thermicon convert``: every kind of file into every other, whole or not at all."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.icons import load_library, read_cue

Cli = Callable[..., Any]


def test_there_and_back(cli: Cli, tmp_path: Path) -> None:
    as_json, as_cue = tmp_path / "six.json", tmp_path / "six.cue"
    said = cli("convert", "six-icons", "-o", as_json)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == f"wrote {as_json}: 6 icons\n"
    assert json.loads(as_json.read_text(encoding="utf-8"))["format"] == "thermicon cue"
    assert cli("convert", as_json, "-o", as_cue).exit_code == 0
    assert read_cue(as_cue) == load_library("six-icons")
    assert as_cue.read_text(encoding="utf-8") == str(load_library("six-icons"))
    assert not list(tmp_path.glob(".*"))


def test_every_command_takes_json(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "step.json"
    assert cli("convert", "cooling-step-skin", "-o", path).exit_code == 0
    assert cli("check", path).stdout.startswith("step.json: 1 icon, 8 s, 26–32 °C")
    assert cli("simulate", path).stdout.startswith("cooling-step: 8 s, reached")
    path.write_text('{"format": "thermicon cue", "version": 1, "icons": [{"name": "a", "statments": []}]}')
    said = cli("check", path)
    assert said.exit_code == 1
    assert 'icons[0].statments: unknown key "statments"\n  did you mean statements?' in said.stderr


def test_hjif_is_said_to_be_experimental(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "step.hjif"
    said = cli("convert", "cooling-step-skin", "-o", path)
    assert said.exit_code == 0
    wrote, warned = said.stderr.splitlines()
    assert wrote == f"wrote {path}: 1 icon"
    assert warned.startswith("experimental: the unit of Temperature in ISO/IEC 23090-31 was not available to check; ")
    assert json.loads(path.read_text(encoding="utf-8"))["perceptions"][0]["perception_modality"] == "Temperature"


def test_one_icon_and_one_member(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "one.cue"
    assert cli("convert", "six-icons", "--icon", "double-dip", "-o", path).exit_code == 0
    (icon,) = read_cue(path)
    assert (icon.name, read_cue(path).metadata) == ("double-dip", load_library("six-icons").metadata)
    member = load_library("search-space").icons[7].name
    said = cli("convert", "search-space", "--icon", member, "-o", tmp_path / "one.hjif")
    assert said.exit_code == 0
    said = cli("convert", "six-icons", "--icon", "doubel-dip", "-o", path)
    assert said.exit_code == 1
    assert "did you mean double-dip?" in said.stderr


def test_what_a_played_icon_needs_comes_along(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "a.cue"
    path.write_text("cue 1; icon a { hold for 1 s }; icon b { play a; hold for 1 s }; icon c { rest for 1 s }")
    assert cli("convert", path, "--icon", "b", "-o", tmp_path / "b.json").exit_code == 0
    assert [icon.name for icon in read_cue(tmp_path / "b.json")] == ["a", "b"]


def test_lost_comments_are_told(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "a.cue"
    path.write_text('cue 1 # version\nicon a means "no # comment" { hold for 1 s }\n')
    assert "comments in a.cue were dropped" in cli("convert", path, "-o", tmp_path / "a.json").stderr
    path.write_text('cue 1\nicon a means "no # \\" comment" { hold for 1 s }\n')
    assert "were dropped" not in cli("convert", path, "-o", tmp_path / "a.json").stderr


def test_an_output_that_is_there_is_replaced_as_in_other_commands(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text("old")
    assert cli("convert", "cooling-step-skin", "-o", path).exit_code == 0
    assert read_cue(path) == load_library("cooling-step-skin")


def test_a_recording_becomes_an_icon(cli: Cli, tmp_path: Path) -> None:
    path, out = tmp_path / "dip.csv", tmp_path / "dip.cue"
    path.write_text("time_s,a,b\n0,32.1,9\n2,26,9\n4,26.04,9\n6,25.97,9\n8,32.1,9\n", encoding="utf-8")
    options = ("--tolerance", "0.2", "--name", "cold", "--column", "a", "--control", "skin")
    said = cli("convert", path, "-o", out, *options)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == f"cold: 4 corners, 8 s\nwrote {out}: 1 icon\n"
    (icon,) = read_cue(out)
    assert (icon.name, icon.context.control) == ("cold", "skin")
    assert abs(icon.corners().at(4) - 26) < 0.2
    assert cli("convert", path, "-o", tmp_path / "dip.json", *options).exit_code == 0
    assert read_cue(tmp_path / "dip.json") == read_cue(out)


def test_a_recording_that_is_wrong(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "dip.csv"
    path.write_text("time_s,skin_C\n0,32\n1,x\n", encoding="utf-8")
    said = cli("convert", path, "-o", tmp_path / "dip.json")
    assert said.exit_code == 1
    assert "skin_C is 'x', not a finite number" in said.stderr
    assert cli("convert", tmp_path / "none.csv", "-o", tmp_path / "dip.json").exit_code == 1
    assert not (tmp_path / "dip.json").exists()


@pytest.mark.parametrize(
    ("arguments", "words", "code"),
    [
        (("two.cue",), "Missing option", 2),
        (("two.cue", "-o", "-"), "give a name such as icons.json", 1),
        (("two.cue", "-o", "a.txt"), "a set of icons is written as .cue or .json or .hjif, not .txt", 1),
        (("two.cue", "-o", "no/a.json"), "the folder no does not exist", 1),
        (("two.cue", "-o", "two.cue"), "cannot write two.cue: it is the input file; give another name", 1),
        (("two.cu", "-o", "a.json"), "E001", 1),
        (("two.cue", "-o", "a.json", "--tolerance", "1"), "'--tolerance': applies only to a recording, a .csv file", 2),
        (("two.cue", "-o", "a.json", "--control", "skin"), "'--control': applies only to a recording, a .csv file", 2),
        (("a.csv", "-o", "a.json", "--tolerance", "0"), "'--tolerance': 0 is not a difference in K above 0", 2),
        (("a.csv", "-o", "a.json", "--control", "amps"), "'--control': 'amps' is not one of skin, display", 2),
        (("search-space", "-o", "a.hjif"), "HJIF takes 128 icons per file at most", 1),
        (
            ("bare.cue", "-o", "a.hjif"),
            "icon a has no baseline, from which HJIF counts temperatures; say it in the set",
            1,
        ),
    ],
)
def test_what_cannot_be(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str, code: int
) -> None:
    monkeypatch.chdir(two.parent)
    Path("bare.cue").write_text("cue 1; icon a { hold for 1 s }")
    said = cli("convert", *arguments)
    assert (said.exit_code, said.stdout) == (code, "")
    assert words in " ".join(said.stderr.split())
    assert not list(Path().glob("a.*"))


def test_one_icon_as_hjif_stands_alone(cli: Any, tmp_path: Path) -> None:
    path = tmp_path / "a.cue"
    text = "cue 1\nset { control display; baseline 32 °C }\nicon a { cool by 2 °C over 1 s; return over 1 s }\n"
    path.write_text(text + "icon b { play a; rest for 1 s; play a }\n", encoding="utf-8")
    out = tmp_path / "b.hjif"
    said = cli("convert", str(path), "--icon", "b", "-o", str(out))
    assert said.exit_code == 0
    assert "1 icon" in said.stderr
    assert out.read_text(encoding="utf-8").count("perception_modality") == 1
