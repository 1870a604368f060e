"""The gate for a controller around the rig's own module.

Doses of repetition, and the temperatures of a loop that works, are bounded by a display that is off by the error of
its sensor. Limits for any loop, in any play after any other, are in `any_loop.py`. Here the loop that the set-points
are shaped for is tested for oscillation in the fastest and slowest corners; its simulation shows how a play ends.
"""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thermicon.icons.number_text import signed

from ..arrays import Array
from ..rig.module import ZERO_C_IN_K
from ..safety.checks import Check, Scenario, worst_of
from ..safety.current import checks_of_lanes
from ..safety.demanded import polarity_check
from ..safety.demands import CutOff, Demands, Loop, SingleFault
from ..safety.display import DisplayCourse, DisplayPlant
from ..safety.gate import Gate, gate_shown
from ..safety.held import BEYOND_K
from ..safety.plant import recovery_s
from ..solver.batch_inputs import Bank, run_regulate
from ..solver.kernel_regulate import DELAY_S, KD, KI, KP, LAG_S
from ..solver.network import ALPHA, COLD_J_PER_K, HIGHEST_A, LOWEST_A, RESISTANCE
from .any_loop import SENSOR_K, AnyLoop, Limits_A
from .delivered_drive import DeliveredDrive
from .formats.form import samples_of
from .samples import Samples
from .shaped import LATE_S, PLAYING, looped
from .temperatures import FollowingModule, past_most_cooling, rest_of_a_loop, updates_of

BESIDE_K = 0.5
"""How far beside its set-points a display is judged: a wrong sensor, and what a loop swings by on the average."""
DELAYS_S = (0.1, 0.05, 0.02, 0.01, 0.0)
"""Delays that a loop of the rig may have beside what its file states; the longest that does not swing is demanded."""
WEAKER = 0.5
"""Share of the gains from which on a loop is judged."""
SETTLING_S, SWING_K = 10.0, 0.2
"""How long after the last set-point a loop may swing, and by how much a second before that."""


def gate_controlled(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """Check set-points that a controller around the rig's module may play in any order; PauseError, RigError."""
    rig, stuck_C = deliveries[0].rig, deliveries[0].device.interval("set-point range")
    verdicts = gate_shown(
        [(_beside(delivery, BESIDE_K), _beside(delivery, -BESIDE_K)) for delivery in deliveries],
        rig, stuck_C=stuck_C, pause_s=pause_s, module=True,
    )  # fmt: skip
    module, under = FollowingModule.of(looped(rig)), DisplayPlant.of(rig, stuck_C)
    loops, plays = AnyLoop(module, past_most_cooling(module.rigs)), [samples_of(delivery) for delivery in deliveries]
    cuts, unpowered_C = [verdict.demands.cut_off_display_C for verdict in verdicts], module.unpowered_C()
    reach_C = (
        min(unpowered_C[0], *(cut.low + BEYOND_K for cut in cuts)),
        max(unpowered_C[1], *(cut.high - BEYOND_K for cut in cuts)),
    )
    around = CutOff(reach_C[0] - BEYOND_K, reach_C[1] + BEYOND_K, 0.0)
    limits_A, swings = loops.limits_A(around, plays)
    drives = [module.drives(play) for play in plays]
    flows = np.concatenate([drive.current_A for drive in drives], axis=1)
    used_A = min(0.0, float(flows.min())), max(0.0, float(flows.max()))
    cut, limits_A, held = loops.cut_off(reach_C, limits_A, used_A)
    loop, swung = _judged_loop(loops, plays, limits_A, cut, (LATE_S,) if rig.controller is None else DELAYS_S)
    failed = tuple(check for check in (*swings, *held, *swung) if not check.passed)
    judged = []
    for delivery, verdict, drive in zip(deliveries, verdicts, drives, strict=True):
        once, repeated = worst_of([checks_of_lanes(module.ensemble, drive, rig.limits), verdict.once]), verdict.repeated
        with_module = replace(
            verdict,
            scenarios=verdict.scenarios + len(module.ensemble.corners),
            checks=(*worst_of([once, verdict.checks]), *failed),
            once=(*once, *failed),
            repeated=replace(repeated, shortest_pause_s=None) if failed else repeated,
        )
        demands = _demands(with_module, module, delivery, under, unpowered_C, (loop, limits_A, cut))
        judged.append(replace(with_module, demands=demands))
    alone = [gate_controlled([delivery], pause_s)[0] for delivery in deliveries] if failed and len(judged) > 1 else []
    if all(verdict.safe for verdict in alone):
        return tuple(judged)
    safe = [delivery for delivery, verdict in zip(deliveries, alone, strict=True) if verdict.safe]
    together = iter(gate_controlled(safe, pause_s) if safe else ())  # what is refused by itself is never played
    return tuple(next(together) if verdict.safe else verdict for verdict in alone)


def _beside(delivery: DeliveredDrive, beside_K: float = 0.0) -> DisplayCourse:
    """A display that is this far beside its set-points or what the loop makes of them, whichever is farther out."""
    samples, beyond = samples_of(delivery), np.maximum if beside_K >= 0.0 else np.minimum
    shown = np.interp(samples.time_s, delivery.trace.time_s, delivery.trace.display_C)
    display = beyond(samples.command, shown) + beside_K
    return DisplayCourse(f"display {signed(beside_K, '+g')} K", 1.0 / samples.rate_Hz, display)


def _demands(
    verdict: Gate,
    module: FollowingModule,
    delivery: DeliveredDrive,
    under: DisplayPlant,
    unpowered_C: tuple[float, float],
    proven: tuple[Loop, Limits_A, CutOff],
) -> Demands:
    """Demands of set-points, and of a loop that loses its sensor or has its poles swapped."""
    loop, limits_A, cut = proven
    rest_s = _rest_s(under, delivery, unpowered_C)
    start = SingleFault("unpowered loop", "green", {"display_C": unpowered_C, "rest_s": rest_s})
    faulty = module.faulty(samples_of(delivery))
    polarity, _ = polarity_check(faulty)
    _, stuck = faulty.cut_off((cut.low, cut.high))
    lost = SingleFault("loop lost", stuck.colour, {"harms": stuck.values["harms"], "cut_off": cut})
    return replace(
        verdict.demands,
        cut_off_display_C=cut,
        polarity_check=replace(polarity, needed=True),
        rest_before_first_play_s=rest_s,
        pause_at_least_s=verdict.repeated.shortest_pause_s,
        faults=(verdict.demands.faults[0], start, lost),
        current_limit_A=limits_A,
        loop=loop,
    )


def _rest_s(under: DisplayPlant, delivery: DeliveredDrive, unpowered_C: tuple[float, float]) -> float | None:
    """How long the loop must hold the baseline after a start without power until the skin is there, in every corner."""
    base = _beside(delivery)
    rest = DisplayCourse(base.way, base.step_s, np.full(2, base.display_C[0]))
    times = [recovery_s(under, rest, under.rest(rest), under.steady(level)) for level in unpowered_C]
    known = [time for time in times if time is not None]
    return max(known) if len(known) == len(times) else None


def _judged_loop(
    loops: AnyLoop, plays: Sequence[Samples], limits_A: Limits_A, cut: CutOff, delays_s: Sequence[float]
) -> tuple[Loop, tuple[Check, ...]]:
    """The rig's loop, what it may differ by, and the longest delay that does not swing; then a failed check, if any."""
    bank = loops.within(limits_A)
    middle_K = float(plays[0].command.mean()) + ZERO_C_IN_K
    heat_W_per_A = bank.plates[:, ALPHA] * middle_K - bank.plates[:, LOWEST_A] * bank.plates[:, RESISTANCE]
    speed = heat_W_per_A * loops.module.ensemble.gain / bank.plates[:, COLD_J_PER_K]
    rigs = sorted({0, int(speed.argmin()), int(speed.argmax())})
    slew = max(float(np.abs(np.diff(play.command)).max()) * play.rate_Hz for play in plays)
    own = loops.module.ensemble.rig.controller
    assert own is not None

    def band(gain: float, low: float) -> tuple[float, float]:
        return float(f"{low * gain:.4g}"), float(f"{(1.0 + PLAYING) * gain:.4g}")

    kp, ki = own.kp_A_per_K, own.ki_A_per_Ks
    for delay in delays_s:
        loop = Loop(
            band(kp, WEAKER), band(ki, WEAKER), own.kd_As_per_K, delay, own.lag_s, SENSOR_K, float(f"{slew:.3g}"),
            band(kp, 1.0 - PLAYING), band(ki, 1.0 - PLAYING), own.lag_s,
        )  # fmt: skip
        swings = (_swing(loops, bank, rigs, loop, play, cut) for play in plays)
        failed = tuple(itertools.islice((check for check in swings if not check.passed), 1))
        if not failed:
            break
    return loop, failed


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
    return Check(
        "swing of the display", "hard", value, limit, "K", float(play.time_s[-1]), since, cure, run=Scenario(what)
    )
