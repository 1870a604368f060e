"""An export on several elements: each element plays in one common file what its rig alone would play."""

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from tests.circuit.verdicts import GreenVerdict
from thermicon.circuit import Element, InputError, Layout, Rig, export
from thermicon.circuit.delivery import export as exporting
from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
from thermicon.circuit.delivery.export_folder import claims_of
from thermicon.circuit.delivery.pack import sealed, sidecar_text
from thermicon.circuit.delivery.verify import verify
from thermicon.circuit.delivery.ways import worst_cases
from thermicon.circuit.safety.demands import Demands
from thermicon.circuit.safety.gate import Gate
from thermicon.icons import IconSet, parse

DIP = "cool by 4 °C at 2 °C/s; return at 2 °C/s"
GLOW = "warm by 3 °C at 3 °C/s; hold for 1 s; return at 3 °C/s"
LEFT_OF_TWO = f"together {{ on left {{ {DIP} }}; on right {{ rest for 500 ms; {GLOW} }} }}"


def spatial(*bodies: str, elements: str = "left, right") -> IconSet:
    icons = "\n".join(f"icon x{place} {{ {body} }}" for place, body in enumerate(bodies))
    return parse(f"cue 1\nset {{ elements {elements}; baseline 32 °C }}\n{icons}")


def table(content: bytes) -> dict[str, list[str]]:
    rows = list(csv.reader(io.StringIO(content.decode())))
    return {name: [row[place] for row in rows[1:]] for place, name in enumerate(rows[0])}


@pytest.fixture
def green(monkeypatch: pytest.MonkeyPatch) -> list[list[object]]:
    """The gate is not asked; what it would have judged together."""
    asked: list[list[object]] = []

    def judge(deliveries: list[object], *about: object, **more: object) -> list[GreenVerdict]:
        asked.append(list(deliveries))
        return [GreenVerdict(each) for each in deliveries]

    monkeypatch.setattr(exporting, "kept_or_judged", judge)
    return asked


@pytest.mark.usefixtures("green")
@pytest.mark.parametrize(("form", "device"), [("csv", "dac-16"), ("csv", "pwm-h-bridge-10"), ("setpoint-csv", None)])
def test_each_column_is_what_the_rig_alone_plays_on_one_clock(form: str, device: str | None) -> None:
    icons = spatial(LEFT_OF_TWO, f"on left {{ {GLOW} }}")
    (icon, only), made = icons.spatial, export(icons, "wheel", device, form)
    both = table(made.files["x0.csv"])
    for element in ("left", "right"):
        track = icon.tracks[element]
        alone = export(track, "thenar", device, form, tail_s=icon.duration_s - track.corners().duration_s)
        own = table(alone.files["x0.csv"])
        assert own["time_s"] == both["time_s"]
        names = [name for name in own if name not in ("time_s", "event")]
        assert all(own[name] == both[f"{element}_{name}"] for name in names), element
    assert len(both) == 2 + 2 * len(names)
    second = table(made.files["x1.csv"])
    resting = [second[name] for name in second if name.startswith("right_")]
    assert all(len(set(column)) == 1 for column in resting)
    assert float(second["time_s"][-1]) == pytest.approx(only.duration_s, abs=0.02)


@pytest.mark.usefixtures("green")
def test_events_name_their_element_and_the_end_is_said_once() -> None:
    events = table(export(spatial(LEFT_OF_TWO), "wheel").files["x0.csv"])["event"]
    told = [event for event in events if event]
    assert told[:3] == ["rest", "left: ramp start", "right: ramp start"]
    assert told[-1].split("; ").count("end") == 1 and events[-1] == told[-1]


def test_distinct_tracks_are_judged_together_on_each_distinct_rig_once(green: list[list[object]]) -> None:
    slow = Rig.load("thenar").with_(**{"contact.area_cm2": 4})
    places = [(0.0, 0.0), (0.1, 0.0), (0.2, 0.0)]
    rigs = (Rig.load("thenar"), slow, Rig.load("thenar"))
    layout = Layout(tuple(Element(rig, name, at) for rig, name, at in zip(rigs, "abc", places, strict=True)), "three")
    body = f"together {{ on a, c {{ {DIP} }}; on b {{ {GLOW} }} }}"
    export(spatial(body, f"on a {{ {DIP} }}", elements="a, b, c"), layout)
    assert [len(each) for each in green] == [3, 3]  # cold, warm and rest, which both icons have for as long
    assert {delivery.rig for delivery in green[0]} == {rigs[0]}  # type: ignore[attr-defined]
    assert {delivery.rig for delivery in green[1]} == {slow}  # type: ignore[attr-defined]


@pytest.mark.usefixtures("green")
def test_sidecars_hold_elements_the_layout_and_one_clock_and_verify(tmp_path: Path) -> None:
    made = export(spatial(LEFT_OF_TWO), "wheel", folder=tmp_path / "out")
    files = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert files == dict(made.files) and verify(files).well
    told = json.loads(files["x0.json"])
    assert told["clock"] == "one" and [each["element"] for each in told["elements"]] == ["left", "right"]
    assert told["elements"][1]["channel"] == ["right_current_A", "right_command_V", "right_code"]
    assert told["layout"]["document"] == json.loads(Layout.load("wheel").document)
    (icon,) = spatial(LEFT_OF_TWO).spatial
    assert (told["icon"]["text"], told["icon"]["content_hash"]) == (str(icon), icon.content_hash)
    assert [each["track"]["text"] for each in told["elements"]] == [str(track) for track in icon.tracks.values()]
    claims = claims_of(files["x0.json"])
    assert claims is not None and claims.drive == "x0.csv"
    for inside in (told["elements"][1]["rig"], told["layout"]):
        inside["document"]["name"] = "other"
        forged = sidecar_text(sealed(told))
        assert [each.text.split(" than")[0] for each in verify({**files, "x0.json": forged}).findings]
    assert not verify({**files, "x0.csv": files["x0.csv"] + b"\n"}).well


@pytest.mark.usefixtures("green")
def test_an_element_has_its_own_columns_only_whatever_others_are_called() -> None:
    names = ("time", "event")
    rig = Rig.load("thenar")
    layout = Layout(tuple(Element(rig, name, (place, 0)) for place, name in enumerate(names)), "w")
    icons = spatial(f"on all {{ {DIP} }}", elements=", ".join(names))
    told = json.loads(export(icons, layout, "dac-16").files["x0.json"])
    for name, each in zip(names, told["elements"], strict=True):
        assert each["channel"] == [f"{name}_current_A", f"{name}_command_V", f"{name}_code"]


@pytest.mark.usefixtures("green")
def test_order_and_names_of_elements_change_names_and_order_of_columns_only() -> None:
    icons, rig = spatial(LEFT_OF_TWO), Rig.load("thenar")
    turned = Layout((Element(rig, "right", (1.0, 0.0)), Element(rig, "left", (0.0, 0.0))), "w")
    first, second = (table(export(icons, on).files["x0.csv"]) for on in ("wheel", turned))
    assert list(first) != list(second) and {k: v for k, v in first.items() if k != "event"} == {
        k: v for k, v in second.items() if k != "event"
    }


def test_a_set_for_elements_needs_its_layout_and_one_rate() -> None:
    with pytest.raises(InputError, match="the rig thenar is one element: give a layout that has them, such as wheel"):
        export(spatial(LEFT_OF_TWO), "thenar")
    quick = Rig.load("thenar").with_(**{"driver.update_Hz": 50})
    unlike = Layout((Element(Rig.load("thenar"), "left", (0, 0)), Element(quick, "right", (1, 0))), "w")
    with pytest.raises(InputError, match=r"on one clock, and have several \(left 100 Hz, right 50 Hz\); give all one"):
        export(spatial(f"on all {{ {DIP} }}"), unlike)


def test_a_red_track_is_refused_by_the_name_of_its_element() -> None:
    hot = "warm by 12 °C at 4 °C/s; hold for 8 s; return at 4 °C/s"
    made = export(spatial(f"together {{ on left {{ {hot} }}; on right {{ {DIP} }} }}"), "wheel")
    assert not made.files
    assert {name for name, refusal in made.refused if refusal.kind == "unsafe"} == {"x0 on left"}


@pytest.mark.usefixtures("green")
def test_zones_of_a_thermode_play_their_own_courses_and_those_that_play_alike_one() -> None:
    body = f"together {{ on s2..s4 {{ {DIP} }}; along s5, s1 every 500 ms {{ {GLOW} }} }}"
    made = export(spatial(body, elements="s1, s2, s3, s4, s5"), "tcs2-strips", None, "tcs2-serial")
    neutral, _, *profiles, zones, start = made.files["x0.tcs2.txt"].decode().split()
    assert (neutral, zones, start) == ("N320", "Ue11111", "L")
    by_mask = {line[2:7]: line[7:] for line in profiles}
    assert set(by_mask) == {"01110", "00001", "10000"}
    (icon,) = spatial(body, elements="s1, s2, s3, s4, s5").spatial
    for zone, mask in (("s1", "10000"), ("s3", "01110"), ("s5", "00001")):
        track = icon.tracks[zone]
        rig, tail_s = Layout.load("tcs2-strips").elements[0].rig, icon.duration_s - track.corners().duration_s
        alone = export(track, rig, None, "tcs2-serial", tail_s=tail_s).files["x0.tcs2.txt"].decode().split()
        assert alone[2] == f"Uw11111{by_mask[mask]}"
    told = json.loads(made.files["x0.json"])
    assert [each["channel"] for each in told["elements"]] == ["10000", "01000", "00100", "00010", "00001"]
    six = Layout(tuple(Element(Rig.load("tcs2"), name, (at, 0.0)) for at, name in enumerate("abcdef")), "six")
    with pytest.raises(InputError, match="a TCS II has 5 zones, and the layout 6 elements; give a layout of at most 5"):
        export(spatial(f"on all {{ {DIP} }}", elements="a, f"), six, None, "tcs2-serial")


@pytest.mark.usefixtures("green")
def test_waveforms_have_a_channel_or_a_file_for_each_element_and_one_player_is_refused() -> None:
    from nptdms import TdmsFile

    icons = spatial(LEFT_OF_TWO)
    group = TdmsFile.read(io.BytesIO(export(icons, "wheel", None, "tdms").files["x0.tdms"]))["thermicon"]
    both = table(export(icons, "wheel", "ni-analogue-output").files["x0.csv"])
    for element in ("left", "right"):
        name = f"{element}_command_V"
        assert group[name][:].tolist() == [float(cell) for cell in both[name]]
    made = export(icons, "wheel", None, "wav")
    assert set(made.files) == {f"x0-{element}.{end}" for element in ("left", "right") for end in ("wav", "json")}
    told = json.loads(made.files["x0-right.json"])
    assert (told["element"], told["elements"], told["clock"]) == ("right", ["left", "right"], "one")
    assert verify(made.files).well
    with pytest.raises(InputError, match=r"its player plays one element, .* use psychopy, csv, tdms, setpoint-csv or "):
        export(icons, "wheel", None, "c-array")


def test_a_verdict_is_kept_by_the_layout_and_an_exchanged_channel_has_its_demands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[str] = []

    def judge(deliveries: list[DeliveredDrive], pause_s: float | None, about: str = "") -> Sequence[Gate]:
        asked.append(about)
        return worst_cases(deliveries, pause_s)

    monkeypatch.setattr(exporting, "kept_or_judged", judge)
    made = export(spatial(LEFT_OF_TWO), "wheel")
    export(parse(f"cue 1; icon a {{ {DIP} }}"), "thenar")
    assert asked == [Layout.load("wheel").document, ""]
    demands = [replace(one.verdict.demands, faults=()) for one in made.tracks]
    assert demands[0] == demands[1] == Demands.strictest([one.verdict.demands for one in made.tracks])
