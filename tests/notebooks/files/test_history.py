"""Undo and redo: what is one step, what is forgotten."""

from __future__ import annotations

from thermicon.notebooks.files.document import MOST_STEPS, Edited, History


def test_typing_without_pause_is_one_step() -> None:
    history = History(Edited("")).typed("a", 0.0).typed("ab", 0.7).typed("abc", 1.4)
    assert history.undo().now.text == ""
    assert history.typed("abcd", 2.2).undo().now.text == "abc"


def test_a_drag_is_one_step_however_many_places_it_passes() -> None:
    history = History(Edited("6")).dragged("5", end=False).dragged("4", end=False).dragged("3", end=True)
    assert history.undo().now.text == "6"
    again = history.dragged("2", end=True)
    assert again.undo().now.text == "3"


def test_a_drag_and_typing_at_once_are_two_steps() -> None:
    history = History(Edited("6")).typed("66", 0.0).dragged("5", end=False).typed("55", 0.1)
    assert [history.undo().now.text, history.undo().undo().now.text] == ["5", "66"]


def test_a_new_edit_clears_redo() -> None:
    history = History(Edited("a")).changed("b").undo()
    assert history.future
    assert history.redo().now.text == "b"
    assert not history.changed("c").future


def test_the_same_text_is_no_step_and_keeps_redo() -> None:
    history = History(Edited("a")).changed("b").undo()
    assert history.typed("a", 0.0).future
    assert not history.typed("a", 0.0).past


def test_nothing_to_undo_or_redo_leaves_the_history_as_it_is() -> None:
    history = History(Edited("a"))
    assert history.undo() == history
    assert history.redo() == history
    assert not history.past


def test_undo_brings_the_icon_back_that_was_shown() -> None:
    history = History(Edited("a", "dip")).changed("b").chosen("rise").changed("c")
    assert history.undo().now == Edited("b", "rise")
    assert history.undo().undo().now == Edited("a", "dip")


def test_the_oldest_steps_are_forgotten() -> None:
    history = History(Edited("0"))
    for step in range(1, MOST_STEPS + 51):
        history = history.changed(str(step))
    assert len(history.past) == MOST_STEPS
    for _ in range(MOST_STEPS + 10):
        history = history.undo()
    assert history.now.text == "50"
