"""Where the bar, the panels and what is kept could fall behind the text, the file, the rig or the icon."""

from __future__ import annotations

import re
from base64 import b64decode
from pathlib import Path

import pytest

from tests.notebooks.workbench.openbench import TEXT, TYPED, opened, said
from thermicon.circuit import Rig
from thermicon.icons.atomic import OutputError
from thermicon.notebooks import Workbench
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
        full.setattr("thermicon.notebooks.files.document.Document._write", refuse)
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


def test_restoring_leaves_another_text_that_is_unsaved_among_the_versions(path: Path) -> None:
    first, second = opened(path)[0], opened(path)[0]
    second.text = TEXT + "# other\n"
    first.text = TYPED
    third, bar = opened(path)
    bar._safely(bar._restore)
    assert third.text == TYPED
    assert [each.text for each in third.document.versions.others] == [TEXT + "# other\n"]
    assert bar.offer.layout.display == "none"
    assert "# other" in opened(path)[0].document.versions.others[0].text


def test_opening_another_file_leaves_unsaved_text_and_versions_with_the_one_before(path: Path) -> None:
    bench, bar = opened(path)
    kept = bench.document.keep()
    bench.text = TYPED
    bar.path.value = "shipped: six-icons"
    bar._safely(bar._open_selected)
    assert bench.document.versions.others == ()
    bar.path.value = "alerts.cue"
    bar._safely(bar._open_selected)
    assert bench.text == TEXT
    assert bar.offer.layout.display == ""
    assert kept in bench.document.versions.others


def test_a_page_whose_file_is_a_link_out_of_its_folder_still_starts(
    path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path_factory.mktemp("elsewhere")))
    bench, bar = opened(path)
    assert bench.text == TEXT
    bar.buttons["Open"].click()
    assert bar.files.options[0].startswith("shipped: ")
