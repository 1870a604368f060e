"""``thermicon doctor``: what it examines, its output, and what remains of it on a broken installation."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from importlib.metadata import Distribution
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from thermicon.notebooks.cli import examine, machine, packages, self_test
from thermicon.notebooks.cli.packages import Finding

Cli = Callable[..., Any]
ROOT = Path(__file__).resolve().parents[3]
ONLY_FOR_DEVELOPERS = {"test", "docs"}


def program(*lines: str) -> list[str]:
    """A Python program in place of the self-test."""
    return [sys.executable, "-c", "\n".join(lines)]


def installation(folder: Path, *files: str) -> Path:
    """The metadata of a distribution of thermicon with these files."""
    info = folder / "thermicon-9.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: thermicon\nVersion: 9\n", encoding="utf-8")
    (info / "RECORD").write_text("".join(f"{name},,\n" for name in files), encoding="utf-8")
    return info


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("x", "bad", "y"), "state 'bad' is not one of ok, note, fault"),
        (("x", "fault", "y"), "x: fault without a cure"),
        (("x", "ok", "y", "z"), "x: ok with a cure"),
        (("x", "ok", "y\nz"), "x: a finding is one line"),
    ],
)
def test_a_finding_is_one_line_with_its_cure(arguments: tuple[Any, ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Finding(*arguments)


class TestSelfTest:
    """Stored numbers against computed ones, in a process of its own."""

    def test_the_stored_numbers_are_those_of_this_program(self) -> None:
        case = self_test.Case.shipped()
        computed = self_test.compute(case)
        assert set(computed) == {each.name for each in case.numbers}
        for each in case.numbers:
            assert computed[each.name] == pytest.approx(each.value, abs=each.tolerance / 4), each.name
            assert each.differs({each.name: each.value + 2 * each.tolerance}) is not None
            assert each.differs({each.name: float("nan")}) is not None

    def test_it_compares(self) -> None:
        case = self_test.Case.shipped()
        numbers = {each.name: each.value for each in case.numbers}
        (fine,) = self_test.check_self_test(program(f"print({json.dumps(numbers)!r})"))
        assert fine.state == "ok"
        wrong = json.dumps({**numbers, "onset": 1.5})
        (finding,) = self_test.check_self_test(program(f"print({wrong!r})"))
        assert finding.state == "fault"
        assert "onset is 1.5 s and should be 1.1349 ± 0.005 s" in finding.text

    @pytest.mark.parametrize(
        ("lines", "words"),
        [
            (("raise SystemExit('broken\\nImportError: no numba')",), "exit code 1: ImportError: no numba"),
            (("raise SystemExit(3)",), "exit code 3: without a message"),
            pytest.param(
                ("import os, signal", "os.kill(os.getpid(), signal.SIGSEGV)"),
                "was ended by signal 11",
                marks=pytest.mark.skipif(sys.platform == "win32", reason="signals work differently there"),
            ),
            (("import time", "time.sleep(60)"), "not ended after 0.5 s"),
        ],
    )
    def test_a_crash_is_a_fault(self, lines: tuple[str, ...], words: str, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(self_test, "WAITS_S", 0.5 if "time" in lines[0] else 60.0)
        (finding,) = self_test.check_self_test(program(*lines))
        assert finding.state == "fault"
        assert words in finding.text


class TestMachine:
    """Shipped files, cache, ngspice, and the Python that runs notebooks."""

    def test_ngspice_that_is_missing_is_a_note(self, monkeypatch: pytest.MonkeyPatch) -> None:
        assert [each.state for each in machine.check_ngspice()] == ["ok"]
        monkeypatch.setenv("PATH", "")
        (finding,) = machine.check_ngspice()
        assert (finding.state, "netlist" in finding.text) == ("note", True)

    def test_the_cache_is_measured(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("THERMICON_CACHE", str(tmp_path / "cache"))
        (fresh,) = machine.check_cache()
        assert (fresh.state, fresh.text.partition(";")[0]) == ("ok", f"{tmp_path / 'cache'}, writable, 0 MB")
        (tmp_path / "cache" / "compiled" / "code").write_bytes(bytes(2_000_000))
        (kept,) = machine.check_cache()
        assert "writable, 2 MB" in kept.text

    def test_a_shipped_file_that_is_missing_is_a_fault(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        names = ("thermicon/icons/data/a.toml", "thermicon/icons/b.cue")
        info = installation(tmp_path, *names)
        monkeypatch.setattr("importlib.metadata.distribution", lambda _: Distribution.at(info))
        (tmp_path / "thermicon/icons").mkdir(parents=True)
        (tmp_path / names[1]).touch()
        (finding,) = machine.check_data()
        assert (finding.state, finding.text) == ("fault", f"1 of 2 shipped files are missing, such as {names[0]}")
        assert "--force-reinstall" in (finding.cure or "")

    @pytest.mark.parametrize(
        ("python", "state", "words"),
        [
            ("python", "ok", "the Python of the notebook server"),
            (sys.executable, "ok", sys.executable),
            ("/nowhere/bin/python3", "fault", "names /nowhere/bin/python3, which is not there (/specs/python3)"),
            ("/bin/sh", "fault", "notebooks do not find thermicon: python3 runs /bin/sh"),
        ],
    )
    def test_the_kernel_is_this_python(
        self, python: str, state: str, words: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        spec = SimpleNamespace(argv=[python, "-m", "ipykernel_launcher"], resource_dir="/specs/python3")
        monkeypatch.setattr("jupyter_client.kernelspec.KernelSpecManager.get_kernel_spec", lambda *_: spec)
        (finding,) = machine.check_kernel()
        assert finding.state == state
        assert words in finding.text
        assert finding.cure == (None if state == "ok" else f"{sys.executable} -m ipykernel install --sys-prefix")


class TestPackages:
    """Versions, requirements and extras: what pip says, and what the metadata of distributions say."""

    @pytest.mark.parametrize(
        ("said", "code", "states", "words"),
        [
            ("No broken requirements found.", 0, ["ok"], "fits the others (numpy "),
            ("thermicon 9 requires warm-lib, which is not installed.", 1, ["fault"], "requires warm-lib"),
            ("cold 1 has requirement b<2, but you have b 2.1.\nthermicon 9 requires c.", 1, ["note", "fault"], "b 2.1"),
            ("", 1, ["note"], "since pip check says: No module named pip"),
        ],
    )
    def test_requirements_are_what_pip_says(
        self, said: str, code: int, states: list[str], words: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        run = subprocess.CompletedProcess([], code, said, "No module named pip\n")
        monkeypatch.setattr(packages, "run_program", lambda *_: run)
        found = list(packages.check_required())
        assert [each.state for each in found] == states
        assert words in found[0].text

    def test_an_extra_that_is_missing_is_a_note_with_what_it_is_for(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(packages, "EXTRAS", {"page": ("no-lib", "pages"), "study": ("numpy", "studies")})
        page, study = packages.check_extras()
        assert (page.state, page.text) == ("note", "not installed, for pages")
        assert page.cure == f'{sys.executable} -m pip install "thermicon[page]"'
        assert (study.state, study.text) == ("ok", "for studies")

    def test_every_extra_has_its_package_and_a_purpose(self) -> None:
        project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        extras = project["optional-dependencies"]
        assert set(extras) - ONLY_FOR_DEVELOPERS == set(packages.EXTRAS)
        assert all(extras[name][0].startswith(brings) for name, (brings, _) in packages.EXTRAS.items())

    @pytest.mark.parametrize(
        ("name", "value", "words", "cure"),
        [
            ("distributions", [], "is not installed", "-m pip install -e ."),
            ("installed_folders", ["/elsewhere/notebooks"], "hides the installed /elsewhere/notebooks", "with -P"),
        ],
    )
    def test_a_program_that_is_not_installed_or_hidden_is_a_fault(
        self, name: str, value: Any, words: str, cure: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(packages, name, lambda **_: value)
        (finding,) = packages.check_program()
        assert (finding.state, finding.check) == ("fault", "thermicon")
        assert words in finding.text
        assert (finding.cure or "").endswith(cure)


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
    first, fault, *others = said.stdout.splitlines()
    assert fault.startswith("fault  one: cannot be checked (ImportError: no numba); ")
    assert [first, *others] == [
        "ok     one: begun",
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
    assert (run.returncode, run.stdout) == (1, "")
    (line,) = run.stderr.splitlines()
    for word in ("cannot start", "lark", "thermicon doctor"):
        assert word in line


@pytest.mark.slow
def test_this_installation_is_examined(tmp_path: Path, process: Cli) -> None:
    said = process("doctor", cwd=tmp_path)
    assert "Traceback" not in said.stdout + said.stderr
    states = {line.split()[1].rstrip(":"): line.split()[0] for line in said.stdout.splitlines() if ":" in line[:40]}
    assert states["Python"] == states["packages"] == states["kernel"] == states["self-test"] == "ok", said.stdout
