"""Text outlives its kernel: what a bench that is made anew hands to the next one, in a static page."""

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


def left(bench: Bench) -> list[str]:
    """What the page handed to the kernel that was there before it."""
    return [message["text"] for message in bench.sent("left")]


def test_a_new_model_is_told_the_text_and_that_is_said(edited: Bench) -> None:
    assert left(edited) == []
    edited.again("two")
    assert left(edited) == [TEXT + "# mine"]
    edited.said(OFFER)
    assert edited.text == TEXT
    assert edited.sent("text") == []
    edited.again("three")
    assert left(edited) == [], "the kernel has it"
    append(edited, "# newer")
    edited.again("four")
    assert left(edited) == [TEXT + "# newer"]


def test_the_same_model_is_told_nothing_and_goes_on_in_its_place(edited: Bench) -> None:
    edited.again("one", text=TEXT + "# mine")
    assert left(edited) == []
    append(edited, "!")
    edited.again("one", text=TEXT)
    assert left(edited) == [], "the kernel knows better"
    edited.again("two")
    assert left(edited) == [TEXT + "# mine!"]


def test_texts_of_the_kernel_are_kept_and_another_source_finds_nothing(edited: Bench) -> None:
    edited.answer()
    edited.frame(design(seq=edited.sent()[-1]["seq"], text=TEXT + "# dragged"))
    edited.again("two", text="cue 1\n")
    assert left(edited) == []
    edited.again("three", text=TEXT + "# dragged")
    assert left(edited) == []
    edited.again("four")
    assert left(edited) == [TEXT + "# dragged"]


def test_the_text_can_be_copied_while_there_is_no_answer(edited: Bench) -> None:
    page = edited.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.wait_for_selector(".tm-banner:not([hidden])", timeout=5_000)
    page.get_by_role("button", name="Copy text").click()
    page.get_by_role("button", name="Copied").wait_for()
    edited.said("Text copied")
    page.locator(".cm-content").press("Control+a")
    page.keyboard.press("Control+v")
    assert edited.text == TEXT + "# mine"
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
