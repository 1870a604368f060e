"""A trace in a few numbers, against the trace itself."""

from __future__ import annotations

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, simulate, simulate_current
from thermicon.circuit.safety.verdict import energy_J, summarise
from thermicon.icons import load_library

RIG = Rig.load("thenar")
STEP = load_library("six-icons")["cooling-step"]


def test_every_extreme_is_that_of_its_column() -> None:
    trace = simulate(STEP, RIG)
    found = summarise(trace).to_dict()
    assert found["skin_min_C"] == trace.skin_C.min()
    assert found["skin_max_C"] == trace.skin_C.max()
    assert found["heat_flow_cold_receptor_min_W_per_m2"] == trace.heat_flow_cold_receptor_W_per_m2.min()
    assert found["voltage_max_V"] == trace.voltage_V.max()
    assert found["duration_s"] == 8.0
    assert (found["reached"], found["safe"], found["safety"], found["reason"]) == (True, True, "green", None)


def test_a_constant_current_puts_in_power_times_time() -> None:
    rig = Rig.load("shani2021")
    trace = simulate_current(Drive([0, 10], [0.5, 0.5]), rig)
    hot, cold = float(trace.hot_plate_C[0]), float(trace.display_C[0])
    power = 0.5 * (0.0521 * (hot - cold) + 0.5 * 6.35)  # V·I with V = α(Th − Tc) + IR, written out
    assert summarise(trace).energy_J == pytest.approx(10 * power, rel=1e-9)


def test_energy_does_not_depend_on_the_rows() -> None:
    for icon, tolerance in ((STEP, 2e-3), (load_library("cooling-step-skin").icons[0], 2e-3)):
        coarse, fine = (energy_J(simulate(icon, RIG, rate_Hz=rate)) for rate in (100.0, 2000.0))
        assert coarse == pytest.approx(fine, rel=tolerance)


def test_a_held_current_counts_until_the_next_row() -> None:
    trace = simulate(STEP, RIG)
    power = trace.voltage_V * trace.current_A
    assert energy_J(trace) == pytest.approx(float(power[:-1].sum()) * 0.01, rel=1e-9)


def test_without_a_target_there_is_no_miss() -> None:
    found = summarise(simulate_current(Drive([0, 1], [0.1, 0.1]), RIG))
    assert (found.reached, found.largest_miss_K, found.largest_miss_s, found.rms_miss_K) == (None,) * 4
    assert "reached" not in repr(found)


def test_a_miss_and_a_hazard_say_why() -> None:
    weak = summarise(simulate(STEP, RIG.with_(**{"driver.current_limit_A": 0.6})))
    assert weak.reached is False
    assert weak.reason is not None and weak.reason.startswith("misses its target by")
    assert repr(weak).startswith("Summary(NOT reached, 8 s, skin ")
    burns = summarise(simulate_current(Drive([0, 1, 30], [0, -1.5, -1.5]), RIG))
    assert (burns.safe, burns.safety) == (False, "red")
    assert burns.reason is not None and "above the hard limit of" in burns.reason


def test_its_dictionary_keeps_names_and_order() -> None:
    found = summarise(simulate(STEP, RIG))
    names = list(found.to_dict())
    assert names[:5] == ["duration_s", "reached", "largest_miss_K", "largest_miss_s", "rms_miss_K"]
    assert names[-3:] == ["safe", "safety", "reason"]
    assert all(np.isfinite(value) for value in found.to_dict().values() if isinstance(value, float))
