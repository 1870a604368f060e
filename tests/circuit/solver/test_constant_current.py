"""A constant current by modes: against the kernel's steps and against the steady state in closed form."""

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.circuit.safety.corners import corners_of
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.solver.batch_inputs import Intervals, State, left_over, run_on
from thermicon.circuit.solver.modes import READ, ConstantCurrent
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current

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
    assert bridge.rate_per_s == pytest.approx(smooth.rate_per_s), "heat of resistance is no rate"
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


def test_some_rigs_of_many_are_the_same_modes() -> None:
    few = ensemble()
    modes, state = few.modes(0.3), few.at_rest(0.1)
    part = modes.only([2, 0])
    whole = modes.run(LANES[[2, 0]], state.nodes_C[[2, 0]], np.array([0.0, 3.0]), READ)
    assert (part.run(LANES[:2], state.nodes_C[[2, 0]], np.array([0.0, 3.0]), READ) == whole).all()


def test_a_pause_is_the_same_as_a_map() -> None:
    few = ensemble()
    modes, state = few.modes(0.08), few.at_rest(0.4)
    matrix, constant = modes.passage(12.5)
    free = np.einsum("rij,rj->ri", matrix, state.nodes_C[:, :-1]) + constant
    assert np.abs(free - few.rest(0.08, State(state.nodes_C, state.sink), 12.5).nodes_C[:, :-1]).max() < 1e-9
    assert matrix.min() > -1e-9, "no node gets colder because another is warmer"


def test_any_rows_are_exponentials_of_their_own() -> None:
    few = ensemble()
    modes, start = few.modes(0.4), few.at_rest(0.1)
    times = np.concatenate(
        [np.arange(300) * 0.1, [30.5, 30.7], 31.0 + np.arange(200) * 1.0, np.geomspace(300.0, 900.0, 30)]
    )
    found = modes.run(LANES, start.nodes_C, times, READ)
    for lane in LANES.tolist():
        away = modes.to_modes[lane] @ (start.nodes_C[lane, :-1] - modes.rest_C[lane])
        decay = np.exp(-np.outer(modes.rate_per_s[lane], times))
        plain = modes.level_C[lane][:, np.newaxis] + (modes.reading[lane] * away) @ decay
        assert np.abs(found[:, lane] - plain).max() < 1e-10


def test_a_lane_beyond_the_last_block_is_the_same_alone() -> None:
    every = Ensemble.of(THENAR)
    lanes = np.arange(33, dtype=np.int64)
    times = np.arange(201) * 0.01
    amps = np.repeat(0.5 * every.gain[np.newaxis, :33], len(times) - 1, axis=0)
    intervals = Intervals(times, np.arange(len(times)), amps, amps)
    start = every.at_rest(0.1).take(lanes)
    alone, _ = run_on(every.bank, lanes, lanes, intervals, start, READ, alone=left_over(33))
    padded, _ = run_on(every.bank, lanes, lanes, intervals, start, READ)
    assert (padded[:, :32] == alone[:, :32]).all()
    assert np.abs(padded[:, 32] - alone[:, 32]).max() < 1e-9
