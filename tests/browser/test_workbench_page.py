"""The workbench as a page of its own, under Voila: the same smoke as in JupyterLab."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.browser.jupyter import Server
from tests.browser.onbench import (
    TWO,
    click_a_confusion,
    expect_text,
    root,
    type_below_the_first_screen,
    type_drag_and_err,
    type_text,
    wait_until_drawn,
    write_drives,
)

Serve = Callable[..., Server]


def open_page(page: Page, serve_page: Serve, place: Path) -> None:
    page.goto(serve_page(place).url)
    wait_until_drawn(page)
    expect(root(page)).to_have_attribute("data-icon", "cooling-step")


def test_the_page_starts_and_shows_the_curve_of_what_is_typed(page: Page, serve_page: Serve, tmp_path: Path) -> None:
    open_page(page, serve_page, tmp_path)
    type_drag_and_err(page)


def test_the_page_designs_compares_and_exports(
    page: Page, serve_page: Serve, tmp_path: Path, shot: Callable[[str], Path]
) -> None:
    page.set_viewport_size({"width": 900, "height": 800})
    open_page(page, serve_page, tmp_path)
    type_below_the_first_screen(page)
    page.set_viewport_size({"width": 1280, "height": 800})
    shot("page-design")
    type_text(page, TWO)
    click_a_confusion(page)
    shot("page-set")
    write_drives(page, tmp_path / "drives")
    shot("page-export")
    assert (tmp_path / "drives" / "near.csv").exists()


def test_unsaved_text_of_a_closed_tab_is_offered_and_saved_to_its_file(
    page: Page, serve_page: Serve, tmp_path: Path
) -> None:
    file = tmp_path / "alerts.cue"
    file.write_text(TWO, encoding="utf-8")
    server = serve_page(file, "--rig", "fingertip")
    page.goto(server.url)
    wait_until_drawn(page)
    expect(page.locator(".thermicon-file")).to_have_text("alerts.cue")
    expect(page.locator(".thermicon-bar select")).to_have_value("fingertip")
    typed = TWO.replace("icon near ", "icon nigh ")
    type_text(page, typed)
    expect(page.locator(".thermicon-file")).to_have_text("alerts.cue, unsaved changes")
    page.wait_for_timeout(1000)
    again = page.context.browser.new_context().new_page()  # type: ignore[union-attr]
    page.close()
    again.goto(server.url)
    wait_until_drawn(again)
    expect_text(again, TWO)
    offer = again.locator(".thermicon-offer")
    expect(offer).to_contain_text("Unsaved text of alerts.cue was typed a moment ago")
    offer.get_by_role("button", name="Restore it").click()
    expect_text(again, typed)
    again.locator(".cm-content").press("Control+s")
    expect(again.locator(".thermicon-project")).to_contain_text("saved alerts.cue")
    assert file.read_text(encoding="utf-8") == typed
    assert [each.name for each in tmp_path.iterdir()] == ["alerts.cue"]
