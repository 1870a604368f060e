"""The house rules that a machine can check."""

import doctest
import importlib
import io
import os
import pkgutil
import re
import sys
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FLOW = ("base", "icons", "circuit", "perception", "notebooks")
LINES_AT_MOST = 400
DOORS = {
    "tests/count.py",
    "tests/test_front_door.py",
    "tests/test_docstrings.py",
    "tests/test_arguments.py",
    "tests/docs/test_site.py",
}
"""Tests of what users import, which the ground floor has nothing of."""
GENERATED = {"build", "dist", "__pycache__", "node_modules"}

# Spelled in pieces so that this file does not find itself.
UNWANTED = {
    "a package registry's host": r"py" r"pi\.org|python" r"hosted\.org|registry\." r"npmjs|deb\." r"debian\.org",
    "a path outside the project": r"/wo" r"rk/|\.\./sha" r"red\b|/fa" r"rm/",
    "the number of an issue": r"(?i)\b(iss" r"ue|pull req" r"uest|tick" r"et)s?\s+#?\d+",
}


def module_names() -> list[str]:
    """Every module of the packages, by its import name, found without importing anything."""
    found = []
    for package in FLOW:
        found.append(f"thermicon.{package}")
        for path in sorted((ROOT / package).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            if parts[-1] != "__init__":
                found.append(".".join(("thermicon", *parts)))
            elif len(parts) > 2:
                found.append(".".join(("thermicon", *parts[:-1])))
    return found


def test_every_list_of_the_packages_knows_all_of_them() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    assert [name.partition(".")[2] for name in project["setuptools"]["package-dir"]][1:] == [*FLOW]
    assert project["coverage"]["run"]["source"] == ["thermicon", *FLOW]
    shorter = []
    for path in (path for path in project_files() if path.suffix == ".py" and path != Path(__file__)):
        here = path.relative_to(ROOT).as_posix()
        if here.startswith(("tests/", ".ci/", "docs/")) and here not in DOORS:
            text = path.read_text(encoding="utf-8")
            shorter += [here for before in re.findall(r'(.{8})"icons", "circuit"', text) if before != '"base", ']
            shorter += [here for before in re.findall(r"(.{5})icons\|circuit", text) if before != "base|"]
    assert not shorter


def project_files() -> Iterator[Path]:
    """Every file of the project: the tree without dot caches, environments and what builds leave behind."""
    for folder, subfolders, names in os.walk(ROOT):
        subfolders[:] = [
            name
            for name in subfolders
            if name not in GENERATED
            and not name.endswith(".egg-info")
            and (not name.startswith(".") or name in {".github", ".ci"})
            and not (Path(folder) / name / "pyvenv.cfg").exists()
        ]
        yield from (Path(folder) / name for name in names if name != ".git")  # in a second checkout, a file


def test_walking_the_packages_finds_every_file_and_imports_none_by_its_bare_name() -> None:
    walked = []
    for package in FLOW:
        module = importlib.import_module(f"thermicon.{package}")
        walked += [module.__name__]
        walked += [info.name for info in pkgutil.walk_packages(module.__path__, f"{module.__name__}.")]
    assert sorted(walked) == sorted(module_names())
    for name in walked:
        importlib.import_module(name)
    assert not set(FLOW) & set(sys.modules), "a folder was imported a second time under its bare name"


@pytest.mark.parametrize("name", module_names())
def test_examples_in_docstrings_run(name: str) -> None:
    module = importlib.import_module(name)
    said = io.StringIO()
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    for example in doctest.DocTestFinder(exclude_empty=True).find(module, name):
        runner.run(example, out=said.write)
    assert runner.failures == 0, said.getvalue()


def test_no_module_is_too_long() -> None:
    lengths = {
        path: len(path.read_text(encoding="utf-8").splitlines()) for path in project_files() if path.suffix == ".py"
    }
    long = {str(path): n for path, n in lengths.items() if n > LINES_AT_MOST}
    assert not long, f"over {LINES_AT_MOST} lines, split where the idea splits: {long}"


def test_modules_open_with_one_idea() -> None:
    """Few first sentences have a semicolon, or a comma beside "and"."""
    texts = (path.read_text("utf-8") for path in project_files() if path.suffix == ".py")
    firsts = [found[1] for text in texts if (found := re.match(r'\W*"""(.*?)(?:[.?]\s|""")', text, re.DOTALL))]
    crowded = [first for first in firsts if ";" in first or (" and " in first and "," in first)]
    assert len(firsts) > 500 and len(crowded) <= 60, "\n".join(crowded)


def test_no_two_classes_have_one_name() -> None:
    places = defaultdict(list)
    for path in (path for package in FLOW for path in sorted((ROOT / package).rglob("*.py"))):
        for name in re.findall(r"^class (\w+)", path.read_text(encoding="utf-8"), re.MULTILINE):
            places[name].append(str(path.relative_to(ROOT)))
    shared = [f"{name}: {', '.join(found)}" for name, found in sorted(places.items()) if len(found) > 1]
    assert not shared, "one name, one thing; rename what is not public:\n" + "\n".join(shared)


@pytest.mark.parametrize("what", UNWANTED)
def test_no_file_mentions(what: str) -> None:
    pattern = re.compile(UNWANTED[what])
    found = []
    for path in project_files():
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(text.splitlines(), 1):
            if match := pattern.search(line):
                found.append(f"{path.relative_to(ROOT)}:{number} {match[0]}")
    assert not found, f"{what} does not belong in the project:\n" + "\n".join(found)


def test_the_version_is_the_same_everywhere() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    assert cited is not None
    assert cited[1].strip('"') == version
    recipe = (ROOT / "conda-recipe" / "recipe.yaml").read_text(encoding="utf-8")
    assert f'\n  version: "{version}"\n' in recipe
    headings = re.findall(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    released = [heading for heading in headings if heading != "Unreleased"]
    assert "Unreleased" in headings or released
    assert not released or released[0] == version
