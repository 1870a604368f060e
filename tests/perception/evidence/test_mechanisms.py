"""The mechanisms of the likelihood one by one, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.experiments.laboratory import Laboratory, samples_of
from thermicon.perception.observer.parts import Transducer, conduction_s
from thermicon.perception.sensation.sensation import area_factor, summed_area_cm2


@pytest.fixture(scope="module")
def laboratory() -> Laboratory:
    posterior = Posterior()
    return Laboratory(posterior.values(np.zeros(len(posterior.priors))))


@pytest.mark.parametrize(("a", "p"), [(12.0, 1.0), (6.0, 2.0), (30.0, 0.7)])
def test_transducer_is_one_at_threshold_a_power_below_and_a_logarithm_above(a: float, p: float) -> None:
    transducer = Transducer(a, p)
    assert float(transducer.psi(1.0)) == pytest.approx(1.0)
    low = float(transducer.psi(2e-4) / transducer.psi(1e-4))
    assert math.log2(low) == pytest.approx(p, abs=0.01)
    high = float(transducer.psi(2e9) - transducer.psi(1e9))
    assert high == pytest.approx(a * p * math.log(2.0), rel=1e-3)
    steps = transducer.difference_threshold(np.array([3.0]))
    assert float((transducer.psi(3.0 + steps) - transducer.psi(3.0))[0]) == pytest.approx(1.0)


def test_summation_has_two_ends() -> None:
    assert summed_area_cm2(0.001) == pytest.approx(summed_area_cm2(0.0001), rel=0.2)
    assert area_factor(400.0, 225.0, 0.9) < 1.2 < 1.4 < area_factor(225.0, 100.0, 0.9)
    assert area_factor(18000.0, 9.0, 0.9) < 20.0 < (18000.0 / 9.0) ** 0.9
    middle = math.log(area_factor(20.0, 10.0, 0.7)) / math.log(2.0)
    assert middle == pytest.approx(0.7, abs=0.12)
    with pytest.raises(ValueError, match="above 0 cm²"):
        summed_area_cm2(0.0)


def test_the_spine_adds_to_the_nerve() -> None:
    assert conduction_s("cold", 6.0, 0.7) == pytest.approx(0.7 / 6.0 + 0.225 / 12.0)
    assert conduction_s("warm", 1.0, [0.7, 0.4]) == pytest.approx([0.7 + 0.225 / 2.0, 0.4 + 0.225 / 2.0])


def test_a_later_decade_raises_thresholds(laboratory: Laboratory) -> None:
    young, old = (laboratory.gain("cold", 9.0, "E3", "hand", years) for years in (25.0, 65.0))
    lost = laboratory.values["cold sensitivity lost per decade"]
    assert math.log(young / old) == pytest.approx(4.0 * lost)


def test_answers_come_later_by_conduction_and_decision(laboratory: Laboratory) -> None:
    corners = ((14 / 4.81, 14.0),)
    drive, samples = laboratory.drive("forearm", "warm", 31.0, corners, 6.0), samples_of(corners, 6.0)
    gain = laboratory.gain("warm", 9.8, "E1", "forearm", 28.0)
    crossed, _ = laboratory.passages(drive, samples, "warm", gain, laboratory.values["criterion of speeded answers"])
    simple = laboratory.answers_s(drive, samples, "warm", gain, site="forearm")
    choice = laboratory.answers_s(drive, samples, "warm", gain, site="forearm", choice=True)
    felt = np.isfinite(crossed)
    assert (simple[felt] > crossed[felt] + laboratory.delay_s("warm", "forearm")).all()
    assert (choice[felt] > simple[felt]).all()
