"""Messages of the commands: one for each fault, without traceback or half-written files."""

import shlex
from pathlib import Path

import pytest

from tests.builders import messages, missing
from tests.notebooks.conftest import Cli, posix

SAID = messages(__file__)
FILES: dict[str, bytes] = {name: text.encode() for name, text in SAID["files"].items()} | {
    "empty.cue": b"",
    "picture.cue": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR",
    "enormous.cue": b"cue 1\n" + b"# filler\n" * 6_000_000,
    "latin.cue": b"cue 1\nicon a { warm by 4 \xb0C at 1 \xb0C/s }\n",
    "wide.csv": b"time_s," + b"x" * 200_000 + b"\n0,30\n1,30\n",
}
CODES = {"said": 0, "bad": 1, "usage": 2}


def held(folder: Path) -> dict[str, bytes]:
    """Every file of a folder, and every folder in it, with what it holds."""
    return {str(path): b"" if path.is_dir() else path.read_bytes() for path in folder.rglob("*")}


@pytest.mark.parametrize(
    ("line", "code", "words"), [(line, code, SAID[kind][line]) for kind, code in CODES.items() for line in SAID[kind]]
)
def test_a_command_says_what_it_must_and_leaves_nothing(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, line: str, code: int, words: str | list[str]
) -> None:
    folder = two.parent
    for name, content in FILES.items():
        if name in shlex.split(line.replace("taken.toml", "taken.csv")):  # what --keep would replace
            (folder / name).write_bytes(content)
    monkeypatch.chdir(folder)
    before = held(folder)
    said = cli(*shlex.split(line))
    told = " ".join(f"{said.stdout} {said.stderr}".replace("│", " ").split())
    assert said.exit_code == code, told
    assert code == 0 or said.stdout == ""
    assert "Traceback" not in told
    assert code < 2 or len(said.stderr.splitlines()) <= 3
    assert missing(words, told) == [], told
    assert held(folder) == before


def test_a_command_line_alone_shows_how_it_is_used(cli: Cli) -> None:
    for line in ((), ("-q",)):
        said = cli(*line)
        assert (said.exit_code, said.stderr) == (0, "") and said.stdout == cli("--help").stdout


def test_a_site_that_data_know_is_not_told(cli: Cli, two: Path) -> None:
    (two.parent / "wrist.cue").write_bytes(FILES["wrist.cue"])
    assert cli("check", two.parent / "wrist.cue").stderr.startswith("Next: ")


@posix
def test_a_file_is_proposed_by_what_its_name_begins_with_and_where_linux_has_it(cli: Cli, two: Path) -> None:
    (two.parent / "note.cue.txt").write_bytes(FILES["note.cue.txt"])
    assert f"did you mean {two.parent / 'note.cue.txt'}?" in cli("rank", two.parent / "note.cue").stderr
    assert "did you mean /mnt/c/Users/me/x.cue?" in cli("check", r"C:\Users\me\x.cue").stderr


@pytest.mark.parametrize(
    ("line", "code", "words"),
    [
        (("rank", "six-icons", "--seed", "9" * 5000), 2, "is not a whole number"),
        (("simulate", "six-icons", "--set", "driver.update_Hz=" + "9" * 5000), 1, "must be a number in Hz"),
        (("simulate", "six-icons", "--set", "contact.area_cm2=" + "[" * 3000), 1, "must be a number in cm²"),
    ],
    ids=["seed", "digits", "nested"],
)
def test_what_is_very_long_is_told_shortly(cli: Cli, line: tuple[str, ...], code: int, words: str) -> None:
    said = cli(*line)
    assert (said.exit_code, words in said.stderr) == (code, True)
    assert len(said.stderr) < 1000


def test_a_drive_that_may_not_be_read_is_bad_input(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "drive.csv"
    path.write_text("time_s,current_A\n0,0.1\n1,0.1\n")

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("os.access", lambda *_: False)  # what the parser of the command line would ask
    for reader in ("read_text", "read_bytes", "open"):
        monkeypatch.setattr(Path, reader, refuse)
    said = cli("simulate", "--current", path)
    assert (said.exit_code, said.stdout) == (1, "")
    assert "drive.csv" in said.stderr and "ermission" in said.stderr
