"""A layout of one element is its rig; one of several is refused with a cure."""

from functools import partial
from pathlib import Path

import pytest

from thermicon.circuit import Drive, Element, InputError, Layout, Rig, export, gate, simulate
from thermicon.circuit.rig.rig import rig_names
from thermicon.icons import Icon, load_library
from thermicon.icons.files.shipped import library_names
from thermicon.perception import rank

SETS = [(name, rig) for name in library_names() for rig in rig_names()]
THENAR = Rig.load("thenar")
TWO = Layout((Element(THENAR, "left"), Element(THENAR, "right")))
STEP = load_library("six-icons")["cooling-step"]
WHEEL = """
format = 1
name = "wheel"
[[element]]
name = "left"
rig = "thenar"
[[element]]
name = "right"
like = "left"
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
        with pytest.raises(InputError, match=r"several elements \(left, right\).*; give the rig of one element$"):
            take(TWO)


def test_a_layout_file_is_refused_where_a_rig_is_needed_in_one_sentence(tmp_path: Path) -> None:
    (file := tmp_path / "wheel.toml").write_text(WHEEL)
    for take in (Rig.of, Rig.load, Layout.of):
        with pytest.raises(InputError, match=r"wheel\.toml: a layout of several elements .* of one element$") as told:
            take(str(file))
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
