"""Experiments of which an abstract is known: what the observer answers follows from what they ask about."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from thermicon.perception import Observer
from thermicon.perception.experiments.abstracts import cool_skin, matched_fingers, order_of_sites, warm_skin
from thermicon.perception.experiments.laboratory import Laboratory
from thermicon.perception.experiments.tasks import Key
from thermicon.perception.observer.channels import CHANNELS
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.mechanisms.bounds import NO_LIMIT_C
from thermicon.perception.observer.priors import LABORATORIES

Experiment = Callable[[Laboratory], Iterator[tuple[Key, float]]]


def ratios(experiment: Experiment, observer: Observer) -> dict[tuple[str, str], float]:
    """Ratios by statistic and channel, in a laboratory that does not differ from others."""
    laboratory = Laboratory.of(observer, dict.fromkeys(LABORATORIES, Both(0.0, 0.0)))
    return {key[1:]: math.exp(log) for key, log in experiment(laboratory)}


def with_corneum(share: float) -> dict[tuple[str, str], float]:
    return ratios(order_of_sites, replace(Observer.load(), corneum_share=share))


@pytest.mark.parametrize("exponent", [0.0, 0.4, 0.9])
def test_three_fingers_match_two_by_the_exponent_of_summation(exponent: float) -> None:
    """Half as much contact again needs less change; adaptation takes more off the larger change of two."""
    observer = replace(Observer.load(), area_exponent=Both(exponent, exponent), limit_C=NO_LIMIT_C)
    matched = ratios(matched_fingers, observer)
    assert list(matched.values()) == pytest.approx(2 * [(2.0 / 3.0) ** exponent], rel=0.06)


def test_fingers_are_less_sensitive_than_the_palm_as_far_as_their_thicker_skin_counts() -> None:
    palms = "ratio_limits_palm_over_finger"
    thin, thick = with_corneum(0.05), with_corneum(1.0)
    for channel in CHANNELS:
        assert thick[palms, channel] < 0.97 < thin[palms, channel]
        # The back of the hand, whose skin is thin, is the other way round.
        assert thick["ratio_limits_palm_over_dorsum", channel] > thin["ratio_limits_palm_over_dorsum", channel]


def test_cool_skin_widens_what_is_neither_cool_nor_warm_by_the_limits_of_quality_alone() -> None:
    person = Observer.load()
    ((_, shipped),) = ratios(cool_skin, person).items()
    ((_, unlimited),) = ratios(cool_skin, replace(person, limit_C=NO_LIMIT_C)).items()
    assert unlimited == pytest.approx(1.0, abs=0.03)
    assert shipped > 1.1


def test_adapting_to_40_degrees_changes_nothing_over_36() -> None:
    """Published as better: an observer who rests as at the nearer end of the evidence cannot follow."""
    assert list(ratios(warm_skin, Observer.load()).values()) == pytest.approx([1.0], abs=1e-6)
