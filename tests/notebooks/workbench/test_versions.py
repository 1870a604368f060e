"""The list of versions without a browser."""

import re
from html import unescape

from tests.notebooks.workbench.openbench import TEXT, TYPED
from thermicon.notebooks import Workbench
from thermicon.notebooks.workbench.versions_view import MOST_LINES, VersionsView, changed_lines


def opened(source: str = TEXT) -> tuple[Workbench, VersionsView]:
    bench = Workbench(source)
    assert bench.page is not None
    view = bench.versions_view
    bench.tabs.selected_index = 3
    assert view.shown
    return bench, view


def said(view: VersionsView, name: str) -> str:
    return re.sub(r"\s+", " ", unescape(re.sub(r"<[^>]*>", " ", str(view.said[name].value)))).strip()


def test_a_version_is_kept_and_what_is_edited_is_shown_beside_it() -> None:
    bench, view = opened()
    assert view.back.disabled
    assert said(view, "about").startswith("Keep the set as it is now")
    view.keep.click()
    assert said(view, "status") == "kept"
    assert said(view, "about") == "as in the editor"
    bench.text = TYPED
    before, after = (f"icon a {{ cool by {k} K at 2 K/s; return at 2 K/s }}" for k in (3, 4))
    assert said(view, "changes") == f"− {before} + {after}"


def test_a_version_comes_back_with_its_icon_as_a_step_that_can_be_undone() -> None:
    bench, view = opened()
    bench.design_view._receive({"type": "icon", "name": "b", "seq": 1})
    view.keep.click()
    bench.text = TYPED
    bench.design_view._receive({"type": "icon", "name": "a", "seq": 2})
    view.back.click()
    assert (bench.text, bench.scene.icon) == (TEXT, "b")
    assert "Undo takes it back out" in said(view, "status")
    bench.design_view._receive({"type": "undo"})
    assert (bench.text, bench.scene.icon) == (TYPED, "a")


def test_the_newest_of_several_is_selected_and_a_choice_stays() -> None:
    bench, view = opened()
    for text in (TEXT, TYPED):
        bench.text = text
        view.keep.click()
    assert [title.split(", ")[1:] for title, _ in view.list.options] == [["a"], ["a"]]
    assert view.picked.text == TYPED
    view.list.value = view.list.options[1][1]
    bench.text = TYPED + "# more\n"
    assert view.picked.text == TEXT
    view.discard.click()
    assert view.picked.text == TYPED
    view.discard.click()
    assert view.list.options == ()
    assert said(view, "about").startswith("Keep the set")


def test_long_differences_are_cut_and_parts_are_set_apart() -> None:
    assert changed_lines(TEXT, TEXT) == []
    many = "\n".join(str(k) for k in range(MOST_LINES + 50))
    rows = changed_lines("", many)
    assert (len(rows), rows[-1]) == (MOST_LINES + 1, ("…", "and 50 more lines"))
    lines = [str(k) for k in range(20)]
    assert changed_lines("\n".join(lines), "\n".join(["x", *lines[1:19], "y"])) == [
        ("−", "0"), ("+", "x"), ("", "1"), ("…", ""), ("", "18"), ("−", "19"), ("+", "y"),
    ]  # fmt: skip
