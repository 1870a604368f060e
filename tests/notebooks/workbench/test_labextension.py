"""The extension for JupyterLab is what its script writes, and the package installs it where JupyterLab looks."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

from thermicon.notebooks.workbench.canvas import LAB_ENTRY as ENTRY
from thermicon.notebooks.workbench.canvas import lab_entry_text as entry_text

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "notebooks" / "labextension"


def test_the_extension_knows_the_words_of_the_language() -> None:
    assert (FOLDER / ENTRY).read_text(encoding="utf-8") == entry_text()
    assert '"sawtooth"' in entry_text()


def test_the_package_installs_it_where_jupyterlab_looks() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    placed = project["tool"]["setuptools"]["data-files"]
    named = json.loads((FOLDER / "package.json").read_text(encoding="utf-8"))
    place = f"share/jupyter/labextensions/{named['name']}"
    assert f"notebooks/labextension/{named['jupyterlab']['_build']['load']}" in placed[f"{place}/static"]
    assert "notebooks/labextension/package.json" in placed[place]
    assert all((ROOT / file).is_file() for files in placed.values() for file in files)
