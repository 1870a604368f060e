import math

import numpy as np
import pytest

from thermicon.perception import Observer, Percept, percept_distance
from thermicon.perception.identification.distance import (
    identification_dprime,
    memory_from_task,
    percept_distances,
    sensory_noise,
    smooth,
)
from thermicon.perception.observer.observer import check_norm


def percept(cold: object, dt: float = 0.01) -> Percept:
    psi = np.asarray(cold, dtype=np.float64)
    return Percept(psi, np.zeros_like(psi), dt, None, None, 0.0)


def test_smoothing_keeps_area_and_has_the_stated_sd() -> None:
    pulse = np.zeros(4001)
    pulse[2000] = 1.0
    blurred = smooth(pulse, 0.01, 0.2)
    time = (np.arange(4001) - 2000) * 0.01
    assert blurred.sum() == pytest.approx(1.0, abs=1e-12)
    assert math.sqrt(float((blurred * time**2).sum())) == pytest.approx(0.2, rel=1e-3)
    assert blurred == pytest.approx(blurred[::-1], abs=1e-12)


def test_smoothing_holds_the_ends() -> None:
    assert smooth(np.full(30, 5.0), 0.01, 0.2) == pytest.approx(5.0, abs=1e-12)
    ramp = np.arange(2000.0)
    assert smooth(ramp, 0.01, 0.2)[1000] == pytest.approx(1000.0, abs=1e-6)
    assert np.array_equal(smooth(ramp, 0.01, 0.0), ramp)


def test_norms_of_a_constant_difference(observer: Observer) -> None:
    cold = np.stack([np.full(1001, 3.0), np.zeros(1001)])[None]
    warm = np.stack([np.zeros(1001), np.full(1001, 4.0)])[None]
    apart = percept_distances(cold, warm, 0.01, observer)
    assert apart["max"][0, 0, 1] == pytest.approx(5.0, rel=1e-9)
    assert apart["rms"][0, 1, 0] == pytest.approx(5.0, rel=1e-9)
    assert apart["integral"][0, 0, 1] == pytest.approx(5.0 * 10.01, rel=1e-9)
    assert apart["max"][0, 1, 1] == 0.0


def test_a_shorter_percept_is_held_at_its_end(observer: Observer) -> None:
    long, short = percept(np.full(2000, 7.0)), percept(np.full(500, 7.0))
    assert percept_distance(long, short, observer) == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(ValueError, match=r"on clocks of 0.01 s and 0.02 s: simulate all at one rate"):
        percept_distance(long, percept(np.zeros(9), 0.02), observer)


def test_dprime_from_memory(observer: Observer) -> None:
    noise = math.hypot(1.0, 2 * 12.0 * 0.30 * 1.5)
    assert identification_dprime(9.0, observer, "max", 18.0, 1.5) == pytest.approx(9.0 / noise)
    assert sensory_noise("max", observer, 18.0) == 1.0
    assert sensory_noise("integral", observer, 15.0) == pytest.approx(3.0)


def test_memory_noise_from_a_task_gives_the_task_back(observer: Observer) -> None:
    from dataclasses import replace
    from statistics import NormalDist

    noise = memory_from_task(8.6, 0.75, observer, "max", 18.0)
    told = identification_dprime(8.6, replace(observer, memory_max=noise), "max", 18.0)
    assert NormalDist().cdf(float(told) / math.sqrt(2)) == pytest.approx(0.75, abs=1e-12)


def test_messages(observer: Observer) -> None:
    with pytest.raises(
        ValueError, match=r"there is no norm 'mean': choose one of episodes, naming, max, rms, integral"
    ):
        check_norm("mean")
    with pytest.raises(ValueError, match=r"must have shape \(people, icons, n_time\)"):
        percept_distances(np.zeros((2, 9)), np.zeros((2, 9)), 0.01, observer)
