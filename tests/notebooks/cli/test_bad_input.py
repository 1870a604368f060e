"""Everything that can be wrong on the command line gets one clear message, exit 1 or 2, and no traceback."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Cli = Callable[..., Any]


def refused(said: Any, *words: str, code: int = 1) -> None:
    assert said.exit_code == code, said
    assert said.stdout == ""
    assert "Traceback" not in said.stderr
    for word in words:
        assert word in said.stderr, said.stderr


def test_an_unknown_rig_lists_the_nearest(cli: Cli, two: Path) -> None:
    refused(cli("simulate", two, "--rig", "thenr"), "thenr", "did you mean thenar?")


def test_an_unknown_library_set_lists_the_nearest(cli: Cli) -> None:
    refused(cli("check", "six-icon"), "six-icon", "six-icons")


def test_an_unknown_key_of_set_lists_the_nearest(cli: Cli, two: Path) -> None:
    refused(cli("simulate", two, "--set", "contact.area=4"), "contact.area", "contact.area_cm2")


def test_an_unknown_icon_lists_the_nearest(cli: Cli, two: Path) -> None:
    refused(cli("simulate", two, "--icon", "cool-stp"), "cool-stp", "did you mean cool-step?")


def test_a_number_without_unit_is_shown_with_the_fix(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "alarm.cue"
    path.write_text("cue 1\nicon a {\n  cool to 26 at 3 °C/s\n}\n", encoding="utf-8")
    refused(cli("check", path), "alarm.cue:3:", "E102", "^^", "did you mean")


def test_all_errors_of_all_files_come_at_once(cli: Cli, tmp_path: Path, two: Path) -> None:
    first, second = tmp_path / "first.cue", tmp_path / "second.cue"
    first.write_text("cue 1\nicon a {\n  cool to 26 at 3 °C/s\n  hold for 4\n}\n", encoding="utf-8")
    second.write_text("cue 1\nicon b {\n  hold for 4\n}\n", encoding="utf-8")
    refused(cli("check", first, two, second), "first.cue:3:", "first.cue:4:", "second.cue:3:")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", "binary"),
        (b"cue 1\n" + b"# filler\n" * 6_000_000, "54,000,006 bytes"),
        (b"cue 1\nicon a { warm by 4 \xb0C at 1 \xb0C/s }\n", "UTF-8"),
    ],
    ids=["empty", "binary", "50 MB", "latin-1"],
)
def test_a_file_that_is_no_cue(cli: Cli, tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "odd.cue"
    path.write_bytes(content)
    refused(cli("check", path), "odd.cue", words)


def test_a_folder_is_no_cue(cli: Cli, tmp_path: Path) -> None:
    refused(cli("check", tmp_path), "folder")


def test_a_missing_file(cli: Cli, tmp_path: Path) -> None:
    refused(cli("rank", tmp_path / "absent.cue"), "absent.cue")


def test_a_rig_that_cannot_be(cli: Cli, two: Path, tmp_path: Path) -> None:
    from importlib.resources import files

    text = (files("thermicon.circuit") / "rigs" / "thenar.toml").read_text(encoding="utf-8")
    rig = tmp_path / "odd.toml"
    rig.write_text(text.replace("area_cm2 = 9.0", "aera_cm2 = 9.0"), encoding="utf-8")
    refused(cli("simulate", two, "--rig", rig), "odd.toml", "aera_cm2", "area_cm2")


def test_a_change_that_cannot_be(cli: Cli, two: Path) -> None:
    refused(cli("check", two, "--set", "contact.area_cm2=wide"), "area_cm2", "wide")


def test_two_files_with_the_same_icon(cli: Cli, two: Path, tmp_path: Path) -> None:
    again = tmp_path / "again.cue"
    again.write_text(two.read_text(encoding="utf-8"), encoding="utf-8")
    refused(cli("rank", two, again), "cool-step", "two.cue", "again.cue")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "out.txt"], [".csv or .parquet, not .txt"]),
        (["-o", "absent/out.csv"], ["the folder absent does not exist"]),
        (["--figure", "out.gif"], [".png", "not .gif"]),
    ],
)
def test_an_output_that_cannot_be(cli: Cli, two: Path, arguments: list[str], words: list[str]) -> None:
    refused(cli("simulate", two, *arguments), *words)


def test_json_that_cannot_be_written_is_told_before_the_work(cli: Cli, two: Path) -> None:
    refused(cli("rank", two, "--people", 100_000, "--json", "absent/out.json"), "the folder absent does not exist")


def test_a_figure_folder_that_is_a_file(cli: Cli, two: Path) -> None:
    refused(cli("rank", two, "--people", 100_000, "--figure", two), "is the name of a file; give a folder", code=2)


def test_a_figure_folder_with_the_name_of_a_picture(cli: Cli, two: Path, tmp_path: Path) -> None:
    said = cli("rank", two, "--people", 100_000, "--figure", tmp_path / "fig.gif")
    refused(said, "--figure", "fig.gif is the name of a file; give a folder, such as ", "fig, for all figures", code=2)


def test_a_drive_that_cannot_be(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "drive.csv"
    path.write_text("time_s,current_A\n0,0.1\n1,x\n")
    refused(cli("simulate", "--current", path), "drive.csv:3", "'x'")


def test_a_drive_that_may_not_be_read_is_bad_input(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "drive.csv"
    path.write_text("time_s,current_A\n0,0.1\n1,0.1\n")

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("os.access", lambda *_: False)  # what the parser of the command line would ask
    for reader in ("read_text", "read_bytes", "open"):
        monkeypatch.setattr(Path, reader, refuse)
    refused(cli("simulate", "--current", path), "drive.csv", "ermission")


USAGE = [
    ((), "Usage"),
    (("chek",), "Did you mean 'check'"),
    (("check",), "Missing argument 'FILE...'"),
    (("check", "two.cue", "--rgi", "x"), "--rgi"),
    (("check", "two.cue", "--set", "contact.area_cm2"), "KEY=VALUE"),
    (("simulate",), "either a cue FILE or --current"),
    (("simulate", "a.cue", "--current", "b.csv"), "either a cue FILE or --current"),
    (("simulate", "a.cue", "--hold"), "--hold"),
    (("simulate", "--current", "b.csv", "--icon", "a"), "--icon"),
    (("simulate", "--current", "b.csv", "--tail", "1"), "--tail"),
    (("simulate", "a.cue", "--rate", "nan"), "--rate"),
    (("simulate", "a.cue", "--tail", "-1"), "--tail"),
    (("rank", "six-icons", "--people", "0"), "--people"),
    (("rank", "six-icons", "--people", "1.5"), "'1.5' is not a whole number; write one, such as 12"),
    (("rank", "six-icons", "--seed", "9" * 5000), "has too many digits to be read"),
    (("pilot", "six-icons", "--wanted", "wide"), "'wide' is not a number in %; write it in digits"),
    (("rank", "six-icons", "--people", "100001"), "1 to 100000"),
    (("rank", "six-icons", "--task", "trials=1000000000000"), "1e+12 is outside 1 to 1e+06"),
    (("rank", "six-icons", "--task", "gap=far"), "'gap=far': 'far' is not a number"),
    (("rank", "six-icons", "--task", "pace=2"), "'pace=2' is not one of trials=VALUE, gap=VALUE"),
    (("rank", "six-icons", "--tracking", "repaly"), "replay, display, ideal"),
    (("rank", "six-icons", "--norm", "max"), "'max' is not one of episodes, naming"),
]


@pytest.mark.parametrize(("arguments", "words"), USAGE)
def test_a_command_line_that_makes_no_sense(cli: Cli, arguments: tuple[str, ...], words: str) -> None:
    said = cli(*arguments)
    assert said.exit_code == 2
    assert words in said.stderr + (said.stdout if not arguments else "")
    assert "Traceback" not in said.stderr


@pytest.mark.parametrize(
    ("words", "output"),
    [
        (("rank", "FILE", "--people", 2, "--json"), None),
        (("improve", "FILE", "--evaluations", 40, "-o"), None),
        (("rank", "FILE", "--json", "both.png", "--figure"), "both.png"),
    ],
)
def test_no_output_takes_the_place_of_an_input_or_of_another_output(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[object, ...], output: str | None
) -> None:
    before = two.read_text()
    monkeypatch.chdir(two.parent)
    said = cli(*(two if word == "FILE" else word for word in words), output or two)
    refused(said, "another output" if output else "is read by this command", "give another name")
    assert two.read_text() == before
    assert list(two.parent.iterdir()) == [two]


def test_a_drive_is_not_overwritten_by_its_trace(cli: Cli, tmp_path: Path) -> None:
    drive = tmp_path / "drive.csv"
    drive.write_text("time_s,current_A\n0,0.1\n1,0.1\n")
    refused(cli("simulate", "--current", drive, "-o", drive), "is read by this command")
    assert drive.read_text().startswith("time_s,current_A")
