"""The document bar without a browser.

What a document does by itself is tested in `tests/notebooks/files/test_document.py`.
"""

from pathlib import Path

import pytest

from tests.notebooks.workbench.openbench import TEXT, TYPED, opened, said, title
from thermicon.base.files.atomic import OutputError
from thermicon.circuit import Rig, simulate
from thermicon.icons import parse
from thermicon.notebooks.files.recovery import UnsavedText
from thermicon.notebooks.workbench.document_bar import DocumentBar


def open_file(bar: DocumentBar, name: str) -> None:
    bar.path.value = name
    bar._safely(bar._open_selected)


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


def test_ctrl_s_in_the_text_saves(path: Path) -> None:
    bench, _ = opened(path)
    canvas = bench.design_view.canvas
    canvas._receive(canvas, {"type": "text", "seq": 7, "text": TYPED}, [])
    canvas._receive(canvas, {"type": "save", "seq": 8}, [])
    assert path.read_text(encoding="utf-8") == TYPED
    assert canvas._newest[0]["seq"] == 8


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


def test_a_new_set_is_right_as_it_is_and_has_a_name_of_its_own(path: Path) -> None:
    bench, bar = opened(path)
    bench.text = TYPED
    bench._design.receive({"type": "pin"})
    bar.buttons["New"].click()
    assert title(bar) == "untitled"
    assert said(bar) == "unsaved text of alerts.cue is kept: open it again to restore it"
    assert bench.set_strip._said()["sides"][0]["what"].endswith(" (alerts.cue)")
    assert [icon.name for icon in parse(bench.text)] == ["first"]
    assert simulate(parse(bench.text)["first"]).reachable
    bar.buttons["Save as"].click()
    assert bar.name.value == "untitled.cue"


def test_what_was_chosen_last_is_opened_and_the_end_of_a_long_name_is_shown(path: Path) -> None:
    (path.parent / f"warm-and-cool-pulses-of-{'many' * 5}-07.cue").write_text(TYPED, encoding="utf-8")
    _, bar = opened(path)
    bar.buttons["Open"].click()
    bar.path.value = "nowhere.cue"
    bar.files.value = next(name for name in bar.files.options if name.endswith("07.cue"))
    bar._safely(bar._open_selected)
    assert title(bar) == "warm-and-coo…ymany-07.cue"
    assert bar.title.tooltip == bar.document.name


def test_files_and_shipped_sets_are_opened_and_undo_stays_within_one(path: Path) -> None:
    (path.parent / "sub").mkdir()
    (path.parent / "sub" / "deep.cue").write_text(TYPED, encoding="utf-8")
    bench, bar = opened(None)
    bar.buttons["Open"].click()
    assert bar.files.options[0] == "alerts.cue"
    assert "shipped: six-icons" in bar.files.options
    bar.files.value = "alerts.cue"
    bar._safely(bar._open_selected)
    assert bench.text == TEXT
    assert bar.buttons["Undo"].disabled
    open_file(bar, "nothing.cue")
    assert "nothing.cue: no such cue file" in said(bar)
    assert bench.text == TEXT
    open_file(bar, "sub/deep.cue")
    bar.buttons["Save as"].click()
    assert (bench.text, bar.name.value) == (TYPED, "deep.cue")


def test_the_rig_that_is_picked_by_name_or_from_a_file_is_used_with_its_knobs(path: Path) -> None:
    mine = path.with_name("mine.toml")
    Rig.load("fingertip").with_(**{"contact.area_cm2": 2}).save(mine)
    bench, bar = opened(path)
    bar.rig.value = "fingertip"
    assert bench.rig.name == "fingertip"
    sliders = bench.design_view.sliders
    assert sliders["contact.area_cm2"].value == pytest.approx(1.5)
    bar.rig.value = "mine.toml"
    assert bench.rig.contact.area_m2 == pytest.approx(2e-4)
    bar.rig.value = "thenar"
    mine.write_text("nonsense = ", encoding="utf-8")
    for _ in range(2):
        bar.rig.value = "mine.toml"
        assert "mine.toml" in said(bar)
        assert bar.rig.value == bench.rig.name == "thenar"
        mine.unlink(missing_ok=True)
    sliders["contact.resistance_m2K_per_W"].value = 2.0
    open_file(bar, "alerts.cue")
    usual = Rig.load("thenar").contact.resistance_m2K_per_W
    assert bench.rig.contact.resistance_m2K_per_W == pytest.approx(2 * usual)


def test_unsaved_text_is_offered_until_it_is_restored_or_dropped(path: Path) -> None:
    first, _ = opened(path)
    first.text = TYPED
    for _ in range(2):
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
    first.text = TYPED + "# more\n"
    first.document.leave()
    _, bar = opened(path)
    bar._safely(bar.discard)
    assert opened(path)[1].offer.layout.display == "none", "dropped on request alone"


def test_what_the_page_kept_is_offered_before_what_the_kernel_wrote(path: Path) -> None:
    first, _ = opened(path)
    first.text = TYPED
    bench, bar = opened(path)
    canvas = bench.design_view.canvas
    for text in (TYPED, TEXT):
        canvas._receive(canvas, {"type": "left", "seq": 0, "text": text}, [])
    assert [each.text for each in bench.document.recovery.others] == [TYPED]
    canvas._receive(canvas, {"type": "left", "seq": 0, "text": TYPED + "# in the page\n"}, [])
    assert bar.offer.layout.display == ""
    bar._safely(bar._restore)
    assert bench.text == TYPED + "# in the page\n"
    assert bar.offer.layout.display == "none"
    assert [each.text for each in bench.document.recovery.others] == [TYPED]


def test_opening_another_file_leaves_unsaved_text_with_the_one_before(path: Path) -> None:
    bench, bar = opened(path)
    bench.text = TYPED
    open_file(bar, "shipped: six-icons")
    assert bench.document.recovery.others == ()
    open_file(bar, "alerts.cue")
    assert bench.text == TEXT
    assert bar.offer.layout.display == ""
    third, bar = opened(path)
    third.document.left(TEXT + "# other\n")
    bar._safely(bar._restore)
    assert third.text == TYPED
    assert TEXT + "# other\n" in [each.text for each in third.document.recovery.others]


def test_versions_that_were_kept_by_hand_are_handed_over_once_and_said(path: Path) -> None:
    opened(path)[0].document.recovery.keep(UnsavedText(TYPED, 1e9))
    bench, bar = opened(path)
    assert "versions of alerts.cue that were kept by hand are cue files now, in " in said(bar)
    (version,) = (path.parent / "alerts-versions").iterdir()
    assert version.read_text(encoding="utf-8") == TYPED
    assert [bench.text, bar.offer.layout.display] == [TEXT, "none"]
    assert said(opened(path)[1]) == ""
    opened(path)[0].document.recovery.keep(UnsavedText(TYPED + "# again\n", 1.1e9))
    bench, bar = opened(None)
    open_file(bar, str(path))
    assert "are cue files now" in said(bar)


def test_text_that_cannot_be_kept_anywhere_is_told_and_not_left(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*given: object, **named: object) -> None:
        raise OSError(28, "No space left on device")

    bench, bar = opened(path)
    monkeypatch.setattr("os.open", full)
    bench.text = TYPED
    assert "unsaved text is not kept" in said(bar)
    bar.buttons["Save"].click()
    assert "No space left on device" in said(bar)
    open_file(bar, "alerts.cue")
    assert "save it first, or undo the changes; nothing was opened" in said(bar)
    assert bench.text == TYPED


def test_only_a_refusal_that_was_read_lets_save_write_over_a_changed_file(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OutputError("the disk is full")

    bench, bar = opened(path)
    bench.text = TYPED
    with monkeypatch.context() as full:
        full.setattr("thermicon.notebooks.files.document.Document._write", refuse)
        bar.buttons["Save"].click()
    assert said(bar) == "the disk is full"
    path.write_text("cue 1 # of another window\n", encoding="utf-8")
    bench.text = TYPED + "# mine\n"
    assert "alerts.cue has changed on disk since it was opened here" in said(bar)
    bar.buttons["Save"].click()
    assert "has changed on disk since it was opened here" in said(bar)
    assert path.read_text(encoding="utf-8") == "cue 1 # of another window\n"
    bar.buttons["Save"].click()
    assert path.read_text(encoding="utf-8") == TYPED + "# mine\n"
    path.unlink()
    bench.text = TYPED
    assert said(bar).startswith("alerts.cue was removed on disk since it was opened here: Save as writes")
    bar.buttons["Save as"].click()
    bar._safely(bar._save_as)
    assert path.read_text(encoding="utf-8") == TYPED
