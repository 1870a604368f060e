"""A layout of one element is its rig; one of several is refused with a cure."""

import math
import re
import tomllib
from functools import partial
from pathlib import Path

import pytest

from tests.builders import messages
from thermicon.circuit import Drive, Element, InputError, Layout, Rig, export, gate, simulate
from thermicon.circuit.rig.layout import layout_names
from thermicon.circuit.rig.rig import rig_names
from thermicon.icons import Icon, load_library
from thermicon.icons.files.shipped import names_on_one_element
from thermicon.perception import rank

SETS = [(name, rig) for name in names_on_one_element() for rig in rig_names()]
THENAR = Rig.load("thenar")
TWO = Layout((Element(THENAR, "left"), Element(THENAR, "right")))
STEP = load_library("six-icons")["cooling-step"]
OWN = """
format = 1
name = "mine"
surfaces = "one"
[[element]]
name = "left"
rig = "thenar"
place_mm = [0, 0]
[[element]]
name = "right"
like = "left"
place_mm = [50, 0]
"""


def outcome(icon: Icon, rig: Rig | Layout | str | None) -> bytes | str:
    """Every number of a trace, or the refusal."""
    try:
        return simulate(icon, rig, rate_Hz=10.0).to_frame().to_numpy(dtype=float).tobytes()
    except ValueError as refusal:
        return str(refusal)


@pytest.mark.parametrize(("name", "on"), SETS)
def test_a_trace_on_a_layout_of_one_is_that_of_the_rig_byte_for_byte(name: str, on: str) -> None:
    icon, rig = load_library(name).icons[0], Rig.load(on)
    assert outcome(icon, Layout((Element(rig),))) == outcome(icon, rig) == outcome(icon, on)


def test_a_layout_of_one_is_ranked_and_exported_as_its_rig() -> None:
    one, some = Layout((Element(THENAR, "palm"),)), tuple(load_library("six-icons"))[:2]
    ranked = [rank(some, on, people=3, parameters=3, seed=5).to_json() for on in (THENAR, one)]
    assert ranked[0] == ranked[1]
    files = [export([STEP], on, "dac-16").files for on in (THENAR, one)]
    assert files[0] == files[1]
    assert set(files[0]) == {"cooling-step.csv", "cooling-step.json"}


def test_without_a_rig_a_layout_has_that_of_the_site() -> None:
    for site in ("fingertip", "cheek", None):
        assert Layout.of(None, site).alone is Rig.of(None, site)


def test_several_elements_are_refused_by_their_names_with_a_cure() -> None:
    still = Drive([0.0, 1.0], [0.0, 0.0])
    for take in (partial(simulate, STEP), partial(rank, [STEP]), partial(export, STEP), partial(gate, still)):
        with pytest.raises(
            InputError, match=r"several elements \(left, right\).*; give the rig of one, such as thenar$"
        ):
            take(TWO)


def test_a_layout_file_is_refused_where_a_rig_is_needed_in_one_sentence(tmp_path: Path) -> None:
    path = file_of(tmp_path, OWN)
    for take in (Rig.of, Rig.load, partial(simulate, STEP), partial(export, STEP), partial(rank, [STEP])):
        for source in (path, "wheel"):
            with pytest.raises(
                InputError, match=r"a layout of several elements.* give the rig of one, such as thenar$"
            ) as told:
                take(source)
            assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("elements", "told"),
    [
        ((), "at least one element"),
        ((Element(THENAR), Element(THENAR, "left")), "each needs a name"),
        ((Element(THENAR, "left"), Element(THENAR, "left")), "two elements are called left"),
    ],
)
def test_elements_that_cannot_be_told_from_each_other(elements: tuple[Element, ...], told: str) -> None:
    with pytest.raises(InputError, match=told):
        Layout(elements)
    with pytest.raises(InputError, match="element: "):
        Element(THENAR, "my left")


def file_of(folder: Path, text: str) -> Path:
    (path := folder / "mine.toml").write_text(text)
    return path


@pytest.mark.parametrize("name", layout_names())
def test_a_shipped_layout_is_read_and_each_of_its_numbers_has_a_source(name: str) -> None:
    layout = Layout.load(name)
    assert layout.name == name
    document = tomllib.loads((Path(__file__).parents[3] / "circuit" / "layouts" / f"{name}.toml").read_text("utf-8"))
    told = set(document["source"])
    for element in document["element"]:
        assert {key for key in element if key.endswith("_mm")} | set(element.get("set", {})) <= told
    assert {key for key in ("around_mm", "supply", "surfaces") if key in document} <= told
    assert not document.get("sink") or "sink.resistance_K_per_W" in told


def test_an_element_that_is_like_another_has_all_of_it_but_name_and_place() -> None:
    ring = Layout.load("ring-four")
    assert {element.rig.contact.area_m2 for element in ring.elements} == {0.6e-4}
    assert {(element.sink, element.gap_m) for element in ring.elements} == {("body", 5.4e-3)}
    assert ring.sinks[0].resistance_K_per_W == 8
    places = [complex(*element.place_m) for element in ring.elements if element.place_m]
    assert [abs(place) * math.tau for place in places] == pytest.approx([0.057] * 4)
    assert abs(places[0] + places[2]) == pytest.approx(0, abs=1e-12), "opposite elements have the centre between them"


def test_a_rig_may_be_a_file_beside_the_layout(tmp_path: Path) -> None:
    THENAR.with_(**{"contact.area_cm2": 5}).save(tmp_path / "small.toml", "small")
    layout = Layout.of(file_of(tmp_path, OWN.replace('"thenar"', '"small.toml"') + 'set = { "contact.area_cm2" = 3 }'))
    assert [element.rig.contact.area_m2 * 1e4 for element in layout.elements] == pytest.approx([5, 3])
    assert [element.rig.name for element in layout.elements] == ["small", "small"]


@pytest.mark.parametrize(("change", "told"), messages(__file__, "layouts.toml")["wrong"].items())
def test_a_wrong_layout_file_is_refused_with_place_and_cure(change: str, told: str, tmp_path: Path) -> None:
    """A change is a text and what stands in its place, or is added behind it."""
    before, _, after = change.partition(" → ")
    assert before in OWN
    path = file_of(tmp_path, OWN.replace(before, after, 1))
    with pytest.raises(InputError, match=told) as refusal:
        Layout.load(path)
    assert all(line.startswith(f"{path}: ") for line in str(refusal.value).splitlines())


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("gap_mm = 1.9", "left, right: with 1.9 mm of bare skin .* nearest millimetre by 0.012 K"),
        ("gap_mm = 0", "left, right: with 0 mm .* by 0.022 K .* nearest millimetre by 0.14 K"),
        ("gap_mm = 0.05", r"left: gap_mm = 0.05 mm: usual are 0.1 to 500 mm; 0.05 looks like m, 50 mm"),
        ("gap_mm = 0.0054", "0.0054 looks like m, 5.4 mm"),
        ("[supply]\ncurrent_limit_A = 900\npower_limit_W = 40", "900 looks like mA, 0.9 A"),
        ("gap_mm = 2.1\n[supply]\ncurrent_limit_A = 99\npower_limit_W = 1999", None),
    ],
)
def test_numbers_of_a_layout_that_are_not_usual_are_told(tmp_path: Path, change: str, told: str | None) -> None:
    where = 'rig = "thenar"\nplace_mm = [0, 0]'
    text = OWN.replace(where, f"{where}\n{change}") if "gap" in change else OWN + change
    warnings = Layout.load(file_of(tmp_path, text)).warnings
    assert any(re.search(told, each) for each in warnings) if told else not warnings


def test_an_unusual_gap_is_told_at_its_element(tmp_path: Path) -> None:
    text = OWN.replace("place_mm = [50, 0]", "place_mm = [50, 0]\ngap_mm = 0.05")
    assert any("right: gap_mm = 0.05 mm" in each for each in Layout.load(file_of(tmp_path, text)).warnings)


@pytest.mark.parametrize(("at_mm", "told"), [(99, True), (101, False)])
def test_elements_that_are_said_to_be_apart_but_near_are_told(tmp_path: Path, at_mm: int, told: bool) -> None:
    text = OWN.replace('surfaces = "one"', 'surfaces = "apart"').replace("[50, 0]", f"[{at_mm}, 0]")
    warnings = Layout.load(file_of(tmp_path, text)).warnings
    assert [f"left and right are {at_mm} mm apart" in each for each in warnings] == [True] * told


def test_one_place_of_a_circle_has_many_lengths(tmp_path: Path) -> None:
    text = OWN.replace('name = "mine"', 'name = "mine"\naround_mm = 60').replace("[0, 0]", "5").replace("[50, 0]", "65")
    with pytest.raises(InputError, match="left and right are at one place"):
        Layout.load(file_of(tmp_path, text))
