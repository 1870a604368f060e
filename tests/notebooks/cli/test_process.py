"""How the program starts, is interrupted, loses its reader, and what it lists."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import entry_points, version
from pathlib import Path
from typing import Any

import pytest

from thermicon.notebooks.cli.main import COMMANDS, main, program

Cli = Callable[..., Any]


def test_the_entry_point_is_the_command_line() -> None:
    (found,) = entry_points(group="console_scripts", name="thermicon")
    assert found.value == "thermicon.notebooks.cli.main:main"


def test_the_version(process: Cli) -> None:
    said = process("--version")
    assert (said.exit_code, said.stdout, said.stderr) == (0, f"thermicon {version('thermicon')}\n", "")


def test_a_command_reads_its_own_options_alone() -> None:
    assert [command.name for command in program(["rank"]).registered_commands] == ["rank"]
    for words in ([], ["--help"], ["chek"], ["-q", "rank"]):
        assert len(program(words).registered_commands) == len(COMMANDS) == 15


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help(cli: Cli, name: str) -> None:
    said = cli(name, "--help")
    assert (said.exit_code, said.stderr) == (0, "")
    assert said.stdout.startswith(f"Usage: thermicon {name} ")


def test_quiet_is_without_notes_and_with_errors(cli: Cli, two: Path, tmp_path: Path) -> None:
    assert cli("simulate", two, "-o", tmp_path / "t.csv").stderr
    assert cli("-q", "simulate", two, "-o", tmp_path / "t.csv").stderr == ""
    assert "no such rig" in cli("-q", "simulate", two, "--rig", "nowhere").stderr
    assert cli("simulate", two, "-o", tmp_path / "t.csv").stderr


def test_the_shell_completes_rigs_and_sets(process: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("_THERMICON_COMPLETE", "complete_bash")
    for words, found in (("thermicon rank six", "six-icons"), ("thermicon rank six-icons --rig fo", "forearm")):
        monkeypatch.setenv("COMP_WORDS", words)
        monkeypatch.setenv("COMP_CWORD", str(len(words.split()) - 1))
        assert found in process().stdout


def test_the_package_runs_as_a_module(tmp_path: Path) -> None:
    command = [sys.executable, "-P", "-m", "thermicon.notebooks", "--version"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (0, f"thermicon {version('thermicon')}\n", "")


@pytest.mark.skipif(sys.platform == "win32", reason="signals work differently there")
def test_an_interrupt_ends_with_130_and_no_traceback() -> None:
    program = (
        "import os, signal, thermicon.notebooks.cli.check as c\n"
        "c.check = lambda *_: os.kill(os.getpid(), signal.SIGINT)\n"
        "from thermicon.notebooks.cli.main import main\nmain()\n"
    )
    run = subprocess.run([sys.executable, "-c", program, "check", "x"], capture_output=True, text=True, check=False)
    assert run.returncode == 130
    assert run.stderr == "interrupted\n"


@pytest.mark.parametrize(
    "where",
    [
        "thermicon.notebooks.cli.app.TyperGroup.make_context",
        "thermicon.notebooks.cli.app.TyperGroup.invoke",
        "thermicon.notebooks.cli.main.program",
    ],
)
def test_an_interrupt_is_told_wherever_it_comes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], where: str
) -> None:
    def stopped(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(where, stopped)
    monkeypatch.setattr(sys, "argv", ["thermicon", "list"])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 130
    assert capsys.readouterr().err == "interrupted\n"


def test_damaged_machine_code_is_told_with_the_cure(monkeypatch: pytest.MonkeyPatch, cli: Cli) -> None:
    def damaged(*_: object, **__: object) -> None:
        raise EOFError("Ran out of input")

    monkeypatch.setattr("thermicon.notebooks.cli.listing.show_icons", damaged)
    said = cli("list", "icons")
    assert said.exit_code == 1
    assert "is damaged: delete this folder; it is made again" in said.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="pipes work differently there")
@pytest.mark.parametrize(
    ("command", "files"),
    [
        pytest.param(
            ("rank", "two.cue", "--people", "3", "--json", "l.json", "--figure", "fl"),
            ("l.json", "fl/distance.png"),
            marks=pytest.mark.slow,
        ),
        (("simulate", "two.cue", "-o", "t.csv", "--figure", "t.png"), ("t.csv", "t-cool-step.png", "t-warm-step.png")),
        pytest.param(
            ("simulate", "two.cue", "--figure", "t.png"), ("t-cool-step.png", "t-warm-step.png"), marks=pytest.mark.slow
        ),
        pytest.param(
            ("sweep", "two.cue", "--vary", "contact.area_cm2=4:9:2", "-o", "-", "--figure", "s.png"),
            ("s.png",),
            marks=pytest.mark.slow,
        ),
        pytest.param(
            ("compare", "two.cue:cool-step", "two.cue:warm-step", "--figure", "c.png"),
            ("c.png",),
            marks=pytest.mark.slow,
        ),
    ],
)
def test_files_are_there_when_nobody_waits_for_the_words(two: Path, command: tuple[str, ...], files: Any) -> None:
    read, write = os.pipe()
    os.close(read)
    run = subprocess.run(
        [sys.executable, "-m", "thermicon.notebooks.cli.main", *command],
        cwd=two.parent, stdout=write, stderr=write, timeout=120, check=False,
    )  # fmt: skip
    os.close(write)
    assert run.returncode == 0
    for name in files:
        assert (two.parent / name).stat().st_size > 0, name


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="pipes work differently there")
def test_a_reader_that_goes_away_is_no_error() -> None:
    command = [sys.executable, "-m", "thermicon.notebooks.cli.main", "simulate", "six-icons", "-o", "-"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        assert run.stderr is not None
        assert run.stdout.readline().startswith("icon,time_s,current_A")
        run.stdout.close()
        said = run.stderr.read()
    assert run.returncode == 0, said
    assert "Traceback" not in said
    assert "Broken" not in said


def test_an_error_of_the_program_itself_is_not_hidden(monkeypatch: pytest.MonkeyPatch, cli: Cli) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("thermicon.notebooks.cli.check.check", broken)
    with pytest.raises(ZeroDivisionError):
        cli("check", "six-icons")


def test_rigs_are_listed_with_what_they_rest_at(cli: Cli) -> None:
    said = cli("list", "rigs")
    assert said.exit_code == 0
    for word in ("thenar", "shani2021", "34.5", "−80"):
        assert word in said.stdout
    assert max(len(line) for line in said.stdout.splitlines()) <= 80


def test_the_library_is_listed_with_its_source(cli: Cli) -> None:
    said = cli("list", "icons")
    assert said.exit_code == 0
    assert "six-icons" in said.stdout
    assert "cooling-step" in said.stdout


def test_text_that_looks_like_markup_is_shown_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    from thermicon.notebooks.report.blocks import grid
    from thermicon.notebooks.report.terminal import show

    show([grid(["icon"], [["[red]loud[/red]"]]), "[b]plain[/b]"])
    assert "[b]plain[/b]" in (said := capsys.readouterr().out)
    assert "[red]loud[/red]" in said


def test_a_checkout_that_hides_the_installed_package_is_reported(tmp_path: Path) -> None:
    """The metadata name a distribution in another folder than the one that is imported."""
    from thermicon.notebooks import startup

    assert startup.hidden_by("/a/notebooks", []) is None
    installed = tmp_path / "site"
    (installed / "thermicon/notebooks").mkdir(parents=True)
    info = installed / "thermicon-9.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: thermicon\nVersion: 9\n", encoding="utf-8")
    program = (
        "import sys, importlib.metadata as m\n"
        f"m.distributions = lambda **_: [m.PathDistribution(__import__('pathlib').Path({str(info)!r}))]\n"
        "from thermicon.notebooks.startup import warn_if_hidden\nwarn_if_hidden()\n"
    )
    run = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    (line,) = run.stderr.splitlines()
    assert str(installed / "thermicon/notebooks") in line
    assert "hides the installed" in line


def test_the_installed_package_runs_without_a_warning() -> None:
    from thermicon.notebooks import startup

    assert startup.hidden_by(str(Path(startup.__file__).parent), startup.installed_folders()) is None
