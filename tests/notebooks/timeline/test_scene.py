"""The scene of a text on a rig: what is drawn and said, and what is said where nothing can be drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library, parse
from thermicon.notebooks.editing.cue_check import MOST_NAMES, mended
from thermicon.notebooks.timeline.marks import missed_spans
from thermicon.notebooks.timeline.scene import MOST_ROWS, TAIL_S, Scene, scene, with_notes
from thermicon.perception import perceive

DIP = "cue 1\nicon dip {\n  cool by 6 °C at 3 °C/s\n  hold for 4 s\n  return at 3 °C/s\n}\n"
BROKEN = DIP.replace("6 °C", "6")


@pytest.fixture(scope="module")
def rig() -> Rig:
    """The default rig."""
    return Rig.load("thenar")


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
    assert made.stale
    assert made.drawing is dip.drawing
    assert made.icon == "dip"
    assert made.names == ("dip",)
    trouble = made.troubles[0]
    assert (trouble.line, trouble.column, trouble.end_column, trouble.code) == (3, 11, 12, "E102")
    assert trouble.headline == "missing unit: this number has no unit"
    assert trouble.hint == 'a difference such as "6 °C" or "6 K"'
    assert trouble.suggestion == "cool by 6 °C at 3 °C/s"
    assert (made.badge.colour, made.badge.text) == ("grey", "safety not judged: the text has errors")
    assert repr(made) == "Scene('dip' of 1 on thenar, grey, 1 error)"
    many = scene("cue 1\nicon dip {\n" + "  cool by 6 at 3 K/s\n" * 150 + "}\n", rig)
    assert (len(many.troubles), many.notes[-1]) == (100, "and 50 more errors")


def test_a_suggestion_taken_mends_its_line_and_no_other() -> None:
    assert mended(BROKEN, 3) == DIP
    assert mended(BROKEN, 4) is None
    assert mended(DIP[6:], 1) == DIP
    assert mended("  " + BROKEN.replace("\n", "\r\n"), 3) == "  " + DIP.replace("\n", "\r\n")


@pytest.mark.parametrize(
    ("text", "headline"),
    [
        ("", "empty file: nothing but white space"),
        ("cue 1\n", "no icons: the file ends without an icon"),
        ("\0", "binary file: a zero byte is on line 1"),
        (
            "cue 1\nicon a(z in [1, 2] K) { cool by z/ }",
            'number expected: "z/" is not a number: there is no arithmetic',
        ),
    ],
)
def test_a_text_with_nothing_in_it_is_a_scene_that_says_so(text: str, headline: str, rig: Rig) -> None:
    made = scene(text, rig)
    assert made.drawing is None
    assert made.icon is None
    assert made.troubles[0].headline == headline
    assert made.troubles[0].line >= 1
    assert made.badge.colour == "grey"


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
    assert made.icon == "dip_size=1"
    assert len(made.names) == MOST_NAMES
    assert made.notes[0] == "501 icons; the first 200 are listed, Workbench(…, icon=NAME) shows any other"
    far = scene(text, rig, "dip_size=5.5")
    assert far.icon == "dip_size=5.5"
    assert far.names[-1] == "dip_size=5.5"


def test_what_is_not_reached_says_why_and_when(rig: Rig) -> None:
    made = scene("cue 1\nicon deep { cool by 9 °C at 10 °C/s; hold for 4 s; return at 1 °C/s }\n", rig)
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
    text = "cue 1\nset { control current }\nicon push { to 2 A over 1 s; hold for 1 s; return over 1 s }\n"
    made = scene(text, rig)
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
    assert made.troubles == ()
    assert made.stale
    assert made.drawing is dip.drawing
    assert made.notes[0].startswith("not drawn: rig thenar: a baseline of 20 °C on the skin cannot be held")
    assert made.badge.text.startswith("safety not judged: not drawn: rig thenar")


def test_a_target_on_the_wrong_side_of_this_rigs_rest_is_an_error_of_its_line(dip: Scene, rig: Rig) -> None:
    text = "cue 1\nicon dip {\n  cool to 31 °C over 1 s\n}\n"
    cold = rig.with_(**{"skin.rest_C": 30.5})
    assert scene(text, rig).troubles == ()
    made = scene(text, cold, before=dip)
    assert made.troubles[0].line == 3
    assert made.troubles[0].code == "E201"
    assert made.stale


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
