"""The tutorials as they are shipped."""

import os
import re
from itertools import pairwise
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

FOLDER = Path(__file__).parents[2] / "notebooks"
PICTURES = {
    "01_first_icon": 2,
    "02_a_rig_of_your_own": 3,
    "03_six_icons_ranked": 2,
    "04_search_a_better_set": 2,
    "05_export_for_an_experiment": 2,
}
ALONE = {"07_validation": 2, "08_your_rig_from_a_log": 2}
"""Tutorials that stand beside the sequence."""

MOST_SAVED = 300_000
MOST_S = 60.0
"""Of all cores together, so that other work on the machine does not count."""


def read(name: str) -> nbformat.NotebookNode:
    return nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)


def executed(notebook: nbformat.NotebookNode, folder: Path) -> list[nbformat.NotebookNode]:
    """Run all cells in a folder; the outputs, of which none is a warning."""
    # As JupyterLab saves: the state of widgets stays out of the file unless a person asks for it.
    options = {"timeout": 300, "kernel_name": "python3", "store_widget_state": False}
    NotebookClient(notebook, **options, resources={"metadata": {"path": str(folder)}}).execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert not [output.text for output in outputs if output.get("name") == "stderr"]
    return outputs


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.ipynb")))
def test_a_notebook_is_thin_and_has_no_outputs(name: str) -> None:
    notebook = read(name)
    assert notebook.metadata.kernelspec.name == "python3"
    assert set(notebook.metadata) == {"kernelspec", "language_info"}
    assert notebook.cells[0].cell_type == "markdown"
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None and not cell.metadata for cell in code)
    python = [cell.source for cell in code if not cell.source.startswith("%%")]
    assert all(len(text.removeprefix("%load_ext thermicon.notebooks\n").splitlines()) <= 8 for text in python)
    assert all("def " not in text and "class " not in text for text in python)
    assert all(len(line) <= 120 for text in python for line in text.splitlines())
    ours = re.findall(r"^ *(?:from|import) (thermicon\S*)", "\n".join(python), re.MULTILINE)
    assert len(ours) <= 2 and all(door.count(".") < 2 for door in ours)
    exercises = [place for place, cell in enumerate(notebook.cells) if "## Exercise" in cell.source.splitlines()]
    assert exercises == [len(notebook.cells) - 1] * (name != "workbench")


def test_each_tutorial_leads_to_the_next() -> None:
    names = sorted(PICTURES)
    for name, after in pairwise(names):
        assert f"({after}.ipynb)" in read(name).cells[-1].source


@pytest.mark.slow
@pytest.mark.parametrize("name", [*PICTURES, *ALONE])
def test_a_tutorial_runs_and_shows_its_pictures(name: str, tmp_path: Path) -> None:
    notebook, began = read(name), sum(os.times()[2:4])
    outputs = executed(notebook, tmp_path)
    assert sum(os.times()[2:4]) - began < MOST_S
    assert sum("image/png" in output.get("data", {}) for output in outputs) == (PICTURES | ALONE)[name]
    assert len(nbformat.writes(notebook)) < MOST_SAVED


def test_what_the_tutorials_write_can_be_read(tmp_path: Path) -> None:
    from thermicon.circuit import Rig

    cell = next(cell for cell in read("02_a_rig_of_your_own").cells if cell.source.startswith("%%writefile bench.toml"))
    (tmp_path / "bench.toml").write_text(cell.source.partition("\n")[2], encoding="utf-8")
    assert Rig.load(tmp_path / "bench.toml").warnings == ()


def test_figures_are_small_pictures() -> None:
    from matplotlib.figure import Figure

    from thermicon.notebooks.figures.print_figure import WIDEST_PX, small_png

    wide = Figure(figsize=(20, 2))
    wide.add_subplot().plot([0, 1])
    made = small_png(wide)
    assert int.from_bytes(made[16:20], "big") <= WIDEST_PX
    assert made[25] == 3, "not a palette"


@pytest.mark.slow
def test_the_interval_of_the_pilot_holds_the_truth_it_is_shown_with(tmp_path: Path) -> None:
    outputs = executed(read("09_your_pilot_sharpens_the_prediction"), tmp_path)
    said = "".join(output.get("text", "") for output in outputs)
    assert "participant,trial,presented,responded\nP1,1," in said
    assert "# written by thermicon observed from inputs " in said and "# participants: 4" in said
    low, high, truth = (int(word.strip("%;")) for word in said.split("after: ")[1].split()[:5:2])
    assert low <= truth <= high
    assert {"trials.csv", "lab.toml", "lab.csv"} <= {path.name for path in tmp_path.iterdir()}
