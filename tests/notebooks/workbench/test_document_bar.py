"""The life of a document in the workbench, without a browser: files, icons, rigs, unsaved text, and what goes wrong."""

from __future__ import annotations

import re
from base64 import b64decode
from pathlib import Path

import pytest

from tests.notebooks.workbench.openbench import TEXT, TYPED, opened, said, title
from thermicon.circuit import Rig
from thermicon.notebooks.files.start_folder import FILE, RIG, VARIABLE


def test_text_goes_back_to_the_file_it_came_from(path: Path) -> None:
    bench, bar = opened(path)
    assert title(bar) == "alerts.cue"
    assert bar.buttons["Save"].disabled
    bench.text = TYPED
    assert title(bar) == "alerts.cue, unsaved changes"
    bar.buttons["Save"].click()
    assert path.read_text(encoding="utf-8") == TYPED
    assert said(bar) == "saved alerts.cue"
    assert title(bar) == "alerts.cue"
    assert [each.name for each in path.parent.iterdir()] == ["alerts.cue"]


def test_a_shipped_set_asks_for_a_name_and_a_name_that_is_there_for_consent(path: Path) -> None:
    bench, bar = opened("wave-shapes")
    bench.text = TYPED
    assert title(bar) == "wave-shapes (not saved to a file)"
    bar.buttons["Save"].click()
    assert bar.shown == "save"
    bar.name.value = "alerts"
    bar._safely(bar._save_as)
    assert "alerts.cue already exists and was kept" in said(bar)
    assert path.read_text(encoding="utf-8") == TEXT
    bar.overwrite.value = True
    bar._safely(bar._save_as)
    assert path.read_text(encoding="utf-8") == TYPED
    assert title(bar) == "alerts.cue"


def test_files_and_shipped_sets_are_opened_and_undo_stays_within_one(path: Path) -> None:
    bench, bar = opened(None)
    bar.buttons["Open"].click()
    assert bar.files.options[0] == "alerts.cue"
    assert "shipped: six-icons" in bar.files.options
    bar.files.value = "shipped: wave-shapes"
    assert "sine" in bar.preview.value
    bar.files.value = "alerts.cue"
    bar._safely(bar._open_selected)
    assert bench.text == TEXT
    assert bar.buttons["Undo"].disabled
    bar.path.value = "nothing.cue"
    bar._safely(bar._open_selected)
    assert "nothing.cue: no such cue file" in said(bar)
    assert bench.text == TEXT


def test_icons_are_added_copied_renamed_and_deleted_each_as_one_step(path: Path) -> None:
    bench, bar = opened(path)
    bar.verbs["New icon"].click()
    assert bench.scene.icon == "new-icon"
    bar.icon_name.value = "glow"
    bar.verbs["Rename"].click()
    bar.verbs["Duplicate"].click()
    assert bench.scene.names == ("a", "b", "glow", "glow-copy")
    assert bench.scene.icon == "glow-copy"
    bar.verbs["Delete"].click()
    assert bench.scene.names == ("a", "b", "glow")
    for _ in range(4):
        bar.buttons["Undo"].click()
    assert bench.text == TEXT
    assert bar.buttons["Undo"].disabled
    bar.icon_name.value = "b"
    bar.verbs["Rename"].click()
    assert said(bar) == "there is an icon called b already"


def test_a_rig_is_picked_by_name_and_from_a_file_and_brings_its_knobs(path: Path) -> None:
    Rig.load("fingertip").with_(**{"contact.area_cm2": 2}).save(path.with_name("mine.toml"))
    bench, bar = opened(path)
    bar.rig.value = "fingertip"
    assert bench.rig.name == "fingertip"
    assert bench.design_view is not None
    assert bench.design_view.sliders["site"].value == "fingertip"
    assert "mine.toml" in bar.rig.options
    bar.rig.value = "mine.toml"
    assert bench.rig.contact.area_m2 == pytest.approx(2e-4)
    path.with_name("mine.toml").write_text("nonsense = ", encoding="utf-8")
    bar.rig.value = "thenar"
    bar.rig.value = "mine.toml"
    assert "mine.toml" in said(bar)
    assert bench.rig.name == "thenar"


def test_unsaved_text_is_offered_when_the_file_is_opened_again(path: Path) -> None:
    first, _ = opened(path)
    first.text = TYPED
    second, bar = opened(path)
    assert second.text == TEXT
    assert bar.offer.layout.display == ""
    assert "Unsaved text of alerts.cue was typed a moment ago" in bar.offered.value
    bar._safely(bar._restore)
    assert second.text == TYPED
    assert bar.offer.layout.display == "none"
    assert "the unsaved text is in the editor" in said(bar)
    bar.buttons["Undo"].click()
    assert second.text == TEXT


def test_unsaved_text_is_dropped_only_on_request(path: Path) -> None:
    first, _ = opened(path)
    first.text = TYPED
    for _ in range(2):
        _, bar = opened(path)
        assert bar.offer.layout.display == ""
    bar._safely(bar.discard)
    assert opened(path)[1].offer.layout.display == "none"


def test_two_workbenches_on_one_file_lose_nothing(path: Path) -> None:
    first, first_bar = opened(path)
    second, second_bar = opened(path)
    first.text = TYPED
    first_bar.save()
    second.text = TEXT + "# second\n"
    assert "alerts.cue has changed on disk since it was opened here" in said(second_bar)
    second_bar.buttons["Save"].click()
    assert "has changed on disk since it was opened here" in said(second_bar)
    assert path.read_text(encoding="utf-8") == TYPED
    second_bar.buttons["Save"].click()
    assert path.read_text(encoding="utf-8") == TEXT + "# second\n"


def test_text_that_cannot_be_kept_anywhere_is_told_and_not_left(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*given: object, **named: object) -> None:
        raise OSError(28, "No space left on device")

    bench, bar = opened(path)
    monkeypatch.setattr("os.open", full)
    bench.text = TYPED
    assert "unsaved text is not kept" in said(bar)
    bar.buttons["Save"].click()
    assert "No space left on device" in said(bar)
    bar.path.value = "alerts.cue"
    bar._safely(bar._open_selected)
    assert "save it first, or undo the changes; nothing was opened" in said(bar)
    assert bench.text == TYPED


def test_a_page_opens_and_saves_only_below_its_folder(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    outside = path.parent.parent / "outside.cue"
    monkeypatch.setenv(VARIABLE, str(path.parent))
    monkeypatch.setenv(FILE, str(path))
    monkeypatch.setenv(RIG, "fingertip")
    bench, bar = opened(None)
    assert (bench.text, bench.rig.name, title(bar)) == (TEXT, "fingertip", "alerts.cue")
    bar.name.value = str(outside)
    bar._safely(bar._save_as)
    assert "is outside the folder of this page" in said(bar)
    assert not outside.exists()
    bar.path.value = "../../etc/passwd"
    bar._safely(bar._open_selected)
    assert "is outside the folder of this page" in said(bar)


@pytest.mark.slow
def test_what_is_downloaded_is_the_text_the_rig_and_pictures(path: Path) -> None:
    _, bar = opened(path)
    bar.buttons["Download"].click()
    found = dict(re.findall(r'download="([^"]+)" href="data:[a-z/+]+;base64,([^"]+)"', bar.links.value))
    assert list(found) == ["alerts.cue", "thenar.toml", "a-on-thenar.png", "a-on-thenar.svg", "a-on-thenar.pdf"]
    assert b64decode(found["alerts.cue"]).decode() == TEXT
    assert b64decode(found["a-on-thenar.png"])[1:4] == b"PNG"


def test_ctrl_s_in_the_text_saves(path: Path) -> None:
    bench, _ = opened(path)
    assert bench.design_view is not None
    canvas = bench.design_view.canvas
    canvas._receive(canvas, {"type": "text", "seq": 7, "text": TYPED}, [])
    canvas._receive(canvas, {"type": "save", "seq": 8}, [])
    assert path.read_text(encoding="utf-8") == TYPED
    assert canvas._newest is not None
    assert canvas._newest[0]["seq"] == 8


def test_what_the_page_kept_is_offered_before_what_the_kernel_wrote(path: Path) -> None:
    first, _ = opened(path)
    first.text = TYPED
    bench, bar = opened(path)
    assert bench.design_view is not None
    canvas = bench.design_view.canvas
    for text in (TYPED, TEXT):
        canvas._receive(canvas, {"type": "left", "seq": 0, "text": text}, [])
    assert [each.text for each in bench.document.versions.others] == [TYPED]
    canvas._receive(canvas, {"type": "left", "seq": 0, "text": TYPED + "# in the page\n"}, [])
    assert bar.offer.layout.display == ""
    bar._safely(bar._restore)
    assert bench.text == TYPED + "# in the page\n"
    assert bar.offer.layout.display == "none"
    assert [each.text for each in bench.document.versions.others] == [TYPED]
