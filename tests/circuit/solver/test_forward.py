"""The forward run against the matrix exponential, and at rest."""

import numpy as np
import pytest
from scipy.linalg import expm

from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.rig.module import ZERO_C_IN_K
from thermicon.circuit.solver.network import RECORDED, Network, network_of
from thermicon.circuit.solver.steady import state_under_current

RIGS = [Rig.load("thenar"), Rig.load("shani2021")]


def matrices(network: Network, current: float) -> tuple[np.ndarray, np.ndarray]:
    """dT/dt = A T + b of the whole circuit at a held current, written out independently of the stepping."""
    a, r, leak, hot_J, cold_J, sink, out, deep = network.plates[:8]
    g, perf = network.conductance_W_per_K, network.perfusion_W_per_K
    n = len(perf)
    capacity = np.concatenate([[hot_J, cold_J], network.capacity_J_per_K])
    matrix, source = np.zeros((n + 2, n + 2)), np.zeros(n + 2)
    matrix[0, :2] = [-(out + leak - a * current), leak]
    matrix[1, :3] = [leak, -(leak + a * current + g[0]), g[0]]
    source[0] = out * sink + a * current * ZERO_C_IN_K + r * current**2 / 2
    source[1] = -a * current * ZERO_C_IN_K + r * current**2 / 2
    for i in range(n):
        matrix[i + 2, i + 1 : i + 3] = [g[i], -(g[i] + g[i + 1] + perf[i])]
        source[i + 2] = perf[i] * deep
        if i < n - 1:
            matrix[i + 2, i + 3] = g[i + 1]
        else:
            source[i + 2] += g[i + 1] * deep
    return matrix / capacity[:, None], source / capacity


@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
def test_half_an_ampere_held_agrees_with_the_matrix_exponential(rig: Rig) -> None:
    # The drive jumps 0 → 0.5 A right after its first row.
    trace = simulate_current(Drive([0, 0.01, 300.01], [0.0, 0.5, 0.5], held=True), rig)
    network = network_of(rig)
    matrix, source = matrices(network, 0.5)
    steady, decay = -np.linalg.solve(matrix, source), expm(matrix * 0.01)
    state = state_under_current(network, 0.0)[:-1]
    worst = dict.fromkeys(RECORDED[:5], 0.0)
    for row in range(1, len(trace.time_s)):
        full = np.append(state, network.deep_C)
        for probe in worst:
            worst[probe] = max(worst[probe], abs(getattr(trace, probe)[row] - network.read(full, probe)))
        state = steady + decay @ (state - steady)
    assert len(trace.time_s) == 30_002
    assert max(worst.values()) < 1e-4, worst


@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)
@pytest.mark.parametrize("current", [-0.3, 0.0, 0.4])
def test_a_constant_current_stays_at_its_steady_state(rig: Rig, current: float) -> None:
    trace = simulate_current(Drive([0, 60], [current, current]), rig)
    network = network_of(rig)
    matrix, source = matrices(network, current)
    full = np.append(-np.linalg.solve(matrix, source), network.deep_C)
    for probe in RECORDED[:5]:
        assert np.abs(getattr(trace, probe) - network.read(full, probe)).max() < 1e-6, probe
