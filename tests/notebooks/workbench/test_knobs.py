"""The usual unknowns: what each changes, where its range is from, and what an impossible value does."""

from __future__ import annotations

import pytest

from tests.builders import missing
from tests.notebooks.workbench.openbench import SAID
from thermicon.circuit import Rig
from thermicon.notebooks.workbench.knobs import knobs_of, turned

CONTACT, AREA = "contact.resistance_m2K_per_W", "contact.area_cm2"
REST, LIMIT = "skin.rest_C", "driver.current_limit_A"


@pytest.fixture(scope="module")
def rig() -> Rig:
    """The default rig."""
    return Rig.load("thenar")


def test_every_knob_says_what_it_changes_and_where_its_range_is_from(rig: Rig) -> None:
    for knob in knobs_of(rig):
        assert knob.what
        assert knob.source
        assert knob.low <= knob.value <= knob.high
        assert knob.step > 0
    assert [(knob.key, knob.low, knob.high) for knob in knobs_of(rig)] == [
        (CONTACT, 0.5, 5.5), (AREA, 1.5, 15.0), (REST, 30.0, 36.0), (LIMIT, 0.1, 2.5)
    ]  # fmt: skip
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
