"""The usual unknowns: what each changes, where its range is from, and what an impossible value does."""

from __future__ import annotations

import numpy as np
import pytest

from tests.builders import missing
from tests.notebooks.workbench.openbench import SAID
from thermicon.circuit import Rig, simulate
from thermicon.icons import load_library
from thermicon.notebooks.workbench.knobs import aged, apply, knobs_of
from thermicon.perception import Observer, perceive
from thermicon.perception.observer.people import age_factor
from thermicon.perception.sensation.percept import perceive_many


@pytest.fixture(scope="module")
def rig() -> Rig:
    """The default rig."""
    return Rig.load("thenar")


def test_every_knob_says_what_it_changes_and_where_its_range_is_from(rig: Rig) -> None:
    for knob in knobs_of(rig):
        assert knob.what
        assert knob.source
        if knob.options:
            assert knob.value in knob.options
        else:
            assert knob.low <= float(knob.value) <= knob.high
            assert knob.step > 0
    assert [knob.key for knob in knobs_of(rig)] == ["contact", "area", "rest", "site", "age", "limit"]
    odd = rig.with_(**{"contact.area_cm2": 40, "driver.current_limit_A": 5, "skin.rest_C": 28})
    by_key = {knob.key: knob for knob in knobs_of(odd)}
    assert (by_key["area"].high, by_key["limit"].high, by_key["rest"].low) == (40, 5, 28)


def test_knobs_where_the_rig_has_them_leave_it_as_it_is(rig: Rig) -> None:
    applied = apply(rig, {knob.key: knob.value for knob in knobs_of(rig)})
    assert applied.rig is rig
    assert applied.observer == Observer.load()
    assert applied.notes == ()


def test_each_knob_changes_its_own_part(rig: Rig) -> None:
    made = apply(rig, {"contact": 2, "area": 4, "rest": 34, "limit": 1}).rig
    assert made.contact.resistance_m2K_per_W == pytest.approx(2 * rig.contact.resistance_m2K_per_W)
    assert made.contact.area_m2 == pytest.approx(4e-4)
    assert made.skin.rest_C == 34
    assert (made.driver.current_min_A, made.driver.current_max_A) == (-1, 1)
    assert made.skin.layers == rig.skin.layers


def test_a_site_is_that_of_the_shipped_rig_on_the_same_display(rig: Rig) -> None:
    made, forearm = apply(rig, {"site": "forearm", "rest": 33.0}).rig, Rig.load("forearm")
    assert made.site == "forearm"
    assert made.skin.layers == forearm.skin.layers
    assert made.receptor_depths() == forearm.receptor_depths()
    assert made.contact == rig.contact
    assert made.skin.rest_C == 33.0
    assert made.changes == ("skin.rest_C=33.0", "site=forearm")
    assert apply(made, {"site": "thenar"}).rig.skin.layers == rig.skin.layers


def test_an_aged_observer_feels_what_a_drawn_person_of_that_age_feels(rig: Rig) -> None:
    trace = simulate(load_library("six-icons")["cold-to-warm"], rig)
    old = perceive(trace, aged(Observer.load(), 70.0))
    cold, warm = perceive_many(
        trace.cold_receptor_C,
        trace.warm_receptor_C,
        0.01,
        Observer.load(),
        area_m2=trace.area_m2,
        site=trace.site,
        threshold_cold=age_factor(70.0, "cold"),
        threshold_warm=age_factor(70.0, "warm"),
    )
    assert np.allclose(old.psi_cold, cold, rtol=1e-9)
    assert np.allclose(old.psi_warm, warm, rtol=1e-9)
    assert perceive(trace, apply(rig, {"age": 70}).observer).onset_s == old.onset_s
    assert apply(rig, {"age": 25}).observer == Observer.load()


@pytest.mark.parametrize(("turn", "words"), SAID["knobs"].items())
def test_an_impossible_value_leaves_the_rig_as_it_was_and_says_so(turn: str, words: list[str], rig: Rig) -> None:
    key, value = turn.split(" = ")
    applied = apply(rig, {key: value if value in ("big", "nose") else float(value)})
    assert applied.rig == rig
    assert applied.observer == Observer.load()
    (note,) = applied.notes
    assert missing(words, note) == []


def test_of_several_values_only_the_impossible_one_is_left_out(rig: Rig) -> None:
    applied = apply(rig, {"rest": 34.0, "limit": 0.01, "contact": 2.0, "age": 65.0})
    assert applied.rig.skin.rest_C == 34.0
    assert applied.rig.contact.resistance_m2K_per_W == pytest.approx(1.08e-3)
    assert applied.rig.driver.current_max_A == 1.5
    assert applied.observer != Observer.load()
    assert len(applied.notes) == 1


def test_an_unusual_value_is_told_and_an_unknown_knob_is_an_error_of_the_caller(rig: Rig) -> None:
    applied = apply(rig, {"rest": 28.0})
    assert applied.rig.skin.rest_C == 28.0
    assert applied.notes == ("rest temperature of 28 °C is outside the usual 30–36 °C",)
    with pytest.raises(KeyError, match="no knob is called volume"):
        apply(rig, {"volume": 11.0})
