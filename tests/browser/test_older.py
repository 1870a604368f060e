"""What is older than the text says so: no word on safety stands beside text that nobody judged."""

from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.jupyter import PANEL
from tests.browser.onbench import TWO, expect_text, open_tab, root, type_text
from tests.browser.staticpage import TEXT, TROUBLE, Bench, design

SAFE = f"# goal: correct >= 10 %\n{TWO}"
UNSAFE = SAFE.replace("warm by 4 °C at 2 °C/s", "warm by 25 °C at 30 °C/s", 1)
WRONG = UNSAFE.replace("hold for 2 s", "hold for 2", 1)
KERNEL = f"{PANEL}.sessionContext.session.kernel"
# Words beside unsafe text, in each picture of the page: of the badge, of the goal, of what the export tab says.
WATCH = """() => {
  const seen = window.seen = new Set();
  const words = ".tm-pill, .tm-met, .thermicon-export summary, .thermicon-export .th-good";
  const look = () => {
    if (document.querySelector(".tm-editor").editor.text.includes("25 °C"))
      for (const one of document.querySelectorAll(words))
        if (one.checkVisibility({ visibilityProperty: true })) seen.add(one.innerText);
    requestAnimationFrame(look);
  };
  look();
}"""
# Words of the badge one after another from now on.
WORDS = """() => {
  const seen = window.words = [];
  const look = () => {
    const word = document.querySelector(".tm-pill").textContent;
    if (seen.at(-1) !== word) seen.push(word);
    requestAnimationFrame(look);
  };
  look();
}"""
DONE_TO_THE_KERNEL = {
    "computing": "() => {}",
    "busy": f"() => {{ {KERNEL}.requestExecute({{ code: 'import ctypes; ctypes.PyDLL(None).sleep(10)' }}); }}",
    "killed": f"() => {{ {KERNEL}.requestExecute({{ code: 'import os; os.kill(os.getpid(), 9)' }}); }}",
    "cut": "() => { WebSocket.prototype.send = () => {}; }",
}


def is_older(page: Page, cause: str) -> None:
    """Badge, strip, numbers and curves say that they are of an earlier text, to eyes and to screen readers."""
    expect(page.locator(".tm-badge-button").first).to_have_text(f"? not judged{cause}")
    expect(page.locator('.tm-root[data-view="design"]').first).to_have_attribute("data-colour", "grey")
    expect(page.get_by_role("group", name="Predictions, older than the text").first).to_be_visible()
    expect(page.locator(".tm-met").first).to_have_text("? not judged")
    expect(page.locator(".tm-older-tag").first).to_be_visible()
    expect(page.locator(".tm-base").first).to_have_css("opacity", "0.5")
    soft = page.locator(".tm-entry").first.evaluate("e => getComputedStyle(e).color")
    expect(page.locator(".tm-value").first).to_have_css("color", soft)
    expect(page.locator(".tm-strip b").first).to_have_css("color", soft)


@pytest.mark.parametrize("state", DONE_TO_THE_KERNEL)
def test_unsafe_text_that_nobody_judged_never_stands_beside_a_word_on_safety(bench: Page, state: str) -> None:
    page = bench
    type_text(page, SAFE)
    expect(page.locator(".tm-met")).to_have_text("✓ met", timeout=60_000)
    open_tab(page, "Export")
    expect(page.locator(".thermicon-export")).to_contain_text("ready to be written", timeout=60_000)
    open_tab(page, "Design")
    page.evaluate(WATCH)
    page.evaluate(DONE_TO_THE_KERNEL[state])
    if state == "killed":
        page.locator(".jp-Dialog button", has_text="Ok").click()  # which says that the kernel died
    type_text(page, UNSAFE)
    if state != "computing":
        is_older(page, "no answer")
        expect(root(page).get_by_role("alert")).to_contain_text("No answer from the kernel")
        open_tab(page, "Export")
        page.wait_for_timeout(300)
        open_tab(page, "Design")
    if state in ("computing", "busy"):
        expect(page.locator(".tm-pill")).to_have_text("✕ not safe", timeout=30_000)
        expect(page.locator(".tm-base").first).to_have_css("opacity", "1")
        type_text(page, WRONG)
        is_older(page, "the text has errors")
    else:
        type_text(page, WRONG)
        is_older(page, "no answer")
    seen = {word for word in page.evaluate("[...seen]") if word}
    assert seen <= {"? not judged", "✕ not safe", "✕ not met", "✓ met"}, seen
    assert state in ("computing", "busy") or seen == {"? not judged"}, seen


def test_a_knob_and_a_rig_that_a_busy_kernel_does_not_know_are_not_judged(bench: Page) -> None:
    page, late = bench, root(bench).get_by_role("alert")
    type_text(page, TWO)
    page.locator(".tm-goal").fill("correct >= 10 %")
    page.locator(".tm-goal").press("Enter")
    expect_text(page, SAFE)
    expect(page.locator(".tm-pill")).to_have_text("✓ limits kept")
    page.get_by_role("button", name="Sliders").click()
    expect(page.locator(".noUi-handle").first).to_be_visible()
    page.evaluate(DONE_TO_THE_KERNEL["busy"])
    page.wait_for_timeout(500)
    slider = page.locator(".thermicon-knob").filter(has_text="contact area").locator(".noUi-handle")
    slider.press("ArrowUp")
    is_older(page, "computing …")
    page.evaluate(WORDS)
    slider.press("ArrowUp")
    expect(late).to_contain_text("No answer from the kernel")
    is_older(page, "no answer")
    slider.press("ArrowUp")  # ipywidgets holds it back until the first one is answered
    expect(page.locator(".tm-pill")).to_have_text("✓ limits kept", timeout=30_000)
    expect(page.locator(".thermicon-knob .changed")).to_have_count(1)
    page.wait_for_timeout(1_000)
    assert page.evaluate("words") == ["? not judged", "✓ limits kept"], "one of an earlier place comes between"
    page.evaluate(DONE_TO_THE_KERNEL["cut"])
    open_tab(page, "Export")
    rig = page.locator(".thermicon-bar select")
    rig.select_option(index=1 if rig.evaluate("e => e.selectedIndex") != 1 else 0)
    expect(page.locator(".thermicon-top").last).to_be_attached()
    expect(page.locator(".thermicon")).to_have_attribute("data-older", "")


def answered(bench: Bench, **changes: Any) -> None:
    bench.answer(**changes)
    expect(bench.page.locator(".tm-root").first).not_to_have_attribute("data-older", "")


STRIP = {"type": "strip", "set": "93 %", "icon": "92 %", "felt": "100 %", "goal": "correct >= 90 %", "about": ""}


def test_typed_text_goal_and_icon_are_not_judged_until_they_are_answered_in_every_view(made: Bench) -> None:
    page = made.page
    made.show()
    made.draw()
    made.frame({**STRIP, "stale": False, "rough": False, "met": True, "binding": ""})
    pills = page.locator(".tm-pill")
    for act in (
        lambda: made.append("#"),
        lambda: page.locator(".tm-goal").first.fill("bits >= 2") or page.keyboard.press("Enter"),
        lambda: page.locator(".tm-picker").first.select_option("rise"),
    ):
        assert pills.all_inner_texts() == ["✓ limits kept"] * 2
        act()
        assert pills.all_inner_texts() == ["? not judged"] * 2
        is_older(page, "computing …")
        answered(made)
    page.locator(".tm-stage").first.focus()
    page.keyboard.press("]")
    page.keyboard.press("ArrowUp")
    assert pills.all_inner_texts() == ["✓ limits kept"] * 2, "a corner that is dragged leaves the text to the kernel"


def test_what_is_older_is_told_where_it_lasts_and_the_details_of_the_badge_go(drawn: Bench) -> None:
    page = drawn.page
    page.locator(".tm-badge-button").click()
    assert page.locator(".tm-badge-more").is_visible()
    drawn.append("#")
    assert page.locator(".tm-badge-more").is_hidden()
    answered(drawn)
    page.wait_for_timeout(800)
    assert page.locator(".tm-live-region").inner_text() == "", "a moment is not told"
    drawn.append("#")
    drawn.said("Safety: not judged. not judged: no answer")
    page.locator(".tm-stage").focus()
    page.keyboard.press("Home")
    drawn.said("Older than the text. At 0.00 s: skin 32.00 °C")
    drawn.answer(badge={"colour": "red", "text": "not safe: skin at 45 °C", "more": []})
    drawn.said("Safety: not safe. not safe: skin at 45 °C")
    drawn.frame(design(stale=True, troubles=[TROUBLE], badge={"colour": "grey", "text": "not judged: x", "more": []}))
    drawn.append("#")
    assert page.locator(".tm-badge-text").inner_text() == "x", "an error stays the reason while its cure is typed"


def test_a_frame_is_of_the_text_that_it_names_whatever_it_answers(drawn: Bench) -> None:
    page = drawn.page
    pill, cause, status = (page.locator(f".tm-{name}") for name in ("pill", "badge-text", "status"))
    drawn.frame({**STRIP, "stale": False, "rough": False, "met": True, "binding": ""})
    drawn.append("#")
    expect(status).to_be_hidden()
    later = drawn.sent()[-1]["seq"] + 1_000
    drawn.frame(design(text=None, of=TEXT, seq=later))  # as a frame that answers another view of the model
    is_older(page, "of another text")
    drawn.frame(design(text=None, of=f"{TEXT}#", seq=later))
    assert (pill.inner_text(), status.inner_text()) == ("✓ limits kept", "no errors")
    drawn.frame(design(text=None, of=f"{TEXT}# typed in another page"))
    assert (pill.inner_text(), cause.inner_text()) == ("? not judged", "of another text")
    drawn.frame(design(text=TEXT.replace("\n", "\r\n")))
    assert pill.inner_text() == "✓ limits kept", "lines may end as they like"


def test_a_touched_knob_is_not_judged_until_the_kernel_has_all_that_was_held_back(drawn: Bench) -> None:
    page = drawn.page
    knobs = "<input class=thermicon-knobs>"
    page.evaluate(f"document.body.className = 'thermicon'; document.querySelector('#app').outerHTML = '{knobs}'")
    drawn.show()
    drawn.frame(design())
    drawn.frame({**STRIP, "stale": False, "rough": False, "met": True, "binding": ""})
    pills, knob = page.locator(".tm-pill"), page.locator(".thermicon-knobs")
    knob.press("ArrowUp")
    expect(pills).to_have_text(["? not judged"] * 2)
    drawn.answer()
    expect(pills).to_have_text(["✓ limits kept"] * 2)
    knob.press("ArrowUp")
    is_older(page, "no answer")
    for answer in (lambda: drawn.frame(design(text=None)), drawn.answer):
        answer()
        expect(pills).to_have_text(["? not judged"] * 2)
    drawn.answer()
    expect(pills).to_have_text(["✓ limits kept"] * 2)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_in_the_bar_moves_where_it_gets_older(page: Any, made: Bench, scheme: Any) -> None:
    page.emulate_media(color_scheme=scheme)
    made.draw()
    made.frame({**STRIP, "stale": False, "rough": False, "met": False, "binding": ""})
    places = "all => all.map((e) => JSON.stringify(e.getBoundingClientRect()))"
    parts = page.locator(".tm-bar > *, .tm-strip > *, .tm-badge-button")
    before = parts.evaluate_all(places)
    made.append("#")
    is_older(page, "computing …")
    assert parts.evaluate_all(places) == before
