"""Thresholds and the quality that is reported where skin rests warmer or colder than in the experiments."""

import os

import numpy as np
import pytest

from thermicon.circuit import Rig, simulate
from thermicon.icons import parse
from thermicon.perception import Observer, perceive
from thermicon.perception.experiments.measure import Condition, Setting, logs_of
from thermicon.perception.observer.channels import Channel
from thermicon.perception.observer.mechanisms.adaptation import RESTS_C
from thermicon.perception.sensation.coverage import load_spans
from thermicon.perception.sensation.received import received

SITES = ("thenar", "forearm", "hand-dorsum", "fingertip")
SIZES_K = np.geomspace(0.005, 16.0, 60)
CONDITIONS = (("forced_choice", None, 1.0, 3.0), ("yes_no", None, 2.5, 1.5), ("limits", 12.0, 1.0, 0.0))


def thresholds_K(site: str, channel: Channel, rest_C: float) -> list[float]:
    """Forced choice, yes/no and limits of the nominal observer's people."""
    setting, found = Setting.of(Rig.load(site)), []
    for method, size_K, rate_K_per_s, hold_s in CONDITIONS:
        condition = Condition("threshold", method, channel, rest_C, size_K, rate_K_per_s, hold_s)
        logs = logs_of(setting.laboratory(Observer.load(), (0.0, 0.0)), setting, condition, SIZES_K)[0]
        found.append(float(np.exp(logs.mean())))
    return found


@pytest.mark.parametrize("site", ["thenar", *(pytest.param(site, marks=pytest.mark.slow) for site in SITES[1:])])
@pytest.mark.parametrize("channel", ["cold", "warm"])
def test_a_question_with_more_haste_needs_a_larger_change_wherever_skin_rests(site: str, channel: Channel) -> None:
    for rest_C in (24.0, 28.0, 30.0, 32.0, 34.0, 36.0, 40.0):
        forced_choice, yes_no, limits = thresholds_K(site, channel, rest_C)
        assert forced_choice < yes_no < limits, rest_C


@pytest.mark.parametrize("channel", ["cold", "warm"])
def test_thresholds_neither_jump_nor_grow_where_no_experiment_rested(channel: Channel) -> None:
    """Receptors are a little warmer than the skin over them, so that the ends of the evidence lie a little lower."""
    cool, end, warm, warmer = (np.log(thresholds_K("thenar", channel, rest_C)) for rest_C in (28.0, 30.0, 34.0, 35.0))
    assert max(np.abs(end - cool).max(), np.abs(warmer - warm).max()) < np.log(1.5)
    assert thresholds_K("thenar", channel, 25.0) == pytest.approx(np.exp(cool), rel=1e-3)
    assert thresholds_K("thenar", channel, 40.0) == pytest.approx(np.exp(warmer), rel=1e-3)


def test_receptors_rest_where_they_did_in_the_experiments() -> None:
    """Under skin at the ends of the span, on every shipped rig; outside it the nearer end is assumed."""
    rest, observer = load_spans()["rest"], Observer.load()
    for site in SITES:
        for skin_C in (rest.low, rest.high):
            icons = parse(f"cue 1; set s {{ control skin; baseline {skin_C} °C }}; icon a {{ hold for 1 s }}")
            depths = received(simulate(icons["a"], Rig.load(site)), observer)
            assert all(RESTS_C[0] <= float(course[0]) <= RESTS_C[1] for course in depths), (site, skin_C)
    assert (rest.low, rest.high + 0.25) == RESTS_C


def quality(site: str, rest_C: float, way: str, size_K: float) -> str | None:
    rested = f"cue 1; set s {{ control display; baseline {rest_C} °C }}"
    icons = parse(f"{rested}; icon a {{ {way} by {size_K} °C at 1 °C/s; hold for 8 s }}")
    return perceive(simulate(icons["a"], Rig.load(site), tail_s=0.5)).channel


@pytest.mark.parametrize("way", ["warm", "cool"])
def test_warming_is_never_felt_by_cold_nor_cooling_by_warmth(way: str) -> None:
    """At rests and sizes drawn by chance (another seed: THERMICON_SEED)."""
    chance, wrong = np.random.default_rng(int(os.environ.get("THERMICON_SEED", "3"))), {"warm": "cold", "cool": "warm"}
    for _ in range(20):
        site, rest_C, size_K = chance.choice(SITES), chance.uniform(24.0, 40.0), chance.uniform(0.3, 6.0)
        assert quality(str(site), round(rest_C, 2), way, round(size_K, 2)) != wrong[way], (site, rest_C, size_K)


def test_a_large_warming_of_cool_skin_is_felt_by_warmth() -> None:
    assert quality("thenar", 28.0, "warm", 4.0) == "warm"
    assert quality("thenar", 28.0, "cool", 2.0) == "cold"
