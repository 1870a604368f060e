"""What the page is given to play, and a version pinned beside the present one, without a browser."""

from collections.abc import Callable
from pathlib import Path
from threading import Event, Thread
from typing import Any

import numpy
import pytest

from tests.notebooks.workbench.openbench import wait
from thermicon.circuit import Rig, simulate
from thermicon.icons import parse
from thermicon.notebooks import Workbench
from thermicon.notebooks.files.document import Document
from thermicon.notebooks.timeline.frames import WORDS
from thermicon.notebooks.workbench import design_model
from thermicon.notebooks.workbench.design_model import DesignModel
from thermicon.notebooks.workbench.knobs import turned
from thermicon.notebooks.workbench.reel import reel_of, shipped_texts
from thermicon.notebooks.workbench.set_strip import SetStrip

TWO = """cue 1; icon near { warm by 4 °C at 2 °C/s; hold for 2 s; return at 2 °C/s }
icon faint { warm by 0.1 °C at 0.1 °C/s; return at 0.1 °C/s }
"""


@pytest.fixture
def design() -> DesignModel:
    return DesignModel(TWO, Rig.load("thenar"))


def test_a_preview_lasts_as_long_as_the_icon_and_what_is_felt_of_it(design: DesignModel) -> None:
    near, faint = (frame.meta["play"] for frame in reel_of(design)[0])
    percept = design.scene.drawing.percept
    assert (near["onset"], near["quality"]) == (percept.onset_s, "warm")
    assert near["until"] > 6.0, "warmth goes on after the icon"
    assert numpy.interp(near["until"] + 0.1, percept.time_s, percept.psi_warm) < 1.0
    assert (faint["felt"], faint["until"]) == (False, pytest.approx(2.0))
    assert faint["share"] < 0.5
    design.receive({"type": "text", "text": "cue 1; icon a { hold for 1 }"})
    assert reel_of(design) == ([], "not played: the text has errors")


def test_sides_change_with_text_icon_rig_and_knobs_and_change_back(design: DesignModel) -> None:
    assert "nothing is pinned" in design.receive({"type": "swap"}).meta["notes"][0]
    design.turn({"contact.area_cm2": 4.0})
    pinned = design.receive({"type": "pin"})
    curves = {panel["key"]: [each["key"] for each in panel["pinned"]] for panel in pinned.meta["panels"]}
    assert curves == {"temperature": ["skin"], "heat": ["skin"], "current": ["current"], "sensation": ["cold", "warm"]}
    behind = pinned.meta["panels"][0]["pinned"][0]["buffer"]
    design.take_rig(Rig.load("fingertip"))
    now = design.receive({"type": "text", "text": TWO.replace("icon near", "icon nigh").replace("by 4", "by 3")})
    assert numpy.array_equal(now.buffers[behind], pinned.buffers[behind])
    design.receive({"type": "swap"})
    assert (design.text, design.rig.name, design.scene.icon) == (TWO, "thenar", "near")
    assert design.values == {"contact.area_cm2": 4.0}
    design.receive({"type": "swap"})
    assert (design.rig.name, design.scene.icon, design.values) == ("fingertip", "nigh", {})
    assert design.receive({"type": "undo"}).meta["text"] == TWO
    assert "pinned" not in design.receive({"type": "unpin"}).meta


@pytest.mark.parametrize(
    "act",
    [
        lambda bench: setattr(bench.bar.rig, "value", "fingertip"),
        lambda bench: setattr(bench.design_view.sliders["contact.area_cm2"], "value", 4.0),
        lambda bench: setattr(bench, "text", TWO.replace("by 4", "by 3")),
    ],
    ids=["rig", "slider", "cell"],
)
def test_what_is_pinned_in_another_thread_is_never_half_of_a_change(
    act: Callable[[Any], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    bench: Any = Workbench(TWO, "thenar")
    assert bench.page is not None
    drawing, go_on, scene = Event(), Event(), design_model.scene

    def held(*given: Any) -> Any:
        drawing.set()
        assert go_on.wait(30.0)
        return scene(*given)

    monkeypatch.setattr(design_model, "scene", held)
    pin = bench.design_view.canvas._receive
    threads = [Thread(target=act, args=(bench,)), Thread(target=pin, args=(None, {"type": "pin"}, ()))]
    threads[0].start()
    assert drawing.wait(30.0)
    threads[1].start()
    threads[1].join(0.3)
    go_on.set()
    for thread in threads:
        thread.join(30.0)
    pinned = bench._design.pinned
    assert pinned.scene.text == pinned.document.text
    assert pinned.scene.rig == turned(pinned.nominal, pinned.values)[0]


def test_stop_on_the_time_line_waits_for_no_other_action() -> None:
    bench: Any = Workbench(TWO, "thenar")
    assert bench.page is not None
    bench.live.on = True
    stop = Thread(target=bench.design_view.canvas._receive, args=(None, {"type": "stop device"}, ()))
    with design_model.ONE_AT_A_TIME:
        stop.start()
        stop.join(10.0)
    assert "Stop on the time line" in bench.live.said["status"].value


def test_a_page_that_asks_again_after_silence_changes_sides_once(design: DesignModel) -> None:
    design.receive({"type": "pin"})
    design.receive({"type": "text", "text": TWO.replace("by 4", "by 3")})
    for once, shown in (
        (1, TWO),
        (1, TWO),
        (2, TWO.replace("by 4", "by 3")),
        (2, TWO.replace("by 4", "by 3")),
        (3, TWO),
    ):
        assert design.receive({"type": "swap", "once": once}).meta["text"] == shown
        assert design.text == shown


def test_a_version_of_another_file_comes_back_with_its_file_and_no_file_gets_the_text_of_another(
    tmp_path: Path, design: DesignModel
) -> None:
    files = {"mine.cue": TWO, "twelve.cue": TWO.replace("near", "far")}
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    mine, twelve = (Document.open(tmp_path / name) for name in files)
    design.open(mine)
    design.receive({"type": "pin"})
    design.receive({"type": "text", "text": TWO.replace("by 4", "by 3")})
    design.open(twelve)
    for document, text in ((mine, TWO), (twelve, files["twelve.cue"]), (mine, TWO)):
        design.receive({"type": "swap"})
        assert (design.document, design.text) == (document, text)
        assert not document.dirty
    design.document.save()
    assert {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()} == files


def test_both_sides_are_ranked_even_where_one_was_changed_at_once(
    design: DesignModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in (("QUICK", (4, 0)), ("WELL", (24, 2))):
        monkeypatch.setattr(f"thermicon.notebooks.workbench.set_strip.{name}", value)
    sent: list[dict[str, Any]] = []
    strip = SetStrip(design, sent.append)
    design.on_change(strip.renew)
    strip.shown = True
    design.receive({"type": "pin"})
    design.receive({"type": "text", "text": TWO.replace("by 0.1", "by 3")})
    assert [row["set"] for row in sent[-1]["sides"]] == ["–", "–"]
    wait(strip.worker)
    pinned, now = sent[-1]["sides"]
    assert (pinned["side"], pinned["what"], now["side"]) == ("pinned", "near, thenar", "now")
    assert float(pinned["set"].strip("≈ %")) < float(now["set"].strip("≈ %"))
    assert now["worst"].startswith(("faint and near", "near and faint"))
    design.receive({"type": "unpin"})
    assert sent[-1]["sides"] == []


def test_all_that_the_palette_offers_is_cue_text_and_its_shapes_are_reached() -> None:
    offered = [text for texts in shipped_texts().values() for text in texts.values()]
    assert len(offered) > 30
    for text in offered:
        assert len(parse(f"cue 1\nset {{ control display; baseline 32 °C }}\n{text}")) >= 1
    for shape in WORDS["shapes"].values():
        assert simulate(parse(f"cue 1; icon a {{ {shape.replace(chr(10), '; ')} }}").icons[0], "thenar").reachable
