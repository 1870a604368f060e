"""What a person does with the workbench in a browser, the same in JupyterLab and under Voila."""

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
    return page.locator(".thermicon .tm-area")


def type_text(page: Page, text: str) -> None:
    editor(page).fill(text)


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
    text = editor(page).input_value()
    for _ in range(20):
        page.wait_for_timeout(500)
        before, text = text, editor(page).input_value()
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
    expect(editor(page)).not_to_have_value(TWO)
    dragged = settled_text(page)
    assert re.search(r"warm by [0-3](\.\d+)? °C at [\d.]+ °C/s  # as far as is pleasant", dragged), dragged
    type_text(page, dragged.replace("hold for 2 s", "hold for 2", 1))
    trouble = page.locator('.tm-trouble-place[data-line="5"]')
    expect(trouble).to_contain_text("unit")
    expect(root(page)).to_have_attribute("data-colour", "grey")
    page.locator(".tm-button", has_text="Undo").click()
    expect(trouble).to_have_count(0)
    expect(editor(page)).to_have_value(dragged)


def type_below_the_first_screen(page: Page) -> None:
    """Scroll the shipped text to its end, click into the last line and type: the letter stands in the text."""
    scroller = page.locator(".thermicon .tm-scroller")
    before = editor(page).input_value()
    high, shown, area = scroller.evaluate(
        "scroller => { scroller.scrollTop = scroller.scrollHeight;"
        " return [scroller.scrollHeight, scroller.clientHeight, scroller.querySelector('.tm-area').clientHeight]; }"
    )
    assert high > 2 * shown, "the text fits into one screen, so that this shows nothing"
    assert area >= high - 1, f"the text area is {area} px high, the text {high} px"
    box = scroller.bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 200, box["y"] + box["height"] - 40)
    page.keyboard.press("x")
    expect(editor(page)).to_be_focused()
    after = editor(page).input_value()
    places = [k for k in range(len(after)) if after[:k] + after[k + 1 :] == before]
    assert places, "the letter is not in the text"
    assert after[: places[0]].count("\n") > after.count("\n") - 4, "the letter is not near the end of the text"
    page.locator(".tm-numbers > div").last.click()
    page.keyboard.press("x")
    assert len(editor(page).input_value()) == len(before) + 2
    page.locator(".tm-button", has_text="Undo").click()
    expect(root(page)).to_be_visible()


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
