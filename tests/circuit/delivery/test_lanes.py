"""Lanes with cut-offs or loops, against exact steps of the independent circuit."""

import json

import numpy as np
import pytest

from tests.circuit.delivery.independent import Array, Circuit, worlds_of
from tests.circuit.delivery.lanes import BEYOND, DOSE, LONGEST, NEVER, RATE, STAGE, SUM, TRIP, Lanes
from tests.circuit.delivery.replay import Skin, exposure
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
    exact = CIRCUIT.read(move @ begun[:, : SUM - 1, None] + add)
    LANES.hold(begun, EVERY, flow(ampere), time_s)
    assert CIRCUIT.read(begun[:, : SUM - 1, None]) == pytest.approx(exact, abs=1e-3)


def test_a_cut_off_acts_when_the_display_leaves_its_span_and_its_reaction_is_over() -> None:
    begun, cut = LANES.steady(*flow(0.1).T), np.tile([25.0, 90.0, 0.1, -NEVER, NEVER, NEVER], (9, 1))
    ended = begun.copy()
    trip_s = LANES.hold(ended, EVERY, flow(0.9), 600.0, cut)[:, TRIP]
    for world, time_s in enumerate(trip_s):
        for late_s, at_C in ((0.0, 25.0), (0.1, CIRCUIT.read(ended[:, : SUM - 1, None])[world, 2, 0])):
            move, add = CIRCUIT.modes(*flow(0.9).T).step(time_s + late_s)
            assert CIRCUIT.read(move @ begun[:, : SUM - 1, None] + add)[world, 2, 0] == pytest.approx(at_C, abs=2e-3)
    never = LANES.hold(begun, EVERY, flow(0.1), 10.0, cut)
    assert (never[:, TRIP] == NEVER).all()
    assert (LANES.hold(ended, EVERY, flow(0.9), 600.0, cut)[:, TRIP] == 0.0).all(), "outside from the beginning"


def test_a_second_cut_off_acts_where_the_display_was_beyond_it_for_longer_without_a_break() -> None:
    begun, cut = LANES.steady(*flow(0.1).T), np.tile([-NEVER, NEVER, 0.0, 25.0, 90.0, 6.0], (9, 1))
    ended = begun.copy()
    far = LANES.hold(ended, EVERY, flow(0.5), 600.0, cut)
    assert (far[:, STAGE] == 2.0).all()
    for world, trip_s in enumerate(far[:, TRIP]):
        move, add = CIRCUIT.modes(*flow(0.5).T).step(trip_s - 6.0)
        assert CIRCUIT.read(move @ begun[:, : SUM - 1, None] + add)[world, 2, 0] == pytest.approx(25.0, abs=0.02)
    state = begun.copy()
    for _ in range(3):  # colder than 25 °C for less than 6 s each time
        assert not LANES.hold(state, EVERY, flow(0.5), float(far[:, TRIP].min()) - 2.5, cut)[:, STAGE].any()
        LANES.hold(state, EVERY, flow(-0.3), 20.0, cut)
        assert not state[:, BEYOND].any()
    assert 3.4 < state[:, LONGEST].max() < 6.0
    again = LANES.hold(begun, EVERY, flow(0.5), far[:, TRIP] - 2.0, cut)
    assert not again[:, STAGE].any()
    assert LANES.hold(begun, EVERY, flow(0.5), 60.0, cut)[:, TRIP] == pytest.approx(np.full(9, 2.0), abs=0.02)


def test_a_lane_adds_up_the_dose_of_skin_and_knows_its_fastest_10_ms() -> None:
    begun, rows = LANES.steady(*flow(0.1).T), []
    state, (move, add) = begun[:, : SUM - 1, None], CIRCUIT.modes(*flow(-0.9).T).step(0.01)
    for _ in range(3001):
        rows.append(CIRCUIT.read(state))
        state = move @ state + add
    far = LANES.hold(begun.copy(), EVERY, flow(-0.9), 30.0)
    exact, _, _ = exposure(np.array(rows), np.full(3000, 0.01))
    assert exact.max() > 0.1
    assert far[:, DOSE] == pytest.approx(exact[:, 0], rel=0.02, abs=1e-4)
    fastest = np.abs(np.diff(np.array(rows)[:, :, 0, 0], axis=0)).max(axis=0) / 0.01
    assert far[:, RATE] == pytest.approx(fastest, rel=0.02)


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
    assert CIRCUIT.read(state[:, : SUM - 1, None])[:, 2, 0] == pytest.approx(np.full(9, 32.7), abs=0.02)
    assert far[:, 5].max() > 36.0, "it began without power"
