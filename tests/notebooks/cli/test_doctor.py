"""``thermicon doctor``: each check, its output, and what a command says where a library is missing."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from thermicon.notebooks.cli import doctor
from thermicon.notebooks.cli.doctor import Finding

Cli = Callable[..., Any]
ROOT = Path(__file__).resolve().parents[3]
ONLY_FOR_DEVELOPERS = {"test", "docs"}


def test_the_stored_numbers_are_those_of_this_program() -> None:
    case = doctor.stored()
    computed = doctor.compute(case)
    assert set(computed) == {each["name"] for each in case["number"]}
    for each in case["number"]:
        assert computed[each["name"]] == pytest.approx(each["value"], abs=each["tolerance"] / 4), each["name"]


def test_the_self_test_compares(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = {each["name"]: each["value"] for each in doctor.stored()["number"]}
    monkeypatch.setattr(doctor, "compute", lambda _: numbers)
    assert [each.state for each in doctor.check_self_test()] == ["ok"]
    for onset in (1.141, float("nan")):
        monkeypatch.setattr(doctor, "compute", lambda _, onset=onset: {**numbers, "onset": onset})
        (finding,) = doctor.check_self_test()
        assert finding.state == "fault"
        assert f"onset is {onset:g} s and should be 1.1349 ± 0.005 s" in finding.text


@pytest.mark.parametrize(
    ("python", "state", "words"),
    [
        ("python", "ok", "the Python of the notebook server"),
        (sys.executable, "ok", sys.executable),
        ("/bin/sh", "fault", "notebooks do not find thermicon: python3 runs /bin/sh"),
    ],
)
def test_the_kernel_is_this_python(python: str, state: str, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = SimpleNamespace(argv=[python, "-m", "ipykernel_launcher"], resource_dir="/specs/python3")
    monkeypatch.setattr("jupyter_client.kernelspec.KernelSpecManager.get_kernel_spec", lambda *_: spec)
    (finding,) = doctor.check_kernel()
    assert (finding.state, words in finding.text) == (state, True)


def test_a_package_that_is_missing_is_a_fault_with_its_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "REPORTED", ("numpy", "no-such-package"))
    fault, found = doctor.check_required()
    assert (fault.state, fault.text, found.state) == ("fault", "no-such-package is not installed", "ok")
    assert "pip install thermicon" in str(fault.cure)
    assert found.text.startswith("numpy ")


def test_every_extra_has_its_package_and_a_purpose() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    assert set(extras) - ONLY_FOR_DEVELOPERS == set(doctor.EXTRAS)
    assert all(extras[name][0].startswith(brings) for name, (brings, _) in doctor.EXTRAS.items())


def test_a_check_that_fails_is_a_fault_and_the_next_one_runs(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> Iterator[Finding]:
        yield Finding("one", "ok", "begun")
        raise ImportError("no numba\nand a long story")

    second = Finding("two", "note", "small", "wait")
    monkeypatch.setattr(doctor, "CHECKS", {"one": broken, "two": lambda: iter([second])})
    said = cli("doctor")
    first, fault, note, _, last = said.stdout.splitlines()
    assert (said.exit_code, first, note) == (1, "ok     one: begun", "note   two: small; wait")
    assert fault.startswith("fault  one: cannot be checked (ImportError: no numba); ")
    assert last == "1 fault: what stands behind each of them cures it. Begin with the first."
    monkeypatch.setattr(doctor, "CHECKS", {"two": lambda: iter([second])})
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
    states = {line.split()[1].rstrip(":"): line.split()[0] for line in said.stdout.splitlines() if ":" in line[:40]}
    assert states["Python"] == states["packages"] == states["kernel"] == states["self-test"] == "ok", said.stdout
