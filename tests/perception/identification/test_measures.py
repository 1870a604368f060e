import math

import numpy as np
import pytest

from thermicon.perception import information_bits
from thermicon.perception.identification.laboratory_draws import Uncertain, latin, memory_parameters
from thermicon.perception.identification.measures import plugin_bits, proportion_correct


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


def test_what_of_memory_is_uncertain_depends_on_the_norm() -> None:
    common = {"share of the scatter of ratings", "bar of an episode", "memory noise (episodes)"}
    assert {each.name for each in memory_parameters("episodes")} == common
    assert {each.name for each in memory_parameters("naming")} == common | {"cost of a missing episode"}


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
