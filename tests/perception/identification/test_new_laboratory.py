import json
import math
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library, parse
from thermicon.perception import Ranking, rank
from thermicon.perception.ranking.assumptions import doubts, explained


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig.load("thenar")


@pytest.fixture(scope="module")
def ranking(rig: Rig) -> Ranking:
    return rank(load_library("six-icons"), rig, people=8, seed=2, parameters=16)


def test_intervals_hold_the_prediction_and_are_wide(ranking: Ranking) -> None:
    found = ranking.new_laboratory
    assert found is not None
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
    assert len(found.detected) == 6
    for icon, (low, high) in zip(ranking.icons, found.detected, strict=True):
        assert low <= icon.detected_probability <= high
    for icon, onset in zip(ranking.icons, found.onset_s, strict=True):
        assert onset is not None
        assert icon.onset_s is not None
        assert 0.5 < onset[0] < icon.onset_s < onset[1] < 5.0
    assert repr(found).startswith("NewLaboratory(16 draws, 8 people each: ")
    assert repr(found).endswith(" bits)")


def test_they_are_in_the_file(ranking: Ranking) -> None:
    held = json.loads(ranking.to_json())
    found = ranking.new_laboratory
    assert found is not None
    assert held["set"]["proportion_correct_interval_new_laboratory"] == list(found.proportion_correct)
    assert held["set"]["information_bits_interval_new_laboratory"] == list(found.information_bits)
    assert held["set"]["posterior_draws"] == 16
    assert held["icons"][0]["detected_interval_new_laboratory"] == list(found.detected[0])
    pair = next(p for p in held["pairs"] if {p["a"], p["b"]} == {"warming-step", "linear-warming"})
    low, high = pair["d_prime_interval_new_laboratory"]
    assert low < pair["d_prime"] < high
    assert [one["constant"] for one in held["set"]["doubt"]] == [one.name for one in doubts(found.each)]


def test_doubt_is_what_explains_the_draws() -> None:
    rng = np.random.default_rng(1)
    values = rng.standard_normal((400, 4))
    values[:, 3] = values[:, 0]  # one that trades off with the first
    predicted = 0.8 + 0.04 * values[:, 0] + 0.02 * values[:, 1] ** 2 + 0.02 * rng.standard_normal(400)
    variance = np.array([0.04**2, 2 * 0.02**2, 0.0, 0.04**2])
    assert explained(values, predicted) == pytest.approx(variance / predicted.var(), abs=0.08)
    assert explained(values, np.full(400, 0.8)) == pytest.approx(0.0)


def test_the_draws_leave_the_prediction_alone(ranking: Ranking, rig: Rig) -> None:
    other = rank(load_library("six-icons"), rig, people=8, seed=2, parameters=0)
    assert other.new_laboratory is None
    assert np.array_equal(other.confusion, ranking.confusion)
    held: Any = json.loads(other.to_json())
    assert held["set"]["proportion_correct_interval_new_laboratory"] is None
    assert held["set"]["posterior_draws"] is None
    assert held["icons"][0]["detected_interval_new_laboratory"] is None


def test_faint_icons_have_wide_intervals_of_detection_and_none_of_onset(rig: Rig) -> None:
    text = "cue 1\nset s { control skin; baseline 32 °C }\nicon %s { cool by %s °C at 0.3 °C/s; hold for 1 s }"
    faint, none = (
        rank(parse(text % course), rig, people=8, parameters=16).new_laboratory
        for course in (("faint", "0.3"), ("none", "0.05"))
    )
    assert faint is not None and none is not None
    ((low, high),) = faint.detected
    assert 0.0 <= low < high <= 1.0 and high - low > 0.1
    assert faint.information_bits == (0.0, 0.0)
    assert none.onset_s == (None,)


def test_only_constants_that_take_part_are_doubted(ranking: Ranking) -> None:
    """The thenar at the reference area: nothing of other sites, of age, of reaction times and of other experiments."""
    idle = {"caution after a pre-pulse", "choice time", "cold receptor depth", "E1 cold"}
    idle |= {"warm sensitivity lost per decade"}
    of_a_site = {"cold threshold on the forearm", "warm threshold on the forearm", "cold area exponent"}
    smaller = Rig.load("forearm").with_(**{"contact.area_cm2": 4.0})
    away = rank(load_library("six-icons"), smaller, people=4, parameters=4)
    for found, some, others in ((ranking, idle | of_a_site, set()), (away, idle, of_a_site)):
        assert found.new_laboratory is not None
        each = found.new_laboratory.each
        acting = {name for name, acts in zip(each.names, each.acts, strict=True) if acts}
        assert acting.isdisjoint(some)
        assert acting >= {"memory noise (episodes)", "laboratory, cold", "gain noise", *others}
        assert acting >= {doubt.name for doubt in doubts(each)}
