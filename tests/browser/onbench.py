"""A person's actions on the workbench in a browser."""

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


def wait_until_refined(page: Page) -> None:
    """Wait until the set view has ranked as many people as make numbers of it."""
    expect(page.locator(".thermicon-top .th-status")).to_have_text("200 people", timeout=2 * SETTLES_MS)
