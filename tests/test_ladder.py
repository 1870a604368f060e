"""The ladder: imports only from packages upstream or rooms below, and in no circle of files.

Imports for types alone (under ``TYPE_CHECKING``) are not executed and do not count: drawing rooms stand at the bottom
and name the objects that they draw by type only.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LADDER = {
    "base": ("words", "checks", "files", "numbers", "results"),
    "icons": ("model", "language", "files", "recordings", "pictures"),
    "circuit": ("rig", "solver", "safety", "play", "delivery", "fitting", "live"),
    "perception": (
        *("kernels", "observer", "sensation", "experiments", "identification"),
        *("ranking", "selection", "pilot", "evidence", "plots"),
    ),
    "notebooks": ("files", "figures", "report", "study", "cli", "editing", "timeline", "workbench"),
}
"""Rooms from the bottom up. Modules that stand in no room are below all of them, the front door is above."""


def room_of(package: str, path: Path) -> str:
    """The room of a module, the empty string for one that stands in none."""
    return path.relative_to(ROOT / package).parts[0] if path.parent.name != package else ""


def type_only(tree: ast.Module) -> set[int]:
    """Identities of the nodes that only type checkers read."""
    return {
        id(node)
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and isinstance(block.test, ast.Name) and block.test.id == "TYPE_CHECKING"
        for statement in block.body
        for node in ast.walk(statement)
    }


@cache
def imports_of(package: str, path: Path) -> list[tuple[int, tuple[str, ...], bool]]:
    """Line and full name of everything that a module imports, relative imports resolved; whether for types alone."""
    tree = ast.parse(path.read_text(encoding="utf-8"), filename=str(path))
    here, found = ("thermicon", package, *path.relative_to(ROOT / package).parts[:-1]), []
    unread = type_only(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(node.lineno, tuple(alias.name.split(".")), id(node) in unread) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = here[: len(here) - node.level + 1] if node.level else ()
            module = (*base, *(node.module.split(".") if node.module else ()))
            found += [(node.lineno, (*module, alias.name), id(node) in unread) for alias in node.names]
    return found


def room_named(package: str, name: tuple[str, ...]) -> str | None:
    """The room that an imported name comes from; None for the front door."""
    for length in range(len(name), 0, -1):
        place = ROOT / package / Path(*name[:length])
        if place.is_dir():
            return name[0]
        if place.with_suffix(".py").is_file():
            return name[0] if length > 1 else ""
    return None


def modules(package: str) -> list[Path]:
    """Every module of a package but its front doors, for imports and for ``python -m``."""
    return [
        path
        for path in sorted((ROOT / package).rglob("*.py"))
        if path.parent.name != package or path.stem not in {"__init__", "__main__"}
    ]


@pytest.mark.parametrize("package", LADDER)
def test_a_package_imports_only_itself_and_what_is_upstream(package: str) -> None:
    """Type checkers' imports too; the bare names of the folders belong to other distributions."""
    downstream = list(LADDER)[list(LADDER).index(package) + 1 :]
    wrong = [
        f"{path.relative_to(ROOT)}:{line} imports {'.'.join(name)}"
        for path in sorted((ROOT / package).rglob("*.py"))
        for line, name, _ in imports_of(package, path)
        if name[0] in LADDER or (name[0] == "thermicon" and len(name) > 1 and name[1] in downstream)
    ]
    wrong += [
        f"{path.relative_to(ROOT)}: its own package by its full name"
        for path in modules(package)
        if re.search(rf"^\s*from thermicon\.{package}[. ]", path.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("package", LADDER)
def test_a_room_imports_from_rooms_below_it(package: str) -> None:
    assert {room_of(package, path) for path in modules(package)} - {""} == set(LADDER[package])
    floor = {"": -1} | {room: k for k, room in enumerate(LADDER[package])}
    wrong = []
    for path in modules(package):
        if path.stem == "drawn":  # the one place that asks the room of pictures, when a picture is made
            continue
        room = room_of(package, path)
        for line, full, for_types in imports_of(package, path):
            if for_types or full[:2] != ("thermicon", package):
                continue
            name = full[2:]
            target = room_named(package, name)
            if target is None or (target != room and floor[target] >= floor[room]):
                wrong.append(f"{path.relative_to(ROOT)}:{line} imports {'.'.join(name)}")
    assert not wrong, f"the ladder of {package} is {' < '.join(LADDER[package])}:\n" + "\n".join(wrong)


def files_of(package: str, path: Path) -> set[Path]:
    """The files of this program that a module imports, at its front or later, but for types."""
    found = set()
    for _, name, for_types in imports_of(package, path):
        for length in range(len(name), 2, -1):
            place = ROOT / Path(*name[1:length])
            if not for_types and name[0] == "thermicon" and place.with_suffix(".py").is_file():
                found.add(place.with_suffix(".py"))
                break
    return found - {path}


def circles(imports: dict[Path, set[Path]]) -> list[list[str]]:
    """Files that import one another, directly or through others, as names in order."""
    reached = {path: set(targets) for path, targets in imports.items()}
    for middle in imports:
        for targets in reached.values():
            if middle in targets:
                targets |= reached[middle]
    rings = {frozenset(other for other in reached[path] if path in reached.get(other, ())) for path in imports}
    return sorted(sorted(path.relative_to(ROOT).as_posix() for path in ring) for ring in rings if ring)


def test_no_files_import_one_another_in_a_circle() -> None:
    imports = {path: files_of(package, path) for package in LADDER for path in modules(package)}
    assert circles(imports) == []
