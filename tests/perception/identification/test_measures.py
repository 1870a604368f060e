"""Scores of confusions with intervals for a new laboratory."""

import json
import math

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library, parse
from thermicon.perception import Ranking, information_bits, rank
from thermicon.perception.identification.laboratory_draws import DrawnLaboratories, Uncertain, latin
from thermicon.perception.identification.measures import plugin_bits, proportion_correct
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.ranking.assumptions import doubts


def spread(correct: float, icons: int = 6) -> np.ndarray:
    wrong = (1 - correct) / (icons - 1)
    return np.full((icons, icons), wrong) + (correct - wrong) * np.eye(icons)


def paired(correct: float, icons: int = 6) -> np.ndarray:
    matrix = correct * np.eye(icons)
    for k in range(icons):
        matrix[k, k ^ 1] = 1 - correct
    return matrix


def test_known_information() -> None:
    assert information_bits(np.eye(6)) == pytest.approx(math.log2(6), abs=1e-12)
    assert information_bits(np.full((6, 6), 1 / 6)) == pytest.approx(0.0, abs=1e-12)
    assert information_bits(spread(0.91)) == pytest.approx(1.94, abs=0.005)
    assert information_bits(paired(0.91)) == pytest.approx(2.15, abs=0.005)
    assert proportion_correct(np.stack([spread(0.8), np.eye(6)])) == pytest.approx([0.8, 1.0])
    assert information_bits(np.stack([np.eye(4), np.full((4, 4), 0.25)])) == pytest.approx([2.0, 0.0], abs=1e-12)


def test_plugin_of_forty_eight_trials_is_biased_as_known() -> None:
    even, pairs = plugin_bits(spread(0.91), 48, seed=1), plugin_bits(paired(0.91), 48, seed=1)
    assert even == pytest.approx(2.20, abs=0.015)
    assert 2.20 < pairs < 2.26


def test_plugin_loses_its_bias_and_repeats() -> None:
    assert plugin_bits(spread(0.91), 60_000, experiments=20) == pytest.approx(1.94, abs=0.01)
    assert plugin_bits(spread(0.8), 50, seed=3) == plugin_bits(spread(0.8), 50, seed=3)
    with pytest.raises(ValueError, match=r"at least one trial, not 0"):
        plugin_bits(np.eye(2), 0)


@pytest.mark.parametrize(("trials", "shown"), [(7, [3, 2, 2]), (6, [2, 2, 2]), (2, [1, 1])])
def test_answers_without_error_carry_the_entropy_of_what_was_presented(trials: int, shown: list[int]) -> None:
    bits = -sum(times / trials * math.log2(times / trials) for times in shown)
    assert plugin_bits(np.eye(3), trials, experiments=5) == pytest.approx(bits, abs=1e-12)


def test_wide_intervals_are_drawn_in_logarithms() -> None:
    for low, high, middle in ((1.0, 100.0, 10.0), (1.0, 1.4, 1.2), (-1.0, 3.0, 1.0)):
        between = Uncertain("t", low, high)
        assert between.at(0.5) == pytest.approx(middle)
        assert between.share(middle) == pytest.approx(0.5)
    with pytest.raises(ValueError, match=r"t: 1 to 1 is not an interval"):
        Uncertain("t", 1.0, 1.0)


def test_a_latin_hypercube_has_one_draw_a_stratum() -> None:
    shares = latin(3, 8, seed=4)
    assert shares.shape == (8, 3)
    assert (np.sort((shares * 8).astype(int), axis=0) == np.arange(8)[:, None]).all()
    assert (shares == latin(3, 8, seed=4)).all()
    assert (shares != latin(3, 8, seed=5)).any()


def test_each_draw_has_its_turn() -> None:
    model = ObserverModel.load()
    assert model.posterior is not None
    found = DrawnLaboratories.of(model, "episodes", len(model.posterior), seed=0)
    assert np.array_equal(found.values[:, : len(model.posterior.names)], model.posterior.draws)


SIX, RIG = load_library("six-icons"), Rig.load("thenar")


@pytest.fixture(scope="module")
def ranking() -> Ranking:
    return rank(SIX, RIG, people=8, seed=2, parameters=16)


def test_intervals_hold_the_prediction_and_are_wide(ranking: Ranking) -> None:
    found = ranking.new_laboratory
    assert found.draws == 16
    assert found.people == 8
    assert found.each.values.shape == (16, len(found.each.names))
    assert {"slope of sensation", "share of the scatter of ratings", "laboratory, cold"} <= set(found.each.names)
    for (low, high), value, most in (
        (found.proportion_correct, ranking.proportion_correct, 1.0),
        (found.information_bits, ranking.information_bits, math.log2(6)),
    ):
        assert 0.0 <= low < value < high <= most
        assert high - low > 0.02
    assert found.proportion_correct == pytest.approx(np.percentile(found.each.proportion_correct, [2.5, 97.5]))
    assert len(found.detected) == 6
    for icon, (low, high) in zip(ranking.icons, found.detected, strict=True):
        assert low <= icon.detected_probability <= high
    for icon, onset in zip(ranking.icons, found.onset_s, strict=True):
        assert 0.5 < onset[0] < icon.onset_s < onset[1] < 5.0


def test_they_are_in_the_file(ranking: Ranking) -> None:
    held, found = json.loads(ranking.to_json()), ranking.new_laboratory
    assert held["set"]["proportion_correct_interval_new_laboratory"] == list(found.proportion_correct)
    assert held["set"]["information_bits_interval_new_laboratory"] == list(found.information_bits)
    assert held["set"]["posterior_draws"] == 16
    assert held["icons"][0]["detected_interval_new_laboratory"] == list(found.detected[0])
    named = [(icon["proportion_correct"], icon["proportion_correct_interval_new_laboratory"]) for icon in held["icons"]]
    asked = [(pair["confused_probability"], pair["confused_interval_new_laboratory"]) for pair in held["pairs"]]
    assert all((often > 0.05) is (ends is not None) for often, ends in asked)
    assert all(ends[0] <= value <= ends[1] and ends[1] - ends[0] > 0.005 for value, ends in [*named, *asked] if ends)
    pair = next(p for p in held["pairs"] if {p["a"], p["b"]} == {"warming-step", "linear-warming"})
    low, high = pair["d_prime_interval_new_laboratory"]
    assert low < pair["d_prime"] < high
    assert [one["constant"] for one in held["set"]["doubt"]] == [one["constant"] for one in doubts(found.each)]


def test_the_draws_leave_the_prediction_alone(ranking: Ranking) -> None:
    other = rank(SIX, RIG, people=8, seed=2, parameters=0)
    assert other.new_laboratory is None
    assert np.array_equal(other.confusion, ranking.confusion)
    held = other.to_dict()
    assert held["set"]["proportion_correct_interval_new_laboratory"] is None
    assert held["set"]["posterior_draws"] is None
    assert held["icons"][0]["detected_interval_new_laboratory"] is None


def test_faint_icons_have_wide_intervals_of_detection_and_none_of_onset() -> None:
    text = "cue 1\nset s { control skin; baseline 32 °C }\nicon %s { cool by %s °C at 0.3 °C/s; hold for 1 s }"
    faint, none = (
        rank(parse(text % course), RIG, people=8, parameters=16).new_laboratory
        for course in (("faint", "0.3"), ("none", "0.05"))
    )
    assert faint is not None and none is not None
    ((low, high),) = faint.detected
    assert 0.0 <= low < high <= 1.0 and high - low > 0.1
    assert faint.information_bits == (0.0, 0.0)
    assert none.onset_s == (None,)


def test_only_constants_that_take_part_are_doubted(ranking: Ranking) -> None:
    """The thenar at the reference area: nothing of other sites, of age, of reaction times and of other experiments."""
    idle = {"caution after a pre-pulse", "choice time", "E1 cold"}
    idle |= {"warm sensitivity lost per decade"}
    of_a_site = {"cold threshold on the forearm", "warm threshold on the forearm", "cold area exponent"}
    smaller = Rig.load("forearm").with_(**{"contact.area_cm2": 4.0})
    away = rank(SIX, smaller, people=4, parameters=4)
    for found, some, others in ((ranking, idle | of_a_site, set()), (away, idle, of_a_site)):
        each = found.new_laboratory.each
        acting = {name for name, acts in zip(each.names, each.acting(), strict=True) if acts}
        assert acting.isdisjoint(some)
        assert acting >= {"memory noise (episodes)", "laboratory, cold", "gain noise", "cold receptor depth", *others}
        assert acting >= {doubt["constant"] for doubt in doubts(each)}
