"""The preview in a static page: time runs, a patch says what is felt, a set and a quiz, versions and the palette."""

from typing import Any

import numpy
import pytest
from playwright.sync_api import Page, expect

from tests.browser.staticpage import INKED, ROWS, TEXT, Bench, design

SPOT = "e => [e.dataset.quality, getComputedStyle(e).backgroundColor]"
PLACE = "document.querySelector('.tm-timeline').timeline.cursor"
PLAYS = "document.querySelector('.tm-player').player.run.playing"


def felt(lasts_s: float = 8.0, **changes: Any) -> dict[str, Any]:
    """A frame with a panel of sensation, cold from 1 s on."""
    lines = [{"key": key, "label": key, "buffer": k, "role": "ink"} for k, key in enumerate(("skin", "cold"))]
    panels = [
        {"key": key, "label": key, "series": [line]}
        for key, line in zip(("temperature", "sensation"), lines, strict=True)
    ]
    told = {"until": lasts_s, "felt": True, "onset": 1.5, "quality": "cold", "share": 1.0}
    return design(
        time={"t0": 0.0, "dt": lasts_s / ROWS, "n": ROWS + 1}, panels=panels, handles=[], play=told, **changes
    )


def curves(lasts_s: float = 8.0) -> tuple[Any, Any]:
    time_s = numpy.linspace(0.0, lasts_s, ROWS + 1)
    return 32.0 - time_s / 4.0, numpy.where(time_s < 1.0, 0.0, 10.0)


@pytest.fixture
def player(made: Bench) -> Bench:
    made.show()
    made.frame(felt(), *curves())
    return made


def press(page: Page, *keys: str) -> None:
    page.locator(".tm-stage").first.focus()
    for key in keys:
        page.keyboard.press(key)


@pytest.mark.parametrize(("speed", "takes_s"), [("1", 8.0), ("2", 4.0)])
def test_time_runs_as_a_clock_does_while_the_kernel_is_silent(player: Bench, speed: str, takes_s: float) -> None:
    page = player.page
    page.get_by_label("Speed").select_option(speed)
    player.append("#")  # a message that nobody answers
    took = page.evaluate(f"""() => new Promise((done) => {{
      document.querySelector(".tm-player .tm-button").click();
      const began = performance.now();
      const look = () => {PLAYS} ? requestAnimationFrame(look) : done(performance.now() - began);
      look();
    }})""")
    assert took / 1e3 == pytest.approx(takes_s, abs=0.1)
    assert page.evaluate(PLACE) == 8.0


def test_space_plays_where_the_time_line_has_the_focus_and_types_elsewhere(player: Bench) -> None:
    page, play = player.page, player.page.locator(".tm-player .tm-button").first
    player.append(" ")
    assert player.text == TEXT + " "
    assert not page.evaluate(PLAYS)
    press(page, "Space")
    assert page.evaluate(PLAYS)
    expect(play).to_have_text("■ Stop")
    player.append("# typed")
    assert page.evaluate(PLAYS), "who types goes on watching"
    assert player.text == TEXT + " # typed"
    expect(page.locator(".tm-older-tag")).to_be_visible()
    page.keyboard.press("Escape")
    assert not page.evaluate(PLAYS)
    play.press("Space")
    assert page.evaluate(PLAYS)
    player.frame(felt(icon="rise"), *curves())
    assert not page.evaluate(PLAYS), "another icon is another play"


def test_the_patch_is_grey_then_blue_and_says_felt_at_the_onset(player: Bench) -> None:
    page, spot, word = player.page, player.page.locator(".tm-spot"), player.page.locator(".tm-felt")
    press(page, "Home")
    assert spot.evaluate(SPOT) == ["", "rgb(106, 106, 106)"]
    small = spot.bounding_box()["width"]
    press(page, "Space")
    page.wait_for_function(f"{PLACE} > 1.1")
    assert spot.evaluate(SPOT) == ["cold", "rgb(33, 102, 172)"]
    assert spot.bounding_box()["width"] > 3 * small
    assert word.inner_text() == "not yet reported"
    page.wait_for_function(f"{PLACE} > 1.6")
    assert word.inner_text() == "felt: cold"
    assert "predicted" in page.locator(".tm-patch").inner_text()
    player.said("Felt: cold, 1.5 s.")
    player.said("End of dip. Felt: cold, 1.5 s.")


def test_an_icon_that_is_not_felt_plays_grey_and_says_so(player: Bench) -> None:
    player.frame(felt(1.0) | {"play": {"until": 1.0, "felt": False, "share": 0.12}}, *curves(1.0))
    press(player.page, "Space")
    player.said("Playing dip. It is not felt.")
    assert player.page.locator(".tm-felt").inner_text() == "not felt (reported in 12 % of trials)"
    assert player.page.locator(".tm-spot").evaluate(SPOT)[0] == ""
    player.said("End of dip. Not felt.")


def test_time_steps_where_less_motion_is_asked_for(player: Bench) -> None:
    player.page.emulate_media(reduced_motion="reduce")
    press(player.page, "Space")
    seen = set()
    for _ in range(12):
        player.page.wait_for_timeout(90)
        seen.add(player.page.evaluate(PLACE))
    assert {t % 0.5 for t in seen} == {0.0}
    assert len(seen) > 1


def reel(bench: Bench, lasts_s: float) -> None:
    """The kernel's answer to who asked for a set: two icons."""
    frames = [felt(lasts_s, icon=name) | {"buffers": 2} for name in ("dip", "rise")]
    bench.frame({"type": "reel", "frames": frames, "why": ""}, *curves(lasts_s), *curves(lasts_s))


def test_while_a_device_plays_nothing_is_previewed_and_space_only_stops_it(player: Bench) -> None:
    page, play = player.page, player.page.locator(".tm-player .tm-button").first
    press(page, " ")
    player.frame({"type": "device", "plays": True})
    assert not page.evaluate(PLAYS), "the preview ends"
    assert play.inner_text() == "■ Stop the device"
    assert page.locator(".tm-predicted").inner_text() == "a device plays: no preview"
    for name in ("Play set", "Quiz"):
        assert page.get_by_role("button", name=name).is_disabled()
    player.append("#")  # a message that nobody answers holds nothing up
    asked = [0]
    for act in (lambda: press(page, " "), lambda: press(page, "Escape"), play.click):
        act()
        asked.append(len(player.sent("stop device")))
    assert asked == sorted(set(asked)), "each of them asks at once"
    assert not page.evaluate(PLAYS)
    player.frame({"type": "device", "plays": False})
    press(page, "ArrowRight")
    assert len(player.sent("stop device")) == asked[-1]
    press(page, " ")
    assert page.evaluate(PLAYS)


def test_a_set_plays_one_icon_after_another_with_their_names(player: Bench) -> None:
    page, title = player.page, player.page.locator(".tm-reel-title")
    page.get_by_role("button", name="Play set").click()
    assert player.sent()[-1]["type"] == "reel"
    reel(player, 0.4)
    expect(title).to_have_text("1 of 2: dip")
    expect(title).to_have_text("2 of 2: rise")
    player.append("#")
    expect(page.locator(".tm-reel-older")).to_be_visible()
    expect(page.locator(".tm-reel")).to_be_hidden()
    page.get_by_role("button", name="Play set").click()
    player.frame({"type": "reel", "frames": [], "why": "not played: the text has errors"}, [])
    expect(page.locator(".tm-felt")).to_have_text("not played: the text has errors")


def test_a_quiz_hides_names_counts_answers_and_calls_itself_a_rehearsal(player: Bench) -> None:
    page = player.page
    page.get_by_role("button", name="Quiz").click()
    reel(player, 8.0)
    player.frame(felt(), *curves())  # the kernel has refined the set, say: what plays goes on
    assert "not data" in page.locator(".tm-counts caption").inner_text()
    right = 0
    for _ in range(4):
        assert page.locator(".tm-reel-title").inner_text() == "Which icon is it?"
        page.locator(".tm-answers").get_by_role("button", name="dip").click()
        right += page.locator(".tm-quiz-prompt").inner_text() == "Right: dip."
        expect(page.locator(".tm-next")).to_be_focused()
        page.keyboard.press("Enter")
    assert right == 2, "each icon comes once before any comes again"
    rows = page.locator(".tm-counts tbody tr").all_inner_texts()
    assert [row.split("\t") for row in rows] == [["dip", "2", "2", ""], ["rise", "2", "0", "dip (2)"]]
    page.keyboard.press("Escape")
    expect(page.locator(".tm-reel")).to_be_hidden()
    assert page.locator(".tm-player .tm-spot").is_visible()


def test_a_pinned_version_lies_behind_and_one_key_changes_sides(player: Bench) -> None:
    page, base = player.page, player.page.locator(".tm-base").first
    press(page, "b")
    assert player.sent("swap") == []
    page.get_by_role("button", name="Pin", exact=True).click()
    assert player.sent()[-1]["type"] == "pin"
    player.answer()
    player.frame(felt(), *curves())
    plain = base.evaluate(INKED)
    numbers = {"set": "93 %", "icon": "92 %", "onset": "0.9 s", "worst": "–", "what": "dip, thenar", "stale": False}
    sides = [{**numbers, "side": side} for side in ("pinned", "now")]
    player.frame({"type": "strip", **numbers, "felt": "1 %", "goal": "", "met": None, "sides": sides})
    shown = felt()
    shown["panels"][0]["pinned"] = [{"key": "skin", "label": "skin", "buffer": 2, "role": "ink"}]
    pinned = numpy.linspace(32.0, 31.0, ROWS + 1)
    player.frame({**shown, "pinned": shown["time"]}, *curves(), pinned)
    assert base.evaluate(INKED) > plain
    player.frame({**shown, "pinned": {**shown["time"], "dt": 0.02}}, *curves(), pinned)
    assert page.evaluate("document.querySelector('.tm-timeline').timeline.view.to") == 12.0
    assert page.locator(".tm-sides tbody tr").count() == 2
    press(page, "b")
    assert player.sent()[-1]["type"] == "swap" and player.sent()[-1]["once"] > 0
    expect(page.locator(".tm-pill")).to_have_text("? not judged")


@pytest.mark.parametrize(
    ("caret", "now"),
    [
        (TEXT.index("hold"), TEXT.replace("hold for 4\n", "hold for 4\n  pulse cool by 3 °C for 2 s\n")),
        (TEXT.index("{") + 1, TEXT.replace("{\n", "{\n  pulse cool by 3 °C for 2 s\n")),
        (len(TEXT), f"{TEXT}\nicon pulse {{\n  pulse cool by 3 °C for 2 s\n}}\n"),
    ],
)
def test_a_shape_is_put_in_as_text_where_the_caret_is(player: Bench, caret: int, now: str) -> None:
    page = player.page
    player.set_caret(caret)
    page.get_by_role("button", name="Insert").click()
    page.locator(".tm-shape").first.click()
    assert player.text == now
    player.answer()  # to who opened the palette
    assert player.sent("text")[-1]["text"] == now


def test_an_icon_of_a_shipped_set_gets_a_name_that_is_free(player: Bench) -> None:
    page = player.page
    player.set_caret(TEXT.index("hold"))
    page.get_by_role("button", name="Insert").click()
    assert player.sent()[-1]["type"] == "palette"
    player.frame({"type": "palette", "sets": {"six": {"dip": 'icon dip means "a dip" { hold for 1 s }'}}})
    page.get_by_role("button", name="Insert icon").click()
    assert player.text == TEXT + '\nicon dip-2 means "a dip" { hold for 1 s }\n'
