"""Views of the canvas module in a static page."""

from typing import Any

import pytest

from tests.browser.staticpage import SHADES, TEXT, TROUBLE, Bench, design, open_bench

OFFER = "An earlier text was saved. Buttons above the editor restore or discard it."
FORBIDDEN = "Object.defineProperty(window, 'sessionStorage', { get() { throw new DOMException('no') } })"


def test_a_view_without_a_drawing_waits_without_a_banner_while_the_kernel_lives(page: Any, made: Bench) -> None:
    made.show("heat")
    page.evaluate("deliver({ type: 'alive' }, [])")
    page.wait_for_timeout(3_500)
    assert page.locator(".tm-banner").is_hidden()
    assert page.locator(".tm-waiting").is_visible()


def test_themes_change_the_colours_that_are_drawn(page: Any, made: Bench) -> None:
    page.emulate_media(color_scheme="dark")
    made.draw()
    ground = "() => getComputedStyle(document.querySelector('.tm-root')).backgroundColor"
    light, dark = page.evaluate(SHADES)
    assert light > 5 * dark, "the skin's line is pale on a dark page"
    assert page.evaluate(ground) == "rgb(20, 23, 26)"
    page.evaluate("document.body.dataset.jpThemeLight = 'true'")
    page.wait_for_timeout(150)
    assert page.evaluate(ground) == "rgb(255, 255, 255)"
    light, dark = page.evaluate(SHADES)
    assert dark > 100, "and dark on a light one, redrawn at once"


def test_a_cell_is_picked_by_click_and_by_keys(page: Any, made: Bench) -> None:
    made.show("heat")
    labels = ["cool", "warm", "wave"]
    both = [
        {"key": "distance", "label": "distance (d′)", "buffer": 0, "unit": "", "low": 0, "high": 6, "text": "0.0"},
        {"key": "confusion", "label": "confusion", "buffer": 1, "unit": "", "low": 0, "high": 1, "text": "0%"},
    ]
    meta = {"type": "frame", "view": "heat", "seq": 0, "labels": labels, "matrices": both, "picked": None, "ms": 1.0}
    arrays = ([0, 1, 2, 1, 0, 3.25, 2, 3.25, 0], [0.9, 0.1, 0, 0.1, 0.9, 0, 0, 0.05, 0.95])
    made.frame(meta, *arrays)
    cell = page.locator("[data-matrix=confusion] .tm-cell[data-row='2'][data-column='1']")
    assert cell.inner_text() == "5%"
    cell.click()
    assert {**made.sent("cell")[0], "seq": 0} == {"type": "cell", "row": 2, "column": 1, "seq": 0}
    assert page.locator(".tm-reading").inner_text() == "wave → warm: distance (d′) 3.3, confusion 5%"
    made.frame({**meta, "seq": made.sent("cell")[0]["seq"], "picked": [2, 1]}, *arrays)
    assert page.locator(".tm-picked").count() == 2
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("Enter")
    assert (made.sent("cell")[-1]["row"], made.sent("cell")[-1]["column"]) == (1, 0)


def test_what_all_names_begin_with_is_said_once(page: Any, made: Bench) -> None:
    made.show("heat")
    one = {"key": "confusion", "label": "confusion", "buffer": 0, "unit": "", "low": 0, "high": 1, "text": "0%"}
    made.frame({"type": "frame", "view": "heat", "labels": ["dip_rate=1", "dip_rate=12"], "matrices": [one]}, [0] * 4)
    assert page.locator(".tm-corner").inner_text() == "dip_rate=…"
    assert page.locator(".tm-column").all_inner_texts() == ["1", "12"]
    assert page.locator(".tm-row").first.get_attribute("aria-label") == "dip_rate=1"


def test_the_number_under_the_focus_follows_the_ranking(page: Any, made: Bench) -> None:
    made.show("heat")
    one = {"key": "confusion", "label": "confusion", "buffer": 0, "unit": "", "low": 0, "high": 1, "text": "0%"}
    meta = {"type": "frame", "view": "heat", "seq": 0, "labels": ["cool", "warm"], "matrices": [one], "picked": None}
    made.frame(meta, [0.9, 0.1, 0.1, 0.9])
    page.locator(".tm-cell[data-row='1'][data-column='0']").focus()
    assert page.locator(".tm-reading").inner_text() == "warm → cool: confusion 10%"
    made.frame(meta, [0.8, 0.2, 0.2, 0.8])
    assert page.locator(".tm-reading").inner_text() == "warm → cool: confusion 20%"


def test_two_icons_over_each_other_offer_no_corner(page: Any, made: Bench) -> None:
    made.show("traces")
    made.frame(design(view="traces", handles=[]))
    said = page.locator(".tm-stage").get_attribute("aria-describedby")
    assert "corner" not in page.locator(f"#{said}").text_content()


def test_two_views_of_one_model_show_one_text_and_leave_nothing_behind(page: Any, made: Bench) -> None:
    made.show()
    made.draw()
    made.append("#")
    assert made.text_in(1) == TEXT + "#"
    page.evaluate("leave()")
    assert page.locator(".tm-root").count() == 1
    assert page.evaluate("listeners.size") == 1


def test_screen_readers_hear_the_cursor_once_and_names_without_signs(drawn: Bench) -> None:
    page = drawn.page
    assert page.locator(".tm-sign").evaluate_all("all => all.map((e) => e.getAttribute('aria-hidden'))") == ["true"] * 2
    assert page.locator(".tm-timeline output").count() == 0, "an <output> is read aloud at each change"
    page.locator(".tm-stage").focus()
    page.keyboard.press("End")
    drawn.said("At 6.00 s: skin 26.00 °C")
    page.keyboard.press("Home")
    drawn.said("At 0.00 s: skin 32.00 °C")


def test_the_list_of_errors_can_be_read_in_the_dark(page: Any, made: Bench) -> None:
    page.emulate_media(color_scheme="dark")
    made.draw(troubles=[TROUBLE])
    made.set_caret(0)
    page.keyboard.press("Control+Shift+M")
    made.set_caret(0)
    chosen = page.locator(".cm-panel-lint [aria-selected]")
    assert chosen.evaluate("e => getComputedStyle(e).backgroundColor") == "rgba(79, 209, 191, 0.14)"
    assert chosen.evaluate("e => getComputedStyle(e).color") == "rgb(232, 235, 238)"


@pytest.fixture
def edited(drawn: Bench) -> Bench:
    """A bench of the model "one" whose text was changed."""
    drawn.append("# mine")
    return drawn


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
    edited.append("# newer")
    edited.again("four")
    assert left(edited) == [TEXT + "# newer"]


def test_the_same_model_is_told_nothing_and_goes_on_in_its_place(edited: Bench) -> None:
    edited.again("one", text=TEXT + "# mine")
    assert left(edited) == []
    edited.append("!")
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
    bench.draw()
    bench.append("#")
    page.wait_for_selector(".tm-banner:not([hidden])", timeout=5_000)
    late = "No answer from the kernel: run the cell again to go on; copy your text first"
    assert page.locator(".tm-banner [role=alert]").inner_text() == late
    assert bench.wrong == []
