import json
import math
from typing import Any

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.perception import Ranking, rank


@pytest.fixture(scope="module")
def rig() -> Rig:
    return Rig.load("thenar")


@pytest.fixture(scope="module")
def ranking(rig: Rig) -> Ranking:
    return rank(load_library("six-icons"), rig, people=8, seed=2, parameters=16)


def test_intervals_hold_the_prediction_and_are_wide(ranking: Ranking) -> None:
    found = ranking.parameter_intervals
    assert found is not None
    assert found.draws == 16
    assert "slope of sensation" in found.parameters
    for (low, high), value, most in (
        (found.proportion_correct, ranking.proportion_correct, 1.0),
        (found.information_bits, ranking.information_bits, math.log2(6)),
    ):
        assert 0.0 <= low < value < high <= most
        assert high - low > 0.02
    assert len(found.detected) == 6
    for icon, (low, high) in zip(ranking.icons, found.detected, strict=True):
        assert low <= icon.detected_probability <= high
    assert repr(found).startswith("ParameterIntervals(16 draws of ")
    assert repr(found).endswith(" bits)")


def test_they_are_in_the_file(ranking: Ranking) -> None:
    held = json.loads(ranking.to_json())
    found = ranking.parameter_intervals
    assert found is not None
    assert held["set"]["proportion_correct_parameter_interval"] == list(found.proportion_correct)
    assert held["set"]["information_bits_parameter_interval"] == list(found.information_bits)
    assert held["set"]["parameter_draws"] == 16
    assert held["icons"][0]["detected_parameter_interval"] == list(found.detected[0])


def test_same_arguments_same_intervals(ranking: Ranking, rig: Rig) -> None:
    again = rank(load_library("six-icons"), rig, people=8, seed=2, parameters=16)
    assert again.to_json() == ranking.to_json()
    other = rank(load_library("six-icons"), rig, people=8, seed=2, parameters=0)
    assert other.parameter_intervals is None
    assert np.array_equal(other.confusion, ranking.confusion)  # the draws leave the prediction alone
    held: Any = json.loads(other.to_json())
    assert held["set"]["proportion_correct_parameter_interval"] is None
    assert held["set"]["parameter_draws"] is None
    assert held["icons"][0]["detected_parameter_interval"] is None


def test_faint_icons_have_wide_intervals_of_detection(rig: Rig) -> None:
    from thermicon.icons import parse

    text = "cue 1\nset s { control skin; baseline 32 °C }\nicon faint { cool by 0.3 °C at 0.3 °C/s; hold for 1 s }"
    found = rank(parse(text), rig, people=8, parameters=16).parameter_intervals
    assert found is not None
    ((low, high),) = found.detected
    assert 0.0 <= low < high <= 1.0
    assert high - low > 0.1
    assert found.information_bits == (0.0, 0.0)


def test_one_draw_is_refused(rig: Rig) -> None:
    with pytest.raises(ValueError, match=r"needs at least two draws of the parameters, or 0 for none, not 1"):
        rank(load_library("six-icons"), rig, people=1, parameters=1)
