"""The scripts of ``.ci``, what stays ordinary of the browser tests, and the paths that CONTRIBUTING names."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]


def script(name: str) -> ModuleType:
    """A script of ``.ci`` as a module."""
    spec = importlib.util.spec_from_file_location(f"ci_{name}", ROOT / ".ci" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


slow_tests, lowest = script("slow_tests"), script("lowest")


@pytest.mark.parametrize(
    ("changed", "folders"),
    [
        ("icons/language/assembly.py", {"tests/icons/language"}),
        ("circuit/delivery/formats/tdms.py", {"tests/circuit/delivery/formats"}),
        ("circuit/rigs/thenar.toml", {"tests/circuit"}),
        ("circuit/inputs.py", {"tests/circuit"}),
        ("tests/perception/evidence/test_targets.py", {"tests/perception/evidence"}),
        ("notebooks/workbench/canvas_parts/draw.js", {"tests/browser", "tests/notebooks/workbench"}),
        ("notebooks/01_first_icon.ipynb", {"tests/notebooks"}),
        ("tests/browser/test_canvas_page.py", {"tests/browser"}),
        ("README.md", {"tests/test_readme.py"}),
        ("LICENSE", set()),
        ("tests/conftest.py", set()),
    ],
)
def test_a_changed_file_calls_for_the_tests_of_its_room(changed: str, folders: set[str]) -> None:
    assert set(slow_tests.folders_of(changed)) == folders
    selected = slow_tests.selection([changed])
    assert all(any(folder == room or folder.startswith(f"{room}/") for room in selected) for folder in folders)
    assert all((ROOT / room).exists() for room in selected)


def test_some_slow_tests_run_after_any_change() -> None:
    assert slow_tests.selection([]) == sorted(slow_tests.ALWAYS)


def test_a_folder_inside_another_is_not_run_twice() -> None:
    selected = slow_tests.selection(["circuit/inputs.py", "circuit/delivery/export.py"])
    assert [room for room in selected if room.startswith("tests/circuit")] == ["tests/circuit"]


def test_a_change_of_everything_gets_the_fixed_selection() -> None:
    rooms = [f"{folder.relative_to(ROOT)}/x.py" for folder in sorted((ROOT / "tests").glob("*/*/"))]
    assert slow_tests.selection(rooms) == sorted(slow_tests.ALWAYS)


def test_the_script_prints_folders() -> None:
    command = [sys.executable, ROOT / ".ci" / "slow_tests.py", "icons/language/assembly.py"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    assert "tests/icons/language" in printed


def test_the_ordinary_browser_tests_exist() -> None:
    folder = ROOT / "tests" / "browser"
    smoke = re.search(
        r"^SMOKE = \{(.*?)^\}", (folder / "conftest.py").read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )
    assert smoke is not None
    names = re.findall(r'"(\w+)"', smoke[1])
    text = "".join(path.read_text(encoding="utf-8") for path in sorted(folder.glob("test_*.py")))
    assert len(names) == 3
    assert all(text.count(f"def {name}(") == 1 for name in names)


def test_lowest_pins_every_requirement_of_the_program_once() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    pins = list(lowest.pins(text))
    names = [pin.partition("==")[0] for pin in pins]
    assert len(names) == len(set(names))
    project = tomllib.loads(text)["project"]
    assert len(pins) >= len(project["dependencies"]) + len(project["optional-dependencies"]) - 1
    assert {"numpy", "pyarrow", "distributed"} <= set(names)
    assert "pytest" not in names


def test_a_requirement_without_a_bound_is_refused() -> None:
    with pytest.raises(ValueError, match="'numpy<3' is not of the form name>=version"):
        list(lowest.pins('[project]\ndependencies = ["numpy<3"]'))


def test_contributing_names_folders_that_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = text.partition("| to change |")[2].partition("\n\n")[0]
    named = re.findall(r"`([\w.]+/[\w./]*)`", table)
    assert len(named) > 40
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_the_workflow_covers_every_python_on_every_system() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = [line.rpartition(" :: ")[2] for line in project["classifiers"] if " :: Python :: 3." in line]
    jobs = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8"))["jobs"]
    assert all(job["strategy"]["matrix"]["python"] == declared for job in jobs.values())
    assert [name.partition("-")[0] for name in jobs["platforms"]["strategy"]["matrix"]["os"]] == [
        "ubuntu",
        "macos",
        "windows",
    ]
    commands = [step["run"] for step in jobs["platforms"]["steps"] if "run" in step]
    assert "thermicon rank six-icons --people 20" in commands
    assert "python -m pytest" in commands


def test_the_conda_recipe_requires_what_the_package_requires() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    recipe = yaml.safe_load((ROOT / "conda-recipe" / "recipe.yaml").read_text(encoding="utf-8"))
    listed = [each.replace(" ", "").replace("matplotlib-base", "matplotlib") for each in recipe["requirements"]["run"]]
    python, *packages = listed
    assert packages == [each.replace(" ", "") for each in project["dependencies"]]
    assert python == f"python{project['requires-python']}".replace("3.11", "${{python_min}}")
