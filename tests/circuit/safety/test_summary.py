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
    assert list(found)[:5] == ["duration_s", "reached", "largest_miss_K", "largest_miss_s", "rms_miss_K"]
    assert list(found)[-3:] == ["safe", "safety", "reason"]
    assert all(np.isfinite(value) for value in found.values() if isinstance(value, float))


def test_energy_is_power_times_time_whatever_the_rows() -> None:
    trace = simulate_current(Drive([0, 10], [0.5, 0.5]), Rig.load("shani2021"))
    hot, cold = float(trace.hot_plate_C[0]), float(trace.display_C[0])
    power = 0.5 * (0.0521 * (hot - cold) + 0.5 * 6.35)  # V·I with V = α(Th − Tc) + IR, written out
    assert summarise(trace).energy_J == pytest.approx(10 * power, rel=1e-9)
    for icon in (STEP, load_library("cooling-step-skin").icons[0]):
        coarse, fine = (energy_J(simulate(icon, RIG, rate_Hz=rate)) for rate in (100.0, 2000.0))
        assert coarse == pytest.approx(fine, rel=2e-3)
    held = simulate(STEP, RIG)  # each row's power counts until the next
    assert energy_J(held) == pytest.approx(float((held.voltage_V * held.current_A)[:-1].sum()) * 0.01, rel=1e-9)


def test_a_miss_and_a_hazard_say_why_and_without_a_target_there_is_no_miss() -> None:
    weak = summarise(simulate(STEP, RIG.with_(**{"driver.current_limit_A": 0.6})))
    assert weak.reached is False
    assert weak.reason is not None and weak.reason.startswith("misses its target by")
    assert repr(weak).startswith("Summary(NOT reached, 8 s, skin ")
    burns = summarise(simulate_current(Drive([0, 1, 30], [0, -1.5, -1.5]), RIG))
    assert (burns.safe, burns.safety) == (False, "red")
    assert burns.reason is not None and "above the hard limit of" in burns.reason
    assert (burns.reached, burns.largest_miss_K, burns.largest_miss_s, burns.rms_miss_K) == (None,) * 4
    assert "reached" not in repr(burns)
