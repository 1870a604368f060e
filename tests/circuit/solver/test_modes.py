"""Modes against the kernel's steps or closed forms, under constant currents or prescribed displays."""

import numpy as np
import pytest
from numpy.typing import NDArray

from thermicon.circuit import Rig, simulate
from thermicon.circuit.safety.corners import corners_of
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.solver.batch_inputs import Intervals, State, run_on
from thermicon.circuit.solver.modes import FELT, READ, ConstantCurrent, modes_of
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current
from thermicon.icons import load_library

THENAR = Rig.load("thenar")
LANES = np.arange(4, dtype=np.int64)


def ensemble() -> Ensemble:
    return Ensemble.on(THENAR, tuple(corners_of(THENAR)[k] for k in (0, 1, 33, 64)), None)


@pytest.mark.parametrize("current_A", [0.0, 0.08, 0.9, -0.5])
def test_it_agrees_with_the_kernel_within_a_millikelvin(current_A: float) -> None:
    few = ensemble()
    start = few.at_rest(0.2)
    times = np.linspace(0.0, 20.0, 2001)
    amps = np.repeat((few.gain * current_A)[np.newaxis], len(times) - 1, axis=0)
    stepped, end = run_on(few.bank, LANES, LANES, Intervals(times, np.arange(len(times)), amps, amps), start, READ)
    modes = few.modes(current_A)
    exact = modes.run(LANES, start.nodes_C, times, READ)
    assert np.abs(exact - stepped).max() < 1e-3
    assert np.abs(modes.after(LANES, start.nodes_C, 20.0) - end.nodes_C).max() < 1e-3
    assert np.ptp(exact[0, 0]) > 0.1, "something moves"


@pytest.mark.parametrize("current_A", [0.0, 0.3, -0.2])
def test_it_comes_to_the_steady_state_of_the_closed_form(current_A: float) -> None:
    few = ensemble()
    late = few.modes(current_A).after(LANES, few.at_rest(0.1).nodes_C, 1e5)
    for lane, corner in enumerate(few.corners):
        closed = state_under_current(network_of(corner.rig), current_A * float(few.gain[lane]))
        assert np.abs(late[lane] - closed).max() < 1e-6


def test_a_bridge_heats_with_its_mean_square() -> None:
    network = network_of(THENAR)
    smooth = ConstantCurrent.of([network], np.array([0.4]), np.array([0.16]))
    bridge = ConstantCurrent.of([network], np.array([0.4]), np.array([0.4 * 1.5]))
    assert bridge.rate_per_s == pytest.approx(smooth.rate_per_s), "heat of resistance is not a rate"
    plate = network.plates
    sink_K = bridge.rest_C[0, 0] - smooth.rest_C[0, 0]
    assert sink_K > 0.0
    more_W = plate[1] * (0.4 * 1.5 - 0.16)
    assert 0.5 * more_W < sink_K / THENAR.heat_sink.resistance_K_per_W < 1.5 * more_W


def test_what_heats_without_end_has_a_negative_rate_and_stays_finite() -> None:
    modes = ConstantCurrent.of([network_of(THENAR)], np.array([-6.0]), np.array([36.0]))
    assert modes.rate_per_s.min() < 0.0
    state = ensemble().at_rest(0.1).nodes_C[:1]
    values = modes.run(LANES[:1], state, np.array([0.0, 60.0, 1e4]), READ)
    assert np.isfinite(values).all()
    assert values[0, 0, 1] > 60.0


def test_a_pause_is_the_same_as_a_map() -> None:
    few = ensemble()
    modes, state = few.modes(0.08), few.at_rest(0.4)
    matrix, constant = modes.passage(12.5)
    free = np.einsum("rij,rj->ri", matrix, state.nodes_C[:, :-1]) + constant
    assert np.abs(free - few.rest(0.08, State(state.nodes_C), 12.5).nodes_C[:, :-1]).max() < 1e-9
    assert matrix.min() > -1e-9, "no node gets colder because another is warmer"


MODES = modes_of(THENAR)
SIX = load_library("six-icons")
EPSILON = float(np.finfo(np.float64).eps)


@pytest.mark.parametrize("name", ["cooling-step", "double-dip"])
def test_fed_with_the_display_of_the_whole_circuit_it_gives_its_skin(name: str) -> None:
    trace = simulate(SIX[name], THENAR, rate_Hz=1000.0)
    step = float(trace.time_s[1] - trace.time_s[0])
    felt, _ = MODES.run(trace.display_C, step, MODES.steady(float(trace.display_C[0])))
    for column in ("display_C", "skin_C", "cold_receptor_C", "warm_receptor_C"):
        assert np.abs(felt[FELT.index(column)] - getattr(trace, column)).max() < 5e-6, column
    assert np.ptp(trace.skin_C) > 2.0


def rounding(largest: NDArray[np.float64], steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How far rounding alone takes modes (n,) of this size in steps of 10 ms, and with them the readings (7,).

    A step rounds a mode by 3 ε of its size on any processor: 1 ulp of the exponential in `keep`, and half of one for
    each of two products and two sums. The mode keeps that share of it in every later step. Readings add modes up, the
    flows with weights of some 10⁴ W/(m²·K) that nearly cancel, and round each of the n terms.
    """
    keep = np.exp(-MODES.rate_per_s * 0.01)
    modes = 3 * EPSILON * largest * (1 - keep**steps) / (1 - keep)
    terms = np.abs(MODES.reading) @ largest + np.abs(MODES.offset_C)
    return modes, np.abs(MODES.reading) @ modes + len(largest) * EPSILON * terms


def test_a_steady_display_is_steady() -> None:
    steady = MODES.steady(27.0)
    felt, end = MODES.run(np.full(2000, 27.0), 0.01, steady)
    of_modes, of_readings = rounding(np.abs(steady), 1999)
    assert (np.abs(felt - felt[:, :1]).max(axis=1) <= of_readings).all()
    assert (np.abs(end - steady) <= of_modes).all()
    temperatures = [name.endswith("_C") for name in FELT]
    assert of_readings[temperatures].max() < 1e-11 and of_readings.max() < 1e-8, "so that it says something"


def test_relaxing_is_running_on_under_a_display_that_is_held() -> None:
    _, begun = MODES.run(np.linspace(32.0, 24.0, 400), 0.01, MODES.steady(32.0))
    ran, end = MODES.run(np.full(1001, 24.0), 0.01, begun)
    relaxed = MODES.relax(np.arange(1001) * 0.01, 24.0, begun)
    of_modes, of_readings = rounding(np.maximum(np.abs(begun), np.abs(MODES.steady(24.0))), 1000)
    assert (np.abs(ran - relaxed).max(axis=1) <= of_readings).all()
    assert (np.abs(MODES.after(10.0, 24.0, begun) - end) <= of_modes).all()
    late = MODES.relax(np.array([1e5]), 24.0, begun)
    assert late[:, 0] == pytest.approx(MODES.relax(np.array([0.0]), 24.0, MODES.steady(24.0))[:, 0], abs=1e-9)


def test_lumps_and_modes_are_each_others_inverse_and_warmth_makes_nothing_colder() -> None:
    count = len(MODES.rate_per_s)
    assert np.abs(MODES.lumps @ MODES.unlumps - np.eye(count)).max() < 1e-10
    passage = MODES.lumps @ np.diag(np.exp(-MODES.rate_per_s * 2.0)) @ MODES.unlumps
    assert passage.min() > -1e-12
    assert (MODES.rate_per_s > 0).all()


def test_the_display_that_holds_the_skin_holds_it() -> None:
    display = MODES.display_holding_skin_C(29.0)
    felt, _ = MODES.run(np.full(2, display), 0.1, MODES.steady(display))
    assert felt[FELT.index("skin_C"), -1] == pytest.approx(29.0, abs=1e-9)


def test_under_a_display_that_lets_no_heat_through_skin_goes_to_its_blood() -> None:
    free = modes_of(THENAR, insulated=True)
    start = free.unlumps @ (MODES.lumps @ MODES.steady(25.0))
    late = free.relax(np.array([0.0, 1e6]), free.deep_C, start)
    cold = FELT.index("cold_receptor_C")
    assert late[cold, 0] < 27.0
    assert late[cold, 1] == pytest.approx(free.deep_C, abs=1e-6)
