"""Felt and named: reports times right names of each person, before any mean and never more than what is named."""

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import IconSet, parse
from thermicon.perception import Ranking, Selection, choose, frontier, judge_goal, rank
from thermicon.perception.observer.observer_model import ObserverModel
from thermicon.perception.ranking import batches
from thermicon.perception.selection.request import Objective

ALERTS = """cue 1
icon faint { cool by 0.4 °C at 1 °C/s; hold for 1 s; return at 1 °C/s }
icon cold { cool by 5 °C at 3 °C/s; hold for 2 s; return at 3 °C/s }
icon warm { warm by 5 °C at 3 °C/s; hold for 2 s; return at 3 °C/s }"""


@pytest.fixture(scope="module")
def ranking() -> Ranking:
    return rank(parse(ALERTS), Rig.load("thenar"), people=24, parameters=24)


def test_it_is_of_each_person_and_not_the_product_of_means(ranking: Ranking) -> None:
    reports, named = ranking.felt.reports[:, 0], ranking.felt.each_correct[:, 0]
    assert ranking.icons[0].felt_and_named == pytest.approx(float((reports * named).mean()), abs=1e-12)
    assert abs(ranking.icons[0].felt_and_named - reports.mean() * named.mean()) > 1e-5, "who feels less names otherwise"


def test_it_is_never_above_what_is_named_nor_what_is_detected(ranking: Ranking) -> None:
    found = ranking.new_laboratory
    assert found is not None
    each = found.each
    assert (each.persons_felt_and_named <= each.persons_correct + 1e-12).all()
    assert (each.felt_and_named <= each.proportion_correct + 1e-12).all()
    for alert, (low, high) in zip(found.each_felt_and_named, found.detected, strict=True):
        assert alert[0] <= low + 0.02 and alert[1] <= high + 0.02
    for k in range(3):
        named = found.pair(k, k, "confused")
        assert all(one <= other + 1e-12 for one, other in zip(found.each_felt_and_named[k], named, strict=True))
    assert (each.felt_and_named < each.proportion_correct - 0.05).all(), "the faint icon is missed in any laboratory"


def test_no_shift_takes_it_above_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draws lie about a centre of their own, from which they are moved to that of many people, each score by itself."""
    icons: IconSet = parse(ALERTS)
    several = batches.PooledResult.each_felt_and_named
    monkeypatch.setattr(batches.PooledResult, "each_felt_and_named", property(lambda felt: several.fget(felt) + 0.4))  # type: ignore[attr-defined]
    found = rank(icons, Rig.load("thenar"), people=12, parameters=12, observer=ObserverModel.load()).new_laboratory
    assert found is not None
    assert (found.each.persons_felt_and_named <= found.each.persons_correct + 1e-12).all()
    assert (found.each.felt_and_named <= found.each.proportion_correct + 1e-12).all()


@pytest.mark.parametrize("number", [0, 1, *(pytest.param(k, marks=pytest.mark.slow) for k in range(2, 10))])
def test_no_objective_and_no_goal_keeps_a_silent_icon(number: int) -> None:
    """It is never confused, since nobody feels it: by names alone it would be the best of all."""
    rng = np.random.default_rng([57, number])
    ways = rng.permutation(["cool", "warm", "cool", "warm"])
    shapes = [
        f"icon i{k} {{ {way} by {rng.uniform(2.0, 4):.1f} °C at {rng.uniform(1, 2.5):.1f} °C/s; "
        f"hold for {rng.uniform(0.5, 4):.1f} s; return at 1.5 °C/s }}"
        for k, way in enumerate(ways)
    ]
    way = str(rng.choice(["cool", "warm"]))
    icons = parse(
        "\n".join(["cue 1", *shapes, f"icon silent {{ {way} by 0.1 °C at 1 °C/s; hold for 1 s; return at 1 °C/s }}"])
    )
    ranking = rank(icons, Rig.load("thenar"), people=8, parameters=0)
    assert ranking.icons[-1].felt_and_named < 0.1 < 0.7 < ranking.icons[-1].proportion_correct
    result = judge_goal("felt-and-named >= 85 %", ranking)
    assert not result.met and result.binding[0].startswith("silent is felt in")
    assert judge_goal("named >= 60 %", ranking).met
    objectives: tuple[Objective, ...] = ("worst", "felt-and-named", "named", "bits", "bits-per-s")
    for objective in objectives:
        choice = choose(ranking, Selection(3, objective), parameters=0)
        assert "silent" not in choice.icons, objective
        assert (choice.excluded[0][0], choice.excluded[0][1][:14]) == ("silent", "is detected in")
    found = frontier(
        icons, Rig.load("thenar"), people=8, most=4, parameters=0, goal="named >= 60 %, detected >= 0.0001"
    )
    assert len(found.points[-1].icons) == 4, "a goal may ask less of detected, and then it may be chosen"
