"""The risk file names tests as its evidence: each of them exists, as a file or as a test in it."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("docs/explain/safety.md",)
NAMED = re.compile(r"`?(tests/[\w/]+\.py)(?:::(\w+))?")
FILE = re.compile(r"`((?:icons|circuit|perception|notebooks)/[\w./-]+\.\w+)`")


def faults_of(text: str) -> list[str]:
    """What a page names that does not exist: a test file, a test in it, or a file of the project."""
    found = [f"{name}: no such file" for name in FILE.findall(text) if not (ROOT / name).is_file()]
    for file, test in NAMED.findall(text):
        if not (ROOT / file).is_file():
            found.append(f"{file}: no such file")
        elif test and test not in named_in(ROOT / file):
            found.append(f"{file}::{test}: no such test")
    return found


def named_in(path: Path) -> set[str]:
    """Names of the test functions of a file, those in classes included."""
    tree = ast.parse(path.read_text(encoding="utf-8"), filename=str(path))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) and node.name[:5] == "test_"}


@pytest.mark.parametrize("page", PAGES)
def test_every_file_and_test_that_a_page_names_exists(page: str) -> None:
    assert faults_of((ROOT / page).read_text(encoding="utf-8")) == []


def test_what_does_not_exist_is_found() -> None:
    text = "`tests/none.py`, `tests/test_house.py::test_none`, `circuit/none.py`, `tests/test_house.py`"
    assert faults_of(text) == [
        "circuit/none.py: no such file",
        "tests/none.py: no such file",
        "tests/test_house.py::test_none: no such test",
    ]
