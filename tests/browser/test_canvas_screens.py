"""The canvas module on other screens, under fingers and for screen readers, in a static page."""

from __future__ import annotations

from typing import Any

from tests.browser.staticpage import TROUBLE, Bench, design, open_bench


def test_screen_readers_hear_the_cursor_once_and_names_without_signs(drawn: Bench) -> None:
    page = drawn.page
    assert page.locator(".tm-sign").evaluate_all("all => all.map((e) => e.getAttribute('aria-hidden'))") == ["true"] * 2
    assert page.locator(".tm-timeline output").count() == 0, "an <output> is read aloud at each change"
    page.locator(".tm-stage").focus()
    page.keyboard.press("End")
    drawn.said("At 6.00 s: skin 26.00 °C")
    page.keyboard.press("Home")
    drawn.said("At 0.00 s: skin 32.00 °C")


def test_the_list_of_errors_can_be_read_in_the_dark(page: Any) -> None:
    made = open_bench(page)
    page.emulate_media(color_scheme="dark")
    made.show()
    made.frame(design(troubles=[TROUBLE]))
    made.set_caret(0)
    page.keyboard.press("Control+Shift+M")
    made.set_caret(0)
    chosen = page.locator(".cm-panel-lint [aria-selected]")
    assert chosen.evaluate("e => getComputedStyle(e).backgroundColor") == "rgba(79, 209, 191, 0.14)"
    assert chosen.evaluate("e => getComputedStyle(e).color") == "rgb(232, 235, 238)"
