"""Deciding numbers, each tested from both sides or by its formula."""

import math
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

from tests.builders import dprime_from_memory
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import Observer, draw_people, perceive, rank
from thermicon.perception.identification.episodes import Episodes, remembered
from thermicon.perception.identification.laboratory_draws import LaboratoryDraws, people_for_intervals
from thermicon.perception.identification.population import run_end_s
from thermicon.perception.kernels.episodes import LENGTH, PAUSE
from thermicon.perception.ranking.assumptions import assumptions_of, doubts, explained
from thermicon.perception.ranking.reasons import DistanceComponent, pair_reasons
from thermicon.perception.ranking.sensitivity import Reduction, Sensitivity
from thermicon.perception.sensation.features import directions

DT = 0.01


def drawn(values: np.ndarray, correct: np.ndarray) -> LaboratoryDraws:
    names = tuple(f"constant {k}" for k in range(values.shape[1]))
    return LaboratoryDraws(
        names, values, lambda: np.ones(len(names), bool), correct, *[np.zeros((len(correct), 1))] * 11
    )


def scores(count: int) -> np.ndarray:
    return np.array([NormalDist().inv_cdf((k + 0.5) / count) for k in range(count)])


def felt(psi: np.ndarray, observer: Observer) -> Episodes:
    return Episodes.of(psi[None, None], np.zeros((1, 1, psi.size)), DT, observer)


def test_ends_of_constants_are_those_of_95_per_cent(observer: Observer) -> None:
    z = scores(256)
    nobody = np.full(20, 0.6), draw_people(20, 0), Rig.load("thenar"), observer
    found = assumptions_of(*nobody, drawn(z[:, None], 0.6 + 0.05 * z))
    (only,) = found.moving
    assert (only.correct_at_low, only.correct_at_high) == pytest.approx((0.6 - 0.05 * 1.96, 0.6 + 0.05 * 1.96))
    assert (only.low, only.high) == pytest.approx(tuple(np.percentile(z, (2.5, 97.5))))
    faint = drawn(z[:, None], 0.6 + 0.0045 * z)  # moves by 0.018, less than two points
    assert assumptions_of(*nobody, faint).moving == ()


def test_doubts_from_two_per_cent_of_the_variance_on() -> None:
    values = np.random.default_rng(0).standard_normal((4000, 3))
    shares = [doubt["constant"] for doubt in doubts(drawn(values, values @ [1.0, 0.22, 0.1]))]
    assert shares == ["constant 0", "constant 1"]  # 95, 5 and 1 % of the variance
    some = np.random.default_rng(1).standard_normal((12, 1))
    predicted = some[:, 0] + np.random.default_rng(2).standard_normal(12)
    z = scores(12)[np.argsort(np.argsort(some[:, 0]))]
    left = predicted - np.polyval(np.polyfit(z, predicted, 2), z)
    assert explained(some, np.full(12, 0.8)) == pytest.approx(0.0)
    assert explained(some, predicted) == pytest.approx(1.0 - left.var() / predicted.var() * 11 / 9, abs=0.02)


def test_intervals_are_of_95_per_cent() -> None:
    ranking = rank(load_library("six-icons"), Rig.load("thenar"), people=20, parameters=8)
    elsewhere = ranking.new_laboratory
    assert elsewhere is not None
    for interval, values in (
        (ranking.proportion_correct_interval, ranking.persons),
        (elsewhere.proportion_correct, elsewhere.each.proportion_correct),
        (elsewhere.detected[1], elsewhere.each.detected[:, 1]),
    ):
        assert interval == pytest.approx(tuple(np.percentile(values, (2.5, 97.5))))
    assert run_end_s([4.0, 2.5]) == 14.0


def test_measurements_are_named_from_two_per_cent_on() -> None:
    few = [Reduction(name, (), share, 0.0) for name, share in (("a", 0.021), ("b", 0.019))]
    found = Sensitivity("thenar", (), 6, 0, "episodes", 64, "shipped", 0.8, 2.0, (0.7, 0.9), (), tuple(few))
    assert [each.measurement for each in found.first] == ["a"]


def test_a_side_counts_from_a_tenth_of_the_other_on(cue: Any) -> None:
    trace = cue(change=-4.0)
    for warmth, moved in ((0.38, ("cold",)), (0.42, ("cold", "warm"))):
        warm = trace.warm_receptor_C.copy()
        warm[-1] = warm[0] + warmth
        assert directions(trace.but(warm_receptor_C=warm)) == moved


@pytest.mark.parametrize(("gap_s", "count"), [(0.26, 1), (0.34, 2)])
def test_stretches_of_one_quality_are_one_over_a_gap_of_up_to_three_tenths(
    observer: Observer, gap_s: float, count: int
) -> None:
    clock = DT * np.arange(600)
    psi = np.where((clock >= 1.0) & (clock < 4.0), 1.2, 0.0)
    psi[(clock > 2.0) & (clock < 2.0 + gap_s)] = 0.4  # below half of the bar, but no valley of the bar
    assert felt(psi, observer).counts.tolist() == [[count]]


@pytest.mark.parametrize(("lasting_s", "count"), [(0.19, 0), (0.22, 1)])
def test_features_of_an_episode_and_its_shortest(observer: Observer, lasting_s: float, count: int) -> None:
    clock = DT * np.arange(900)
    assert felt(np.where((clock >= 1.0) & (clock < 1.0 + lasting_s), 6.0, 0.0), observer).counts.tolist() == [[count]]
    psi = np.interp(clock, [1.0, 3.0, 4.0, 6.0], [0.0, 20.0, 20.0, 0.0])
    (row,) = felt(psi, observer).features[0, 0, :1]
    u = (np.expm1(psi / observer.a) / math.expm1(1.0 / observer.a)) ** (1.0 / observer.p)
    assert math.exp(row[LENGTH]) == pytest.approx(DT * (u >= 0.5 * u.max()).sum(), abs=0.011)
    assert math.exp(row[PAUSE]) == pytest.approx(DT * int((psi >= 0.5).argmax()) + 0.5)


@pytest.mark.parametrize(("wanted", "said"), [(0.28, "remembered alike: d′ 0.3"), (0.32, "mostly distinguished by")])
def test_a_feature_is_named_from_three_tenths_on(cue: Any, observer: Observer, wanted: float, said: str) -> None:
    one, low, high = cue(change=-4.0, name="a"), 0.0, 1.0
    for _ in range(20):
        middle = 0.5 * (low + high)
        other = cue(change=-4.0 - middle, name="b")
        both = perceive(one, observer), perceive(other, observer)
        low, high = (low, middle) if dprime_from_memory(both, observer) > wanted else (middle, high)
    assert said in pair_reasons(one, other, both, observer, "episodes", remembered(both, observer), (0, 1))[0]


def test_what_is_noticeable_and_how_many_judge() -> None:
    assert [DistanceComponent("rate", value).above for value in (0.99, 1.0)] == [False, True]
    assert [people_for_intervals(icons) for icons in (6, 40, 64)] == [24, 19, 12]
