"""The forward run against the matrix exponential, closed forms and energy."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.special import erfc

from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.module import ZERO_C_IN_K
from thermicon.circuit.network import PROBES, Network, network_of
from thermicon.circuit.steady import steady_state

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
    state = steady_state(network, 0.0)[:-1]
    worst = dict.fromkeys(PROBES[:5], 0.0)
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
    for probe in PROBES[:5]:
        assert np.abs(getattr(trace, probe) - network.read(full, probe)).max() < 1e-6, probe


@pytest.mark.parametrize("held", [False, True])
def test_energy_closes(held: bool) -> None:
    # Over a run: electrical work in, sink and deep tissue and blood out, the rest stored. Fine rows for the integrals.
    rig = RIGS[1]
    drive = Drive([0, 1, 3, 6, 8], [0.2, 0.2, 1.0, -0.5, -0.5], held)
    trace = simulate_current(drive, rig, rate_Hz=2000)
    network, dt = network_of(rig), np.diff(trace.time_s)

    def total(power: np.ndarray) -> float:
        return float(np.sum(dt * (power[1:] + power[:-1]) / 2))

    into_skin = total(trace.heat_flow_skin_W_per_m2) * rig.contact.area_m2
    module = rig.module
    absorbed = total(module.heat_absorbed_W(trace.current_A, trace.display_C, trace.hot_plate_C))
    stored = module.cold_plate_J_per_K * (trace.display_C[-1] - trace.display_C[0])
    assert -into_skin == pytest.approx(absorbed + stored, abs=0.02 if held else 2e-4)
    assert network.deep_C == 37.0


def test_second_order_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    # A smooth drive; the step is set by the rows. Errors against a run with 32 times finer steps.
    rig = RIGS[0]
    times = np.linspace(0, 8, 9)
    drive = Drive(times, 0.1 + 0.6 * np.sin(times / 8 * np.pi) ** 2)
    fine = simulate_current(drive, rig, rate_Hz=6400).display_C[::64]
    errors = []
    for rate in (100, 200, 400):
        errors.append(np.abs(simulate_current(drive, rig, rate_Hz=rate).display_C[:: rate // 100] - fine).max())
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders == pytest.approx([2.0, 2.0], abs=0.1), errors


def test_skin_under_a_stepped_surface_is_the_error_function() -> None:
    # A heavy display with almost no contact resistance steps the face of a uniform body: θ = θs · erfc(x / 2√(αt)).
    body = {
        "name": "dermis", "thickness_mm": 30.0, "conductivity_W_per_mK": 0.45, "density_kg_per_m3": 1060,
        "heat_capacity_J_per_kgK": 3300, "perfusion_per_s": 0.0,
    }  # fmt: skip
    rig = RIGS[0].with_(
        **{
            "skin.layer": [body],
            "skin.warm_receptor_mm": 0.5,
            "skin.deep_C": 30.0,
            "contact.resistance_m2K_per_W": 1e-6,
            "module.cold_plate_J_per_K": 1e7,
        }
    )
    trace = _from_display_step(rig, start=30.0, display=31.0)
    at_2_s = trace["warm_receptor_C"][-1] - 30.0
    assert erfc(0.5e-3 / (2 * np.sqrt(0.45 / (1060 * 3300) * 2.0))) == pytest.approx(0.485792, abs=1e-6)
    assert at_2_s == pytest.approx(0.485792, abs=2e-3)  # what the graded mesh and the contact leave
    assert trace["heat_flow_skin_W_per_m2"][-1] == pytest.approx(500.5, rel=5e-3)


def test_contact_resistance_delays_the_skin_as_the_closed_form_says() -> None:
    # Convective face, h = 1000 W/(m²·K), fluid step, 2 s: 0.248150 at 0.5 mm, 0.604824 at the surface.
    body = {
        "name": "dermis", "thickness_mm": 30.0, "conductivity_W_per_mK": 0.45, "density_kg_per_m3": 1060,
        "heat_capacity_J_per_kgK": 3300, "perfusion_per_s": 0.0,
    }  # fmt: skip
    rig = RIGS[0].with_(
        **{
            "skin.layer": [body],
            "skin.warm_receptor_mm": 0.5,
            "skin.deep_C": 30.0,
            "contact.resistance_m2K_per_W": 1e-3,
            "module.cold_plate_J_per_K": 1e7,
        }
    )
    trace = _from_display_step(rig, start=30.0, display=31.0)
    assert trace["skin_C"][-1] - 30.0 == pytest.approx(0.604824, abs=1e-3)
    assert trace["warm_receptor_C"][-1] - 30.0 == pytest.approx(0.248150, abs=1e-3)


def _from_display_step(rig: Rig, start: float, display: float) -> dict[str, np.ndarray]:
    """Run 2 s from skin at `start` throughout and a display that stays at `display`, being too heavy to change."""
    from thermicon.circuit.bank import Bank, cut, run_forward

    network = network_of(rig)
    bank, one = Bank.of([network]), np.zeros(1, dtype=np.int64)
    state = np.full(len(network.capacity_J_per_K) + 3, start)
    state[1] = display
    rows = np.linspace(0.0, 2.0, 2001)
    intervals = cut(rows, np.array([0.0, 2.0]), np.zeros((1, 2)), held=True)
    out = run_forward(bank, one, one, intervals, bank.states([state]))
    return dict(zip(PROBES, out[:, 0], strict=True))
