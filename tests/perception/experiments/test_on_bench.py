"""One observer asked in the ways that laboratories ask, on a bench; thresholds by bisection are those of a scan."""

from dataclasses import replace

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer, draw_people
from thermicon.perception.evidence.predicted import plausible_observers
from thermicon.perception.experiments import on_bench
from thermicon.perception.experiments.on_bench import (
    SIZES_K,
    choice_reaction_time,
    forced_choice,
    method_of_levels,
    method_of_limits,
    ramps,
    size_reaching,
    yes_no,
)
from thermicon.perception.observer.channels import CHANNELS, VARIABLES, Channel
from thermicon.perception.observer.people import People
from thermicon.perception.sensation.bench import Bench


@pytest.fixture(scope="module")
def bench() -> Bench:
    return Bench(Rig.load("thenar"), surface="display")


@pytest.fixture(scope="module")
def person() -> Observer:
    return Observer.load()


@pytest.mark.parametrize("channel", CHANNELS)
def test_one_observer_gives_the_methods_their_order(person: Observer, bench: Bench, channel: Channel) -> None:
    """Forced choice below levels below limits: the same sense, asked differently."""
    choice, limits = forced_choice(person, bench, channel), method_of_limits(person, bench, channel)[0]
    assert choice < np.median(method_of_levels(person, bench, channel)) < limits
    assert limits > 5.0 * choice


def test_limits_are_rate_times_delay_and_a_crossing(person: Observer, bench: Bench) -> None:
    """Conduction a second longer means a second more of the ramp, K for K."""
    person = replace(person, decision_noise=0.0)
    here = method_of_limits(person, bench, "cold")[0]
    slow = replace(person, decision_s=person.decision_s + 1.0)
    assert method_of_limits(slow, bench, "cold")[0] == pytest.approx(here + 1.0, abs=2e-3)
    assert method_of_limits(person, bench, "cold", rate_K_per_s=2.0)[0] > here + 0.3


def test_yes_no_needs_more_of_who_is_cautious(person: Observer, bench: Bench) -> None:
    assert yes_no(person, bench, "cold") < yes_no(replace(person, criterion=2.0 * person.criterion), bench, "cold")


def test_people_spread_limits_by_thresholds_and_criteria(person: Observer, bench: Bench) -> None:
    crowd = draw_people(60, seed=4)
    limits = method_of_limits(person, bench, "cold", people=crowd)
    # Criteria and decisions differ more between people than sensitivities do.
    assert np.corrcoef(np.log(limits), np.log(crowd.threshold_cold * crowd.criterion_cold))[0, 1] > 0.7


def test_the_start_of_a_ramp_is_enough_for_limits(
    person: Observer, bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    people = draw_people(30, seed=5)
    soon = method_of_limits(person, bench, "warm", people=people).tolist()
    monkeypatch.setattr(on_bench, "EARLY", 1.0)
    assert soon == method_of_limits(person, bench, "warm", people=people).tolist()


def test_levels_are_drawn_from_a_seed(person: Observer, bench: Bench) -> None:
    found = [method_of_levels(person, bench, "warm", runs=20, seed=seed).tolist() for seed in (1, 1, 2)]
    assert found[0] == found[1] != found[2]
    assert len(found[0]) == 20


def test_a_staircase_ends_within_its_last_step() -> None:
    draws = np.random.default_rng(0)
    found = [on_bench._staircase(lambda level, at=at: float(level >= at), 8.0, draws) for at in (1.03, 0.37, 2.7)]  # type: ignore[misc]
    assert found == [1.0625, 0.3125, 2.6875]


def test_reaction_time_falls_with_area_and_cold_is_first(person: Observer) -> None:
    small, large = (Bench(Rig.load("forearm").with_(**{"contact.area_cm2": a}), 31.0, "display") for a in (2.5, 10.0))
    cold, warm = (choice_reaction_time(person, large, channel) for channel in CHANNELS)
    assert cold.quantile()[0] < warm.quantile()[0]
    assert choice_reaction_time(person, small, "cold").quantile()[0] > cold.quantile()[0]
    assert cold.cold_share[0] > 0.99
    assert warm.cold_share[0] < 0.01


def test_what_is_not_felt_is_infinite(person: Observer, bench: Bench) -> None:
    numb = replace(People.nominal(2), threshold_warm=np.array([1.0, 1e4]))
    assert np.isinf(method_of_limits(person, bench, "warm", people=numb, limit_K=3.0))[1]
    deaf = replace(person, warm=replace(person.warm, threshold_drive=1e4))
    assert np.isinf(forced_choice(deaf, bench, "warm"))
    assert np.isinf(method_of_levels(deaf, bench, "warm", runs=3)).all()
    keen = replace(person, cold=replace(person.cold, threshold_drive=1e-5))
    with pytest.raises(ValueError, match=r"a step of 0.005 K is felt already"):
        forced_choice(keen, bench, "cold")


@pytest.mark.parametrize("variable", VARIABLES)
def test_what_is_felt_and_reported_rises_with_size(variable: str) -> None:
    """Bisection needs it, for every variant and for observers far from the nominal one."""
    bench = Bench(Rig.load("hand-dorsum"), surface="display")
    for observer in plausible_observers(4, 1, variable=variable):  # type: ignore[arg-type]
        for channel in CHANNELS:
            played = ramps(bench, channel, 1.0, 1.0)
            assert (np.diff([played.peak(k, observer) for k in range(SIZES_K.size)]) >= -1e-9).all()
            reported = np.array([played.reported(k, observer) for k in range(SIZES_K.size)])
            inside = (reported > 0.01) & (reported < 0.99)
            assert (np.diff(reported[inside]) > 0.0).all()


def test_the_peak_is_that_of_the_whole_course(person: Observer, bench: Bench) -> None:
    played = ramps(bench, "cold", 1.0, 1.0)
    largest = max(float((psi - psi[..., :1]).max()) for psi in played.played(20).felt(person))
    assert played.peak(20, person) == pytest.approx(largest, rel=1e-12)


def test_bisection_finds_what_a_scan_finds() -> None:
    asked: list[int] = []
    for seed in range(5):
        own = np.cumsum(np.random.default_rng(seed).random(SIZES_K.size))
        asked.clear()

        def at(k: int, own: np.ndarray = own) -> float:
            asked.append(k)
            return float(own[k])

        k = int(np.argmax(own >= 7.0))
        share = (7.0 - own[k - 1]) / (own[k] - own[k - 1])
        assert size_reaching(at, SIZES_K, 7.0) == pytest.approx(SIZES_K[k - 1] * (SIZES_K[k] / SIZES_K[k - 1]) ** share)
        assert len(asked) == len(set(asked)) < SIZES_K.size
        assert np.isinf(size_reaching(at, SIZES_K, 1e9))


def test_slow_ramps_lack_the_sizes_that_take_too_long(bench: Bench) -> None:
    assert ramps(bench, "warm", 0.01, 1.0).sizes_K[-1] <= 6.0 < SIZES_K[-1]
