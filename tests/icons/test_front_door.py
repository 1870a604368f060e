"""Front doors load a room when one of its names is asked for; the list for type checkers names the same modules."""

import ast
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LAZY = ("icons", "circuit", "perception")


def listed(package: str) -> dict[str, str]:
    """Names and modules that type checkers read, and those that are imported at once."""
    tree = ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8"))
    return {
        alias.name: str(node.module)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.level == 1 and node.module != "front_door"
        for alias in node.names
    }


@pytest.mark.parametrize("package", LAZY)
def test_every_name_is_the_one_that_type_checkers_see(package: str) -> None:
    door = import_module(f"thermicon.{package}")
    names = listed(package)
    assert set(door.__all__) == set(names)
    for name, module in names.items():
        assert getattr(door, name) is getattr(import_module(f"thermicon.{package}.{module}"), name)
    assert set(door.__all__) <= set(dir(door))


@pytest.mark.parametrize("package", LAZY)
def test_an_unknown_name_is_an_error_of_its_own(package: str) -> None:
    with pytest.raises(AttributeError, match=f"thermicon.{package}.*nothing_like_it"):
        import_module(f"thermicon.{package}").nothing_like_it  # noqa: B018
