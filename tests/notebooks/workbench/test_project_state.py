"""Where the bar, the panels and what is kept could fall behind the text, the file, the rig or the icon."""

from __future__ import annotations

import os
import re
import time
from base64 import b64decode
from pathlib import Path

import pytest

from tests.notebooks.workbench.openbench import TEXT, TYPED, opened, said, title
from thermicon.circuit import Rig
from thermicon.notebooks import Workbench
from thermicon.notebooks.files.outputs import OutputError
from thermicon.notebooks.files.start_folder import VARIABLE


def test_a_rig_of_another_folder_can_be_picked_again(path: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    file = tmp_path_factory.mktemp("rigs") / "own.toml"
    text = Rig.load("thenar").with_(**{"contact.area_cm2": 2}).toml
    file.write_text(text.replace('name = "thenar"', 'name = "own"', 1), encoding="utf-8")
    bench = Workbench(path, rig=file)
    assert bench.page is not None
    assert bench.bar is not None
    assert bench.bar.rig.value == "own"
    bench.bar.rig.value = "thenar"
    bench.bar.rig.value = "own"
    assert bench.rig.contact.area_m2 == pytest.approx(2e-4)
    assert said(bench.bar) == ""


def test_the_list_of_rigs_shows_the_one_that_is_used(path: Path) -> None:
    mine = path.with_name("mine.toml")
    Rig.load("fingertip").with_(**{"contact.area_cm2": 2}).save(mine)
    bench, bar = opened(path)
    mine.unlink()
    bar.rig.value = "mine.toml"
    assert "mine.toml" in said(bar)
    assert bar.rig.value == bench.rig.name == "thenar"
    assert bench.design_view is not None
    bench.design_view.sliders["contact"].value = 2.0
    bar.path.value = "alerts.cue"
    bar._safely(bar._open_selected)
    assert bench.rig.contact.resistance_m2K_per_W == pytest.approx(2 * Rig.load("thenar").contact.resistance_m2K_per_W)


def test_a_site_of_a_rig_file_is_shown_as_text(path: Path) -> None:
    text = Rig.load("thenar").toml.replace('site = "thenar"', 'site = "<b>palm</b>"')
    path.with_name("odd.toml").write_text(text, encoding="utf-8")
    bench = Workbench(path, rig=path.with_name("odd.toml"))
    assert bench.page is not None
    assert bench.design_view is not None
    bench.design_view.sliders["site"].value = "thenar"
    assert "site · rig &lt;b&gt;palm&lt;/b&gt;" in bench.design_view._labels["site"].value


def test_a_file_with_the_line_ends_of_windows_is_as_saved(path: Path) -> None:
    data = TEXT.replace("\n", "\r\n").encode()
    path.write_bytes(data)
    bench, bar = opened(path)
    assert bench.text == TEXT
    assert title(bar) == "alerts.cue"
    bench.text = TYPED
    bar.buttons["Save"].click()
    assert path.read_bytes() == data.replace(b"3 K", b"4 K")


def test_a_file_that_was_removed_is_said_with_what_to_do(path: Path) -> None:
    bench, bar = opened(path)
    path.unlink()
    bench.text = TYPED
    assert said(bar).startswith("alerts.cue was removed on disk since it was opened here: Save as writes")
    bar.buttons["Save as"].click()
    bar._safely(bar._save_as)
    assert path.read_text(encoding="utf-8") == TYPED


def test_only_a_refusal_that_was_read_lets_save_write_over_a_changed_file(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench, bar = opened(path)
    bench.text = TYPED
    with monkeypatch.context() as full:
        full.setattr("thermicon.notebooks.files.cue_document._written", refuse)
        bar.buttons["Save"].click()
    assert said(bar) == "the disk is full"
    path.write_text("cue 1 # of another window\n", encoding="utf-8")
    bar.buttons["Save"].click()
    assert "has changed on disk" in said(bar)
    bar.buttons["Save"].click()
    assert path.read_text(encoding="utf-8") == TYPED


def refuse(*_: object) -> None:
    raise OutputError("the disk is full")


def test_a_set_goes_by_the_name_of_the_file_that_it_was_saved_to_or_opened_from(path: Path) -> None:
    _, bar = opened(None)
    bar.name.value = "mine.cue"
    bar._safely(bar._save_as)
    bar.buttons["Download"].click()
    assert 'download="mine.cue"' in bar.links.value
    folder = path.parent / "sub"
    folder.mkdir()
    (folder / "deep.cue").write_text(TEXT, encoding="utf-8")
    bar.path.value = "sub/deep.cue"
    bar._safely(bar._open_selected)
    bar.buttons["Save as"].click()
    assert bar.name.value == "deep.cue"


def test_open_panels_follow_the_text_and_the_icon_that_is_shown(path: Path) -> None:
    bench, bar = opened(path)
    bar.buttons["Icon"].click()
    assert bench.design_view is not None
    bench.design_view._receive({"type": "icon", "name": "b", "seq": 1})
    assert ">b<" in bar.about.value
    bar.buttons["Download"].click()
    assert bar.panel.children
    bench.text = TYPED
    assert not bar.panel.children
    bar.buttons["Download"].click()
    data = re.search(r'download="alerts.cue" href="data:[^,]*,([^"]*)"', bar.links.value)
    assert data is not None
    assert b64decode(data[1]).decode() == TYPED


def test_restoring_leaves_another_text_of_a_running_editor_with_it(path: Path) -> None:
    drafts = [path.with_name(f".alerts.cue.{os.getppid()}-{k}.unsaved") for k in range(2)]  # a process that runs
    for age_s, draft, text in zip((0, 60), drafts, (TYPED, TEXT + "# other\n"), strict=True):
        first, _ = opened(path)
        first.text = text
        next(path.parent.glob(f".alerts.cue.{os.getpid()}-*")).rename(draft)
        os.utime(draft, (time.time() - age_s,) * 2)
    second, bar = opened(path)
    assert "in another workbench that is still open" in bar.offered.value
    bar._safely(bar._restore)
    assert second.text == TYPED
    assert [draft.exists() for draft in drafts] == [False, True]


def test_version_a_stays_kept_when_its_file_is_opened_again(path: Path) -> None:
    bench, bar = opened(path)
    assert bench.versions_view is not None
    bench.versions_view.keep_now()
    bar.path.value = "alerts.cue"
    bar._safely(bar._open_selected)
    assert len(list(path.parent.glob(".alerts.cue.*"))) == 1


def test_a_page_whose_file_is_a_link_out_of_its_folder_still_starts(
    path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path_factory.mktemp("elsewhere")))
    bench, bar = opened(path)
    assert bench.text == TEXT
    bar.buttons["Open"].click()
    assert bar.files.options[0].startswith("shipped: ")
