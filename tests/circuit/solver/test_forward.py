"""The forward run against the matrix exponential, and at rest."""

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.solver.network import RECORDED, network_of

from .dense import Dense

RIGS = [Rig.load("thenar"), Rig.load("shani2021")]


def read(rig: Rig, states: np.ndarray, probe: str) -> np.ndarray:
    """A recorded quantity at exact states (rows, nodes), whose last node is the heat sink."""
    network = network_of(rig)
    return np.array([network.read(np.append(state[:-1], network.deep_C), probe) for state in states])


@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
def test_half_an_ampere_held_agrees_with_the_matrix_exponential(rig: Rig) -> None:
    # The drive jumps 0 → 0.5 A right after its first row.
    drive = Drive([0, 0.01, 300.01], [0.0, 0.5, 0.5], held=True)
    trace = simulate_current(drive, rig)
    exact = Dense.of(rig, 0, 0.0).run(drive, rig.heat_sink.temperature_C, 0.01)
    assert len(trace.time_s) == len(exact) == 30_002
    for probe in RECORDED[:5]:
        assert np.abs(getattr(trace, probe) - read(rig, exact, probe)).max() < 1e-4, probe


@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
@pytest.mark.parametrize("current", [-0.3, 0.0, 0.4])
def test_a_constant_current_stays_at_its_steady_state(rig: Rig, current: float) -> None:
    trace = simulate_current(Drive([0, 60], [current, current]), rig)
    steady = Dense.of(rig, 0, 0.0).rest(current, rig.heat_sink.temperature_C)
    for probe in RECORDED[:5]:
        assert np.abs(getattr(trace, probe) - read(rig, steady[np.newaxis], probe)).max() < 1e-6, probe
