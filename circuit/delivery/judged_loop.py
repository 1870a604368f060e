"""Which PI loops around a module play set-points without swinging, in its fastest and slowest corners."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from ..arrays import Array
from ..rig.module import ZERO_C_IN_K
from ..rig.parts import Controller
from ..safety.checks import Check
from ..safety.demands import CutOff, Loop
from ..solver.batch_inputs import Bank, run_regulate
from ..solver.kernel_pid import DELAY_S, KD, KI, KP, LAG_S
from ..solver.plate import ALPHA, COLD_J_PER_K, HIGHEST_A, LOWEST_A, RESISTANCE
from .any_loop import SENSOR_K, AnyLoop, Limits_A
from .samples import Samples
from .temperatures import rest_of_a_loop, updates_of

SENSOR_LAG_S, LATE_S = 0.1, 0.02
"""Sensor and delay of a loop that the rig does not state: a bead glued to a plate, two turns of a loop of 100 Hz."""
DELAYS_S = (0.1, 0.05, 0.02, 0.01, 0.0)
"""Delays that a loop of the rig may have beside what its file states; the longest that does not swing is demanded."""
CALM = 0.7
"""kp · K/s per A · (lag + delay): an integrator that is late by so much overshoots by some percent."""
RESETS_PER_S = (0.5, 0.25, 0.1, 0.05)
"""ki/kp, the quickest first: slower than the loop itself, so that it does not swing."""
WEAKER = 0.5
"""Share of the gains from which on a loop is judged."""
SETTLING_S, SWING_K = 10.0, 0.2
"""How long after the last set-point a loop may swing, and by how much a second before that."""


def judged_loop(
    loops: AnyLoop, plays: Sequence[Samples], limits_A: Limits_A, cut: CutOff
) -> tuple[Loop, tuple[Check, ...]]:
    """The rig's own loop, or one that suits its module, with what it may differ by; then a check that fails, if any."""
    bank = loops.within(limits_A)
    middle_K = float(plays[0].command.mean()) + ZERO_C_IN_K
    heat_W_per_A = bank.plates[:, ALPHA] * middle_K - bank.plates[:, LOWEST_A] * bank.plates[:, RESISTANCE]
    speed = heat_W_per_A * loops.module.ensemble.gain / bank.plates[:, COLD_J_PER_K]
    rigs = sorted({0, int(speed.argmin()), int(speed.argmax())})
    slew = max(float(np.abs(np.diff(play.command)).max()) * play.rate_Hz for play in plays)
    for loop in _candidates(loops.module.ensemble.rig.controller, float(speed.max()), float(f"{slew:.3g}")):
        swings = (_swing(loops, bank, rigs, loop, play, cut) for play in plays)
        failed = tuple(itertools.islice((check for check in swings if not check.passed), 1))
        if not failed:
            break
    return loop, failed


def _candidates(own: Controller | None, speed: float, slew: float) -> Iterator[Loop]:
    """The loops that are tried, the most useful first: the rig's with shorter and shorter delays, or slower resets."""
    if own is not None:
        kp, ki = own.kp_A_per_K, own.ki_A_per_Ks
        for delay in DELAYS_S:
            yield Loop((WEAKER * kp, kp), (WEAKER * ki, ki), own.kd_As_per_K, delay, own.lag_s, SENSOR_K, slew)
        return
    kp = float(f"{CALM / (speed * (SENSOR_LAG_S + LATE_S)):.2g}")
    for reset in RESETS_PER_S:
        ki = float(f"{reset * kp:.2g}")
        yield Loop((WEAKER * kp, kp), (WEAKER * ki, ki), 0.0, LATE_S, SENSOR_LAG_S, SENSOR_K, slew)


def _swing(loops: AnyLoop, bank: Bank, rigs: Sequence[int], loop: Loop, play: Samples, cut: CutOff) -> Check:
    """How far a play leaves the display beyond its set-points, or swinging after the last of them, at worst."""
    module = loops.module
    period = 1.0 / module.ensemble.rig.driver.update_Hz
    held: Array = updates_of(play.until(float(play.time_s[-1]) + SETTLING_S), period)
    goals = np.array([held - SENSOR_K, held + SENSOR_K])
    lanes = list(itertools.product(rigs, range(len(goals))))
    rests = [rest_of_a_loop(module.rigs[rig], float(goals[goal, 0])) for rig, goal in lanes]
    rig_of, goal_of = np.array(lanes, dtype=np.int64).T.copy()
    bias, states = np.array([rest[0] for rest in rests]), bank.states([rest[1] for rest in rests])
    bias = np.clip(bias, bank.plates[rig_of, LOWEST_A], bank.plates[rig_of, HIGHEST_A])
    beyond, swing = 0.0, 0.0
    for kp, ki in zip(loop.kp_A_per_K, loop.ki_A_per_Ks, strict=True):
        flowing = np.zeros((len(bank.count), 5))
        flowing[:, [KP, KI, KD]] = np.outer(module.ensemble.gain, [kp, ki, loop.kd_As_per_K])
        flowing[:, LAG_S], flowing[:, DELAY_S] = loop.sensor_lag_at_most_s, loop.delay_at_most_s
        _, display, _ = run_regulate(bank, rig_of, goal_of, period, goals, flowing, bias, states)
        beyond = max(beyond, float(display.max()) - held.max(), held.min() - float(display.min()))
        late = display[:, -max(2, round(1.0 / period)) :]
        swing = max(swing, float(np.ptp(late, axis=1).max()))
    room = min(cut.high - held.max(), held.min() - cut.low) - SENSOR_K
    value, limit = (beyond, room) if beyond > room or swing <= SWING_K else (swing, SWING_K)
    since = float(play.time_s[-1]) if value > limit else None
    gains = f"{loop.kp_A_per_K[1]:g} A/K, {loop.ki_A_per_Ks[1]:g} A/(K·s)"
    what = f"a loop of {gains} and a lag of {loop.sensor_lag_at_most_s:g} s"
    cure = "so that its cut-off would act; use a smaller controller.kp_A_per_K or a faster sensor"
    return Check("swing of the display", "hard", value, limit, "K", float(play.time_s[-1]), since, cure, "", True, what)
