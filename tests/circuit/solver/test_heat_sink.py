"""A passive heat sink: against an exact solution, closed forms, and what its keys may be."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.rig.corner import perturbed
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current

from .dense import Dense

THENAR = Rig.load("thenar")
PASSIVE: dict[str, object] = {"capacity_J_per_K": 90.0, "air_resistance_K_per_W": 1.5}
WARM = THENAR.with_(heat_sink={**PASSIVE, "temperature_C": 28.0})
STEADY = THENAR.with_(heat_sink={**PASSIVE, "temperature_C": None})
FAST = Drive([0, 1, 1.5, 6, 9, 12, 20], [0.1, 0.5, 1.2, -0.9, -0.8, 0.3, 0.3], held=True)


@pytest.mark.slow
@pytest.mark.parametrize(("rig", "start_C"), [(WARM, 28.0), (STEADY, None)], ids=["warm", "steady"])
@pytest.mark.parametrize("cells", [0, 3])
def test_a_drive_is_the_exact_solution(rig: Rig, start_C: float | None, cells: int) -> None:
    if cells:
        rig = rig.with_(module={"leg_nodes": cells, "leg_capacity_J_per_K": 0.8})
    trace, exact = simulate_current(FAST, rig, rate_Hz=10), Dense.of(rig, cells, 0.8)
    states = exact.run(FAST, start_C, 0.1)
    assert np.abs(trace.display_C - states[:, exact.cold]).max() < 1e-4
    assert np.abs(trace.hot_plate_C - states[:, 0]).max() < 2e-4


def test_a_sink_alone_cools_exponentially() -> None:
    # A module that conducts nothing and no current: the sink has only its air and the hot plate, which follows it.
    rig = THENAR.with_(
        module={"thermal_resistance_K_per_W": 1e9, "hot_plate_J_per_K": 1e-6},
        heat_sink={"capacity_J_per_K": 30.0, "air_resistance_K_per_W": 2.0, "temperature_C": 50.0, "air_C": 20.0},
    )
    trace = simulate_current(Drive([0, 120], [0.0, 0.0]), rig, rate_Hz=10)
    exact = 20.0 + 30.0 * np.exp(-trace.time_s / 60.0)
    assert np.abs(trace.hot_plate_C - exact).max() < 1e-3


def test_in_the_end_the_sink_is_in_balance_with_its_air() -> None:
    network = network_of(WARM)
    begun, end = state_under_current(network, 0.5), state_under_current(network, 0.5, in_the_end=True)
    assert begun[-2] == pytest.approx(28.0)
    late = simulate_current(Drive([0, 3600], [0.5, 0.5]), WARM, rate_Hz=0.1)
    assert late.hot_plate_C[-1] == pytest.approx(end[0], abs=1e-3)
    assert end[-2] > 29.0


def test_its_air_is_the_rooms_unless_it_is_given() -> None:
    assert WARM.heat_sink.passive is not None
    assert WARM.heat_sink.passive.air_C == 24.0
    warmer = perturbed(WARM, ambient_K=3.0, heat_sink_K=1.0)
    assert warmer.heat_sink.passive is not None
    assert (warmer.heat_sink.passive.air_C, warmer.heat_sink.temperature_C) == (25.0, 29.0)
    only_room = perturbed(STEADY, ambient_K=3.0)
    assert only_room.heat_sink.passive is not None
    assert math.isclose(only_room.heat_sink.passive.air_C, 24.0)


@pytest.mark.parametrize("rig", [WARM, STEADY, perturbed(WARM, ambient_K=1.0)], ids=["warm", "steady", "corner"])
def test_a_passive_sink_survives_a_file(rig: Rig, tmp_path: Path) -> None:
    rig.save(tmp_path / "sink.toml")
    assert Rig.load(tmp_path / "sink.toml").heat_sink == rig.heat_sink
