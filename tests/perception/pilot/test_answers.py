"""Scores of observed answers: closed forms, bias, and intervals that cover."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermicon.perception.identification.measures import information_bits
from thermicon.perception.pilot.trials import Trials, plugin_information, score_person, score_pooled, wilson

CHANCES = np.array([[0.7, 0.2, 0.1], [0.2, 0.7, 0.1], [0.1, 0.2, 0.7]])


def drawn(rng: np.random.Generator, participants: int, times: int) -> Trials:
    counts = rng.multinomial(times, CHANCES, size=(participants, 3)).astype(float)
    return Trials(("a", "b", "c"), tuple(f"P{k}" for k in range(participants)), counts)


def test_plugin_bits_are_those_of_the_matrix_with_rows_alike() -> None:
    bits, bias = plugin_information(CHANCES * 1000)
    assert bits == pytest.approx(float(information_bits(CHANCES)), abs=1e-12)
    assert bias == pytest.approx((9 - 3 - 3 + 1) / (2 * 3000 * math.log(2)))


def test_the_correction_takes_much_of_the_bias_away() -> None:
    rng, truth = np.random.default_rng(0), float(information_bits(CHANCES))
    scores = [score_pooled(drawn(rng, 1, 16)) for _ in range(300)]
    plugin = np.mean([score.bits_plugin for score in scores]) - truth
    corrected = np.mean([score.bits_plugin - score.bits_bias for score in scores]) - truth
    assert plugin > 0.05
    assert abs(corrected) < 0.5 * plugin


def test_intervals_over_participants_cover() -> None:
    rng, truth = np.random.default_rng(1), float(information_bits(CHANCES))
    scores = [score_pooled(drawn(rng, 8, 12)) for _ in range(200)]
    covered = [low <= truth <= high for low, high in (score.bits_interval for score in scores)]
    correct = [low <= 0.7 <= high for low, high in (score.proportion_interval for score in scores)]
    assert 0.9 <= np.mean(covered) <= 1.0
    assert 0.9 <= np.mean(correct) <= 0.99


def test_half_widths_are_wilsons_and_the_jackknifes() -> None:
    assert wilson(18.0, 20.0) == pytest.approx((0.69897, 0.97214), abs=1e-4)
    hits = np.array([9.0, 9.0, 9.0, 4.0, 4.0, 4.0])
    counts = np.zeros((6, 2, 2))
    counts[:, 0, 0], counts[:, 0, 1] = hits, 10.0 - hits
    without = (39.0 - hits) / 50.0
    half = 2.570582 * math.sqrt(5.0 / 6.0 * float(np.square(without - without.mean()).sum()))
    found = score_pooled(Trials(("a", "b"), tuple("PQRSTU"), counts)).proportion_interval
    assert found == pytest.approx((0.65 - half, 0.65 + half), abs=1e-6)
    # Over trials: leaving out one of n answers, n times.
    alone = score_person(drawn(np.random.default_rng(5), 1, 20), 0)
    counts = drawn(np.random.default_rng(5), 1, 20).counts[0]
    cells = [(a, b) for a, b in np.argwhere(counts > 0).tolist() for _ in range(int(counts[a, b]))]
    left = []
    for cell in cells:
        fewer = counts.copy()
        fewer[tuple(cell)] -= 1.0
        bits, bias = plugin_information(fewer)
        left.append(bits - bias)
    half = 1.96 * math.sqrt((len(left) - 1) / len(left) * float(np.square(np.array(left) - np.mean(left)).sum()))
    assert alone.bits_interval == pytest.approx((alone.bits - half, alone.bits + half), abs=1e-4)


def test_participants_who_happen_to_be_alike_leave_an_interval() -> None:
    alike = np.zeros((2, 3, 3))
    alike[:, range(3), range(3)] = 4.0
    alike[:, 0, 0], alike[:, 0, 1] = 2.0, 2.0
    score = score_pooled(Trials(("a", "b", "c"), ("P1", "P2"), alike))
    assert score.proportion_correct == pytest.approx(20 / 24)
    assert score.proportion_interval == wilson(20.0, 24.0)
    assert score.bits_interval[1] - score.bits_interval[0] > 0.3


def test_answers_without_a_slip_leave_an_interval() -> None:
    right = Trials(("a", "b", "c"), ("P1", "P2", "P3"), np.stack([np.eye(3)] * 3))
    for score in (score_pooled(right), score_person(right, 0)):
        assert score.proportion_interval == wilson(float(score.trials), float(score.trials))
        assert (score.bits, score.bits_interval[1]) == pytest.approx((math.log2(3), math.log2(3)))
    few, many = score_pooled(right), score_pooled(Trials(right.icons, right.participants, 20 * right.counts))
    assert few.bits_interval[0] < 1.2 < 1.4 < many.bits_interval[0] < many.bits


def test_one_participant_has_an_interval_over_trials_and_one_trial_says_nothing() -> None:
    rng = np.random.default_rng(2)
    alone = drawn(rng, 1, 20)
    assert score_person(alone, 0).bits_interval == score_pooled(alone).bits_interval
    counts = np.zeros((1, 3, 3))
    counts[0, 1, 1] = 1.0
    single = score_person(Trials(("a", "b", "c"), ("P1",), counts), 0)
    assert single.bits_interval == (0.0, math.log2(3))
    assert single.proportion_interval == wilson(1.0, 1.0)


def test_bits_stay_within_what_the_set_can_carry() -> None:
    perfect = score_person(Trials(("a", "b", "c"), ("P1",), 4.0 * np.eye(3)[None]), 0)
    assert perfect.bits == pytest.approx(math.log2(3))
    assert perfect.bits_interval[0] <= perfect.bits_interval[1] <= math.log2(3)
    assert perfect.to_dict()["median_time_s"] is None


@pytest.mark.parametrize(
    ("counts", "said"),
    [
        (np.zeros((1, 2, 2)), "every participant needs at least one answer"),
        (np.full((1, 2, 2), 0.5), "whole numbers of 0 or more"),
        (np.ones((1, 3, 3)), "must have shape"),
    ],
)
def test_counts_that_cannot_be_are_refused(counts: np.ndarray, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Trials(("a", "b"), ("P1",), counts)
