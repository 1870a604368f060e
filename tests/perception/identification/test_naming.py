"""Naming of trials beside a Monte Carlo written out."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from thermicon.perception import Observer
from thermicon.perception.identification.confusion import name_directly
from thermicon.perception.identification.episodes import Episodes, episode_distances
from thermicon.perception.identification.surfaces import name_apart
from thermicon.perception.identification.tracks import Tracks
from thermicon.perception.observer.constants import Both

DT = 0.01
CLOCK = DT * np.arange(1800)


def pulses(pause_s: float = 2.0, hold_s: float = 1.0, rise_s: float = 0.5) -> np.ndarray[Any, Any]:
    """Sensation of two strong pulses."""
    one = np.cumsum([1.0, rise_s, hold_s, rise_s])
    corners = [*one, *(one + one[-1] - 1.0 + pause_s)]
    return np.interp(CLOCK, corners, 2 * [0.0, 120.0, 120.0, 0.0])


USUAL = pulses()
OTHERS = {"pause": pulses(pause_s=2.5), "length": pulses(hold_s=1.3), "rate": pulses(rise_s=0.65, hold_s=0.85)}


def remembered(felt: Episodes, icon: int) -> Any:
    """Logs of rate, length and pause of each pulse."""
    listed = felt.listed(0, icon)
    return np.log([[each.rate_per_s, each.length_s, each.pause_s + 0.5] for each in listed])


@pytest.mark.parametrize("louder", [1.0, 2.0])
@pytest.mark.parametrize("differs", OTHERS)
def test_the_icon_before_blurs_every_feature(observer: Observer, differs: str, louder: float) -> None:
    """Every feature is felt with noise, more of it after some icons, and named after the nearer of two icons."""
    cold = np.stack([USUAL, OTHERS[differs]])[None]
    felt = Episodes.of(cold, np.zeros_like(cold), DT, observer)
    named = name_directly(felt, observer, louder=[[louder] * 2], lapse=0.0, samples=8000).probability[0]
    one, other = (remembered(felt, icon) for icon in (0, 1))
    noise = np.random.default_rng(0).normal(0.0, louder * observer.timing_noise, (100_000, *one.shape))
    off, less = (np.square(one + noise - icon).sum(axis=(1, 2)) for icon in (one, other))
    wrong = float((less < off).mean())
    assert 0.02 < wrong < 0.45
    assert [named[0, 1], named[1, 0]] == pytest.approx([wrong, wrong], abs=0.02)


def test_costs_of_a_name_add_over_surfaces(observer: Observer) -> None:
    cold = np.stack([USUAL, OTHERS["pause"], OTHERS["length"]])[None]
    felt = Episodes.of(cold, np.zeros_like(cold), DT, observer)
    played, person = np.array([[0, 1], [0, 2]]), np.ones(1)
    tracks = Tracks(("a", "b"), (), ("left", "right"), played, ranks=(0, 1))
    named = name_apart(felt, tracks, observer, memory=person, lapse=0.0, seed=1, samples=8000).probability[0]
    costs = np.zeros((2, 100_000))
    for seed, (own, other) in enumerate(played):
        one, two = remembered(felt, own), remembered(felt, other)
        noise = np.random.default_rng(seed).normal(0.0, observer.timing_noise, (100_000, *one.shape))
        costs += [np.square(one + noise - icon).sum(axis=(1, 2)) for icon in (one, two)]
    wrong = float((costs[1] < costs[0]).mean())
    assert 0.02 < wrong < 0.45
    assert [named[0, 1], named[1, 0]] == pytest.approx([wrong, wrong], abs=0.02)


def test_a_scale_of_ratings_may_have_any_unit(observer: Observer) -> None:
    """The same ratings in points of 1000: faint pulses are missed and named as before."""
    cold = np.stack([USUAL, 0.02 * OTHERS["pause"], 0.05 * OTHERS["rate"]])[None]
    felt = Episodes.of(cold, np.zeros_like(cold), DT, observer)
    other = replace(
        observer,
        rating_at_threshold=Both(*(10.0 * each for each in observer.rating_at_threshold)),
        mean_rating=Both(*(10.0 * each for each in observer.mean_rating)),
        rating_scatter=10.0 * observer.rating_scatter,
    )
    apart, again = (episode_distances(felt, felt, each, "naming") for each in (observer, other))
    assert felt.counts.tolist() == [[2, 2, 2]] and again == pytest.approx(apart, rel=1e-9)
    named, anew = (name_directly(felt, each, samples=400).probability for each in (observer, other))
    assert anew == pytest.approx(named, abs=0.005)
