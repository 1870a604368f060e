"""The notebook of a pilot: every cell runs, the files are there, and the interval holds the truth it is shown with."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).parents[2] / "notebooks/09_your_pilot_sharpens_the_prediction.ipynb"


@pytest.mark.slow
def test_every_cell_runs_and_shows_something(tmp_path: Path) -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    options = {"timeout": 120, "kernel_name": "python3", "store_widget_state": False}
    NotebookClient(notebook, **options, resources={"metadata": {"path": str(tmp_path)}}).execute()
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    outputs = [output for cell in code for output in cell.outputs]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 1
    assert not [output.text for output in outputs if output.get("name") == "stderr"]
    said = "".join(output.get("text", "") for output in outputs)
    assert "participant,trial,presented,responded\nP1,1," in said
    assert "# written by thermicon observed from inputs " in said and "# participants: 4" in said
    low, high, truth = (int(word.strip("%;")) for word in said.split("after: ")[1].split()[:5:2])
    assert low <= truth <= high
    assert {"trials.csv", "lab.toml", "lab.csv"} <= {path.name for path in tmp_path.iterdir()}
