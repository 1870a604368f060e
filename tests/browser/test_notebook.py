"""The first notebook in JupyterLab, and a notebook as a page under Voila."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import nbformat
from playwright.sync_api import Page

from tests.browser.jupyter import Server, errors_in, make_notebook, open_notebook, run_all, save

MOST_SAVED = 300_000


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
