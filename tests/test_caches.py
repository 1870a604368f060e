"""Every cache of the program is listed in caches.toml with the time that it saves."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CACHES = {"cache", "lru_cache", "cached_property"}
LEAST_PER_CENT = 0.8
"""Of a command or an evaluation: what saves less is not worth what it hides."""


def name_of(node: ast.expr) -> str:
    """The name of a decorator or of a called function, without its arguments."""
    return name_of(node.func) if isinstance(node, ast.Call) else getattr(node, "id", getattr(node, "attr", ""))


def caches_in(path: Path) -> Iterator[str]:
    """Functions with a cache, and names that a cached function is given: ``room.module.name``."""
    module = path.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".")
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef) and any(name_of(each) in CACHES for each in node.decorator_list):
            yield f"{module}.{node.name}"
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call) and name_of(node.value) in CACHES:
            yield f"{module}.{name_of(node.targets[0])}"


def test_each_cache_is_known_by_what_it_saves() -> None:
    rooms = ("icons", "circuit", "perception", "notebooks")
    found = sorted(name for room in rooms for path in (ROOT / room).rglob("*.py") for name in caches_in(path))
    listed = tomllib.loads((ROOT / "tests" / "caches.toml").read_text(encoding="utf-8"))
    assert found == sorted(listed)
    assert [name for name, (saves_s, share, _) in listed.items() if share < LEAST_PER_CENT or saves_s <= 0.0] == []
