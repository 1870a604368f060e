"""The canvas module on other screens, under fingers and for screen readers, in a static page."""

from __future__ import annotations

from typing import Any

import pytest

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


def test_a_second_finger_moves_no_corner(drawn: Bench) -> None:
    page = drawn.page
    touch = page.context.new_cdp_session(page)
    (x, y), (away, below) = drawn.corner(2.0, 30.0), drawn.corner(5.0, 27.0)
    first, second = {"x": x, "y": y, "id": 0}, {"x": away, "y": below, "id": 1}
    steps = (
        ("touchStart", [first]),
        ("touchMove", [{**first, "x": x + 20}]),
        ("touchStart", [{**first, "x": x + 20}, second]),
        ("touchMove", [{**first, "x": x + 20}, {**second, "x": away - 20}]),
        ("touchEnd", []),
    )
    for kind, points in steps:
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    drawn.answer()
    ended = drawn.sent("drag")[-1]
    assert ended["end"]
    per_px = 6.0 / (page.locator(".tm-over").bounding_box()["width"] - 56)
    assert ended["t"] == pytest.approx(2.0 + 20 * per_px, abs=per_px)


@pytest.mark.parametrize("width", [340, 1280])
def test_meanings_of_words_open_inside_of_the_time_line(drawn: Bench, width: int) -> None:
    page = drawn.page
    page.set_viewport_size({"width": width, "height": 800})
    (panel,) = design()["panels"]
    label, terms = (
        "sensation (d′) of the nominal person",
        [["d′", "distance in units of noise"], ["clock", "from when"]],
    )
    drawn.frame(design(panels=[panel, {**panel, "key": "sensation", "label": label, "terms": terms}]))
    page.locator(".tm-words summary").click()
    opened, around = (page.locator(place).bounding_box() for place in (".tm-words dl", ".tm-timeline"))
    for axis, size in (("x", "width"), ("y", "height")):
        assert around[axis] <= opened[axis]
        assert opened[axis] + opened[size] <= around[axis] + around[size]


def test_labels_of_marks_are_whole_in_a_narrow_panel(drawn: Bench) -> None:
    page = drawn.page
    page.set_viewport_size({"width": 330, "height": 800})
    (panel,) = design()["panels"]
    mark = {"t": 3.0, "label": "felt peak (cold) 3.00 s, percept clock", "role": "cool", "y": None}
    drawn.frame(design(panels=[{**panel, "marks": [mark]}]))
    placed = page.evaluate("document.querySelector('.tm-timeline').timeline.panels[0].lay.marks.placed")
    width = page.locator(".tm-over").bounding_box()["width"]
    assert [each["left"] >= 0 and each["left"] + each["wide"] <= width for each in placed] == [True]


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
