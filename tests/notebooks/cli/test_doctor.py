"""The command as a whole: the self-test, its output, and what remains of it on a broken installation."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from thermicon.notebooks.cli import examine, self_test
from thermicon.notebooks.cli.packages import Finding

Cli = Callable[..., Any]


def program(*lines: str) -> list[str]:
    """A Python program in place of the self-test."""
    return [sys.executable, "-c", "\n".join(lines)]


def test_the_stored_numbers_are_those_of_this_program() -> None:
    case = self_test.Case.shipped()
    computed = self_test.compute(case)
    assert set(computed) == {each.name for each in case.numbers}
    for each in case.numbers:
        assert computed[each.name] == pytest.approx(each.value, abs=each.tolerance / 4), each.name
        assert each.differs({each.name: each.value + 2 * each.tolerance}) is not None
        assert each.differs({each.name: float("nan")}) is not None


def test_the_self_test_compares() -> None:
    case = self_test.Case.shipped()
    numbers = {each.name: each.value for each in case.numbers}
    (fine,) = self_test.check_self_test(program(f"print({json.dumps(numbers)!r})"))
    assert fine.state == "ok"
    assert fine.text.startswith("cooling-step of six-icons on the thenar rig gives the 6 stored numbers (")
    wrong = json.dumps({**numbers, "onset": 1.5})
    (finding,) = self_test.check_self_test(program(f"print({wrong!r})"))
    assert (finding.state, finding.text.partition(": ")[2]) == (
        "fault",
        "onset is 1.5 s and should be 1.1349 ± 0.005 s",
    )


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (("raise SystemExit('broken\\nImportError: no numba')",), "ended with exit code 1: ImportError: no numba"),
        (("raise SystemExit(3)",), "ended with exit code 3: without a message"),
        pytest.param(
            ("import os, signal", "os.kill(os.getpid(), signal.SIGSEGV)"),
            "was ended by signal 11",
            marks=pytest.mark.skipif(sys.platform == "win32", reason="signals work differently there"),
        ),
    ],
)
def test_a_self_test_that_crashes_is_a_fault(lines: tuple[str, ...], words: str) -> None:
    (finding,) = self_test.check_self_test(program(*lines))
    assert finding.state == "fault"
    assert words in finding.text


def test_a_self_test_that_does_not_end_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(self_test, "WAITS_S", 0.2)
    (finding,) = self_test.check_self_test(program("import time", "time.sleep(60)"))
    assert (finding.state, finding.text) == ("fault", "not ended after 0.2 s")


@pytest.fixture
def checks(monkeypatch: pytest.MonkeyPatch) -> dict[str, Callable[[], Iterator[Finding]]]:
    """Two checks in place of all of them: `first` and `second` give what a test puts here."""
    given: dict[str, Callable[[], Iterator[Finding]]] = {}
    for name in ("first", "second"):
        monkeypatch.setattr(f"thermicon.notebooks.cli.packages.{name}", lambda name=name: given[name](), raising=False)
    monkeypatch.setattr(examine, "CHECKS", (("one", "packages", "first"), ("two", "packages", "second")))
    return given


def test_a_check_that_fails_is_a_fault_and_the_next_one_runs(
    cli: Cli, checks: dict[str, Callable[[], Iterator[Finding]]]
) -> None:
    def broken() -> Iterator[Finding]:
        yield Finding("one", "ok", "begun")
        raise ImportError("no numba\nand a long story")

    checks.update(first=broken, second=lambda: iter([Finding("two", "note", "small", "wait")]))
    said = cli("doctor")
    assert said.exit_code == 1
    assert said.stdout.splitlines() == [
        "ok     one: begun",
        "fault  one: cannot be checked (ImportError: no numba); mend the faults above, then run this again; else "
        "install thermicon in a new environment",
        "note   two: small; wait",
        "",
        "1 fault: what stands behind each of them cures it. Begin with the first.",
    ]


def test_notes_do_not_make_it_fail_and_json_has_everything(
    cli: Cli, checks: dict[str, Callable[[], Iterator[Finding]]]
) -> None:
    checks.update(
        first=lambda: iter([Finding("one", "ok", "fine")]), second=lambda: iter([Finding("two", "note", "a", "b")])
    )
    said = cli("doctor", "--json")
    assert (said.exit_code, said.stderr) == (0, "")
    data = json.loads(said.stdout)
    assert data["ok"] is True
    assert data["findings"] == [
        {"check": "one", "state": "ok", "text": "fine", "cure": None},
        {"check": "two", "state": "note", "text": "a", "cure": "b"},
    ]


def test_every_check_exists() -> None:
    from importlib import import_module

    for _, module, function in examine.CHECKS:
        assert callable(getattr(import_module(f"thermicon.notebooks.cli.{module}"), function))


def broken_run(missing: str, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the command in a process in which a library cannot be imported; only the checks of packages are made."""
    start = (
        f"import sys; sys.modules[{missing!r}] = None; sys.argv = ['thermicon', *{list(words)!r}]\n"
        "import thermicon.notebooks.cli.examine as e; e.CHECKS = e.CHECKS[:2] + e.CHECKS[6:7]\n"
        "from thermicon.notebooks.cli.main import main; main()"
    )
    return subprocess.run(
        [sys.executable, "-c", start], capture_output=True, encoding="utf-8", timeout=120, check=False
    )


@pytest.mark.parametrize(("missing", "cache"), [("typer", "ok"), ("lazy_loader", "fault")])
def test_it_runs_where_the_command_line_cannot_be_imported(missing: str, cache: str) -> None:
    run = broken_run(missing, "doctor", "--json")
    assert (run.returncode, run.stderr) == (1, "")
    first, *others = json.loads(run.stdout)["findings"]
    assert (first["check"], first["state"]) == ("commands", "fault")
    assert missing in first["text"]
    findings = {each["check"]: each for each in others}
    assert findings["Python"]["state"] == "ok"
    assert (findings["cache"]["state"] == "fault") == (cache == "fault"), "whether our own packages can be imported"


def test_other_commands_name_the_missing_library_and_the_doctor() -> None:
    run = broken_run("lark", "check", "six-icons")
    assert run.returncode == 1
    assert run.stdout == ""
    (line,) = run.stderr.splitlines()
    assert line.startswith("thermicon cannot start: ")
    assert "lark" in line
    assert line.endswith("thermicon doctor says what is missing and how to install it")


@pytest.mark.slow
def test_this_installation_is_examined(tmp_path: Path, process: Cli) -> None:
    said = process("doctor", cwd=tmp_path)
    assert "Traceback" not in said.stdout + said.stderr
    states = {line.split()[1].rstrip(":"): line.split()[0] for line in said.stdout.splitlines() if ":" in line[:40]}
    assert states["Python"] == states["packages"] == states["kernel"] == states["self-test"] == "ok", said.stdout
