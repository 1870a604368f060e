"""Lanes with cut-offs or loops, against exact steps of the independent circuit."""

import json

import numpy as np
import pytest

from tests.circuit.delivery.independent import Array, Circuit, worlds_of
from tests.circuit.delivery.lanes import Lanes
from tests.circuit.delivery.replay import Skin
from thermicon.circuit import Rig

RIG = json.loads(Rig.load("shani2021").document)
CIRCUIT = Circuit.of(RIG, worlds_of(RIG)[:9])
LANES, EVERY, GAIN = Lanes.of(CIRCUIT), np.arange(9), CIRCUIT.gain


def flow(mean: float) -> Array:
    return np.column_stack([mean * GAIN, (mean * GAIN) ** 2])


@pytest.mark.parametrize(("ampere", "time_s"), [(-1.0, 0.01), (0.9, 2.0), (0.3, 60.0), (-0.2, 600.0)])
def test_a_held_current_is_an_exact_step_within_a_millikelvin(ampere: float, time_s: float) -> None:
    begun = LANES.steady(*flow(0.1).T)
    move, add = CIRCUIT.modes(*flow(ampere).T).step(time_s)
    exact = CIRCUIT.read(move @ begun[:, :-2, None] + add)
    LANES.hold(begun, EVERY, flow(ampere), time_s)
    assert CIRCUIT.read(begun[:, :-2, None]) == pytest.approx(exact, abs=1e-3)


def test_a_cut_off_acts_when_the_display_leaves_its_span_and_its_reaction_is_over() -> None:
    begun, cut = LANES.steady(*flow(0.1).T), np.tile([25.0, 90.0, 0.1], (9, 1))
    ended = begun.copy()
    trip_s = LANES.hold(ended, EVERY, flow(0.9), 600.0, cut)[:, 8]
    for world, time_s in enumerate(trip_s):
        for late_s, at_C in ((0.0, 25.0), (0.1, CIRCUIT.read(ended[:, :-2, None])[world, 2, 0])):
            move, add = CIRCUIT.modes(*flow(0.9).T).step(time_s + late_s)
            assert CIRCUIT.read(move @ begun[:, :-2, None] + add)[world, 2, 0] == pytest.approx(at_C, abs=2e-3)
    never = LANES.hold(begun, EVERY, flow(0.1), 10.0, cut)
    assert (never[:, 8] == 1e9).all()
    assert (LANES.hold(ended, EVERY, flow(0.9), 600.0, cut)[:, 8] == 0.0).all(), "outside from the beginning"


def test_a_display_that_is_prescribed_moves_the_skin_as_its_modes_do() -> None:
    skin = Skin(RIG, np.random.default_rng(1))
    lanes, worlds = Lanes.of(skin.circuit), np.arange(len(skin.circuit.worlds))
    state = lanes.steady(np.full(len(worlds), 32.0), np.zeros(len(worlds)))
    rows, _ = skin.run(np.full(301, 40.0), 0.01, skin.steady(32.0))
    far = lanes.hold(state, worlds, np.tile([40.0, 0.0], (len(worlds), 1)), 3.0)
    assert far[:, [1, 3]] == pytest.approx(rows[-1, :, :2], abs=1e-3)


def test_a_loop_brings_the_display_to_its_set_point_less_the_error_of_its_sensor() -> None:
    state = LANES.steady(*flow(0.0).T)
    loop = np.tile([0.4, 0.2, 0.9, 0.3, -1.0, 1.0, 1.0], (9, 1))
    far = LANES.regulate(loop, state, EVERY, np.full(6000, 33.0), 0.01)
    assert CIRCUIT.read(state[:, :-2, None])[:, 2, 0] == pytest.approx(np.full(9, 32.7), abs=0.02)
    assert far[:, 5].max() > 36.0, "it began without power"
