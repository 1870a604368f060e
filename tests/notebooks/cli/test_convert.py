"""``thermicon convert``: icons and recordings as cue text and as JSON, complete or not at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.icons import load_library, read_cue, to_json

Cli = Callable[..., Any]


def test_json_for_other_programs_is_written_and_not_read(cli: Cli, tmp_path: Path) -> None:
    as_json, as_cue = tmp_path / "six.json", tmp_path / "six.cue"
    said = cli("convert", "six-icons", "-o", as_json)
    assert (said.exit_code, said.stdout) == (0, "")
    assert said.stderr == f"wrote {as_json}: 6 icons\n"
    assert as_json.read_text(encoding="utf-8") == to_json(load_library("six-icons"))
    said = cli("convert", as_json, "-o", as_cue)
    assert (said.exit_code, said.stdout) == (1, "")
    assert "E101 not understood" in said.stderr
    assert "this is JSON, which thermicon writes for other programs" in said.stderr
    assert not as_cue.exists()
    assert not list(tmp_path.glob(".*"))


def test_a_set_as_cue_text(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "six.cue"
    assert cli("convert", "six-icons", "-o", path).exit_code == 0
    assert path.read_text(encoding="utf-8") == str(load_library("six-icons"))


def test_one_icon_and_one_member(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "one.cue"
    assert cli("convert", "six-icons", "--icon", "double-dip", "-o", path).exit_code == 0
    (icon,) = read_cue(path)
    assert (icon.name, read_cue(path).metadata) == ("double-dip", load_library("six-icons").metadata)
    member = load_library("search-space").icons[7].name
    said = cli("convert", "search-space", "--icon", member, "-o", tmp_path / "member.cue")
    assert said.exit_code == 0
    said = cli("convert", "six-icons", "--icon", "doubel-dip", "-o", path)
    assert said.exit_code == 1
    assert "did you mean double-dip?" in said.stderr


def test_what_a_played_icon_needs_comes_along(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "a.cue"
    path.write_text("cue 1; icon a { hold for 1 s }; icon b { play a; hold for 1 s }; icon c { rest for 1 s }")
    assert cli("convert", path, "--icon", "b", "-o", tmp_path / "b.cue").exit_code == 0
    assert [icon.name for icon in read_cue(tmp_path / "b.cue")] == ["a", "b"]


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
    assert path.read_text(encoding="utf-8") == to_json(load_library("cooling-step-skin"))


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
    assert (tmp_path / "dip.json").read_text(encoding="utf-8") == to_json(read_cue(out))


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
        (("two.cue", "-o", "a.txt"), "a set of icons is written as .cue or .json, not .txt", 1),
        (("two.cue", "-o", "no/a.json"), "the folder no does not exist", 1),
        (("two.cue", "-o", "two.cue"), "cannot write two.cue: it is the input file; give another name", 1),
        (("two.cu", "-o", "a.json"), "E001", 1),
        (("two.cue", "-o", "a.json", "--tolerance", "1"), "'--tolerance': applies only to a recording, a .csv file", 2),
        (("two.cue", "-o", "a.json", "--control", "skin"), "'--control': applies only to a recording, a .csv file", 2),
        (("a.csv", "-o", "a.json", "--tolerance", "0"), "'--tolerance': 0 is not a difference in K above 0", 2),
        (("a.csv", "-o", "a.json", "--control", "amps"), "'--control': 'amps' is not one of skin, display", 2),
    ],
)
def test_what_cannot_be(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str, code: int
) -> None:
    monkeypatch.chdir(two.parent)
    said = cli("convert", *arguments)
    assert (said.exit_code, said.stdout) == (code, "")
    assert words in " ".join(said.stderr.split())
    assert not list(Path().glob("a.*"))
