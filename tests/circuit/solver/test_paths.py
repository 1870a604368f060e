"""Every path that simulates takes a passive heat sink: none ignores it."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.peltier import heat_rejected_W
from thermicon.circuit import Drive, Rig, design, gate, simulate, simulate_current, simulate_many
from thermicon.circuit.safety.corners import corners_of
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.safety.tally import WATCHED
from thermicon.circuit.solver.simulate import simulate_all
from thermicon.circuit.solver.steady import state_under_current, steady_state
from thermicon.icons import Icon, load_library, parse

THENAR = Rig.load("thenar")
PASSIVE = THENAR.with_(
    heat_sink={"temperature_C": 28.0, "capacity_J_per_K": 40.0, "air_resistance_K_per_W": 1.5},
)
PID = {"kp_A_per_K": 0.5, "ki_A_per_Ks": 0.2, "lag_s": 0.1}
PROBES = ("hot_plate_C", "skin_C")
END_S = 8.0


def cue(control: str) -> Icon:
    shipped = load_library("cooling-step-skin" if control == "skin" else "six-icons").icons[0]
    if control != "current":
        return shipped
    text = "cue 1\nset amps { control current }\nicon a {\n  to 0.5 A at 1 A/s\n  hold for 7 s\n}\n"
    return parse(text)["a"]


def alone(rig: Rig, icon: Icon) -> np.ndarray:
    trace = simulate(icon, rig, tail_s=max(0.0, END_S - simulate(icon, rig).time_s[-1]))
    return np.array([getattr(trace, probe)[:801] for probe in PROBES])


def replayed(rig: Rig, icon: Icon) -> np.ndarray:
    plan = design(icon, rig, END_S)
    trace = simulate_current(plan.drive, rig, start_C=plan.start_C)
    return np.array([getattr(trace, probe) for probe in PROBES])


def all_at_once(rig: Rig, icon: Icon) -> np.ndarray:
    trace = simulate_all([icon] * 9, rig, end_s=END_S)[8]
    return np.array([getattr(trace, probe) for probe in PROBES])


def many(tracking: str, count: int) -> Callable[[Rig, Icon], np.ndarray]:
    def run(rig: Rig, icon: Icon) -> np.ndarray:
        rigs = [rig] * count
        batch = simulate_many([icon], rigs, nominal=rig, end_s=END_S, tracking=tracking, probes=PROBES)
        return np.asarray(batch.values[:, -1, 0])

    return run


PATHS: dict[str, Callable[[Rig, Icon], np.ndarray]] = {
    "replay": replayed,
    "all of a set": all_at_once,
    **{f"{tracking}, {kind}": many(tracking, count) for tracking in ("replay", "display", "ideal")
       for kind, count in (("one lane", 1), ("block", 9))},
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("control", ["display", "skin", "current"])
def test_paths_agree_with_a_single_run_which_a_passive_sink_changes(control: str) -> None:
    icon = cue(control)
    reference, plain = alone(PASSIVE, icon), alone(THENAR, icon)
    assert np.abs(reference[:, :100] - plain[:, :100]).max() > 5e-4
    for name, path in PATHS.items():
        if control == "skin" and name.startswith("display"):
            continue  # tracks the display of the nominal rig by its own control: another current
        assert np.abs(path(PASSIVE, icon)[:, :801] - reference).max() < 2e-4, name


def test_the_loop_of_a_pid_controller_takes_the_key() -> None:
    icon = cue("display")
    rig, plain = PASSIVE.with_(controller=PID), THENAR.with_(controller=PID)
    reference = alone(rig, icon)
    assert np.abs(reference - alone(plain, icon)).max() > 0.004
    for name in ("replay", "all of a set", "display, one lane", "display, block"):
        assert np.abs(PATHS[name](rig, icon) - reference).max() < 2e-4, name


def test_the_gate_plays_holds_and_repeats_with_a_passive_sink() -> None:
    drive = Drive([0, 1, 3], [0.3, 0.9, 0.9], held=True)
    every = Ensemble.of(PASSIVE)
    start = every.at_rest(0.3)
    (rows, played), then = next(every.play(drive, start))
    trace = simulate_current(drive, PASSIVE)
    skin = WATCHED.index("skin_C")
    assert np.abs(played[skin, 0] - np.interp(rows, trace.time_s, trace.skin_C)).max() < 1e-4
    held, after = every.hold(0.9, then, np.array([0.0, 5.0]))
    longer = simulate_current(Drive([0, 1, 8], [0.3, 0.9, 0.9], held=True), PASSIVE)
    assert held[skin, 0, -1] == pytest.approx(longer.skin_C[-1], abs=1e-3)
    assert after.nodes_C.shape == start.nodes_C.shape
    moved = every.rest(0.9, then, 5.0)
    assert np.abs(moved.nodes_C - after.nodes_C).max() < 1e-6


def test_corners_keep_a_passive_sink() -> None:
    sinks = [corner.rig.heat_sink for corner in corners_of(PASSIVE)]
    assert {sink.passive.air_C for sink in sinks} == {23.0, 24.0, 25.0}
    assert {sink.temperature_C for sink in sinks} == {27.0, 28.0, 29.0}


@pytest.mark.slow
def test_a_verdict_takes_a_passive_sink() -> None:
    plan = design(cue("display"), PASSIVE, END_S)
    ended = Drive(plan.drive.time_s, [*plan.drive.current_A[:-1], plan.rest_A], held=True)
    verdict, network = gate(ended, PASSIVE, rest_A=plan.rest_A), Ensemble.of(PASSIVE).networks[0]
    end = state_under_current(network, 0.0, in_the_end=True)
    assert verdict.drift_C == pytest.approx(network.read(end, "skin_C"))


def test_steady_states_take_the_key() -> None:
    assert steady_state(PASSIVE, "skin", 32.0)[1][-2] == pytest.approx(28.0)
    steady = PASSIVE.with_(**{"heat_sink.temperature_C": None})
    current, state = steady_state(steady, "skin", 32.0)
    rejected = heat_rejected_W(steady.module, current, float(state[1]), float(state[0]))
    assert state[-2] == pytest.approx(24.0 + 1.5 * rejected, abs=1e-9)
    assert state[0] == pytest.approx(state[-2] + 0.2 * rejected, abs=1e-9)
