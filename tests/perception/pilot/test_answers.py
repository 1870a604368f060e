"""Scores of observed answers."""

import math

import numpy as np
import pytest

from thermicon.perception.identification.measures import information_bits
from thermicon.perception.pilot.trials import Trials, plugin_information, score, wilson

CHANCES = np.array([[0.7, 0.2, 0.1], [0.2, 0.7, 0.1], [0.1, 0.2, 0.7]])


def test_plugin_bits_are_those_of_the_matrix_with_rows_alike() -> None:
    bits, bias = plugin_information(CHANCES * 1000)
    assert bits == pytest.approx(float(information_bits(CHANCES)), abs=1e-12)
    assert bias == pytest.approx((9 - 3 - 3 + 1) / (2 * 3000 * math.log(2)))


def test_half_widths_are_wilsons_and_the_jackknifes() -> None:
    assert wilson(18.0, 20.0) == pytest.approx((0.69897, 0.97214), abs=1e-4)
    hits = np.array([9.0, 9.0, 9.0, 4.0, 4.0, 4.0])
    counts = np.zeros((6, 2, 2))
    counts[:, 0, 0], counts[:, 0, 1] = hits, 10.0 - hits
    without = (39.0 - hits) / 50.0
    half = 2.570582 * math.sqrt(5.0 / 6.0 * float(np.square(without - without.mean()).sum()))
    assert score("all", counts).proportion_correct_interval == pytest.approx((0.65 - half, 0.65 + half), abs=1e-6)


@pytest.mark.parametrize("slips", [2.0, 0.0])
def test_participants_who_happen_to_be_alike_leave_an_interval(slips: float) -> None:
    alike = np.zeros((2, 3, 3))
    alike[:, range(3), range(3)] = 4.0
    alike[:, 0, 0], alike[:, 0, 1] = 4.0 - slips, slips
    found = score("all", alike)
    assert (found.trials, found.proportion_correct) == (24, pytest.approx(1.0 - slips / 12))
    assert found.proportion_correct_interval == pytest.approx(wilson(24.0 - 2.0 * slips, 24.0))
    assert score("P1", alike[:1]).proportion_correct_interval == wilson(12.0 - slips, 12.0)


def test_bits_stay_within_what_the_set_can_carry() -> None:
    assert score("P1", 4.0 * np.eye(3)[None]).information_bits == pytest.approx(math.log2(3))
    assert score("P1", np.ones((1, 2, 2))).information_bits == 0.0  # less than their bias


@pytest.mark.parametrize(
    ("counts", "said"),
    [
        (np.zeros((1, 2, 2)), "every participant needs at least one trial"),
        (np.full((1, 2, 2), 0.5), "whole numbers of 0 or more"),
        (np.ones((1, 3, 3)), "must have shape"),
    ],
)
def test_counts_that_cannot_be_are_refused(counts: np.ndarray, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Trials(("a", "b"), ("P1",), counts)
