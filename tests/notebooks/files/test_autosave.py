"""Cue files that an editor has open, and unsaved text beside them."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from thermicon.notebooks.files.autosave import EVERY_S, KEPT_S, Autosave, unsaved_texts
from thermicon.notebooks.files.cue_document import ChangedOnDisk, create_document, open_document
from thermicon.notebooks.files.kept_draft import HEAD, KeptVersion, draft_text, read_draft
from thermicon.notebooks.files.outputs import OutputError

GONE = 4_000_000
"""A process number that Linux gives to no process."""


def left_behind(place: Path, text: str, process: int = GONE) -> Path:
    path = place.with_name(f".{place.name}.{process}-0.unsaved")
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_keeps_its_line_ends_and_its_name(tmp_path: Path) -> None:
    path = tmp_path / "a.cue"
    path.write_bytes(b"\xef\xbb\xbfcue 1\r\n# \xc2\xb0\r\n")
    document = open_document(path)
    assert document.text == "cue 1\n# °\n"
    document = document.saved("cue 1\n# mine\n")
    assert path.read_bytes() == b"cue 1\r\n# mine\r\n"
    assert not document.changed
    assert [each.name for each in tmp_path.iterdir()] == ["a.cue"]


def test_what_came_in_between_is_not_overwritten_unless_asked_for(tmp_path: Path) -> None:
    first = create_document(tmp_path / "a.cue", "cue 1")
    second = open_document(first.path)
    first.saved("cue 1 # first")
    assert second.changed
    with pytest.raises(
        ChangedOnDisk, match=r"a\.cue has changed on disk since it was opened here: save your text under"
    ):
        second.saved("cue 1 # second")
    assert first.path.read_text() == "cue 1 # first"
    second.saved("cue 1 # second", overwrite=True)
    assert first.path.read_text() == "cue 1 # second"
    first.path.unlink()
    with pytest.raises(ChangedOnDisk, match=r"a\.cue was removed"):
        second.saved("cue 1")


def test_files_that_cannot_be_are_told(tmp_path: Path) -> None:
    (tmp_path / "bytes.cue").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "folder.cue").mkdir()
    with pytest.raises(OutputError, match=r"bytes\.cue: it is not UTF-8 text"):
        open_document(tmp_path / "bytes.cue")
    with pytest.raises(OutputError, match=r"folder\.cue: this is a directory, not a cue file"):
        open_document(tmp_path / "folder.cue")
    with pytest.raises(OutputError, match=r"none\.cue: no such cue file"):
        open_document(tmp_path / "none.cue")
    create_document(tmp_path / "a.cue", "cue 1")
    with pytest.raises(OutputError, match=r"a\.cue already exists and was kept"):
        create_document(tmp_path / "a.cue", "cue 1")
    with pytest.raises(OutputError, match=r"cue text is written as \.cue, not \.txt"):
        create_document(tmp_path / "a.txt", "cue 1")


def test_unsaved_text_is_kept_at_once_then_twice_a_second(tmp_path: Path) -> None:
    kept = Autosave(tmp_path / "a.cue")
    kept.keep("one")
    assert kept.path.read_text() == "one"
    kept.keep("two")
    kept.keep("three")
    time.sleep(EVERY_S + 0.3)
    assert kept.path.read_text() == "three"
    assert [each.text for each in unsaved_texts(tmp_path / "a.cue", "as saved")] == ["three"]
    assert unsaved_texts(tmp_path / "a.cue", "as saved", kept.path) == []
    kept.keep("four")
    kept.forget()
    time.sleep(EVERY_S + 0.3)
    assert list(tmp_path.iterdir()) == []


def test_what_is_saved_or_old_is_swept_and_what_runs_is_left(tmp_path: Path) -> None:
    place = tmp_path / "a.cue"
    same, old = left_behind(place, "as saved"), left_behind(place, "old", GONE + 1)
    os.utime(old, (1, time.time() - KEPT_S - 60))
    running = left_behind(place, "of another", os.getppid())
    other = left_behind(tmp_path / "b.cue", "of b")
    found = unsaved_texts(place, "as saved")
    assert [(each.text, each.alive, each.age) for each in found] == [("of another", True, "a moment ago")]
    assert not same.exists()
    assert not old.exists()
    assert running.exists()
    assert other.exists()


def test_a_folder_that_takes_nothing_is_told(tmp_path: Path) -> None:
    kept = Autosave(tmp_path / "gone" / "a.cue")
    kept.keep("text")
    assert kept.failed is not None
    assert "cannot write" in kept.failed


def test_a_version_is_kept_with_the_text_and_plain_drafts_are_still_read(tmp_path: Path) -> None:
    place, version = (
        tmp_path / "a.cue",
        KeptVersion(text="cue 1 # A", rig="name = 'x'", values={"age": 65.0, "site": "y"}),
    )
    kept = Autosave(place)
    kept.keep("cue 1", version)
    (alone,) = unsaved_texts(place, "cue 1")
    assert (alone.text, alone.version) == (None, version)
    (both,) = unsaved_texts(place, "as saved")
    assert (both.text, both.version) == ("cue 1", version)
    kept.forget()
    left_behind(place, "typed by an earlier release")
    assert [(each.text, each.version) for each in unsaved_texts(place, "cue 1")] == [
        ("typed by an earlier release", None)
    ]


def test_a_draft_of_another_release_is_read_as_far_as_it_is_known() -> None:
    version = KeptVersion(text="A", rig="r")
    later = draft_text("B", version).replace('"text":"B"', '"text":"B","theme":"dark"')
    assert "dark" in later
    assert read_draft(later) == read_draft(draft_text("B", version))
    broken = HEAD + ": 9}"
    assert read_draft(broken).text == broken
