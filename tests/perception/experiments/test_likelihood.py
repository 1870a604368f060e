"""Rows of the likelihood against written-out equations.

The likelihood plays sums of ramps in few steps. What is compared is one median person, young, of a laboratory without
an offset.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.perception.survival import answered
from thermicon.circuit import Rig
from thermicon.perception import Observer
from thermicon.perception.evidence.results import load_constants
from thermicon.perception.evidence.rows import load_evidence
from thermicon.perception.experiments import published as experiments
from thermicon.perception.experiments.laboratory import Laboratory
from thermicon.perception.experiments.published import PEAKS_C, TWO_STRIPS_CM2, Predictions
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.priors import LABORATORIES
from thermicon.perception.sensation.bench import Bench
from thermicon.perception.sensation.detection import time_of

VALUES = {each.name: each.value for each in load_constants()}


@pytest.fixture(scope="module")
def predicted() -> Predictions:
    nobody = Both(1e-9, 1e-9)
    alike = {"sensitivity_between": nobody, "lost_per_decade": nobody, "decision_between": 1e-9}
    person = replace(Observer.from_values(VALUES), criterion_between=1e-9, **alike)
    laboratory = Laboratory.of(person, dict.fromkeys(LABORATORIES, nobody))
    with np.errstate(divide="ignore", invalid="ignore"):  # correlations of people who do not differ
        return experiments.predict(laboratory)


@pytest.fixture(scope="module")
def person() -> Observer:
    return Observer.load()


def bench(area_cm2: float, baseline_C: float) -> Bench:
    """A thermode that is where it is told, on the forearm with the contact and the living skin that were inferred."""
    rig = Rig.load("tcs2")
    changes: dict[str, float] = {
        "contact.area_cm2": area_cm2,
        "contact.resistance_m2K_per_W": VALUES["contact resistance of a thermode"],
        "skin.depth_from": "stratum corneum",
        "skin.cold_receptor_mm": VALUES["cold receptor depth"],
        "skin.warm_receptor_mm": VALUES["warm receptor depth"],
        "thermode.lag_s": 0.0,
        "thermode.resolution_K": 0.0,
    }
    living = VALUES["effusivity of living skin"]
    for k, layer in enumerate(rig.skin.layers[1:], start=1):
        changes[f"skin.layer.{k}.conductivity_W_per_mK"] = living * layer.conductivity_W_per_mK
        changes[f"skin.layer.{k}.heat_capacity_J_per_kgK"] = living * layer.heat_capacity_J_per_kgK
    return Bench(rig.with_(**changes), baseline_C, "display")


def answers(
    cold: np.ndarray, warm: np.ndarray, dt_s: float, person: Observer, caution: float = 1.0, choice_s: float = 0.0
) -> Callable[[float], float]:
    """The time by which a share of trials is answered."""
    path = person.path_m("forearm")
    late = float(person.delay_s("cold", path)), float(person.delay_s("warm", path))
    time, given = answered(cold, warm, dt_s, person, late, person.decision_s + choice_s, caution)
    return lambda share: time_of(given, time, share)


def test_cooling_after_warmth(predicted: Predictions, person: Observer) -> None:
    """E5: falls at the press within 3 %, shares called warm within 0.001, for every peak."""
    on, lowest = bench(TWO_STRIPS_CM2, 32.0), predicted["E5", "cold_change_at_report_peak1_age_lt36", "cold"]
    for level, peak in enumerate(PEAKS_C, start=1):
        rise = peak - 32.0
        start_s = round(2.0 * rise / 2.5 + 1.0, 2)
        course = (
            f"warm by {rise:.9g} K at 2.5 K/s; hold for 0.75 s; return at 2.5 K/s; "
            f"hold for {start_s - 2.0 * rise / 2.5 - 0.75:.9g} s; cool by 14 K at 1 K/s"
        )
        stimulus = on.play([course], start_s + 15.0)
        cold, warm = (psi[0] for psi in stimulus.felt(person))
        start = round(start_s / stimulus.dt_s)
        falling = cold[start:].copy()
        falling[0] = 0.0  # what the pulse leaves of cold when the fall begins is part of it
        found = answers(falling, np.zeros_like(falling), stimulus.dt_s, person, VALUES["caution after a pre-pulse"])
        more = 0.0 if level == 1 else predicted["E5", f"ratio_to_lowest_peak{level}_age_lt36", "cold"]
        assert found(0.5) == pytest.approx(math.exp(lowest + more), rel=0.03)
        wrong, lingering = VALUES["wrong labels"], VALUES["warmth that lingers"] * float(warm[:start].max())
        share = predicted["E5", f"share_called_warm_peak{level}_age_lt36", "cold"]
        assert wrong + (0.5 - wrong) * -math.expm1(-lingering) == pytest.approx(share, abs=0.002)


def test_the_lag_of_a_thermode_is_that_of_the_published_one() -> None:
    """E7 at 2.5 K/s: within 0.02 s of the offset-free lag and of the best shift; reading errors are not modelled."""
    known = load_evidence()
    stimulus = Bench(Rig.load("tcs2"), 30.0, "display").play(["warm by 10 K at 2.5 K/s; return at 2.5 K/s"], 10.0)
    time, surface = stimulus.time_s, stimulus.surface_C("display")[0]

    def told(at: np.ndarray) -> np.ndarray:
        return np.interp(at, [0.0, 4.0, 8.0], [30.0, 40.0, 30.0])

    behind = told(time) - surface
    rising, falling = (float(np.abs(behind[(time >= end - 2.0) & (time <= end)]).mean()) / 2.5 for end in (4.0, 8.0))
    assert rising == pytest.approx(falling, abs=0.005)
    lag = known.find("E7", "lag_offset_free_2.5K_per_s", "both").value
    assert 0.5 * (rising + falling) == pytest.approx(lag, abs=0.02)
    shifts = np.arange(0.0, 0.6, 0.005)
    left = [float(np.square(told(time - shift) - surface).mean()) for shift in shifts.tolist()]
    best = known.find("E7", "best_single_lag_2.5K_per_s", "both").value
    assert shifts[int(np.argmin(left))] == pytest.approx(best, abs=0.03)
