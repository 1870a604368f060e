"""``thermicon doctor``: each check, its output, and what a command says where a library is missing."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.notebooks.cli import doctor

Cli = Callable[..., Any]


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
        assert f"onset is {onset:g} s and should be 1.1349 ± 0.005" in text


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
