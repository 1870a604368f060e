"""The process of the program and ``thermicon doctor``."""

import json
import os
import subprocess
import sys
from importlib.metadata import entry_points, version
from pathlib import Path

import pytest

from tests.notebooks.conftest import Cli, posix
from thermicon.notebooks.cli import doctor
from thermicon.notebooks.cli.main import COMMANDS, program


@pytest.mark.parametrize("start", [("-m", "thermicon.notebooks.cli.main"), ("-P", "-m", "thermicon")])
def test_the_version(tmp_path: Path, start: tuple[str, ...]) -> None:
    (found,) = entry_points(group="console_scripts", name="thermicon")
    assert found.value == "thermicon.notebooks.cli.main:main"
    run = subprocess.run([sys.executable, *start, "--version"], cwd=tmp_path, capture_output=True, text=True)
    assert (run.returncode, run.stdout, run.stderr) == (0, f"thermicon {version('thermicon')}\n", "")


def test_a_command_reads_its_own_options_alone() -> None:
    assert [command.name for command in program(["rank"]).registered_commands] == ["rank"]
    assert [command.name for command in program(["-q", "rank"]).registered_commands] == ["rank"]
    for words in ([], ["--help"], ["chek"], ["-q"]):
        assert len(program(words).registered_commands) == len(COMMANDS) == 16


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help(cli: Cli, name: str) -> None:
    said = cli(name, "--help")
    assert (said.exit_code, said.stderr) == (0, "")
    assert said.stdout.startswith(f"Usage: thermicon {name} ")


def test_quiet_is_without_notes_and_with_errors(cli: Cli, two: Path, tmp_path: Path) -> None:
    assert cli("simulate", two, "-o", tmp_path / "t.csv").stderr
    assert cli("-q", "simulate", two, "-o", tmp_path / "t.csv").stderr == ""
    assert cli("simulate", two, "-o", tmp_path / "t.csv", "--quiet").stderr == ""
    assert "no such file" in cli("check", "--", "-q").stderr
    assert "no such rig" in cli("-q", "simulate", two, "--rig", "nowhere").stderr
    assert cli("simulate", two, "-o", tmp_path / "t.csv").stderr


@posix
def test_an_interrupt_ends_with_130_and_no_traceback() -> None:
    program = (
        "import os, signal, thermicon.notebooks.cli.check as c\n"
        "c.check = lambda *_: os.kill(os.getpid(), signal.SIGINT)\n"
        "from thermicon.notebooks.cli.main import main\nmain()\n"
    )
    run = subprocess.run([sys.executable, "-c", program, "check", "x"], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (130, "interrupted\n")


def test_damaged_machine_code_is_told_and_an_error_of_the_program_is_not_hidden(
    monkeypatch: pytest.MonkeyPatch, cli: Cli
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("thermicon.notebooks.cli.listing.show_icons", fails)
    error: Exception = EOFError("Ran out of input")
    said = cli("list", "icons")
    assert (said.exit_code, "is damaged: delete this folder" in said.stderr) == (1, True)
    error = ZeroDivisionError()
    with pytest.raises(ZeroDivisionError):
        cli("list", "icons")


@posix
def test_files_are_there_when_nobody_waits_for_the_words(two: Path) -> None:
    read, write = os.pipe()
    os.close(read)
    words = [sys.executable, "-m", "thermicon.notebooks.cli.main", "simulate", "two.cue", "-o", "t.csv"]
    run = subprocess.run(words, cwd=two.parent, stdout=write, stderr=write, timeout=120, check=False)
    os.close(write)
    assert run.returncode == 0
    assert (two.parent / "t.csv").stat().st_size > 0


def test_the_stored_numbers_are_those_of_this_program() -> None:
    case = doctor.stored()
    computed = doctor.compute(case)
    assert set(computed) == {each["name"] for each in case["number"]}
    for each in case["number"]:
        assert computed[each["name"]] == pytest.approx(each["value"], abs=each["tolerance"] / 4), each["name"]


def test_the_self_test_compares(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = {each["name"]: each["value"] for each in doctor.stored()["number"]}
    monkeypatch.setattr(doctor, "compute", lambda _: numbers)
    assert doctor.check_self_test()[0] == "ok"
    for onset in (1.141, float("nan")):
        monkeypatch.setattr(doctor, "compute", lambda _, onset=onset: {**numbers, "onset": onset})
        state, text, _ = doctor.check_self_test()
        assert state == "fault"
        assert f"onset is {onset:g} s and should be {numbers['onset']:g} ± 0.005" in text


def test_a_check_that_fails_is_a_fault_and_the_next_one_runs(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> doctor.Found:
        raise ImportError("no numba\nand a long story")

    note = {"two": lambda: ("note", "small", "wait")}
    monkeypatch.setattr(doctor, "CHECKS", {"one": broken, **note})
    said = cli("doctor")
    fault, other = said.stdout.splitlines()
    assert (said.exit_code, other) == (1, "note   two: small; wait")
    assert fault.startswith("fault  one: cannot be checked (ImportError: no numba); install thermicon again")
    monkeypatch.setattr(doctor, "CHECKS", note)
    said = cli("doctor", "--json")
    assert (said.exit_code, said.stderr) == (0, "")
    data = json.loads(said.stdout)
    assert data["ok"] is True
    assert data["findings"] == [{"check": "two", "state": "note", "text": "small", "cure": "wait"}]


def test_a_command_without_its_library_names_it_and_the_cure() -> None:
    start = (
        "import sys; sys.modules['lark'] = None; sys.argv = ['thermicon', 'check', 'six-icons']\n"
        "from thermicon.notebooks.cli.main import main; main()"
    )
    run = subprocess.run([sys.executable, "-c", start], capture_output=True, encoding="utf-8", timeout=120, check=False)
    assert (run.returncode, run.stdout) == (1, "")
    (line,) = run.stderr.splitlines()
    for word in ("cannot start", "lark", "pip check"):
        assert word in line


@pytest.mark.slow
def test_this_installation_is_examined(tmp_path: Path, process: Cli) -> None:
    said = process("doctor", cwd=tmp_path)
    assert "Traceback" not in said.stdout + said.stderr
    states = {line.split()[1].rstrip(":"): line.split()[0] for line in said.stdout.splitlines()}
    assert states["Python"] == states["packages"] == states["self-test"] == "ok", said.stdout
