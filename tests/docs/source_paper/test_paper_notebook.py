"""The notebook of the paper's figures: thin, without outputs, and every cell runs."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).resolve().parents[3] / "docs/explain/06_the_papers_figures.ipynb"


def test_it_is_thin_and_has_no_outputs() -> None:
    cells = nbformat.read(NOTEBOOK, as_version=4).cells
    code = [cell for cell in cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    assert all(len(cell.source.splitlines()) <= 7 for cell in code)
    assert "def " not in "".join(cell.source for cell in code)


@pytest.mark.slow
def test_every_cell_runs_and_shows_something() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    resources = {"metadata": {"path": str(NOTEBOOK.parent)}}
    NotebookClient(notebook, timeout=60, kernel_name="python3", resources=resources).execute()
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    kinds = [{kind for output in cell.outputs for kind in output.get("data", {"text": 1})} for cell in code]
    assert kinds[0] == set()
    assert [("image/png" in kind) for kind in kinds[1:]] == [*[True] * 7, False, False]
    assert "text/html" in kinds[8]
    table = code[9].outputs[0]["data"]["text/html"]
    assert all(words in table for words in ("change at the receptors", "mm from skin", "claim", "why", "differs"))
    assert len(nbformat.writes(notebook)) < 300_000
