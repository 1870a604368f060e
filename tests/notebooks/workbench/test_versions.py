"""Versions A and B without a browser: what is kept, compared, swapped and dropped, and what is said of it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.notebooks import Workbench
from thermicon.notebooks.workbench.versions_model import both_frame, changed_lines
from thermicon.notebooks.workbench.versions_view import VersionsView

TEXT = (
    "cue 1\n"
    "icon near { warm by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }\n"
    "icon nearer { warm by 3.6 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }\n"
)
EDITED = TEXT.replace("warm by 3.6", "cool by 4")


@pytest.fixture(autouse=True)
def few_people(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    """Numbers are not what is tested here, so a few people do."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("thermicon.notebooks.workbench.versions_model.PEOPLE", 6)
    monkeypatch.setattr("thermicon.notebooks.workbench.versions_model.DRAWS", 2)
    yield


def opened(text: str = TEXT) -> tuple[Workbench, VersionsView]:
    bench = Workbench(text)
    assert bench.page is not None
    view = bench.versions_view
    assert view is not None
    bench.tabs.selected_index = 3
    assert view.shown
    return bench, view


def said(view: VersionsView, name: str) -> str:
    return re.sub(r"\s+", " ", unescape(re.sub(r"<[^>]*>", " ", str(view.said[name].value)))).strip()


def test_a_version_is_kept_and_the_edited_one_is_compared_with_it() -> None:
    bench, view = opened()
    assert view.swap.disabled
    assert "Keep the set as it is now" in said(view, "about")
    view.keep.click()
    bench.text = EDITED
    assert view.worker.wait()
    results = said(view, "results")
    assert re.search(
        r"correct \d+ % \d+ % \+\d+ points \(middle 95 % of people: [+−]?\d+ to \+\d+ points\)", results
    ), results
    assert "confused most near and nearer near and nearer" in results
    assert "limits of this simulation kept kept" in results
    assert "same 6 people" in said(view, "status")
    changes = said(view, "changes")
    assert "A icon nearer { warm by 3.6" in changes
    assert "B icon nearer { cool by 4" in changes
    assert view.curves._newest is not None
    panels = view.curves._newest[0]["panels"]
    assert panels[0]["label"] == "nearer: skin (°C)"
    assert [panel["key"] for panel in panels] == ["skin", "gap", "current", "cold", "warm"]
    assert [series["label"] for series in panels[0]["series"]] == ["A", "B"]


def test_the_difference_of_the_skin_is_that_of_the_curves() -> None:
    bench, view = opened()
    view.keep.click()
    bench.text = TEXT.replace("4 °C at 2", "5 °C at 2")
    assert view.kept is not None
    frame = both_frame(view.kept, view.now)
    buffers = {panel["key"]: [frame.buffers[s["buffer"]] for s in panel["series"]] for panel in frame.meta["panels"]}
    a, b = buffers["skin"]
    assert np.nanmax(b) - np.nanmax(a) == pytest.approx(1.0, abs=0.02)
    assert np.allclose(buffers["gap"][0], b - a, equal_nan=True)


def test_swapping_brings_text_icon_rig_and_knobs_back_and_can_be_undone() -> None:
    bench, view = opened()
    view.keep.click()
    assert bench.design_view is not None
    assert bench.bar is not None
    bench.text = EDITED
    bench.design_view.take_rig(Rig.load("fingertip"))
    bench.design_view._turned("contact", 2.0)
    view.swap.click()
    assert bench.text == TEXT
    assert bench.rig.name == "thenar"
    assert bench.rig.changes == ()
    assert bench.bar.rig.value == "thenar"
    assert view.kept is not None
    assert view.kept.text == EDITED
    assert view.kept.rig.name == "fingertip"
    assert "rig fingertip, contact" in said(view, "changes") or view.worker.wait()
    bench.design_view.step("undo")
    assert bench.text == EDITED
    view.swap.click()
    assert bench.rig.name == "fingertip"
    assert bench.design_view.sliders["contact"].value == 2.0
    assert view.worker.wait()


def test_a_version_with_errors_or_without_the_icon_is_said_and_the_other_is_shown() -> None:
    bench, view = opened()
    view.keep.click()
    bench.text = TEXT.replace("warm by 4 °C", "warm by 4")
    assert view.worker.wait()
    assert "B is not ranked: the text has errors: line 2" in said(view, "results")
    assert view.curves._newest is not None
    assert "B is not drawn" in view.curves._newest[0]["notes"][0]
    bench.text = TEXT.replace("icon near ", "icon other ")
    assert view.worker.wait()
    assert "only in B" in said(view, "results")
    assert view.curves._newest[0]["notes"] == ["A has no icon other"]


def test_a_goal_is_judged_of_both_and_dropping_a_clears_the_view() -> None:
    bench, view = opened()
    view.keep.click()
    assert bench.set_view is not None
    bench.set_view.goal.text.value = "time <= 10 s"
    bench.text = TEXT.replace("hold for 2 s; return at 2 °C/s }\nicon nearer", "return at 2 °C/s }\nicon nearer")
    view.renew(0.0)
    assert view.worker.wait()
    results = said(view, "results")
    assert "goal all of it not met met" in results
    assert re.search(r"time <= 10 s ✗ [\d.]+ s, [\d.]+ s over ✓ [\d.]+ s, [\d.]+ s to spare", results), results
    view.discard.click()
    assert view.kept is None
    assert view.body.layout.display == "none"
    assert said(view, "about").startswith("Keep the set")


def test_nothing_changed_is_said(tmp_path: Path) -> None:
    _, view = opened()
    view.keep.click()
    assert view.worker.wait()
    assert said(view, "changes") == "A and B are the same"
    assert changed_lines(view.now, view.now) == []
