"""The first notebook in JupyterLab, a page under Voila, and ``.cue`` files, which the package's extension colours."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from importlib import resources
from pathlib import Path

import nbformat
from playwright.sync_api import Page, expect

from tests.browser.conftest import LAB
from tests.browser.jupyter import Server, errors_in, make_notebook, open_notebook, run_all, running, save

MOST_SAVED = 300_000
TEXT = '# a comment\ncue 1\nicon dip means "down" {\n  cool by 6 °C at 3 °C/s\n}\n'
LOOKS = """() => Object.fromEntries([...document.querySelectorAll(".jp-FileEditor .cm-line span")].map(
  (span) => [span.textContent, getComputedStyle(span).color]))"""


def test_the_first_notebook_runs_and_shows_its_pictures(page: Page, lab: Server, shot: Callable[[str], Path]) -> None:
    notebook = open_notebook(page, lab, "01_first_icon.ipynb")
    run_all(page)
    assert errors_in(page) == []
    pictures = notebook.locator(".jp-OutputArea-output img")
    assert pictures.count() == 2
    for place in range(2):
        pictures.nth(place).scroll_into_view_if_needed()
        box = pictures.nth(place).bounding_box()
        assert box is not None
        assert box["width"] > 500
    assert notebook.locator(".jp-OutputArea-output svg").count() >= 2
    shot("notebook-01-overview")
    save(page)
    saved = lab.folder / "01_first_icon.ipynb"
    assert saved.stat().st_size < MOST_SAVED
    assert any(cell.get("outputs") for cell in nbformat.read(saved, as_version=4).cells)


def test_a_notebook_is_served_as_a_page(
    page: Page, serve_page: Callable[[Path], Server], tmp_path: Path, shot: Callable[[str], Path]
) -> None:
    cue = "%%cue\nicon dip { cool by 3 °C at 2 °C/s; return at 2 °C/s }"
    made = make_notebook(tmp_path / "workbench.ipynb", "%load_ext thermicon.notebooks", cue)
    page.goto(serve_page(made.parent).url)
    page.locator(".jp-OutputArea-output svg").first.wait_for()
    assert page.get_by_text("%%cue").count() == 0
    shot("page-of-a-cue")


def test_a_cue_file_opens_in_colours(page: Page, tmp_path: Path, shot: Callable[[str], Path]) -> None:
    folder, own = tmp_path / "files", tmp_path / "jupyter"
    folder.mkdir()
    (folder / "a.cue").write_text(TEXT, encoding="utf-8")
    with resources.as_file(resources.files("thermicon.notebooks") / "labextension") as shipped:
        shutil.copytree(shipped, own / "data" / "labextensions" / "thermicon-cue")
    with running("jupyterlab", LAB, folder, own) as server:
        page.goto(f"{server.url}/lab/tree/a.cue?reset")
        expect(page.locator(".jp-FileEditor .cm-content")).to_contain_text("cool by 6", timeout=60_000)
        page.wait_for_function("document.querySelectorAll('.jp-FileEditor .cm-line span').length > 5")
        looks = page.evaluate(LOOKS)
        shot("cue-file-in-jupyterlab")
        page.close()
    assert {"# a comment", "cue", "cool", "6", '"down"'} <= set(looks)
    assert len({looks[text] for text in ("# a comment", "cool", "6", '"down"')}) == 4
