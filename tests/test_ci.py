"""The scripts and workflows of continuous integration."""

import re
import signal
import subprocess
import sys
import tomllib
from importlib.machinery import SourceFileLoader
from pathlib import Path, PurePosixPath
from types import ModuleType

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
WORKFLOWS = ROOT / ".github" / "workflows"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def script(name: str) -> ModuleType:
    """A script of ``.ci`` as a module."""
    loader = SourceFileLoader(f"ci_{name}", str(ROOT / ".ci" / f"{name}.py"))
    module = ModuleType(loader.name)
    module.__file__ = loader.path
    loader.exec_module(module)
    return module


slow_tests, lowest = script("slow_tests"), script("lowest")


PACKAGED = "tests/test_package.py"


@pytest.mark.parametrize(
    ("changed", "called"),
    [
        ("icons/language/assembly.py", {"tests/icons/language", PACKAGED}),
        ("tests/perception/evidence/test_targets.py", {"tests/perception/evidence"}),
        ("notebooks/workbench/canvas.py", {"tests/browser", "tests/notebooks/workbench", PACKAGED}),
        ("circuit/safety/words.py", {"tests/circuit/safety", "tests/test_readme.py", PACKAGED}),
        ("README.md", {"tests/test_readme.py"}),
        ("docs/how-to/simulate.md", {"tests/docs", "tests/test_readme.py"}),
        ("pyproject.toml", {PACKAGED}),
        ("MANIFEST.in", {PACKAGED}),
        (".ci/lowest.py", {PACKAGED}),
        ("conda-recipe/recipe.yaml", {PACKAGED}),
        ("Dockerfile", {PACKAGED}),
        ("tests/conftest.py", set()),
    ],
)
def test_a_changed_file_calls_for_the_tests_that_prove_it(changed: str, called: set[str]) -> None:
    assert set(slow_tests.tests_of(changed)) == called
    selected = slow_tests.selection([changed])
    assert set(selected) >= set(slow_tests.ALWAYS)
    assert all(any(test == each or test.startswith(f"{each}/") for each in selected) for test in called)
    assert all((ROOT / each).exists() for each in (*selected, *slow_tests.MINUTES))


def test_data_of_a_package_call_for_all_its_rooms_each_once() -> None:
    called = list(slow_tests.tests_of("circuit/rigs/thenar.toml"))
    assert {f"tests/circuit/{room}" for room in ("rig", "solver", "safety", "delivery")} < set(called)
    command = [sys.executable, ROOT / ".ci" / "slow_tests.py", "circuit/rigs/thenar.toml", "circuit/delivery/pack.py"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    assert [each for each in printed if each.startswith("tests/circuit/delivery")] == ["tests/circuit/delivery"]


def test_a_push_whose_parent_is_unknown_asks_all_folders(monkeypatch: pytest.MonkeyPatch) -> None:
    head = slow_tests.git("rev-parse", "HEAD")
    for given, known in ((head, head), ("0" * 40, "")):
        monkeypatch.setenv("THERMICON_BASE", given)
        assert slow_tests.base() == known
    printed = subprocess.run(
        [sys.executable, ROOT / ".ci" / "slow_tests.py"], capture_output=True, text=True, check=True
    ).stdout.split()
    assert printed == slow_tests.selection(slow_tests.git("ls-files").splitlines())


@pytest.mark.skipif(sys.platform == "win32", reason="jobs in the background of a shell")
def test_tests_do_not_depend_on_how_they_are_started() -> None:
    interrupted = "test_an_interrupt_ends_with_130_and_no_traceback or test_a_request_to_end_leaves_nothing"
    where = [ROOT / "tests/notebooks/cli/test_process.py", ROOT / "tests/notebooks/files/test_exportfolder.py"]
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-n0", "-p", "no:cacheprovider", *where, "-k", interrupted],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    )
    assert "3 passed" in run.stdout and run.returncode == 0, run.stdout


def test_a_change_of_everything_gets_what_fits_and_that_is_most() -> None:
    everything = [*(f"{package}/x.py" for package in slow_tests.PACKAGES), "README.md", "docs/x.md", "pyproject.toml"]
    called = {test for name in everything for test in slow_tests.tests_of(name)}
    selected = slow_tests.selection(everything)
    assert sum(slow_tests.MINUTES.get(each, slow_tests.A_TEST) for each in selected) <= slow_tests.MOST_MINUTES
    assert len(selected) > 0.7 * len(called)
    assert {"tests/test_package.py", "tests/test_readme.py"} <= set(selected)


def test_the_ordinary_browser_test_exists() -> None:
    folder = ROOT / "tests" / "browser"
    (name,) = re.findall(r'^SMOKE = "(\w+)"', (folder / "conftest.py").read_text(encoding="utf-8"), re.MULTILINE)
    text = "".join(path.read_text(encoding="utf-8") for path in sorted(folder.glob("test_*.py")))
    assert text.count(f"def {name}(") == 1


def test_lowest_pins_every_requirement_of_the_program_once() -> None:
    pins = list(lowest.pins((ROOT / "pyproject.toml").read_text(encoding="utf-8")))
    names = [pin.partition("==")[0] for pin in pins]
    assert len(names) == len(set(names))
    assert len(pins) >= len(PROJECT["dependencies"]) + len(PROJECT["optional-dependencies"]) - 1
    assert {"numpy", "pyarrow", "distributed"} <= set(names)
    assert "pytest" not in names
    with pytest.raises(ValueError, match="'numpy<3' is not of the form name>=version"):
        list(lowest.pins('[project]\ndependencies = ["numpy<3"]'))


def test_contributing_names_folders_that_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = text.partition("| to change |")[2].partition("\n\n")[0]
    named = re.findall(r"`([\w.]+/[\w./]*)`", table)
    assert len(named) > 40
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_the_workflow_covers_every_python_on_every_system_once() -> None:
    declared = [line.rpartition(" :: ")[2] for line in PROJECT["classifiers"] if " :: Python :: 3." in line]
    jobs = yaml.safe_load((WORKFLOWS / "ci.yml").read_text(encoding="utf-8"))["jobs"]
    assert all(job["strategy"]["matrix"]["python"] == declared for job in jobs.values())
    listed = [job["strategy"]["matrix"].get("os", [job["runs-on"]]) for job in jobs.values()]
    assert sorted(name.partition("-")[0] for names in listed for name in names) == ["macos", "ubuntu", "windows"]
    commands = [step["run"] for step in jobs["platforms"]["steps"] if "run" in step]
    assert {"thermicon rank six-icons --people 20", "python -m pytest"} <= set(commands)


def test_the_weekly_parts_are_those_that_the_script_knows() -> None:
    jobs = yaml.safe_load((WORKFLOWS / "weekly.yml").read_text(encoding="utf-8"))["jobs"]
    known = re.findall(r"^    (\w+)\) .*pytest", (ROOT / ".ci" / "run").read_text(encoding="utf-8"), re.MULTILINE)
    assert jobs["part"]["strategy"]["matrix"]["part"] == known


def test_the_image_compiles_into_a_folder_that_no_home_hides() -> None:
    image = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    cache, home = (re.search(rf"^{key}[ =](\S+)$", image, re.MULTILINE) for key in ("ENV THERMICON_CACHE", "WORKDIR"))
    assert cache and home and not PurePosixPath(cache[1]).is_relative_to(home[1])
    assert f"--owner=jovyan --group=jovyan --mode=700 {cache[1]}\n" in image


def test_the_conda_recipe_requires_what_the_package_requires() -> None:
    recipe = yaml.safe_load((ROOT / "conda-recipe" / "recipe.yaml").read_text(encoding="utf-8"))
    listed = [each.replace(" ", "").replace("matplotlib-base", "matplotlib") for each in recipe["requirements"]["run"]]
    assert listed[1:] == [each.replace(" ", "") for each in PROJECT["dependencies"]]
    assert listed[0] == f"python{PROJECT['requires-python']}".replace("3.11", "${{python_min}}")
