"""The scene of a text on a rig."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library, parse
from thermicon.notebooks.editing.cue_check import MOST_NAMES, mended
from thermicon.notebooks.report.blocks import fragment
from thermicon.notebooks.timeline.frames import MOST_POINTS, WORDS, CanvasFrame, frame_of
from thermicon.notebooks.timeline.marks import missed_spans
from thermicon.notebooks.timeline.scene import MOST_ROWS, TAIL_S, Scene, scene, with_notes
from thermicon.perception import perceive

DIP = "cue 1\nicon dip {\n  cool by 6 °C at 3 °C/s\n  hold for 4 s\n  return at 3 °C/s\n}\n"
DEEP = "cue 1\nicon deep { cool by 9 °C at 10 °C/s; hold for 4 s; return at 1 °C/s }\n"
LONG = "cue 1\nicon long { rest for 50 s; cool by 3 °C over 7.35 s; return over 1 s }\n"
PUSH = "cue 1\nset { control current }\nicon push { to 2 A over 1 s; hold for 1 s; return over 1 s }\n"
GLOSSARY = Path(__file__).parents[3] / "docs" / "reference" / "glossary.md"
ROLES = {"ink", "grey", "cool", "warm", "target", "limit"}
BROKEN = DIP.replace("6 °C", "6")


@pytest.fixture(scope="module")
def dip(rig: Rig) -> Scene:
    """The scene of a text without errors."""
    return scene(DIP, rig)


def test_a_scene_is_what_the_circuit_and_the_observer_say(dip: Scene, rig: Rig) -> None:
    drawing = dip.drawing
    trace = simulate(parse(DIP)["dip"], rig, tail_s=TAIL_S)
    assert np.array_equal(drawing.trace.skin_C, trace.skin_C)
    assert drawing.percept.onset_s == perceive(trace).onset_s
    assert (dip.icon, dip.names, dip.count, dip.stale, dip.troubles) == ("dip", ("dip",), 1, False, ())
    assert dip.badge.colour == "green"
    assert drawing.trace.reason is None
    assert drawing.missed == ()


def test_moments_are_on_the_clocks_that_they_name(dip: Scene) -> None:
    by_kind = {moment.kind: moment for moment in dip.drawing.moments}
    percept = dip.drawing.percept
    assert by_kind["onset"].time_s == percept.onset_s
    assert by_kind["onset"].clock == "response"
    assert by_kind["felt peak"].time_s == percept.felt_peak_s("cold")
    assert by_kind["felt peak"].label.endswith("s, percept clock")
    assert by_kind["physical peak"].label.startswith("physical peak (cold) ")
    assert [moment.time_s for moment in dip.drawing.moments] == sorted(m.time_s for m in dip.drawing.moments)
    both = scene(str(load_library("six-icons")), dip.rig, "cold-to-warm").drawing
    assert [m.channel for m in both.moments if m.kind == "felt peak"] == ["cold", "warm"]


def test_errors_keep_the_last_drawing_and_are_told_where_they_are(dip: Scene, rig: Rig) -> None:
    made = scene(BROKEN, rig, before=dip)
    assert made.drawing is dip.drawing
    assert (made.stale, made.icon, made.names) == (True, "dip", ("dip",))
    assert (made.badge.colour, made.badge.text) == ("grey", "safety not judged: the text has errors")
    many = scene("cue 1\nicon dip {\n" + "  cool by 6 at 3 K/s\n" * 150 + "}\n", rig)
    assert (len(many.troubles), many.notes[-1]) == (100, "and 50 more errors")


def test_a_suggestion_taken_mends_its_line_and_no_other() -> None:
    assert mended(BROKEN, 3) == DIP
    assert mended(BROKEN, 4) is None
    many = "cue 1\nicon dip {\n" + "  cool by 6 at 3 K/s\n" * 104 + "}"
    assert mended(many, 3) == many.replace("6 at", "6 °C at", 1), "also of more than are shown"
    assert mended(DIP[6:], 1) == DIP
    assert mended("  " + BROKEN.replace("\n", "\r\n"), 3) == "  " + DIP.replace("\n", "\r\n")


@pytest.mark.parametrize(
    ("text", "headline"),
    [
        ("", "empty file: nothing but white space"),
        ("\0", "binary file: a zero byte is on line 1"),
        ("cue 1\nicon a(z in [1, 2] K) { cool by z/ }", 'number expected: "z/" is not a number'),
    ],
)
def test_a_text_with_nothing_in_it_is_a_scene_that_says_so(text: str, headline: str, rig: Rig) -> None:
    made = scene(text, rig)
    assert (made.drawing, made.icon, made.badge.colour) == (None, None, "grey")
    assert made.troubles[0].headline.startswith(headline)
    assert made.troubles[0].line >= 1


def test_an_icon_that_is_renamed_is_followed(dip: Scene, rig: Rig) -> None:
    two = DIP + DIP.removeprefix("cue 1\n").replace("dip", "rise")
    before = scene(two, rig, "rise")
    made = scene(two.replace("rise", "swell"), rig, "rise", before=before)
    assert made.icon == "swell"
    assert made.notes[0] == "rise is now called swell"
    gone = scene(DIP, rig, "rise", before=before)
    assert gone.icon == "dip"
    assert gone.notes[0] == "no icon is called rise; dip is shown"
    assert scene(two + "\n", rig, before=before).icon == "rise", "without being named again"


def test_members_of_families_can_be_chosen_and_their_list_is_short(rig: Rig) -> None:
    text = "cue 1\nicon dip(size in 1..6 step 0.01 K) { cool by size over 2 s; return over 2 s }\n"
    made = scene(text, rig)
    assert (made.icon, len(made.names)) == ("dip_size=1", MOST_NAMES)
    assert made.notes[0] == "501 icons; the first 200 are listed, Workbench(…, icon=NAME) shows any other"
    far = scene(text, rig, "dip_size=5.5")
    assert far.icon == far.names[-1] == "dip_size=5.5"


def test_what_is_not_reached_says_why_and_when(rig: Rig) -> None:
    made = scene(DEEP, rig)
    assert made.notes[0].startswith("deep is not reached: it misses its target by ")
    assert made.notes[0].endswith("limited by the current limit from 0.00 s")
    (missed,) = made.drawing.missed
    assert missed.label == "unreachable: current limit"
    assert missed.from_s < 0.1
    assert 1.0 < missed.to_s < 4.9
    inside = (made.drawing.trace.time_s > missed.from_s + 0.02) & (made.drawing.trace.time_s < missed.to_s - 0.02)
    miss = np.abs(made.drawing.trace.skin_C - made.drawing.trace.target_C)
    assert miss[inside].min() > 0.1


def test_a_step_on_its_way_is_not_missed(rig: Rig) -> None:
    made = scene("cue 1\nset { control display }\nicon s { step cool by 3 °C; hold for 4 s }\n", rig).drawing
    assert made.missed == ()
    late = scene("cue 1\nset { control display }\nicon s { step cool by 20 °C; hold for 2 s; return at 4 °C/s }", rig)
    assert late.drawing.missed[0].from_s < 0.1


def test_a_current_beyond_the_driver_is_not_played_as_written(rig: Rig) -> None:
    made = scene(PUSH, rig)
    assert made.notes[0].startswith("push is not played as written: the drive needs 2 A at 1.00 s")
    (span,) = made.drawing.missed
    assert span.from_s == pytest.approx(0.74, abs=0.03)
    assert span.label == "unreachable: driver's limits"
    assert made.drawing.start == pytest.approx(0.083, abs=1e-3)
    assert [handle.level for handle in made.drawing.handles][:2] == [2.0, 2.0]


def test_what_passes_a_limit_of_safety_says_rule_and_time(rig: Rig) -> None:
    made = scene("cue 1\nset { control display }\nicon hot { warm by 20 °C at 5 °C/s; hold for 20 s }\n", rig)
    assert made.badge.colour == "red"
    assert made.badge.text.startswith("not safe: ")
    assert " s, above the hard limit of " in made.badge.text
    assert "(thermicon, a choice of this project" in made.badge.more[0]


def test_a_baseline_that_no_current_holds_is_told_and_keeps_the_last_drawing(dip: Scene, rig: Rig) -> None:
    weak = rig.with_(**{"driver.current_limit_A": 0.2})
    made = scene("cue 1\nset { baseline 20 °C }\nicon dip { rest for 1 s }\n", weak, before=dip)
    assert (made.troubles, made.stale) == ((), True)
    assert made.drawing is dip.drawing
    assert made.notes[0].startswith("not drawn: rig thenar: a baseline of 20 °C on the skin cannot be held")
    assert made.badge.text.startswith("safety not judged: not drawn: rig thenar")


def test_a_target_on_the_wrong_side_of_this_rigs_rest_is_an_error_of_its_line(dip: Scene, rig: Rig) -> None:
    text = "cue 1\nicon dip {\n  cool to 31 °C over 1 s\n}\n"
    cold = rig.with_(**{"skin.rest_C": 30.5})
    assert scene(text, rig).troubles == ()
    made = scene(text, cold, before=dip)
    assert (made.troubles[0].line, made.troubles[0].code, made.stale) == (3, "E201", True)


def test_another_site_and_other_notes_are_told_once(rig: Rig) -> None:
    made = scene("cue 1\nset { site forearm }\nicon still { rest for 1 s }\n", rig, notes=("first", "first"))
    assert made.notes[:2] == ("first", "the set is for the site forearm, the rig thenar is for thenar")
    assert "still is not felt by the nominal person, who reports it in 0 % of trials" in made.notes
    assert with_notes(made, "refused", "first").notes[:2] == ("refused", "first")


def test_long_icons_have_fewer_rows_on_a_uniform_clock(rig: Rig) -> None:
    made = scene("cue 1\nicon long { rest for 20 min; cool by 3 °C over 7.3 s }\n", rig).drawing
    assert len(made.trace.time_s) <= MOST_ROWS + 1
    steps = np.diff(made.trace.time_s)
    assert np.allclose(steps, steps[0], rtol=1e-6)


def test_spans_are_only_those_of_an_unreached_run(rig: Rig) -> None:
    icon = parse(DIP)["dip"]
    trace = simulate(icon, rig)
    assert missed_spans(icon, trace, rig) == ()
    assert trace.outcome is not None
    unmet = replace(trace, outcome=replace(trace.outcome, reached=False), skin_C=trace.skin_C + 0.5)
    (span,) = missed_spans(icon, unmet, rig)
    assert (span.from_s, span.to_s) == (0.0, 8.0)


@pytest.mark.parametrize("name", ["search-space", "wave-shapes"])
def test_whatever_is_typed_on_the_way_is_a_scene(name: str, rig: Rig) -> None:
    text = str(load_library(name))
    made = scene(text, rig)
    for end in range(0, len(text), 13):
        made = scene(text[:end], rig, before=made)
        assert made.troubles or made.drawing
        assert made.drawing is not None


PANEL = {"key", "label", "height", "series", "levels", "spans", "marks", "digits", "terms", "folds"}


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
    said = "limits kept: in this simulation (export judges worst cases)"
    assert meta["badge"] == {"colour": "green", "text": said, "more": []}
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
    frame = frame_of(scene(PUSH, rig))
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
    assert (frame.meta["stale"], frame.meta["handles"], frame.meta["badge"]["colour"]) == (True, [], "grey")
    assert len(frame.buffers) == len(frame_of(before).buffers)
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
    assert (frame.meta["time"]["n"], frame.buffers, frame.meta["icon"]) == (0, (), None)


def test_words_mean_what_the_glossary_says() -> None:
    rows = GLOSSARY.read_text(encoding="utf-8").splitlines()
    for word, meaning in WORDS["terms"].items():
        assert f"| **{word}** | {meaning} |" in rows, word


def test_the_sheet_is_short_and_the_panel_of_sensation_explains_d_prime_and_clocks(rig: Rig) -> None:
    html = fragment("points", WORDS["sheet"])
    assert "F8" in html
    assert html.count("<li>") <= 10
    assert max(map(len, WORDS["sheet"])) <= 110, "a line of it would take two"
    panel = frame_of(scene(DIP, rig)).meta["panels"][-1]
    assert {"d′", "clock"} <= {word for word, _ in panel["terms"]}
    assert panel["digits"] == 1
