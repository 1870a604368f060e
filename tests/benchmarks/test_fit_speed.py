"""Speed of a fit of three parameters to a log of 60 s, beside what a user would write with scipy alone.

The alternative: `solve_ivp` (LSODA) on the same lumps, and `least_squares` with its own numerical derivatives. Run with
`pytest -n 0 -m benchmark tests/benchmarks/test_fit_speed.py`.
"""

from __future__ import annotations

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from thermicon.circuit import Rig, fit
from thermicon.circuit.fitting.laboratory import synthetic_log
from thermicon.circuit.fitting.log import Log
from thermicon.circuit.rig.module import ZERO_C_IN_K
from thermicon.circuit.solver.network import COLD, HOT, SKIN, network_of
from thermicon.circuit.solver.plate import COLD_J_PER_K, CONDUCTANCE, HOT_J_PER_K, SINK_C, SINK_W_PER_K
from thermicon.circuit.solver.steady import state_under_current

pytestmark = pytest.mark.benchmark
TRUTH = {"contact.resistance_m2K_per_W": 7e-4, "module.seebeck_V_per_K": 0.0505, "module.resistance_ohm": 6.6}
KEYS = list(TRUTH)
MOST_S = 2.0


@pytest.fixture(scope="module")
def log() -> Log:
    return synthetic_log(Rig.load("thenar").with_(**TRUTH), seed=1)


def test_a_fit_of_three_parameters_takes_less_than_two_seconds(benchmark: BenchmarkFixture, log: Log) -> None:
    found = benchmark.pedantic(lambda: fit(log, Rig.load("thenar"), free=KEYS), rounds=3, warmup_rounds=1, iterations=1)
    assert all(abs(found[key].value / value - 1) < 0.02 for key, value in TRUTH.items())
    assert benchmark.stats.stats.min < MOST_S


def test_the_same_with_scipy_alone(benchmark: BenchmarkFixture, log: Log) -> None:
    few = slice(None, None, 10)  # ten rows a second are enough for it, and kind
    time, measured = (
        log.time_s[few],
        np.concatenate([log.column("display_C")[few] / 0.02, log.column("voltage_V")[few] / 0.005]),
    )

    def residuals(logs: np.ndarray) -> np.ndarray:
        rig = Rig.load("thenar").with_(**dict(zip(KEYS, np.exp(logs), strict=True)))
        display, voltage = by_solve_ivp(rig, log, time)
        return np.concatenate([display / 0.02, voltage / 0.005]) - measured

    start = np.log([5.4e-4, 0.0521, 6.35])
    answer = benchmark.pedantic(
        lambda: least_squares(residuals, start, diff_step=1e-4, xtol=1e-5, ftol=1e-5, max_nfev=8),
        rounds=1,
        iterations=1,
    )
    assert np.allclose(np.exp(answer.x), list(TRUTH.values()), rtol=0.1)


def by_solve_ivp(rig: Rig, log: Log, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Display in °C and voltage in V at times, from the ordinary differential equations of the circuit."""
    network, module = network_of(rig), rig.module
    current = log.column("current_A")
    capacity = np.concatenate([network.plates[[HOT_J_PER_K, COLD_J_PER_K]], network.capacity_J_per_K])
    conduct, perfusion, deep = network.conductance_W_per_K, network.perfusion_W_per_K, network.deep_C
    leak, sink, out = (float(network.plates[k]) for k in (CONDUCTANCE, SINK_C, SINK_W_PER_K))

    def slope(t: float, state: np.ndarray) -> np.ndarray:
        amperes = float(np.interp(t, log.time_s, current))
        hot, cold, skin = state[HOT], state[COLD], state[SKIN:]
        heat = np.empty_like(state)
        joule, alpha = 0.5 * amperes**2 * module.resistance_ohm, module.seebeck_V_per_K * amperes
        heat[HOT] = alpha * (hot + ZERO_C_IN_K) + joule - leak * (hot - cold) - out * (hot - sink)
        down = conduct * (np.concatenate([[cold], skin]) - np.concatenate([skin, [deep]]))
        heat[COLD] = -alpha * (cold + ZERO_C_IN_K) + joule + leak * (hot - cold) - down[0]
        heat[SKIN:] = down[:-1] - down[1:] + perfusion * (deep - skin)
        return heat / capacity

    begin = state_under_current(network, float(current[0]))[:-1]
    found = solve_ivp(slope, (0.0, float(time[-1])), begin, "LSODA", t_eval=time, rtol=1e-6, atol=1e-6, max_step=0.5)
    volts = module.seebeck_V_per_K * (found.y[HOT] - found.y[COLD])
    return found.y[COLD], volts + np.interp(time, log.time_s, current) * module.resistance_ohm
