"""A scene as a frame: what the canvas is promised."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.notebooks.timeline.frames import MOST_POINTS, WORDS, CanvasFrame, frame_of
from thermicon.notebooks.timeline.scene import scene
from thermicon.notebooks.workbench.document_bar import help_html

GLOSSARY = Path(__file__).parents[3] / "docs" / "reference" / "glossary.md"
ROLES = {"ink", "grey", "cool", "warm", "target", "limit"}
DIP = "cue 1\nicon dip {\n  cool by 6 °C at 3 °C/s\n  hold for 4 s\n  return at 3 °C/s\n}\n"
CURRENT = "cue 1\nset { control current }\nicon push { to 2 A over 1 s; hold for 1 s; return over 1 s }\n"
DEEP = "cue 1\nicon deep { cool by 9 °C at 10 °C/s; hold for 4 s; return at 1 °C/s }\n"
LONG = "cue 1\nicon long { rest for 50 s; cool by 3 °C over 7.35 s; return over 1 s }\n"


@pytest.fixture(scope="module")
def rig() -> Rig:
    """The default rig."""
    return Rig.load("thenar")


PANEL = {"key", "label", "height", "series", "levels", "spans", "marks", "digits", "terms"}


def keep_promises(frame: CanvasFrame) -> dict[str, dict[str, Any]]:
    """Hold a frame against the contract; its panels by key."""
    meta = json.loads(json.dumps(frame.meta, allow_nan=False))
    assert meta == frame.meta
    panels = {panel["key"]: panel for panel in meta["panels"]}
    used = [series["buffer"] for panel in panels.values() for series in panel["series"]]
    assert used == list(range(len(frame.buffers)))
    for buffer in frame.buffers:
        assert buffer.dtype == np.float32
        assert buffer.flags.c_contiguous
        assert buffer.shape == (meta["time"]["n"],)
    for panel in panels.values():
        assert set(panel) == PANEL
        for part in (*panel["series"], *panel["levels"], *panel["marks"]):
            assert part["role"] in ROLES
    return panels


def test_a_frame_has_all_that_the_canvas_draws(rig: Rig) -> None:
    made = scene(DIP, rig)
    frame = frame_of(made).numbered(seq=7, ms=4.2, text=None, can_undo=True, can_redo=False)
    panels = keep_promises(frame)
    meta = frame.meta
    assert list(panels) == ["temperature", "heat", "current", "sensation"]
    assert (meta["type"], meta["view"], meta["seq"], meta["text"], meta["ms"]) == ("frame", "design", 7, None, 4.2)
    assert (meta["can_undo"], meta["can_redo"], meta["stale"]) == (True, False, False)
    assert (meta["icons"], meta["icon"], meta["troubles"]) == (["dip"], "dip", [])
    assert meta["badge"] == {
        "colour": "green",
        "text": "limits kept: in this simulation (export judges worst cases)",
        "more": [],
    }
    assert meta["time"] == {"t0": 0.0, "dt": pytest.approx(0.01), "n": 1801}
    assert [handle["t"] for handle in meta["handles"]] == [2.0, 6.0, 8.0]
    assert meta["handles"][0] == {
        "t": 2.0, "y": 26.0, "panel": "temperature", "moves_time": True, "moves_level": True, "why": None, "line": 3,
    }  # fmt: skip
    assert [level["at"] for level in panels["current"]["levels"]] == [1.5, -1.5]
    assert panels["current"]["series"][0]["step"]
    assert {mark["label"].split()[0] for mark in panels["sensation"]["marks"]} == {"onset", "felt", "physical"}
    assert panels["sensation"]["label"] == "sensation (d′) of the nominal person, receptor clock"
    (onset,) = (mark["label"] for mark in panels["sensation"]["marks"] if mark["label"].startswith("onset"))
    assert onset.endswith(" s, response clock, p 1.00")
    skin = next(series for series in panels["temperature"]["series"] if series["key"] == "skin")
    assert np.allclose(frame.buffers[skin["buffer"]], made.drawing.trace.skin_C, atol=1e-5)


def test_what_is_not_reached_is_shaded_where_it_is_missed(rig: Rig) -> None:
    panels = keep_promises(frame_of(scene(DEEP, rig)))
    for key in ("temperature", "current"):
        (span,) = panels[key]["spans"]
        assert span["label"] == "unreachable: current limit"
        assert span["from"] < span["to"]
    assert panels["heat"]["spans"] == []


def test_a_cue_of_current_is_handled_in_the_panel_of_current(rig: Rig) -> None:
    frame = frame_of(scene(CURRENT, rig))
    panels = keep_promises(frame)
    assert {handle["panel"] for handle in frame.meta["handles"]} == {"current"}
    assert "target" not in [series["key"] for series in panels["temperature"]["series"]]
    assert not panels["current"]["series"][0].get("step")


def test_a_long_run_is_thinned_on_a_uniform_clock(rig: Rig) -> None:
    made = scene(LONG, rig)
    frame = frame_of(made)
    keep_promises(frame)
    time = frame.meta["time"]
    assert MOST_POINTS / 2 < time["n"] <= MOST_POINTS
    calm = frame_of(scene("cue 1\nicon calm { rest for 20 s }\n", rig))
    assert calm.meta["time"] == {"t0": 0.0, "dt": pytest.approx(0.01), "n": MOST_POINTS + 1}, "row by row"
    assert time["t0"] + time["dt"] * (time["n"] - 1) == pytest.approx(made.drawing.trace.time_s[-1], abs=time["dt"])
    assert frame.buffers[2][100] == pytest.approx(np.interp(100 * time["dt"], made.drawing.trace.time_s,
                                                            made.drawing.trace.skin_C), abs=1e-4)  # fmt: skip


def test_a_stale_frame_keeps_its_curves_without_handles(rig: Rig) -> None:
    before = scene(DIP, rig)
    frame = frame_of(scene(DIP.replace("6 °C", "6"), rig, before=before))
    keep_promises(frame)
    assert frame.meta["stale"]
    assert frame.meta["handles"] == []
    assert len(frame.buffers) == len(frame_of(before).buffers)
    assert frame.meta["badge"]["colour"] == "grey"
    assert frame.meta["troubles"] == [
        {
            "line": 3, "column": 11, "end_column": 12, "code": "E102",
            "headline": "missing unit: this number has no unit", "hint": 'a difference such as "6 °C" or "6 K"',
            "suggestion": "cool by 6 °C at 3 °C/s",
        }
    ]  # fmt: skip


def test_nothing_to_draw_is_a_frame_as_well(rig: Rig) -> None:
    frame = frame_of(scene("", rig))
    assert keep_promises(frame) == {}
    assert frame.meta["time"]["n"] == 0
    assert frame.buffers == ()
    assert frame.meta["icon"] is None


def test_words_mean_what_the_glossary_says() -> None:
    rows = GLOSSARY.read_text(encoding="utf-8").splitlines()
    for word, meaning in WORDS["terms"].items():
        assert f"| **{word}** | {meaning} |" in rows, word


def test_the_sheet_and_the_panel_of_sensation_explain_d_prime_and_clocks(rig: Rig) -> None:
    html = help_html()
    assert "F8" in html
    assert "d′: distance in units of noise" in html
    assert f"limits of this simulation: {WORDS['simulated']['limits of this simulation']}" in html
    panel = frame_of(scene(DIP, rig)).meta["panels"][-1]
    assert {"d′", "clock"} <= {word for word, _ in panel["terms"]}
    assert panel["digits"] == 1
