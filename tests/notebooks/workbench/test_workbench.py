"""The workbench without a browser."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.builders import missing
from tests.notebooks.workbench.openbench import SAID
from thermicon.circuit import Rig
from thermicon.circuit.rig.rigfile import RigError
from thermicon.icons import CueErrors, load_library, parse
from thermicon.notebooks import Workbench
from thermicon.notebooks.files.document import Document
from thermicon.notebooks.workbench.design_model import DesignModel
from thermicon.notebooks.workbench.document_bar import document_of
from thermicon.notebooks.workbench.knobs import knobs_of, turned

DIP = """cue 1

# kept as it is
icon dip {
  cool by 4 °C at 2 °C/s  # deep
  hold for 2 s
  return at 2 °C/s
}

icon glow {
  warm by 3 °C at 2 °C/s
  hold for 2 s
  return at 2 °C/s
}
"""
CONTACT, AREA = "contact.resistance_m2K_per_W", "contact.area_cm2"
REST, LIMIT = "skin.rest_C", "driver.current_limit_A"
MOST_MS = 30.0
"""CPU time of a frame in the kernel, whatever else the machine does."""
Send = Callable[..., dict[str, Any]]


@pytest.fixture
def bench() -> Workbench:
    """A workbench with its widgets, on two icons."""
    made = Workbench(DIP)
    assert made.page is not None
    return made


@pytest.fixture
def send(bench: Workbench) -> Send:
    """``send(type="undo")`` is a message of the page; the answer is what the canvas was told to draw."""
    seq = [100]

    def message(**content: Any) -> dict[str, Any]:
        seq[0] += 1
        canvas = bench.design_view.canvas
        canvas._receive(canvas, {"seq": seq[0], **content}, [])
        meta = canvas._newest[0]
        assert meta["seq"] == seq[0]
        return dict(meta)

    return message


def test_what_is_typed_is_drawn_and_keeps_its_text(bench: Workbench, send: Send) -> None:
    answer = send(type="text", text=DIP.replace("4 °C", "5 °C"))
    assert answer["text"] is None
    assert (answer["of"], answer["stale"]) == (bench.text, False)
    assert answer["handles"][0]["y"] == 27.0
    assert bench.icon is not None
    assert bench.trace.skin_C.min() < 28.5
    assert bench.percept.channel == "cold"
    assert send(type="hello")["text"] == bench.text, "a page that is opened later"


def test_an_error_is_named_under_its_line_and_the_drawing_stays(bench: Workbench, send: Send) -> None:
    answer = send(type="text", text=DIP.replace("by 4 °C", "by 4"))
    assert answer["stale"]
    assert [(each["line"], each["code"]) for each in answer["troubles"]] == [(5, "E102")]
    assert len(answer["panels"]) == 4
    assert answer["badge"]["colour"] == "grey"
    with pytest.raises(CueErrors, match="missing unit"):
        _ = bench.icons
    mended = send(type="apply", line=5)
    assert mended["text"] == DIP
    assert mended["troubles"] == []


@pytest.mark.parametrize("act", ["text", "knob"])
def test_what_could_not_be_computed_is_not_judged_and_the_frame_names_the_text_that_it_is_of(
    bench: Workbench, send: Send, monkeypatch: pytest.MonkeyPatch, act: str
) -> None:
    def fail(*given: Any) -> None:
        raise ArithmeticError("of an unknown kind")

    with monkeypatch.context() as broken:
        broken.setattr("thermicon.notebooks.workbench.design_model.scene", fail)
        if act == "text":
            answer = send(type="text", text=DIP.replace("4 °C", "5 °C"))
        else:
            bench.design_view.sliders["contact.area_cm2"].value = 1.5
            answer = bench.design_view.canvas._newest[0]
    assert "of an unknown kind" in answer["badge"]["text"]
    assert (answer["of"], answer["badge"]["colour"]) == (DIP, "grey")
    assert send(type="hello")["badge"]["colour"] == "grey", "until something is computed"
    assert send(type="text", text=DIP)["badge"]["colour"] == "green"


def test_a_drag_is_one_step_and_undo_and_redo_carry_the_text(bench: Workbench, send: Send) -> None:
    for step in range(1, 6):
        answer = send(type="drag", handle=0, t=2.0, y=28.0 - 0.2 * step, end=step == 5)
        assert answer["text"] is not None
    assert "cool by 5 °C at 2.5 °C/s  # deep" in bench.text
    assert answer["can_undo"]
    undone = send(type="undo")
    assert undone["text"] == DIP
    assert not undone["can_undo"]
    assert "cool by 5 °C" in send(type="redo")["text"]
    assert "nothing to redo" in send(type="redo")["notes"][0]
    bench.text = DIP.replace("dip", "sip")
    assert bench.icon.name == "sip"
    assert "cool by 5 °C" in send(type="undo")["text"]


def test_a_drag_that_cannot_be_says_why_and_leaves_the_text(bench: Workbench, send: Send) -> None:
    answer = send(type="drag", handle=1, t=0.1, y=28.0, end=True)
    assert answer["text"] == DIP
    assert "cannot come before 2 s" in answer["notes"][0]
    assert "none to move" in send(type="drag", handle=9, t=1.0, y=30.0, end=True)["notes"][0]


def test_a_drag_that_was_cut_off_does_not_bring_the_text_of_another_file_back() -> None:
    model = DesignModel(DIP, Rig.load("thenar"))
    model.receive({"type": "drag", "handle": 0, "t": 2.0, "y": 28.0})
    model.open(Document(DIP.replace("# deep", "# of another file")))
    model.receive({"type": "drag", "handle": 0, "t": 2.0, "y": 28.0, "end": True})
    assert "# of another file" in model.text


def test_another_icon_is_shown_and_an_unknown_one_is_said(bench: Workbench, send: Send) -> None:
    assert send(type="icon", name="glow")["icon"] == "glow"
    assert bench.icon.name == "glow"
    assert "no icon is called gone" in send(type="icon", name="gone")["notes"][0]


@pytest.mark.parametrize(
    "message",
    [{"type": "nonsense"}, {"type": "drag"}, {"type": "drag", "handle": "x"}, {"type": "text", "text": None}, {}],
)
def test_a_message_that_makes_no_sense_is_a_note_and_the_page_goes_on(send: Send, message: dict[str, Any]) -> None:
    assert "the action failed" in send(**message)["notes"][0]
    assert send(type="text", text=DIP)["troubles"] == []


def test_an_impossible_value_is_told_and_reset_brings_all_back(bench: Workbench, send: Send) -> None:
    for key, value in ((REST, 30.0), (LIMIT, 0.1)):
        bench.design_view.sliders[key].value = value
    assert bench.design_view.canvas._newest[0]["notes"]
    assert send(type="text", text=DIP.replace("4 °C", "3 °C"))["icon"] == "dip"
    bench.design_view.reset.click()
    assert bench.rig.driver.current_max_A == 1.5
    assert bench.design_view.sliders["skin.rest_C"].value == 32.0
    assert bench.scene.notes == ()


def test_nothing_in_the_kernel_takes_long_for_a_frame_of_text_or_slider() -> None:
    design = DesignModel(document_of(None).text, Rig.load("thenar"))
    spent: dict[str, list[float]] = {"text": [], "slider": []}
    for step in range(40):
        text = design.text.replace("cool by 6 °C at 1", f"cool by {5 + step / 60:.3f} °C at 1")
        for name, act in (
            ("text", lambda text=text: design.receive({"type": "text", "text": text})),
            ("slider", lambda step=step: design.turn({"contact.resistance_m2K_per_W": 1.0 + 0.05 * step})),
        ):
            began = time.process_time()
            act()
            spent[name].append(1e3 * (time.process_time() - began))
    assert design.rig.contact.resistance_m2K_per_W == pytest.approx(
        2.95 * Rig.load("thenar").contact.resistance_m2K_per_W
    )
    assert max(sorted(each)[len(each) // 2] for each in spent.values()) < MOST_MS


@pytest.mark.slow
@pytest.mark.parametrize("view", ["design", "set", "export"])
def test_every_view_is_a_figure(bench: Workbench, view: Any) -> None:
    figure = bench.figure(view)
    assert len(figure.axes) >= 2


def test_figures_of_what_cannot_be_say_why() -> None:
    wrong, late = Workbench("cue 1; icon dip { cool by 4 at 2 K/s }"), Workbench(DIP)
    late.text = wrong.text
    assert "missing unit" in wrong.figure().get_suptitle()
    for bench, view in ((wrong, "set"), (wrong, "export"), (late, "export")):
        with pytest.raises(CueErrors, match="missing unit"):
            bench.figure(view)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="there is no view 'sets'; there are design, set, export"):
        wrong.figure("sets")  # type: ignore[arg-type]


def test_what_a_workbench_can_be_made_of(tmp_path: Path) -> None:
    path = tmp_path / "own.cue"
    path.write_text(DIP, encoding="utf-8")
    icons = parse(DIP)
    assert Workbench(path).text == Workbench(str(path)).text == DIP
    assert Workbench(icons).icons == icons
    assert Workbench(icons["glow"]).icon == icons["glow"]
    assert Workbench("wave-shapes").icons == load_library("wave-shapes")
    assert Workbench(None, Rig.load("fingertip"), icon="double-dip").scene.icon == "double-dip"
    assert "# Known" in Workbench().text
    path.write_bytes(DIP.encode("utf-16"))
    for given, error, words in (
        ({"text": "six-icon"}, CueErrors, "no such"),
        ({"rig": "thenr"}, RigError, "thenar"),
        ({"text": "six-icons", "icon": "cooling-stap"}, ValueError, "'cooling-stap'; did you mean cooling-step"),
        ({"text": path}, ValueError, r"own\.cue: it is not UTF-8 text; convert it first"),
    ):
        with pytest.raises(error, match=words):
            Workbench(**given)


def test_without_a_kernel_it_is_text_and_a_picture(bench: Workbench) -> None:
    shown = bench._repr_mimebundle_()
    assert shown["text/plain"] == repr(bench) == "Workbench('dip' of 2 on thenar, green)"
    assert shown["image/png"][1:4] == b"PNG"


def test_every_knob_says_what_it_changes_and_where_its_range_is_from(rig: Rig) -> None:
    for knob in knobs_of(rig):
        assert knob.what
        assert knob.source
        assert knob.low <= knob.value <= knob.high
        assert knob.step > 0
    odd = rig.with_(**{AREA: 40, LIMIT: 15, REST: 28})
    by_key = {knob.key: knob for knob in knobs_of(odd)}
    assert (by_key[AREA].high, by_key[LIMIT].high, by_key[REST].low) == (40, 15, 28)


def test_each_knob_changes_its_own_part(rig: Rig) -> None:
    made, notes = turned(rig, {CONTACT: 2, AREA: 4, REST: 34, LIMIT: 1})
    assert made.contact.resistance_m2K_per_W == pytest.approx(2 * rig.contact.resistance_m2K_per_W)
    assert made.contact.area_m2 == pytest.approx(4e-4)
    assert made.skin.rest_C == 34
    assert (made.driver.current_min_A, made.driver.current_max_A) == (-1, 1)
    assert made.skin.layers == rig.skin.layers
    assert notes == ()


@pytest.mark.parametrize(("turn", "words"), SAID["knobs"].items())
def test_an_impossible_value_leaves_the_rig_as_it_was_and_says_so(turn: str, words: list[str], rig: Rig) -> None:
    key, value = turn.split(" = ")
    made, (note,) = turned(rig, {key: float(value)})
    assert made == rig
    assert missing(words, note) == []


def test_of_several_values_only_the_impossible_one_is_left_out(rig: Rig) -> None:
    made, notes = turned(rig, {REST: 34.0, LIMIT: 0.01, CONTACT: 2.0})
    assert made.skin.rest_C == 34.0
    assert made.contact.resistance_m2K_per_W == pytest.approx(1.08e-3)
    assert made.driver.current_max_A == 1.5
    assert len(notes) == 1


def test_an_unusual_value_is_told(rig: Rig) -> None:
    made, notes = turned(rig, {REST: 28.0})
    assert made.skin.rest_C == 28.0
    assert notes == ("rest temperature of 28 °C is outside the usual 30–36 °C",)
