"""Each step to current limits for any loop, on the independent circuit: as it answers, and a step beyond."""

import json
from functools import cache

import numpy as np
import pytest

from tests.circuit.delivery.followed import Follower
from tests.circuit.delivery.independent import Array
from tests.circuit.delivery.loops_at_work import Bench, Controllers
from tests.circuit.delivery.one_drive import icon_of
from tests.circuit.delivery.replay import RATE_K_PER_S, Worst
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.any_loop import AnyLoop, Limits_A
from thermicon.circuit.delivery.formats.form import samples_of
from thermicon.circuit.delivery.shaped import looped
from thermicon.circuit.delivery.temperatures import FollowingModule, past_most_cooling
from thermicon.circuit.delivery.ways import deliver
from thermicon.circuit.safety.demands import CutOff, HeldCutOff
from thermicon.circuit.safety.held import Stages
from thermicon.circuit.safety.tally import WATCHED

QUICK = {
    "skin.elements": [1] * 5, "driver.update_Hz": 20.0, "driver.voltage_limit_V": 60.0, "driver.current_limit_A": 2.0,
    "module.cold_plate_J_per_K": 1.5,
}  # fmt: skip
UNSURE, SURE, CUT = Rig.load("thenar").with_(**QUICK), sure_rig().with_(**QUICK), CutOff(28.0, 38.0, 0.0)
LAGGING = SURE.with_(**{
    "driver.current_limit_A": 1.668, "heat_sink.temperature_C": 33.94, "module.cold_plate_J_per_K": 2.054,
    "module.seebeck_V_per_K": 0.05852, "contact.area_cm2": 4.662, "contact.resistance_m2K_per_W": 0.001064,
})  # fmt: skip
"""Where the skin is fastest when a loop goes to a limit and stays there, not when it swings."""
SLUGGISH = SURE.with_(**{
    "driver.current_limit_A": 2.84, "heat_sink.temperature_C": 33.0, "module.cold_plate_J_per_K": 1.99,
    "module.hot_plate_J_per_K": 9.86, "contact.area_cm2": 3.365, "contact.resistance_m2K_per_W": 0.0035,
})  # fmt: skip
"""Where the skin is fastest only more than a second after a loop went from a far cut-off to a limit."""
WIDE = CutOff(18.9, 43.0, 0.0)
WRONG_K, LOSS_K = 0.3, 0.05
"""Offset of a sensor, and what a display may miss more than with the driver's own limits, rms."""


def loops_of(rig: Rig) -> AnyLoop:
    module = FollowingModule.of(looped(rig))
    return AnyLoop(module, past_most_cooling(module.rigs))


@cache
def slowed(rig: Rig, cut: CutOff = CUT, given: Limits_A = (-2.0, 2.0)) -> Limits_A:
    """The limits to which those of the driver come down."""
    return loops_of(rig).slowed(cut, given)[0]


def limited(rig: Rig, limits_A: Limits_A) -> Follower:
    """The module with the strongest loop within current limits, in all its worlds."""
    document = json.loads(rig.document)
    driver = {**document["driver"], "current_min_A": limits_A[0], "current_limit_A": limits_A[1]}
    return Follower({**document, "driver": driver}, np.random.default_rng(0), extra=0)


def fastest(rig: Rig, limits_A: Limits_A, cut: CutOff = CUT) -> float:
    """The skin in K/s under a relay between the cut-offs, and at a limit from the cut-off of the other side."""
    module = limited(rig, limits_A)
    unpowered = module._steady(np.zeros(len(module.least_A)))
    courses = [module.follow(np.repeat([cut.low, cut.high] * 4, [60, 60, 20, 20, 6, 6, 2, 2]), unpowered)[0]]
    for level_C, amperes in ((cut.low - WRONG_K, module.least_A), (cut.high + WRONG_K, module.most_A)):
        states = [module.rest(level_C)]
        for _ in range(60):
            states.extend(module.update(amperes, states[-1]))
        courses.append(module.circuit.read(np.array(states).transpose(1, 2, 0)).transpose(2, 0, 1))
    worst = Worst()
    for rows in courses:
        worst.rates(rows, np.full(len(rows) - 1, module.row_s))
    return (1.0 + worst.beyond["rate"]) * RATE_K_PER_S


def test_within_slowed_limits_no_loop_is_too_fast_and_a_tenth_wider_on_either_side_one_is() -> None:
    low_A, high_A = slowed(UNSURE)
    assert -2.0 < low_A < -0.5 and 1.0 < high_A < 2.0
    assert fastest(UNSURE, (low_A, high_A)) <= 0.975 * RATE_K_PER_S, "with room for swings that are worse"
    assert fastest(UNSURE, (1.1 * low_A, high_A)) > RATE_K_PER_S
    assert fastest(UNSURE, (low_A, 1.1 * high_A)) > RATE_K_PER_S
    assert slowed(SURE)[1] == 2.0, "nor do they come down where they need not"
    low_A, high_A = slowed(LAGGING)
    assert fastest(LAGGING, (low_A, high_A)) <= 0.975 * RATE_K_PER_S
    assert fastest(LAGGING, (1.15 * low_A, high_A)) > RATE_K_PER_S
    low_A, high_A = slowed(SLUGGISH, WIDE, (-2.84, 2.84))
    assert fastest(SLUGGISH, (low_A, high_A), WIDE) <= 0.975 * RATE_K_PER_S
    assert fastest(SLUGGISH, (1.2 * low_A, high_A), WIDE) > RATE_K_PER_S


def test_swapped_wires_are_told_where_turned_limits_are_too_fast_and_only_there() -> None:
    loops = loops_of(UNSURE)
    for limits_A, told in (((-0.7, 0.7), False), ((-0.6, 0.68), False), ((-0.6, 0.8), True)):
        turned_A = -limits_A[1], -limits_A[0]
        faults = loops.swapped(CUT, limits_A)
        assert (fastest(UNSURE, turned_A) > RATE_K_PER_S) == told == bool(faults)
        assert not told or faults[0].values["rate"] == pytest.approx(fastest(UNSURE, turned_A), abs=0.05)


def test_limits_suffice_where_the_display_follows_its_set_points_as_well_as_without_them() -> None:
    """By the loop of the rig on the independent circuit; with 20 mA less it is farther off, with 20 mA more nearer."""
    delivery = deliver(icon_of("warm by 4 °C at 4 °C/s; hold for 1 s"), SURE, Device.load("closed-loop-controller"))
    loops, samples, own = loops_of(SURE), samples_of(delivery), looped(SURE).controller
    assert own is not None
    shown_C = loops._shown_C(samples, (-2.0, 2.0))
    one, none = np.ones(1), np.zeros(1)
    gains = (gain * one for gain in (own.kp_A_per_K, own.ki_A_per_Ks, own.kd_As_per_K, own.lag_s))
    loop = Controllers(*gains, delay_s=none, offset_K=none, second_K=none, bound=none > 0.0)

    def display_C(most_A: float) -> Array:
        wide = {"low": -1e9, "high": 1e9, "react_within_s": 0.0}
        demands = {"current_limit_A": (-most_A, most_A), "cut_off_display_C": wide, "held_cut_off_display_C": None}
        bench = Bench(json.loads(SURE.document), demands, loop, np.random.default_rng(0))
        bench.start(float(samples.command[0]))
        places = (np.arange(len(shown_C)) * bench.period_s * samples.rate_Hz + 1e-6).astype(int)
        rows, _ = bench.play(samples.command[np.minimum(places, len(samples.command) - 1)])
        return np.asarray(rows[bench.follower.rows :: bench.follower.rows, 0, 2])

    def off_K(most_A: float) -> float:
        return float(np.sqrt(np.mean((display_C(most_A) - display_C(2.0)) ** 2)))

    tried_A = np.arange(0.3, 0.6, 0.01)
    enough_A = next(most_A for most_A in tried_A if loops.suffices((-most_A, most_A), [samples], [shown_C]))
    assert off_K(enough_A + 0.02) < LOSS_K < off_K(enough_A - 0.02)
    low_A, high_A = loops.limits_A(CUT, [samples])[0]
    assert low_A == -high_A == slowed(SURE)[0], "alike for both signs, as these set-points need no more"


def test_a_display_held_beyond_the_second_cut_off_has_changed_the_skin_until_that_acts() -> None:
    loops, held = loops_of(SURE), HeldCutOff(30.0, 36.0, 5.0)
    stages = Stages((31.0, 39.0), (29.0, 40.0), (30.0, 36.0), held)
    cold, warm = loops.stayed(stages)
    module = limited(SURE, (-2.0, 2.0))
    for state, lasting_C, level_C in ((cold, 30.0 - WRONG_K, 29.0 - WRONG_K), (warm, 36.0 + WRONG_K, 40.0 + WRONG_K)):
        rows, _ = module.follow(np.full(round(6.0 * 20), level_C), module.rest(lasting_C))
        skin_C = loops.module.ensemble.hold(0.0, state, np.array([0.0, 1.0]))[0][WATCHED.index("skin_C"), 0, 0]
        settled_C = module.circuit.read(module.rest(level_C)[:, :, None])[0, 0, 0]
        assert skin_C == pytest.approx(rows[-1, 0, 0], abs=0.004)
        assert abs(skin_C - settled_C) > 0.1, "it has not been there for good"
