"""People drawn at random."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from thermicon.circuit import Rig
from thermicon.perception import Observer, draw_people
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.observer import CHANNELS, observer_records
from thermicon.perception.observer.people import People, people_records
from thermicon.perception.observer.priors import Prior, Priors, load_priors


def test_the_first_people_are_the_same_whatever_the_number() -> None:
    few, many = draw_people(5, seed=3), draw_people(300, seed=3)
    for field in fields(People):
        assert np.array_equal(getattr(few, field.name), getattr(many, field.name)[:5]), field.name
    assert not np.array_equal(draw_people(5, seed=4).memory, few.memory)


def test_spreads_are_those_of_the_records() -> None:
    crowd = draw_people(20_000, seed=0)
    records = people_records()
    assert set(records) == {field.name for field in fields(People)}
    for name in ("threshold_cold", "threshold_warm", "criterion_cold", "criterion_warm"):
        logs = np.log(getattr(crowd, name))
        assert logs.std() == pytest.approx(records[name].central, rel=0.03)
        assert logs.mean() == pytest.approx(0.0, abs=0.02)
    shared = observer_records().one("correlation of cold and warm").central
    for what in ("threshold", "criterion"):
        both = [np.log(getattr(crowd, f"{what}_{channel}")) for channel in ("cold", "warm")]
        assert np.corrcoef(both[0], both[1])[0, 1] == pytest.approx(shared, abs=0.02)
    assert (crowd.memory.min(), crowd.memory.max()) == pytest.approx((0.5, 1.5), abs=0.01)
    assert np.log(crowd.contact_resistance).std() == pytest.approx(np.log(1.3), rel=0.02)
    assert np.median(crowd.decision_s) == pytest.approx(Observer.load().decision_s, rel=0.03)
    assert crowd.lapse.max() <= 0.03


def test_people_with_one_criterion_are_otherwise_the_same() -> None:
    young, one = (
        draw_people(9, seed=1),
        draw_people(9, seed=1, observer=replace(Observer.load(), criterion_between=0.0)),
    )
    assert np.all(one.criterion_cold == 1.0)
    assert np.array_equal(one.threshold_cold, young.threshold_cold)
    assert np.array_equal(one.decision_s, young.decision_s)


def test_people_change_the_rig() -> None:
    rig, crowd = Rig.load("thenar"), draw_people(3, seed=1)
    for person, own in enumerate(crowd.rigs(rig, [Both(0.2e-3, 0.3e-3)] * 3)):
        assert (own.skin.cold_receptor_m, own.skin.warm_receptor_m) == pytest.approx((0.2e-3, 0.3e-3))
        assert own.contact.resistance_m2K_per_W == pytest.approx(5.4e-4 * crowd.contact_resistance[person])
        assert own.skin.layers[0].thickness_m == pytest.approx(0.17e-3 * crowd.outer_layer[person])
        assert own.module == rig.module


def test_age_raises_the_thresholds_of_each_channel_by_its_own_loss() -> None:
    young, old = draw_people(300, seed=2), draw_people(300, seed=2, age_years=65.0)
    for channel in CHANNELS:
        ratio = getattr(old, f"threshold_{channel}") / getattr(young, f"threshold_{channel}")
        lost = observer_records().one("sensitivity lost per decade", channel=channel).central
        assert ratio == pytest.approx(np.exp(4.0 * lost))
        assert 1.2 < Observer.load().age_factor(65.0, channel) < 3.0
    assert np.array_equal(draw_people(9, seed=2, age_years=25.0).threshold_cold, young.threshold_cold[:9])
    assert np.array_equal(old.memory, young.memory)
    assert np.array_equal(old.criterion_warm, young.criterion_warm)


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"an age of 12 years is not covered: give 18 to 100"):
        draw_people(3, age_years=12.0)
    with pytest.raises(ValueError, match=r"at least one person is needed, not 0"):
        draw_people(0)
    columns: dict[str, Any] = {field.name: np.ones(2) for field in fields(People)}
    with pytest.raises(ValueError, match=r"people: lapse must be one finite number for each person"):
        People(**{**columns, "lapse": np.ones(3)})


ALL = load_priors().each


@given(st.sampled_from(ALL), st.floats(-3.0, 3.0))
def test_places_and_values_go_both_ways(prior: Prior, sds: float) -> None:
    place = prior.middle + sds * prior.sd
    assert prior.to_place(prior.to_value(place)) == pytest.approx(place, abs=1e-6)


def test_every_parameter_has_a_source_or_says_that_it_has_none() -> None:
    assert all(prior.source and prior.mechanism for prior in ALL)
    assert {prior.name for prior in ALL if "no source" in prior.source} >= {"softness of the limits", "gain noise"}


def test_two_parameters_of_one_name_and_one_without_width_are_refused() -> None:
    with pytest.raises(ValueError, match="one name"):
        Priors((ALL[0], ALL[0]))
    with pytest.raises(ValueError, match="cold limit: a prior needs"):
        Prior("cold limit", "degC", "linear", 33.0, 0.0, "quality", "none")
