"""The workbench in JupyterLab, as a lab uses it: text and curve, set, export, and going on after an interruption."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from tests.browser.jupyter import Server, open_notebook, reload, restart_kernel, run_all, save
from tests.browser.onbench import (
    TWO,
    click_a_confusion,
    editor,
    expect_text,
    root,
    text_of,
    type_below_the_first_screen,
    type_drag_and_err,
    type_text,
    wait_until_drawn,
    write_drives,
)

MOST_SAVED = 300_000


def test_text_and_curve_stay_in_step(bench: Page) -> None:
    fits = bench.evaluate(
        "() => { const box = (name) => document.querySelector(name).getBoundingClientRect();"
        " return box('.thermicon').bottom - box('.jp-Notebook').bottom; }"
    )
    assert fits <= 0, "the design view does not fit into the window"
    type_drag_and_err(bench)


def test_it_designs_compares_and_exports(bench: Page, lab: Server) -> None:
    bench.set_viewport_size({"width": 900, "height": 800})
    type_below_the_first_screen(bench)
    bench.set_viewport_size({"width": 1280, "height": 800})
    type_text(bench, TWO)
    click_a_confusion(bench)
    write_drives(bench, lab.folder / "drives")
    assert (lab.folder / "drives" / "near.csv").exists()


def test_unsaved_text_of_a_closed_tab_is_offered_and_saved_to_its_file(page: Page, lab: Server) -> None:
    file = lab.folder / "alerts.cue"
    file.write_text(TWO, encoding="utf-8")
    notebook = lab.folder / "workbench.ipynb"
    one = notebook.read_text(encoding="utf-8").replace("Workbench()", "Workbench('alerts.cue', 'fingertip')")
    notebook.write_text(one, encoding="utf-8")
    open_notebook(page, lab, "workbench.ipynb")
    run_all(page)
    wait_until_drawn(page)
    expect(page.locator(".thermicon-file")).to_have_text("alerts.cue")
    expect(page.locator(".thermicon-bar select")).to_have_value("fingertip")
    typed = TWO.replace("icon near ", "icon nigh ")
    type_text(page, typed)
    expect(page.locator(".thermicon-file")).to_have_text("alerts.cue, unsaved changes")
    page.wait_for_timeout(1000)
    again = page.context.browser.new_context().new_page()  # type: ignore[union-attr]
    page.close()
    open_notebook(again, lab, "workbench.ipynb")
    run_all(again)
    wait_until_drawn(again)
    expect_text(again, TWO)
    offer = again.locator(".thermicon-offer")
    expect(offer).to_contain_text("Unsaved text of alerts.cue was typed a moment ago")
    offer.get_by_role("button", name="Restore it").click()
    expect_text(again, typed)
    editor(again).press("Control+s")
    expect(again.locator(".thermicon-project")).to_contain_text("saved alerts.cue")
    assert file.read_text(encoding="utf-8") == typed
    assert not list(lab.folder.glob(".alerts*"))


CUT = """all => all.filter((label) => {
  const span = label.querySelector("span").getBoundingClientRect(), box = label.getBoundingClientRect();
  return span.width > box.width + 0.5 || span.top < box.top - 1 || span.bottom > box.bottom + 1;
}).map((label) => label.textContent)"""


def test_it_goes_on_after_a_reload_and_a_restart(bench: Page, lab: Server) -> None:
    type_text(bench, TWO)
    expect(root(bench)).to_have_attribute("data-icon", "near")
    reload(bench)
    assert (lab.folder / "workbench.ipynb").stat().st_size < MOST_SAVED
    wait_until_drawn(bench)
    expect_text(bench, TWO)
    slider = bench.locator(".thermicon-knob").filter(has_text="contact area").locator(".noUi-handle")
    slider.focus()
    bench.keyboard.press("ArrowRight")
    expect(bench.locator(".thermicon-knob .changed")).to_have_text("contact area (cm²) · rig 9 cm²")
    assert bench.locator(".thermicon-knob .widget-html").evaluate_all(CUT) == []
    places = "all => all.map((e) => JSON.stringify(e.getBoundingClientRect()))"
    knobs = bench.locator(".thermicon-knob")
    before = knobs.evaluate_all(places)

    restart_kernel(bench)
    typed = TWO.replace("icon near ", "icon nigh ")
    type_text(bench, typed)
    banner = root(bench).locator(".tm-banner")
    expect(banner).to_contain_text("run the cell again to go on; your text is saved in this page", timeout=15_000)
    assert text_of(bench) == typed
    icons = "all => all.filter((one) => getComputedStyle(one, '::before').content !== 'none').length"
    lost = bench.locator(".thermicon.jupyter-widgets-disconnected, .thermicon .jupyter-widgets-disconnected")
    assert lost.count() > 10
    assert lost.evaluate_all(icons) == 0, "a lost kernel leaves no mark"
    assert knobs.evaluate_all(places) == before, "and moves nothing"
    run_all(bench)
    wait_until_drawn(bench)
    expect(banner).to_be_hidden()
    bench.get_by_role("button", name="Restore it").click()
    expect(root(bench)).to_have_attribute("data-icon", "nigh")
    expect_text(bench, typed)
    save(bench)
