"""The most influential assumptions of a ranking."""

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import Observer, rank
from thermicon.perception.identification.laboratory_draws import LaboratoryDraws
from thermicon.perception.observer.people import draw_people
from thermicon.perception.ranking.assumptions import assumptions_of

THENAR, FINGERTIP = Rig.load("thenar"), Rig.load("fingertip")


def draws_of(values: np.ndarray, correct: np.ndarray, *names: str, idle: tuple[str, ...] = ()) -> LaboratoryDraws:
    acts = np.array([name not in idle for name in names])
    return LaboratoryDraws(names, values, lambda: acts, correct, *[np.zeros((len(correct), 1))] * 11)


@pytest.mark.slow
def test_nothing_is_named_where_nothing_moves() -> None:
    """Noise of people and of 50 constants: over 60 rankings, at most one is misled."""
    observer, misled = Observer.load(), 0
    for seed in range(60):
        chance = np.random.default_rng(seed)
        crowd = draw_people(200, seed)
        correct = np.clip(0.7 + 0.15 * chance.standard_normal(200), 0.0, 1.0)
        names = tuple(f"constant {k}" for k in range(50))
        draws = draws_of(chance.standard_normal((128, 50)), 0.7 + 0.06 * chance.standard_normal(128), *names)
        misled += bool(assumptions_of(correct, crowd, THENAR, observer, draws).moving)
    assert misled <= 1


def test_too_few_people_and_draws_say_nothing() -> None:
    chance = np.random.default_rng(1)
    values = chance.standard_normal((40, 1))
    crowd = draw_people(40, 0)
    found = assumptions_of(
        0.5 - 0.2 * np.log(crowd.contact_resistance),
        crowd,
        FINGERTIP,
        Observer.load(),
        draws_of(values, values[:, 0], "a"),
    )
    assert found.moving == ()
    assert found.site is not None and found.site["proportion_correct_at_twice_the_thresholds"] is None


def test_contact_is_named_with_what_it_does_to_everyone() -> None:
    """Proportion correct that falls with the logarithm of contact resistance alone."""
    crowd = draw_people(200, 3)
    noise = 0.01 * np.random.default_rng(0).standard_normal(200)
    found = assumptions_of(0.6 - 0.2 * np.log(crowd.contact_resistance) + noise, crowd, THENAR, Observer.load(), None)
    (only,) = found.moving
    assert (only.key, only.unit, only.source) == ("contact.resistance_m2K_per_W", "m²K/W", "people")
    assert only.low == pytest.approx(5.4e-4 / 1.3) and only.high == pytest.approx(5.4e-4 * 1.3)
    assert only.correct_at_low - only.correct_at_high == pytest.approx(0.4 * np.log(1.3), rel=0.1)


def test_a_constant_is_named_and_those_that_take_no_part_are_not() -> None:
    chance = np.random.default_rng(2)
    values = chance.standard_normal((128, 3))
    names = ("gain noise", "cold threshold on the forearm", "wrist cold")
    draws = draws_of(values, 0.6 + 0.05 * values.sum(axis=1), *names, idle=names[1:])
    crowd = draw_people(20, 0)
    found = assumptions_of(np.full(20, 0.6), crowd, THENAR, Observer.load(), draws)
    assert [each.name for each in found.moving] == ["gain noise"]
    assert found.moving[0].correct_at_high > found.moving[0].correct_at_low + 0.15


@pytest.mark.slow
def test_the_area_predicted_from_people_is_that_of_another_run() -> None:
    """Half and twice the area, from one ranking and from two more: within four points."""
    icons = load_library("six-icons")
    ranking = rank(icons, FINGERTIP, parameters=0)
    assert ranking.assumptions is not None
    area = next(each for each in ranking.assumptions.moving if each.key == "contact.area_cm2")
    for value, predicted in ((area.low, area.correct_at_low), (area.high, area.correct_at_high)):
        there = rank(icons, FINGERTIP.with_(**{"contact.area_cm2": value}), parameters=0)
        assert predicted == pytest.approx(there.proportion_correct, abs=0.04)


def test_a_ranking_keeps_its_assumptions() -> None:
    ranking = rank(load_library("six-icons"), FINGERTIP, people=4, parameters=0)
    found = ranking.to_dict()["assumptions"]
    assert found["moving"] == [] and found["site"]["nearest_recorded"] == "thenar"
    assert "module, driver and heat sink" in found["not_varied"]
