"""A laboratory has one form of memory and pairs of its own, and intervals for a new laboratory hold both."""

import numpy as np
import pytest

from tests.builders import without_pairs
from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import Ranking, rank
from thermicon.perception.identification.laboratory_draws import DrawnLaboratories
from thermicon.perception.identification.pairs import pair_scores, with_pairs
from thermicon.perception.observer.channels import FORM
from thermicon.perception.observer.observer_model import ObserverModel

THREE = np.array([[0.8, 0.15, 0.05], [0.15, 0.7, 0.15], [0.1, 0.1, 0.8]])
SIX, RIG = load_library("six-icons"), Rig.load("thenar")


@pytest.fixture(scope="module")
def ranking() -> Ranking:
    return rank(SIX, RIG, people=24, parameters=128)


def test_one_pair_is_confused_more_and_the_others_as_often_against_their_own_names() -> None:
    scores = np.zeros((3, 3))
    scores[0, 1] = scores[1, 0] = 1.5
    found = with_pairs(THREE, 1.0, scores)
    odds, usual = (each / np.diagonal(each)[:, None] for each in (found, THREE))
    assert odds[0, 1] / usual[0, 1] == pytest.approx(odds[1, 0] / usual[1, 0]) == pytest.approx(np.e)
    assert odds[0, 2] / usual[0, 2] == pytest.approx(odds[2, 1] / usual[2, 1]) == pytest.approx(np.exp(-0.5))
    assert np.allclose(found.sum(axis=1), 1.0)


def test_odds_are_those_of_the_model_in_the_mean_over_laboratories() -> None:
    factors = []
    for scores in pair_scores(3, 20_000, seed=1):
        found = with_pairs(THREE, 0.7, scores)
        factors.append(found / np.diagonal(found)[:, None] / (THREE / np.diagonal(THREE)[:, None]))
    assert np.allclose(np.mean(factors, axis=0), 1.0, atol=0.03)
    assert np.std(np.log(factors), axis=0)[0, 1] == pytest.approx(0.7, rel=0.03)


def test_each_laboratory_has_one_form_with_even_odds_unless_it_is_forced() -> None:
    model = ObserverModel.load()

    def forms(memory: str) -> list[str]:
        laboratories = DrawnLaboratories.of(model, memory, 40, 3)  # type: ignore[arg-type]
        return [laboratories.at(k, 1).form for k in range(40)]

    assert sorted(forms("both")) == ["episodes"] * 20 + ["naming"] * 20
    assert forms("both") != sorted(forms("both")), "by chance, not by the order of draws"
    assert set(forms("naming")) == {"naming"} and set(forms("episodes")) == {"episodes"}


def test_the_interval_holds_both_forms_and_pairs_and_says_so(ranking: Ranking) -> None:
    found = ranking.new_laboratory
    assert found is not None and {"form of memory", "pairs of icons"} < set(found.covers)
    alone = rank(SIX, RIG, people=24, parameters=128, memory="episodes").new_laboratory
    assert alone is not None and "form of memory" not in alone.covers and "pairs of icons" in alone.covers
    without = rank(SIX, RIG, people=24, parameters=128, observer=without_pairs())
    assert without.new_laboratory is not None and "pairs of icons" not in without.new_laboratory.covers
    wide = found.proportion_correct
    for narrower in (alone.proportion_correct, without.new_laboratory.proportion_correct):
        assert wide[1] - wide[0] > narrower[1] - narrower[0]


def test_the_published_order_of_the_six_icons_is_possible_and_their_mean_inside(ranking: Ranking) -> None:
    found, names = ranking.new_laboratory, list(ranking.labels)
    assert found is not None
    low, high = found.proportion_correct
    assert low < 0.91 < high
    each = np.diagonal(found.each.confused, axis1=1, axis2=2)
    assert np.mean(each.argmin(axis=1) == names.index("cold-to-warm")) > 0.02
    assert np.mean(each.argmax(axis=1) == names.index("linear-cooling")) > 0.02


def test_what_the_form_carries_of_the_doubt_is_told(ranking: Ranking) -> None:
    doubts = {each["constant"]: each["share_of_variance"] for each in ranking.to_dict()["set"]["doubt"]}
    assert doubts[FORM] > 0.05
    by_form = ranking.by_form
    assert ranking.proportion_correct == pytest.approx((by_form["episodes"] + by_form["naming"]) / 2.0)
