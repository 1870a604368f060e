"""``.cue`` files in JupyterLab: the prebuilt extension of the package colours them, with nothing to build."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from importlib import resources
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.browser.conftest import LAB
from tests.browser.jupyter import running

TEXT = '# a comment\ncue 1\nicon dip means "down" {\n  cool by 6 °C at 3 °C/s\n}\n'
LOOKS = """() => Object.fromEntries([...document.querySelectorAll(".jp-FileEditor .cm-line span")].map(
  (span) => [span.textContent, getComputedStyle(span).color]))"""


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
