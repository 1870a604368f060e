"""Text outlives its kernel: what a bench that is made anew offers, in a static page."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.browser.staticpage import TEXT, Bench, design, open_bench

OFFER = "An earlier text was saved. Buttons above the editor restore or discard it."
FORBIDDEN = "Object.defineProperty(window, 'sessionStorage', { get() { throw new DOMException('no') } })"


@pytest.fixture
def edited(page: Any) -> Iterator[Bench]:
    """A bench of the model "one" whose text was changed; at the end nothing has gone wrong in the page."""
    made = open_bench(page)
    made.show()
    made.frame(design())
    append(made, "# mine")
    yield made
    assert made.wrong == []


def append(bench: Bench, text: str) -> None:
    bench.page.locator(".cm-content").press("Control+End")
    bench.page.keyboard.type(text)


def offered(bench: Bench) -> bool:
    return bool(bench.page.locator(".tm-unsaved").is_visible())


def text_of(bench: Bench) -> str:
    return bench.text


def test_a_new_model_offers_the_text_and_takes_it_back(edited: Bench) -> None:
    assert not offered(edited)
    edited.again("two")
    assert offered(edited)
    assert edited.page.locator(".tm-unsaved span").inner_text() == "An earlier text was saved:"
    edited.said(OFFER)
    assert text_of(edited) == TEXT
    assert edited.sent("text") == []
    edited.page.locator(".tm-badge-button").focus()
    edited.page.keyboard.press("Tab")
    edited.page.keyboard.press("Enter")
    assert [message["text"] for message in edited.sent("text")] == [TEXT + "# mine"]
    assert text_of(edited) == TEXT + "# mine"
    assert not offered(edited)
    assert "cm-content" in edited.page.evaluate("document.activeElement.className")
    edited.said("The earlier text is back in the editor.")


def test_the_same_model_offers_nothing_and_goes_on_in_its_place(edited: Bench) -> None:
    edited.again("one", text=TEXT + "# mine")
    assert not offered(edited)
    append(edited, "!")
    edited.again("one", text=TEXT)
    assert not offered(edited), "the kernel knows better"
    edited.again("two")
    edited.page.get_by_role("button", name="Restore it").click()
    assert text_of(edited) == TEXT + "# mine!"


def test_what_is_forgotten_is_not_offered_again(edited: Bench) -> None:
    edited.again("two")
    edited.again("two")
    assert offered(edited), "as long as nothing is decided"
    edited.page.get_by_role("button", name="Discard").click()
    assert not offered(edited)
    assert text_of(edited) == TEXT
    edited.said("The earlier text was discarded.")
    edited.again("three")
    assert not offered(edited)


def test_a_newer_edit_takes_the_place_of_the_kept_text(edited: Bench) -> None:
    edited.again("two")
    append(edited, "# newer")
    assert not offered(edited)
    edited.again("three")
    edited.page.get_by_role("button", name="Restore it").click()
    assert text_of(edited) == TEXT + "# newer"


def test_texts_of_the_kernel_are_kept_and_another_source_finds_nothing(edited: Bench) -> None:
    edited.answer()
    edited.frame(design(seq=edited.sent()[-1]["seq"], text=TEXT + "# dragged"))
    edited.again("two", text="cue 1\n")
    assert not offered(edited)
    edited.again("three", text=TEXT + "# dragged")
    assert not offered(edited)
    edited.again("four")
    edited.page.get_by_role("button", name="Restore it").click()
    assert text_of(edited) == TEXT + "# dragged"


def test_two_views_of_one_model_decide_once(edited: Bench) -> None:
    edited.again("two")
    edited.show(key="two")
    edited.frame(design())
    bars = edited.page.locator(".tm-unsaved:visible")
    assert bars.count() == 2
    bars.nth(1).get_by_role("button", name="Discard").click()
    assert bars.count() == 0


def test_the_text_can_be_copied_while_there_is_no_answer(edited: Bench) -> None:
    page = edited.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.wait_for_selector(".tm-banner:not([hidden])", timeout=5_000)
    page.get_by_role("button", name="Copy text").click()
    page.get_by_role("button", name="Copied").wait_for()
    edited.said("Text copied")
    page.locator(".cm-content").press("Control+a")
    page.keyboard.press("Control+v")
    assert text_of(edited) == TEXT + "# mine"
    edited.answer()
    assert page.locator(".tm-banner").is_hidden()


def test_where_nothing_may_be_kept_the_banner_says_copy(page: Any) -> None:
    page.add_init_script(FORBIDDEN)
    bench = open_bench(page)
    bench.show()
    bench.frame(design())
    append(bench, "#")
    page.wait_for_selector(".tm-banner:not([hidden])", timeout=5_000)
    late = "No answer from the kernel: run the cell again to go on; copy your text first"
    assert page.locator(".tm-banner [role=alert]").inner_text() == late
    assert bench.wrong == []
