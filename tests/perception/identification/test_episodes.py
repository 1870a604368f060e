"""Remembered episodes of icons."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from thermicon.perception import Observer
from thermicon.perception.identification.confusion import name_directly
from thermicon.perception.identification.episodes import Episodes, EpisodesError, distance_shares, episode_distances
from thermicon.perception.kernels.episodes import MOST, RISE, USUAL

Trace = NDArray[np.float64]
DT = 0.01
CLOCK = DT * np.arange(1500)


def bump(start_s: float, peak: float, rise_s: float = 1.0, hold_s: float = 1.0) -> Trace:
    """Sensation that rises to a peak in d′, stays and falls."""
    return np.interp(
        CLOCK, start_s + np.array([0.0, rise_s, rise_s + hold_s, 2 * rise_s + hold_s]), [0.0, peak, peak, 0.0]
    )


NOTHING = np.zeros_like(CLOCK)


def episodes(*icons: tuple[Trace, Trace], observer: Observer, names: ArrayLike = "") -> Episodes:
    cold, warm = (np.stack([icon[k] for icon in icons])[None] for k in (0, 1))
    return Episodes.of(cold, warm, DT, observer, names)


def qualities(found: Episodes, icon: int = 0) -> str:
    return " ".join(each.channel for each in found.listed(0, icon))


def test_qualities_pauses_and_order(observer: Observer) -> None:
    icon = bump(1.0, 20.0), bump(8.0, 15.0)
    first, second = episodes(icon, observer=observer).listed(0, 0)
    assert (first.channel, second.channel) == ("cold", "warm")
    # ψ passes half the bar of 1 d′ on its way to 20 in 1 s
    assert first.start_s == pytest.approx(1.0 + 0.5 / 20.0, abs=0.011)
    assert first.pause_s == pytest.approx(first.start_s, abs=0.011)
    assert second.pause_s == pytest.approx(second.start_s - (4.0 - 0.5 / 20.0), abs=0.03)
    u = math.sqrt(math.expm1(20.0 / 12.0) / math.expm1(1.0 / 12.0))
    assert first.peak == pytest.approx(u, rel=1e-6)
    assert not first.cut


def test_deep_valleys_part(observer: Observer) -> None:
    # a gap that is bridged is also a valley of more than 1 d′
    gap = np.where((CLOCK > 2.5) & (CLOCK < 2.7), 0.0, bump(1.0, 20.0))
    assert qualities(episodes((gap, NOTHING), observer=observer)) == "cold cold"
    for floor, expected in ((19.1, "cold"), (18.9, "cold cold")):
        valley = np.maximum(bump(1.0, 20.0), bump(4.0, 20.0))
        valley = np.where((CLOCK > 2.0) & (CLOCK < 6.0), np.maximum(valley, floor), valley)
        assert qualities(episodes((valley, NOTHING), observer=observer)) == expected
    assert qualities(episodes((bump(1.0, 20.0) + bump(4.2, 20.0), NOTHING), observer=observer)) == "cold cold"


def test_the_stronger_quality_has_the_instant(observer: Observer) -> None:
    both = bump(1.0, 20.0, hold_s=6.0), bump(3.0, 30.0)
    assert qualities(episodes(both, observer=observer)) == "cold warm cold"
    assert qualities(episodes((both[0], bump(3.0, 10.0)), observer=observer)) == "cold"


def test_what_is_weak_or_short_is_not_remembered(observer: Observer) -> None:
    assert qualities(episodes((bump(1.0, 0.99), NOTHING), observer=observer)) == ""
    assert qualities(episodes((bump(1.0, 20.0, 0.05, 0.05), NOTHING), observer=observer)) == ""
    higher = replace(observer, episode_bar=2.0)
    faint = bump(1.0, 1.9), NOTHING
    assert (qualities(episodes(faint, observer=observer)), qualities(episodes(faint, observer=higher))) == ("cold", "")
    cautious = replace(observer, criterion=30.0)  # of speeded answers, not of memory
    assert qualities(episodes(faint, observer=cautious)) == "cold"


def test_pulses_on_a_plateau_are_counted_and_rise_from_their_valleys(observer: Observer) -> None:
    """Three peaks of 6, 5 and 6 d′ with valleys of 3 and 2: each part rises from the bar or from its valley."""
    course = np.interp(CLOCK, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], [0.0, 6.0, 3.0, 5.0, 2.0, 6.0, 0.0])
    found = episodes((course, NOTHING), observer=observer)
    assert found.counts.tolist() == [[3]]
    assert found.features[0, 0, :3, RISE] == pytest.approx([5.0, 2.0, 4.0], abs=1e-9)


def test_as_many_episodes_as_an_icon_has_and_no_more_than_the_bound(observer: Observer) -> None:
    def train(pulses: int) -> tuple[Trace, Trace]:
        sample = np.arange(CLOCK.size)
        return np.where((sample % 23 < 22) & (sample < 23 * pulses), 5.0, 0.0), NOTHING

    def felt(pulses: int) -> Episodes:
        return episodes(train(pulses), train(1), observer=observer, names=["many", "one"])

    for pulses in (2, USUAL, USUAL + 1, MOST):
        found = felt(pulses)
        assert found.counts.tolist() == [[pulses, 1]]
        assert found.features.shape[2] == max(pulses, USUAL)  # room for what is needed, not for all that is allowed
    said = r"many: felt as 65 separate episodes of cold and warmth; memory is computed for at most 64 of an icon: give"
    with pytest.raises(EpisodesError, match=said):
        felt(MOST + 1)


def test_an_episode_that_the_end_cuts_has_no_length(observer: Observer) -> None:
    long, longer = bump(1.0, 20.0, hold_s=30.0), bump(1.0, 20.0, hold_s=5.0)
    found = episodes((long, NOTHING), (longer, NOTHING), observer=observer)
    assert found.listed(0, 0)[0].cut
    assert episode_distances(found, found, observer, "episodes")[0, 0, 1] == pytest.approx(0.0, abs=1e-6)


def test_distances_follow_their_formulas(observer: Observer) -> None:
    """Two coolings of one shape that differ in intensity alone, and one that is not there."""
    strong, weak = bump(1.0, 20.0), bump(1.0, 12.0)
    found = episodes((strong, NOTHING), (weak, NOTHING), (NOTHING, NOTHING), observer=observer)
    apart = episode_distances(found, found, observer, "episodes")[0]
    assert apart == pytest.approx(apart.T)
    assert np.diagonal(apart) == pytest.approx(0.0)
    shares = distance_shares(found, 0, found, 1, observer, "episodes")
    assert sum(shares.values()) == pytest.approx(apart[0, 1] ** 2)
    other = Episodes(found.features.copy(), found.counts.copy())
    assert apart == pytest.approx(episode_distances(found, other, observer, "episodes")[0], abs=1e-12)
    one, other = (found.listed(0, k)[0] for k in (0, 1))
    b = 1.0 / math.expm1(1.0 / observer.a)
    noises = [(b + each.peak**2) / (observer.a * 2.0 * each.peak**2) for each in (one, other)]
    variance = observer.intensity_noise("cold") ** 2 + 0.5 * (noises[0] ** 2 + noises[1] ** 2)
    assert shares["intensity"] == pytest.approx(math.log(one.peak / other.peak) ** 2 / variance, rel=1e-6)
    assert shares["rate"] == pytest.approx(math.log(one.rate_per_s / other.rate_per_s) ** 2 / 0.09, rel=1e-6)
    lone = distance_shares(found, 1, found, 2, observer, "episodes")
    at_bar = math.sqrt(b * math.expm1(observer.episode_bar / observer.a))
    variance = observer.intensity_noise("cold") ** 2 + noises[1] ** 2
    assert lone["direction"] == pytest.approx(math.log(other.peak / at_bar) ** 2 / variance, rel=1e-6)


def test_a_miss_costs_no_more_than_the_rise(observer: Observer) -> None:
    """Of a bump on a high plateau it counts by how much it rises, not how intense it is."""
    plateau, raised = (
        np.interp(CLOCK, [0.0, 1.0, 9.0, 9.5, 10.0, 11.0], [0, 20, 20, 18.5, top, 0]) for top in (18.5, 20)
    )
    found = episodes((plateau, NOTHING), (raised, NOTHING), observer=observer)
    assert found.counts.tolist() == [[1, 2]]
    assert distance_shares(found, 0, found, 1, observer, "episodes")["direction"] == pytest.approx(1.5**2)
    assert episode_distances(found, found, observer, "naming")[0, 0, 1] < 1.6


def test_a_distance_grows_from_nothing_where_an_episode_appears(observer: Observer) -> None:
    faint = [(bump(1.0, peak), NOTHING) for peak in (0.98, 1.02, 1.2, 5.0)]
    found = episodes(*faint, (NOTHING, NOTHING), observer=observer)
    apart = episode_distances(found, found, observer, "episodes")[0, :, -1]
    assert apart[0] == 0.0
    assert (np.diff(apart[:-1]) > 0).all()
    assert apart[1] < 0.05


def test_noise_of_a_person_divides_distances(observer: Observer) -> None:
    cold = np.stack([[bump(1.0, 20.0, rise_s=rise) for rise in (0.5, 1.5)]] * 2)
    stacked = Episodes.of(cold, np.zeros_like(cold), DT, observer)
    once, twice = episode_distances(stacked, stacked, observer, "episodes", np.array([1.0, 2.0]))[:, 0, 1]
    assert once == pytest.approx(2.0 * twice, rel=0.02)  # sensory noise of intensity does not change


def test_naming_loses_faint_episodes_and_never_gains_one(observer: Observer) -> None:
    plain = bump(1.0, 20.0), NOTHING
    echoed = bump(1.0, 20.0), bump(8.0, 4.5)
    found = episodes(plain, echoed, observer=observer)
    assert found.counts.tolist() == [[1, 2]]
    named = name_directly(found, observer, lapse=0.0, samples=4000).probability[0]
    assert named[1, 0] > named[0, 1]


def test_icons_alike_share_their_names_and_lapses_are_any_name(observer: Observer) -> None:
    found = episodes(
        (bump(1.0, 20.0), NOTHING), (bump(1.0, 20.0), NOTHING), (NOTHING, bump(1.0, 20.0)), observer=observer
    )
    named = name_directly(found, observer, lapse=0.3, samples=500).probability[0]
    assert named[0, 0] == pytest.approx(named[0, 1])
    assert named[2, 2] == pytest.approx(0.7 + 0.1, abs=0.01)
    assert named.sum(axis=1) == pytest.approx(1.0)


def test_the_same_person_gets_the_same_noise_in_another_crowd(observer: Observer) -> None:
    icon = np.stack([[bump(1.0, 20.0), bump(1.0, 15.0)]] * 3)
    crowd = Episodes.of(icon, np.zeros_like(icon), DT, observer)
    last = Episodes.of(icon[2:], np.zeros_like(icon[2:]), DT, observer)
    whole = name_directly(crowd, observer, seed=4).probability
    assert np.array_equal(name_directly(last, observer, seed=4, first=2).probability[0], whole[2])
    assert not np.array_equal(whole[0], whole[1])


def test_share_of_the_scatter_of_ratings_moves_intensity_noise(observer: Observer) -> None:
    noises = [replace(observer, rated_share=share).intensity_noise("warm") for share in (0.0, 0.5, 1.0)]
    assert noises[0] == pytest.approx(0.30)
    assert noises[2] == pytest.approx(13.0 / (0.7 * 27.0))
    assert noises[1] == pytest.approx(math.sqrt(noises[0] * noises[2]))
