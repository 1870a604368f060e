"""The design view of the canvas module in a static page with frames like the kernel's."""

import pytest
from playwright.sync_api import expect

from tests.browser.staticpage import INKED, TEXT, TROUBLE, Bench, design


def test_a_view_greets_and_draws_the_first_frame(drawn: Bench) -> None:
    assert drawn.sent() == [{"type": "hello"}]
    root = drawn.page.locator(".tm-root")
    data = [root.get_attribute(f"data-{name}") for name in ("icon", "colour", "seq", "view")]
    assert data == ["dip", "green", "0", "design"]
    assert drawn.text == TEXT
    assert drawn.page.locator(".tm-pill").inner_text() == "✓ limits kept"
    assert [option.inner_text() for option in drawn.page.locator(".tm-picker option").all()] == ["dip", "rise"]
    assert drawn.page.locator(".tm-base").evaluate(INKED) > 1_000
    measured = drawn.page.evaluate("__thermicon.design")
    assert measured[-1]["kernel_ms"] == 2.0
    assert measured[-1]["drawn_ms"] > 0


def test_typing_sends_text_one_message_at_a_time_and_the_newest_wins(drawn: Bench) -> None:
    drawn.append("# abc")
    first = drawn.sent("text")
    assert [message["text"] for message in first] == [TEXT + "#"]
    drawn.answer()
    texts = [message["text"] for message in drawn.sent("text")]
    assert texts == [TEXT + "#", TEXT + "# abc"]
    numbers = [message["seq"] for message in drawn.sent("text")]
    assert numbers == sorted(set(numbers))
    drawn.page.keyboard.type("d")
    drawn.frame(design(seq=0, text=None, notes=["the skin is at 33 °C"]))
    assert drawn.page.locator(".tm-notes").inner_text() == "the skin is at 33 °C"
    assert len(drawn.sent("text")) == 2, "a frame that answers nothing lets no message go"


def test_a_text_of_the_kernel_never_replaces_newer_typing_and_the_caret_stays(drawn: Bench) -> None:
    drawn.set_caret(7)
    drawn.page.keyboard.type("# x")
    drawn.frame(design(text="cue 1\n"))
    assert drawn.text.startswith("cue 1\n\n# xicon")
    assert drawn.caret == 10
    drawn.answer()
    drawn.answer(text="\n" + drawn.text)
    assert drawn.text.startswith("\ncue 1")
    assert drawn.caret == 11


def test_the_icon_that_the_caret_enters_is_shown(drawn: Bench) -> None:
    icons = ["dip", "rise", "sway_by=1", "sway_by=2"]
    text = TEXT + "icon rise { hold for 1 s }\nicon sway(by in [1, 2] K) { warm by {by} at 2 K/s }\n"
    drawn.frame(design(text=text, icons=icons))
    drawn.set_caret(text.index("rise"))
    drawn.page.keyboard.press("ArrowRight")
    assert [message["name"] for message in drawn.sent("icon")] == ["rise"]
    drawn.answer(icon="rise", icons=icons)
    for keys in ("Home", "Control+a"):  # it is shown already, and a selection of all is of no icon
        drawn.page.keyboard.press(keys)
    drawn.set_caret(text.index("rise"))
    drawn.page.keyboard.press("ArrowDown")
    assert [message["name"] for message in drawn.sent("icon")] == ["rise", "sway_by=1"]
    drawn.answer(icon="sway_by=2", icons=icons)
    drawn.page.keyboard.press("End")
    drawn.page.keyboard.press("Control+Home")
    assert len(drawn.sent("icon")) == 2, "a member of this family is shown; the first line is of no icon"


def test_words_numbers_and_units_are_coloured(drawn: Bench) -> None:
    line = drawn.page.locator(".cm-line >> nth=3")
    assert line.text_content() == "  cool by 6 °C at 3 °C/s"
    kinds = line.locator("span").evaluate_all("all => all.map(s => s.className.slice(3) + ' ' + s.textContent)")
    assert kinds == ["keyword cool", "keyword by", "number 6", "unit °C", "keyword at", "number 3", "unit °C/s"]
    pitch = "e => [e.getBoundingClientRect().height, parseFloat(getComputedStyle(e).fontSize)]"
    height, font = line.evaluate(pitch)
    assert 1.35 < height / font < 1.6, "lines are as far apart as the font asks"
    drawn.frame(design(text='icon dip means "a word" ' * 30))
    assert drawn.page.locator(".cm-scroller").evaluate("e => e.scrollWidth - e.clientWidth") == 0, "long ones wrap"


def test_an_error_is_marked_and_named_with_its_cure(drawn: Bench) -> None:
    drawn.frame(design(troubles=[TROUBLE], stale=True))
    page = drawn.page
    wrong = page.locator(".cm-lintRange-error")
    assert wrong.inner_text() == "4"
    assert page.locator(".tm-go").inner_text() == "1 error, line 5"
    assert page.locator(".tm-first").inner_text() == "E102 missing unit: this number has no unit"
    expect(page.locator(".tm-older-tag")).to_be_visible()
    assert page.locator(".cm-content").get_attribute("aria-invalid") == "true"
    wrong.hover()
    assert page.locator(".cm-diagnostic .tm-hint").inner_text() == 'a time is written as "4 s"'
    page.locator(".cm-diagnosticAction").click()
    assert drawn.sent("apply")[-1]["line"] == 5
    page.wait_for_function("document.querySelector('.tm-live-region').textContent.startsWith('Line 5: E102')")
    drawn.answer(text=TEXT.replace("4\n", "4 s\n"))
    assert wrong.count() == 0
    assert page.locator(".tm-status").inner_text() == "no errors"
    assert page.locator(".cm-content").get_attribute("aria-invalid") == "false"


def test_the_keyboard_reaches_error_cure_undo_and_leaves_the_text(drawn: Bench) -> None:
    drawn.frame(design(troubles=[TROUBLE]))
    page = drawn.page
    drawn.set_caret(0)
    page.keyboard.press("F8")
    assert drawn.caret == TEXT.index("4\n") + 1
    page.keyboard.press("Control+.")
    assert drawn.sent("apply")[-1]["line"] == 5
    drawn.answer(troubles=[TROUBLE])
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "tm-go"
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "tm-take"
    page.keyboard.press("Enter")
    drawn.answer(troubles=[TROUBLE])
    assert [message["type"] for message in drawn.sent("apply")] == ["apply", "apply"]
    drawn.set_caret(0)
    page.keyboard.press("Control+z")
    drawn.answer(troubles=[TROUBLE])
    page.keyboard.press("Control+Shift+z")
    drawn.answer()
    page.keyboard.press("Control+y")
    assert [message["type"] for message in drawn.sent("undo", "redo")] == ["undo", "redo", "redo"]
    assert drawn.text == TEXT


@pytest.mark.parametrize(("text", "begins"), [("cue 1\n", True), (TEXT, True), (TEXT.rpartition("}")[0], False)])
def test_a_new_icon_is_offered_first_only_where_one_may_begin(drawn: Bench, text: str, begins: bool) -> None:
    drawn.frame(design(text=text))
    drawn.set_caret(len(text))
    drawn.page.keyboard.press("Control+Space")
    assert (drawn.page.locator(".cm-completionLabel").first.inner_text() == "icon") == begins


def test_heat_folds_to_its_legend(drawn: Bench) -> None:
    panel = design()["panels"][0]
    drawn.frame(design(panels=[panel, {**panel, "key": "heat", "folds": True}]))
    plots = drawn.page.locator(".tm-plot")
    tall = plots.first.bounding_box()["height"]
    drawn.page.locator(".tm-fold").click()
    assert not plots.last.is_visible()
    assert plots.first.bounding_box()["height"] > 1.5 * tall
    drawn.page.locator(".tm-fold").press("Enter")
    assert plots.last.locator(".tm-base").evaluate(INKED) > 1_000


def test_a_kernel_that_is_gone_is_said_while_nobody_types(drawn: Bench) -> None:
    drawn.page.wait_for_timeout(3_500)
    assert drawn.page.locator(".tm-banner").is_hidden()
    drawn.page.evaluate(
        "document.querySelector('.tm-root').parentElement.classList.add('jupyter-widgets-disconnected')"
    )
    drawn.page.wait_for_selector(".tm-banner:not([hidden])", timeout=5_000)


def test_the_strip_says_set_goal_and_icon_and_is_pale_while_the_text_is_newer(drawn: Bench) -> None:
    numbers = {"type": "strip", "set": "93 %", "icon": "92 %", "felt": "100 %", "goal": "correct >= 90 %", "about": ""}
    strip, goal = drawn.page.locator(".tm-strip"), drawn.page.get_by_label("goal")
    drawn.frame({**numbers, "stale": False, "rough": False, "met": True, "binding": ""})
    assert strip.locator("b").all_inner_texts() == ["93 %", "92 %", "100 %", "✓ met"]
    assert goal.input_value() == "correct >= 90 %"
    drawn.frame({**numbers, "stale": True, "rough": True, "met": False, "binding": "a and b"})
    assert strip.get_attribute("aria-label") == "Predictions, older than the text"
    assert strip.locator("b").all_inner_texts() == ["≈ 93 %", "≈ 92 %", "≈ 100 %", "? not judged"]
    goal.fill("bits >= 2")
    goal.press("Enter")
    assert drawn.sent("goal")[-1]["text"] == "bits >= 2"


def test_a_drag_sends_the_newest_place_and_ends_once(drawn: Bench) -> None:
    page = drawn.page
    x, y = drawn.corner(2.0, 30.0)
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(1, 9):
        page.mouse.move(x + 10 * step, y + 4 * step)
    first = drawn.sent("drag")
    assert len(first) == 1, "one message in flight"
    assert (first[0]["handle"], first[0]["end"]) == (0, False)
    drawn.answer()
    newest = drawn.sent("drag")[-1]
    assert len(drawn.sent("drag")) == 2
    per_px = 6.0 / (page.locator(".tm-over").bounding_box()["width"] - 56)
    assert newest["t"] == pytest.approx(2.0 + 80 * per_px, abs=per_px)
    assert newest["y"] < 30.0
    drawn.answer()
    page.mouse.up()
    drags = drawn.sent("drag")
    assert [message["end"] for message in drags] == [False, False, True]
    assert drags[-1]["t"] == newest["t"]


def test_a_fixed_corner_says_why_and_sends_nothing(drawn: Bench) -> None:
    page = drawn.page
    x, y = drawn.corner(6.0, 26.0)
    page.mouse.move(x, y)
    page.wait_for_selector(".tm-tip:not([hidden])")
    assert page.locator(".tm-tip").inner_text() == "line 4 · 6.00 s, 26.00 °C · fixed: rest is at baseline"
    page.mouse.down()
    page.mouse.move(x - 50, y - 50)
    page.mouse.up()
    assert drawn.sent("drag") == []


def test_keys_move_cursor_and_corners(drawn: Bench) -> None:
    page = drawn.page
    page.locator(".tm-stage").focus()
    page.keyboard.press("Home")
    page.keyboard.press("Shift+ArrowRight")
    page.wait_for_function("document.querySelector('.tm-value').textContent === '31.50'")
    page.keyboard.press("]")
    page.keyboard.press("]")
    page.keyboard.press("ArrowUp")
    drawn.answer()
    page.keyboard.press("Shift+ArrowRight")
    drawn.answer()
    drags = drawn.sent("drag")
    assert {message["handle"] for message in drags} == {1}
    assert (drags[0]["t"], drags[0]["y"], drags[0]["end"]) == (4.0, 28.1, False)
    assert drags[-1]["end"]
    page.wait_for_function("document.querySelector('.tm-live-region').textContent.startsWith('Corner 2 of 3, line 4')")


def test_undo_and_save_work_where_a_corner_was_dragged(drawn: Bench) -> None:
    page = drawn.page
    page.locator(".tm-stage").focus()
    for keys in ("Control+z", "Control+Shift+Z", "Control+s"):
        page.keyboard.press(keys)
        drawn.answer()
    assert [message["type"] for message in drawn.sent()[1:]] == ["undo", "redo", "save"]


@pytest.mark.parametrize(
    ("free", "why", "said"),
    [
        ("moves_time", None, "this corner moves in time only"),
        ("moves_level", None, "this corner moves in level only"),
        ("moves_time", "the level is held", "the level is held"),
    ],
)
def test_a_key_across_the_way_of_a_corner_says_why(drawn: Bench, free: str, why: str | None, said: str) -> None:
    page = drawn.page
    corner = {"t": 2.0, "y": 30.0, "panel": "temperature", "line": 4, "why": why}
    drawn.frame(design(handles=[{**corner, "moves_time": False, "moves_level": False, free: True}]))
    page.locator(".tm-stage").focus()
    page.keyboard.press("]")
    across, along = ("ArrowUp", "ArrowLeft") if free == "moves_time" else ("ArrowLeft", "ArrowUp")
    page.keyboard.press(across)
    tip = page.locator(".tm-tip", has_text=said)
    tip.wait_for()
    assert tip.inner_text() == f"line 4 · 2.00 s, 30.00 °C · {said}"
    drawn.said(f"{said[0].upper()}{said[1:]}.")
    assert drawn.sent("drag") == []
    page.keyboard.press(along)
    tip.wait_for(state="detached")
    assert drawn.sent("drag") != []


def test_without_an_answer_a_banner_says_so_and_the_text_is_sent_again(drawn: Bench) -> None:
    page = drawn.page
    drawn.append("#")
    assert page.locator(".tm-banner").is_hidden()
    page.wait_for_selector(".tm-banner:not([hidden])", timeout=5_000)
    late = "No answer from the kernel: run the cell again to go on; your text is saved in this page"
    assert page.locator(".tm-banner [role=alert]").inner_text() == late
    page.keyboard.type("x")
    assert drawn.text == TEXT + "#x"
    drawn.frame(design(seq=0))
    assert page.locator(".tm-banner").is_hidden()
    assert drawn.text == TEXT + "#x"
    assert drawn.sent("text")[-1]["text"] == TEXT + "#x"


def test_the_badge_says_the_rule_and_opens_to_more(drawn: Bench) -> None:
    page = drawn.page
    red = {"colour": "red", "text": "not safe: skin above 42 °C at 5.0 s", "more": ["skin 45 °C", "dose 4 min"]}
    drawn.frame(design(badge=red))
    assert page.locator(".tm-badge-button").inner_text().split("\n") == ["✕ not safe", "skin above 42 °C at 5.0 s"]
    assert page.locator(".tm-root").get_attribute("data-colour") == "red"
    page.locator(".tm-badge-button").press("Enter")
    assert page.locator(".tm-badge-more li").all_inner_texts() == ["skin 45 °C", "dose 4 min"]
    page.keyboard.press("Escape")
    assert page.locator(".tm-badge-more").is_hidden()
    page.wait_for_function("document.querySelector('.tm-live-region').textContent.startsWith('Safety: not safe')")
