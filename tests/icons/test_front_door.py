"""Front doors load a room when one of its names is asked for, and list each name once, for people and type checkers."""

import ast
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("icons", "circuit", "perception", "notebooks")


def listed(package: str) -> dict[str, str]:
    """Names and their modules, as type checkers read them."""
    tree = ast.parse((ROOT / package / "__init__.pyi").read_text(encoding="ascii"))
    return {
        alias.name: str(node.module)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.name == alias.asname  # else it is not for others
    }


@pytest.mark.parametrize("package", PACKAGES)
def test_every_name_is_the_one_that_type_checkers_see(package: str) -> None:
    door = import_module(f"thermicon.{package}")
    names = listed(package)
    assert set(door.__all__) == set(names)
    for name, module in names.items():
        assert getattr(door, name) is getattr(import_module(f"thermicon.{package}.{module}"), name)
    assert set(door.__all__) <= set(dir(door))


@pytest.mark.parametrize("package", PACKAGES)
def test_an_unknown_name_is_an_error_of_its_own(package: str) -> None:
    with pytest.raises(AttributeError, match=f"thermicon.{package}.*nothing_like_it"):
        import_module(f"thermicon.{package}").nothing_like_it  # noqa: B018
