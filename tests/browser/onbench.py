"""What a person does with the workbench in a browser."""

from __future__ import annotations

import re
from pathlib import Path

from playwright.sync_api import Locator, Page, expect

SETTLES_MS = 30_000
TWO = """cue 1

icon near {
  warm by 4 °C at 2 °C/s  # as far as is pleasant
  hold for 2 s
  return at 2 °C/s
}

icon nearer { warm by 3.6 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }

icon far { cool by 4 °C at 2 °C/s; return at 2 °C/s }
"""
# The middle of the leftmost dot in the colour of handles, in pixels of the window.
FIRST_HANDLE = """() => {
  const panel = document.querySelector('.tm-panel[data-panel="temperature"]');
  const colour = getComputedStyle(panel).getPropertyValue("--tm-focus").trim();
  const wanted = [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));
  for (const canvas of panel.querySelectorAll("canvas")) {
    const { width, height } = canvas, box = canvas.getBoundingClientRect();
    const data = canvas.getContext("2d").getImageData(0, 0, width, height).data, found = [];
    for (let x = 0; x < width; x += 1) for (let y = 0; y < height; y += 1) {
      const at = 4 * (y * width + x);
      if (data[at + 3] > 250 && wanted.every((value, k) => Math.abs(data[at + k] - value) < 3)) found.push([x, y]);
    }
    if (!found.length) continue;
    const near = found.filter(([x]) => x < found[0][0] + 14);
    const mean = (k) => near.reduce((sum, place) => sum + place[k], 0) / near.length;
    return [box.x + (mean(0) * box.width) / width, box.y + (mean(1) * box.height) / height];
  }
  return null;
}"""


def wait_until_drawn(page: Page) -> Locator:
    """Wait for the first drawing, bring the workbench to the top of the window, and return it."""
    page.locator(".thermicon .tm-root[data-seq]").first.wait_for(timeout=SETTLES_MS)
    page.locator(".tm-panel").first.wait_for()
    bench = page.locator(".thermicon").first
    bench.evaluate("bench => bench.scrollIntoView({ block: 'start' })")
    page.wait_for_timeout(300)
    return bench


def open_tab(page: Page, name: str) -> None:
    page.locator(".thermicon").get_by_role("tab", name=name).click()


def editor(page: Page) -> Locator:
    return page.locator(".thermicon .tm-editor .cm-content")


def text_of(page: Page) -> str:
    """The cue text as it stands in the editor, lines out of sight too."""
    return str(page.locator(".thermicon .tm-editor").evaluate("element => element.editor.text"))


def expect_text(page: Page, text: str) -> None:
    """Wait until the editor holds this text."""
    page.wait_for_function("text => document.querySelector('.thermicon .tm-editor').editor.text === text", arg=text)


def type_text(page: Page, text: str) -> None:
    """Write another text in the place of the one in the editor, as pasting over it does."""
    editor(page).focus()
    page.keyboard.press("Control+a")
    page.keyboard.insert_text(text)
    expect_text(page, text)


def root(page: Page) -> Locator:
    return page.locator('.thermicon .tm-root[data-view="design"]')


def drag_first_handle(page: Page, across: float, down: float) -> None:
    """Take hold of the first corner and pull it, with the pointer."""
    place = page.evaluate(FIRST_HANDLE)
    assert place is not None, "no handle is drawn"
    page.mouse.move(*place)
    page.mouse.down()
    for step in range(1, 6):
        page.mouse.move(place[0] + across * step / 5, place[1] + down * step / 5)
        page.wait_for_timeout(30)
    page.mouse.up()


def settled_text(page: Page) -> str:
    """The cue text when it has not changed for half a second: a drag is followed by several updates."""
    text = text_of(page)
    for _ in range(20):
        page.wait_for_timeout(500)
        before, text = text, text_of(page)
        if text == before:
            return text
    raise AssertionError("the text goes on changing after the drag")


def type_drag_and_err(page: Page) -> None:
    """A cue is typed and drawn, a corner dragged changes the text, an error is named at its line, undo works."""
    type_text(page, TWO)
    expect(root(page)).to_have_attribute("data-icon", "near")
    expect(root(page)).to_have_attribute("data-colour", "green")
    page.wait_for_timeout(300)
    drag_first_handle(page, 0.0, 25.0)
    dragged = settled_text(page)
    assert dragged != TWO
    assert re.search(r"warm by [0-3](\.\d+)? °C at [\d.]+ °C/s  # as far as is pleasant", dragged), dragged
    type_text(page, dragged.replace("hold for 2 s", "hold for 2", 1))
    trouble = page.locator(".tm-status.tm-has-errors")
    expect(trouble).to_contain_text("1 error, line 5")
    expect(trouble).to_contain_text("unit")
    expect(page.locator(".cm-lintRange-error")).to_have_count(1)
    expect(root(page)).to_have_attribute("data-colour", "grey")
    page.locator(".tm-button", has_text="Undo").click()
    expect(trouble).to_have_count(0)
    expect_text(page, dragged)


def type_below_the_first_screen(page: Page) -> None:
    """Scroll the shipped text to its end, click into the last line and type: the letter stands there."""
    wrong: list[str] = []
    page.on("pageerror", lambda problem: wrong.append(str(problem)))
    scroller = page.locator(".thermicon .tm-editor .cm-scroller")
    before = text_of(page)
    high, shown = scroller.evaluate("scroller => [scroller.scrollHeight, scroller.clientHeight]")
    assert high > 1.2 * shown, "the text fits into one screen, so that this shows nothing"
    scroller.hover()
    for _ in range(10):
        page.mouse.wheel(0, 800)
        page.wait_for_timeout(30)
    end = scroller.evaluate("scroller => scroller.scrollHeight - scroller.clientHeight - scroller.scrollTop")
    assert end < 2, f"the text ends {end} px below what can be scrolled to"
    last = page.locator(".thermicon .tm-editor .cm-line", has_text="}").last
    last.click()
    page.keyboard.press("End")
    page.keyboard.press("x")
    expect(editor(page)).to_be_focused()
    assert text_of(page) == before.rstrip("\n") + "x" + before[len(before.rstrip("\n")) :]
    expect(page.locator(".tm-status.tm-has-errors")).to_be_visible()
    page.locator(".thermicon .cm-lineNumbers .cm-gutterElement").last.click()
    expect(editor(page)).to_be_focused()
    page.keyboard.press("x")
    assert len(text_of(page)) == len(before) + 2
    undo = page.locator(".tm-button", has_text="Undo")
    undo.click()  # letters typed in one go are one step
    page.wait_for_timeout(1500)
    if text_of(page) != before:
        undo.click()
    expect_text(page, before)
    expect(root(page)).to_have_attribute("data-colour", "green")
    assert wrong == []


def wait_until_refined(page: Page) -> None:
    """Wait until the set view has ranked as many people as make numbers of it."""
    expect(page.locator(".thermicon-top .th-status")).to_have_text("200 people", timeout=2 * SETTLES_MS)


def click_a_confusion(page: Page) -> None:
    """In the set view, a cell of the confusions shows both icons, why they are confused, and an edit."""
    open_tab(page, "Set")
    cell = page.locator('.tm-map[data-matrix="confusion"] .tm-cell[aria-label^="near, nearer"]')
    cell.wait_for(timeout=SETTLES_MS)
    wait_until_refined(page)
    cell.click()
    expect(cell).to_have_class(re.compile("tm-picked"))
    pair = page.locator(".thermicon-pair")
    expect(pair).to_contain_text("confused in")
    expect(pair.locator(".tm-panel")).to_have_count(3)
    expect(pair.get_by_role("button", name="Apply edit")).to_be_enabled(timeout=SETTLES_MS)


def write_drives(page: Page, folder: Path) -> None:
    """In the export view, the icon that is shown is written into a folder."""
    open_tab(page, "Export")
    view = page.locator(".thermicon-export")
    expect(view).to_contain_text("ready to be written", timeout=SETTLES_MS)
    expect(view.locator("table.asked")).to_contain_text("shortest safe pause")
    where = view.locator(".widget-text", has_text="folder").locator("input")
    where.fill(str(folder))
    where.press("Enter")
    view.get_by_role("button", name="Write").click()
    expect(view).to_contain_text("wrote 1 drive")
