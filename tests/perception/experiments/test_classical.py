from dataclasses import replace

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer, draw_people
from thermicon.perception.experiments.classical import (
    choice_reaction_time,
    forced_choice,
    method_of_limits,
    yes_no,
)
from thermicon.perception.experiments.levels import method_of_levels
from thermicon.perception.experiments.measured import Measurement, crowd_of
from thermicon.perception.sensation.bench import Bench


@pytest.fixture(scope="module")
def bench() -> Bench:
    return Bench(Rig.load("thenar"), surface="display")


@pytest.fixture(scope="module")
def person() -> Observer:
    return Observer.load()


def test_one_observer_gives_the_methods_their_order(person: Observer, bench: Bench) -> None:
    """Forced choice below levels below limits: the same sense, asked differently."""
    for channel, least in (("cold", 5.0), ("warm", 5.0)):
        choice = forced_choice(person, bench, channel).value  # type: ignore[arg-type]
        levels = method_of_levels(person, bench, channel).value  # type: ignore[arg-type]
        limits = method_of_limits(person, bench, channel).value  # type: ignore[arg-type]
        assert choice is not None
        assert levels is not None
        assert limits is not None
        assert choice < levels < limits
        assert limits > least * choice


def test_limits_are_rate_times_delay_and_a_crossing(person: Observer, bench: Bench) -> None:
    """Conduction a second longer means a second more of the ramp, K for K."""
    person = replace(person, decision_noise=0.0)
    here = method_of_limits(person, bench, "cold").value
    slow = replace(person, decision_s=person.decision_s + 1.0)
    assert here is not None
    assert method_of_limits(slow, bench, "cold").value == pytest.approx(here + 1.0, abs=2e-3)
    fast_ramp = method_of_limits(person, bench, "cold", rate_K_per_s=2.0).value
    assert fast_ramp is not None
    assert fast_ramp > here + 0.3


def test_forced_choice_is_harder_at_a_higher_proportion(person: Observer, bench: Bench) -> None:
    found = [forced_choice(person, bench, "warm", proportion=p).value or 0.0 for p in (0.6, 0.75, 0.9)]
    assert found == sorted(found)


def test_yes_no_needs_less_when_false_alarms_may_be_many(person: Observer, bench: Bench) -> None:
    bold, shy = (yes_no(person, bench, "cold", false_alarms=rate).value or 0.0 for rate in (0.3, 0.01))
    assert bold < shy
    more = yes_no(person, bench, "cold", hits=0.9).value or 0.0
    assert more > (yes_no(person, bench, "cold").value or 0.0)


def test_people_spread_thresholds_as_their_records_do(person: Observer, bench: Bench) -> None:
    crowd = draw_people(60, seed=4)
    found = forced_choice(person, bench, "cold", people=crowd)
    alone = forced_choice(person, bench, "cold").value
    assert alone is not None
    assert found.each == pytest.approx(alone * crowd.threshold_cold, rel=0.08)
    assert np.log10(found.each).std(ddof=1) == pytest.approx(np.log10(crowd.threshold_cold).std(ddof=1), rel=0.08)
    assert found.unfelt == 0.0
    limits = method_of_limits(person, bench, "cold", people=crowd)
    # Criteria and decisions differ more between people than sensitivities do.
    assert np.corrcoef(np.log(limits.each), np.log(crowd.threshold_cold * crowd.criterion_cold))[0, 1] > 0.7


def test_levels_are_drawn_from_a_seed(person: Observer, bench: Bench) -> None:
    found = [method_of_levels(person, bench, "warm", runs=20, seed=seed).each for seed in (1, 1, 2)]
    assert np.array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])
    assert found[0].size == 20


def test_reaction_time_falls_with_area_and_cold_is_first(person: Observer) -> None:
    small, large = (Bench(Rig.load("forearm").with_(**{"contact.area_cm2": a}), 31.0, "display") for a in (2.5, 10.0))
    cold, warm = (choice_reaction_time(person, large, channel) for channel in ("cold", "warm"))  # type: ignore[arg-type]
    assert cold.quantile()[0] < warm.quantile()[0]
    assert choice_reaction_time(person, small, "cold").quantile()[0] > cold.quantile()[0]
    assert cold.cold_share[0] > 0.99
    assert warm.cold_share[0] < 0.01
    crowd = choice_reaction_time(person, large, "cold", people=draw_people(5, seed=0))
    assert crowd.probability.shape[0] == 5


def test_what_is_not_felt_is_none_and_not_a_number(person: Observer, bench: Bench) -> None:
    numb = draw_people(2, seed=0)
    numb = replace(numb, threshold_warm=np.array([1.0, 1e4]))
    found = forced_choice(person, bench, "warm", people=numb)
    assert found.unfelt == 0.5
    assert np.isinf(found.each[1])
    assert found.value is None
    assert found.quantile(0.0) is not None
    assert "not felt" in repr(found)
    alone = replace(numb, threshold_warm=np.array([1e4, 1e4]))
    assert method_of_limits(person, bench, "warm", people=alone, limit_K=3.0).value is None
    assert method_of_levels(person, bench, "warm", people=alone).unfelt == 1.0


def test_the_nominal_person_is_the_observer(person: Observer) -> None:
    crowd = crowd_of(person, "forearm", None)
    assert len(crowd) == 1
    assert crowd.conduction_s[1][0] == pytest.approx(0.55 / person.warm.velocity_m_per_s + 0.225 / 2.0)


def test_messages(person: Observer, bench: Bench) -> None:
    with pytest.raises(ValueError, match=r"choice of two lies between 0.5 and 1, not 0.5"):
        forced_choice(person, bench, "cold", proportion=0.5)
    with pytest.raises(ValueError, match=r"the share of hits lies between 0 and 1, not 0"):
        yes_no(person, bench, "cold", hits=0.0)
    with pytest.raises(ValueError, match=r"levels need a run and 0 < last_K < first_K, not 0, 0.1 and 2"):
        method_of_levels(person, bench, "cold", runs=0)
    keen = replace(draw_people(1), threshold_cold=np.array([1e-3]))
    with pytest.raises(ValueError, match=r"a step of 0.005 K is felt already"):
        forced_choice(person, bench, "cold", people=keen)
    with pytest.raises(ValueError, match=r"limits: one number is needed for each person"):
        Measurement("limits", "cold", "K", np.array([np.nan]), "")
