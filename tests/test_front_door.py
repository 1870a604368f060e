"""Front doors that load a room on demand, with one list of names for people and type checkers."""

import ast
import pydoc
import subprocess
import sys
import textwrap
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
DOORS = ("thermicon", "thermicon.icons", "thermicon.circuit", "thermicon.perception", "thermicon.notebooks")
HEAVY = ("lark", "numpy", "pandas", "numba", "scipy", "matplotlib", "IPython")


def listed(package: str) -> dict[str, str]:
    """Names and the modules that they come from, as type checkers read them."""
    tree = ast.parse((ROOT / package.rpartition(".")[2] / "__init__.pyi").read_text(encoding="ascii"))
    return {
        alias.name: f"{package}.{node.module or ''}".rstrip(".")
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.name == alias.asname  # else it is not for others
    }


@pytest.mark.parametrize("package", DOORS)
def test_every_name_is_the_one_that_type_checkers_see_and_no_other_is_there(package: str) -> None:
    door, names = import_module(package), listed(package)
    assert sorted(door.__all__) == sorted(names)
    for name, module in names.items():
        assert getattr(door, name) is getattr(import_module(module), name)
    assert set(door.__all__) <= set(dir(door))
    assert (ROOT / package.rpartition(".")[2] / "py.typed").is_file()
    with pytest.raises(AttributeError, match=f"{package}.*nothing_like_it"):
        _ = door.nothing_like_it


@pytest.mark.parametrize("start", [".", ".."], ids=["the checkout", "elsewhere"])
def test_the_short_names_are_there_wherever_python_starts_and_load_nothing_heavy(start: str) -> None:
    code = (
        "import sys, thermicon, thermicon.icons, thermicon.perception\n"
        f"print([name for name in {HEAVY} if name in sys.modules])\n"
        "from thermicon import circuit, parse\n"
        "print(parse is thermicon.icons.parse, circuit.Rig is thermicon.Rig)"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT / start, capture_output=True, text=True, check=True)
    assert run.stdout.splitlines() == ["[]", "True True"]


def test_help_fits_two_screens_and_begins_with_the_eight_lines_of_the_readme() -> None:
    import thermicon

    lines = textwrap.dedent((thermicon.__doc__ or "").partition("\n\n")[2].partition("\n\nSets")[0])
    assert len(lines.replace("\n\n", "\n").splitlines()) == 8
    assert f"```python\n{lines}\n# →" in (ROOT / "README.md").read_text(encoding="utf-8")
    said = pydoc.plain(pydoc.render_doc(thermicon)).splitlines()
    assert said[6].strip() == lines.splitlines()[0]
    assert len(said) <= 100
