"""Documents: cue files under edit."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from thermicon.base.files.atomic import OutputError
from thermicon.notebooks.files.document import MOST_STEPS, Document, History, HistoryStep
from thermicon.notebooks.files.recovery import EVERY_S, MOST, MOST_LETTERS, RecoveryFile, UnsavedText


def typed(document: Document, text: str) -> Document:
    document.history = document.history.changed(text)
    document.changed()
    return document


def test_a_file_keeps_its_line_ends_and_its_name(tmp_path: Path) -> None:
    path = tmp_path / "a.cue"
    path.write_bytes(b"\xef\xbb\xbfcue 1\r\n# \xc2\xb0\r\n")
    document = Document.open(path, keeps=True)
    assert document.text == "cue 1\n# °\n"
    assert document.title == "a.cue"
    with pytest.raises(OutputError, match="does not exist"):
        document.save_as(tmp_path / "gone" / "b.cue")
    typed(document, "cue 1\n# mine\n").save()
    assert path.read_bytes() == b"cue 1\r\n# mine\r\n"
    assert document.warning() == ""
    assert [each.name for each in tmp_path.iterdir()] == ["a.cue"]


def test_what_came_in_between_is_not_overwritten_unless_asked_for(tmp_path: Path) -> None:
    first = Document("cue 1")
    path = first.save_as(tmp_path / "a.cue")
    second = typed(Document.open(path), "cue 1 # second")
    typed(first, "cue 1 # first").save()
    with pytest.raises(OutputError, match=r"a\.cue has changed on disk since it was opened here: save your text under"):
        second.save()
    assert path.read_text() == "cue 1 # first"
    second.save()
    assert path.read_text() == "cue 1 # second"
    path.unlink()
    with pytest.raises(OutputError, match=r"a\.cue was removed"):
        second.save()


def test_files_that_cannot_be_are_told(tmp_path: Path) -> None:
    (tmp_path / "bytes.cue").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "folder.cue").mkdir()
    with pytest.raises(OutputError, match=r"bytes\.cue: it is not UTF-8 text"):
        Document.open(tmp_path / "bytes.cue")
    with pytest.raises(OutputError, match=r"folder\.cue: this is a folder, not a cue file"):
        Document.open(tmp_path / "folder.cue")
    with pytest.raises(OutputError, match=r"none\.cue: no such cue file"):
        Document.open(tmp_path / "none.cue")
    document = Document("cue 1")
    with pytest.raises(OutputError, match=r"this set has no file yet"):
        document.save()
    document.save_as(tmp_path / "a.cue")
    with pytest.raises(OutputError, match=r"a\.cue already exists and was kept"):
        document.save_as(tmp_path / "a.cue")
    with pytest.raises(OutputError, match=r"cue text is written as \.cue, not \.txt"):
        document.save_as(tmp_path / "a.txt")


def test_unsaved_text_is_kept_at_once_then_twice_a_second(tmp_path: Path) -> None:
    kept, seen = RecoveryFile(tmp_path / "a.cue"), RecoveryFile(tmp_path / "a.cue")
    kept.typed("one", "dip")
    assert [(each.text, each.icon) for each in seen.others] == [("one", "dip")]
    assert kept.others == ()
    kept.typed("two", None)
    kept.typed("three", None)
    assert [each.text for each in seen.others] == ["one"]
    time.sleep(EVERY_S + 0.3)
    assert [each.text for each in seen.others] == ["three"]
    kept.typed("four", None)
    kept.typed(None, None)
    time.sleep(EVERY_S + 0.3)
    assert list(tmp_path.iterdir()) == []


def test_text_of_a_killed_process_is_offered_until_it_is_dropped(tmp_path: Path) -> None:
    path = tmp_path / "a.cue"
    path.write_text("cue 1", encoding="utf-8")
    code = (
        "import os, sys; from pathlib import Path; from thermicon.notebooks.files.document import Document\n"
        "made = Document.open(Path(sys.argv[1]), keeps=True)\n"
        "made.history = made.history.changed('cue 1 # typed'); made.changed(); os.kill(os.getpid(), 9)"
    )
    subprocess.run([sys.executable, "-c", code, str(path)], check=False)
    document = Document.open(path, keeps=True)
    assert document.offer is not None
    assert (document.offer.text, document.offer.age) == ("cue 1 # typed", "a moment ago")
    assert document.text == "cue 1"
    os.utime(path, (time.time() + 60,) * 2)
    again = Document.open(path, keeps=True)
    assert again.offer == document.offer
    again.recovery.drop(again.offer)
    assert again.offer is None
    assert list(tmp_path.iterdir()) == [path]


def test_two_editors_of_one_file_keep_their_texts_side_by_side(tmp_path: Path) -> None:
    path = Document("cue 1").save_as(tmp_path / "a.cue")
    first, second = Document.open(path, keeps=True), Document.open(path, keeps=True)
    typed(first, "cue 1 # first")
    typed(second, "cue 1 # second")
    time.sleep(EVERY_S + 0.1)
    typed(first, "cue 1 # first, again")
    third = Document.open(path, keeps=True)
    assert sorted(unsaved.text for unsaved in third.recovery.others) == ["cue 1 # first, again", "cue 1 # second"]
    first.save()
    assert [unsaved.text for unsaved in third.recovery.others] == ["cue 1 # second"]


def test_versions_that_were_kept_by_hand_become_files_and_none_is_lost(tmp_path: Path) -> None:
    by_hand = [UnsavedText(f"cue 1 # {number}", 1e9 + number / 10, "dip") for number in (1, 2)]
    recovery, folder = RecoveryFile(tmp_path / "a.cue"), tmp_path / "a-versions"
    recovery.keep(*by_hand, UnsavedText("cue 1 # unsaved", 2e9, None, "page"))
    folder.write_text("in the way")
    with pytest.raises(OutputError, match="a-versions: it is a file"):
        recovery.write_versions()
    assert [unsaved.text for unsaved in recovery.others] == ["cue 1 # 1", "cue 1 # 2", "cue 1 # unsaved"]
    folder.unlink()
    assert recovery.write_versions() == folder
    assert sorted(path.read_text() for path in folder.glob("*.cue")) == ["cue 1 # 1", "cue 1 # 2"]
    assert [unsaved.text for unsaved in recovery.others] == ["cue 1 # unsaved"]
    assert recovery.write_versions() is None


def test_the_oldest_versions_make_room(tmp_path: Path) -> None:
    kept = RecoveryFile(tmp_path / "a.cue")
    kept.keep(*(UnsavedText(str(k), float(k)) for k in range(MOST + 5)))
    assert [each.text for each in kept.others] == [str(k) for k in range(5, MOST + 5)]
    kept.keep(UnsavedText("x" * (MOST_LETTERS - 1), 1e9))
    assert [each.text[:2] for each in kept.others] == ["xx"]


@pytest.mark.parametrize("held", ["typed by hand", '[{"text": 1}]', "[1", '[{"text": "a", "at_s": 1e300}]'])
def test_a_file_of_another_form_is_offered_as_it_is(tmp_path: Path, held: str) -> None:
    (tmp_path / ".a.cue.unsaved").write_text(held, encoding="utf-8")
    (found,) = RecoveryFile(tmp_path / "a.cue").others
    assert found.text == held
    (tmp_path / ".a.cue.unsaved").write_text('[{"text": "B", "at_s": 1.0, "theme": "dark"}]', encoding="utf-8")
    assert RecoveryFile(tmp_path / "a.cue").others == (UnsavedText("B", 1.0),)


def test_a_folder_that_takes_nothing_is_told_and_texts_stay_in_memory(tmp_path: Path) -> None:
    kept = RecoveryFile(tmp_path / "gone" / "a.cue")
    kept.typed("text", None)
    assert kept.failed is not None
    assert "cannot write" in kept.failed
    kept.keep(UnsavedText("kept", 1.0))
    assert [each.text for each in kept.others] == ["kept"]


def test_what_is_not_kept_on_disk_is_kept_in_memory(tmp_path: Path) -> None:
    document = Document("cue 1")
    document.left("cue 1 # of the page")
    left = document.offer
    with pytest.raises(OutputError, match=r"icons .not saved to a file.: save it first, or undo the changes"):
        typed(document, "cue 2").leave()
    assert document.recovery.others == (left,)
    document.save_as(tmp_path / "a.cue")
    assert [each.name for each in tmp_path.iterdir()] == ["a.cue"]


SIX = History(HistoryStep("6", "dip"))
DRAGGED = SIX.dragged("5", end=False).dragged("4", end=False).dragged("3", end=True)


@pytest.mark.parametrize(
    ("history", "undone"),
    [
        (SIX.typed("a", 0.0).typed("ab", 0.7).typed("abc", 1.4), ["6"]),  # without a pause, one step
        (SIX.typed("a", 0.0).typed("ab", 0.7).typed("abc", 1.6), ["ab", "6"]),
        (DRAGGED, ["6"]),  # one step, however many places it passes
        (DRAGGED.dragged("2", end=True), ["3", "6"]),
        (SIX.typed("66", 0.0).dragged("5", end=False).typed("55", 0.1), ["5", "66", "6"]),
        (SIX.typed("6", 0.0), []),
        (SIX.changed("7").undo().typed("6", 0.0), []),
    ],
)
def test_steps_of_typing_and_drags(history: History, undone: list[str]) -> None:
    texts = []
    while history.past:
        history = history.undo()
        texts.append(history.now.text)
    assert texts == undone
    assert history.undo() is history


def test_redo_is_cleared_by_a_new_edit_alone_and_the_icon_comes_with_its_step() -> None:
    history = SIX.changed("7").undo()
    assert history.redo().now.text == "7"
    assert history.typed("6", 0.0).future
    assert not history.changed("8").future
    assert SIX.redo() is SIX
    risen = SIX.changed("7").chosen("rise").changed("8")
    assert (risen.undo().now, risen.undo().undo().now) == (HistoryStep("7", "rise"), HistoryStep("6", "dip"))


def test_the_oldest_steps_are_forgotten() -> None:
    history = SIX
    for step in range(1, MOST_STEPS + 51):
        history = history.changed(str(step))
    assert (len(history.past), history.past[0].text) == (MOST_STEPS, "50")
