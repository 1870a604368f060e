"""What holds for every loop that may play set-points around a module.

Limits for any loop, in any play after any other, are in `any_loop.py`. Here the loop that the set-points are shaped for
is tested for oscillation in the fastest and slowest corners.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.module import ZERO_C_IN_K
from ..rig.rig import Rig
from ..safety.checks import Check, Scenario
from ..safety.demanded import inside_fault
from ..safety.demands import CutOff, Demands, Loop, PolarityCheck, SingleFault
from ..safety.display import DisplayCourse, for_good_C
from ..safety.ensemble import Ensemble, LaneDrives
from ..safety.fault_limits import FaultLimits
from ..safety.held import LASTING_S, SENSOR_K, HeldSkin, Span, Stages, one_stage, two_stages
from ..safety.polarity import least_fall_K, polarity_check, where_tests_begin
from ..safety.shown import Stay, healthy_C
from ..safety.ways_out import with_ways_out_of_set_points
from ..solver.batch_inputs import Bank, State, run_regulate
from ..solver.kernel_regulate import DELAY_S, KD, KI, KP, LAG_S
from ..solver.network import ALPHA, COLD_J_PER_K, HIGHEST_A, LOWEST_A, RESISTANCE
from .any_loop import BEYONDS_K, AnyLoop, Limits_A, narrowed_A
from .delivered_drive import DeliveredDrive
from .formats.form import samples_of
from .samples import Samples
from .shaped import LATE_S, PLAYING, looped
from .take_over import WEAKER, TakeOver, baselines_C, ends_of, taken_over_C
from .temperatures import FollowingModule, past_most_cooling, rest_of_a_loop, updates_of

DELAYS_S = (0.1, 0.05, 0.02, 0.01, 0.0)
"""Delays that a loop of the rig may have beside what its file states; the longest that does not swing is demanded."""
SETTLING_S, SWING_K = 10.0, 0.2
"""How long after the last set-point a loop may swing, and by how much a second before that."""


@dataclass(frozen=True, slots=True, eq=False)
class LoopProof:
    """What was proven of every loop around a module for some deliveries: demands on it, and the checks that fail.

    `drives` are the currents of each delivery, `dose_min` what a display adds that a fault holds inside the cut-offs,
    and `warmest` the state in which it leaves each corner.
    """

    module: FollowingModule
    drives: list[LaneDrives]
    unpowered_C: Span
    dose_min: float
    warmest: State
    demands: Demands
    failed: tuple[Check, ...]

    @staticmethod
    def of(deliveries: Sequence[DeliveredDrive], courses: Sequence[DisplayCourse], dose_before_min: float) -> LoopProof:
        """Find limits of current, then cut-offs, then gains; `courses` is where displays may go without a fault."""
        rig = deliveries[0].rig
        module, plays = FollowingModule.of(looped(rig)), [samples_of(delivery) for delivery in deliveries]
        loops, unpowered_C = AnyLoop(module, past_most_cooling(module.rigs)), module.unpowered_C()
        without_fault_C = [unpowered_C, *(ends_of(course.display_C) for course in courses)]
        taken_over, moving = TakeOver.of(loops, plays, without_fault_C)
        drives = [module.drives(play) for play in plays]
        used_A = _used_A(drives)
        skin = HeldSkin.of(rig, FaultLimits.of(rig.limits, dose_before_min))
        around = _stages(loops, plays, courses, taken_over, skin, narrowed_A(taken_over.limits_A, used_A))
        cut, stages, limits_A, stuck = loops.cut_off(around, taken_over.limits_A, used_A, skin.limits)
        reaching = _with_ways_out(stages, skin, deliveries, taken_over.played_C)
        delays_s = (LATE_S,) if rig.controller is None else DELAYS_S
        loop, swinging = _judged_loop(loops, plays, limits_A, cut, delays_s)
        if reaching:  # there is no cut-off around the plays that a swing could reach
            swinging = ()
        failed = tuple(check for check in (*moving, *reaching, *stuck, *swinging) if not check.passed)
        polarity, lost = _wiring(module, rig, plays, cut)
        demands = Demands(
            watchdog_s=0.0, cut_off_display_C=cut, polarity_check=polarity, rest_before_first_play_s=None,
            pause_at_least_s=None, zero_current_at_most_s=None, faults=(*loops.swapped(cut, limits_A), lost),
            held_cut_off_display_C=stages.held, current_limit_A=limits_A, loop=loop,
        )  # fmt: skip
        _, warmest = loops.stayed(stages)
        return LoopProof(module, drives, unpowered_C, skin.worst_dose_min(stages), warmest, demands, failed)

    @property
    def inside(self) -> tuple[SingleFault, ...]:
        """The fault of a loop that is stuck where the first cut-off does not act."""
        held = self.demands.held_cut_off_display_C
        return () if held is None else (inside_fault(held, self.demands.cut_off_display_C),)


def ends_of_traces(deliveries: Sequence[DeliveredDrive]) -> Span:
    """Between which temperatures in °C the display of the rig as given is."""
    lows = [float(one.trace.display_C.min()) for one in deliveries]
    highs = [float(one.trace.display_C.max()) for one in deliveries]
    return min(lows), max(highs)


def _beyond_s(display_C: Array, step_s: float, inside_C: Span, since_s: float = -math.inf) -> float:
    """For how long in s displays (lanes, rows) are beyond temperatures without a break."""
    stay, times_s = Stay(inside_C, since_s), step_s * np.arange(display_C.shape[1], dtype=np.float64)
    stay.add(times_s, display_C)
    return stay.beyond_s


def _used_A(drives: Sequence[LaneDrives]) -> Limits_A:
    """Between which currents drives are, and no current."""
    flows_A = np.concatenate([drive.current_A for drive in drives], axis=1)
    return min(0.0, float(flows_A.min())), max(0.0, float(flows_A.max()))


def _stages(
    loops: AnyLoop, plays: Sequence[Samples], courses: Sequence[DisplayCourse], taken_over: TakeOver, skin: HeldSkin,
    narrow_A: Limits_A,
) -> list[Stages]:  # fmt: skip
    """Cut-offs around what displays reach, the farther ones first: one each where that suffices, else two."""
    limits, lasting = loops.module.ensemble.rig.limits, skin.lasting_C()
    reach_C, bank = taken_over.reach_C, loops.within(narrow_A)
    slow_C = (taken_over_C(loops, bank, level_C, is_wound_up=False) for level_C in baselines_C(plays))
    single = [one_stage(limits, reach_C, lasting, beyond_K) for beyond_K in BEYONDS_K]
    if not single[0].failed:  # what fails does not depend on how far beyond a cut-off acts
        return single
    inside, period = healthy_C(lasting), 1.0 / loops.module.ensemble.rig.driver.update_Hz
    stays_s = [_beyond_s(course.display_C[np.newaxis], course.step_s, inside) for course in courses]
    stays_s += [_beyond_s(display_C, period, inside, since_s=0.0) for display_C in (*taken_over.displays_C, *slow_C)]
    return [two_stages(limits, skin, reach_C, lasting, max(stays_s), beyond_K) for beyond_K in BEYONDS_K]


def _with_ways_out(
    stages: Stages, skin: HeldSkin, deliveries: Sequence[DeliveredDrive], played_C: Span
) -> tuple[Check, ...]:
    """What fails of cut-offs, with what would pass."""
    if not stages.failed:
        return ()
    known = HeldSkin(skin.modes[:1], skin.limits).brief_C(stages.lasting, stages.brief_s or LASTING_S)
    thermode_C = for_good_C(skin.modes, deliveries[0].rig.limits)
    return with_ways_out_of_set_points(stages.failed, ends_of_traces(deliveries), thermode_C, known, played_C)


def _wiring(
    module: FollowingModule, rig: Rig, plays: Sequence[Samples], cut: CutOff
) -> tuple[PolarityCheck, SingleFault]:
    """The test of the polarity from any start, and what a loop does that has lost its sensor or its polarity."""
    every = Ensemble.of(rig)
    faulty = [module.faulty(play, every) for play in plays]
    starts = where_tests_begin(every, [one.start for one in faulty], [one.moments() for one in faulty])
    nominal = module.faulty(plays[0], every.only([0]))
    polarity, _ = polarity_check(nominal, least_fall_K(every, starts))
    _, stuck = nominal.cut_off((cut.low, cut.high))
    lost = SingleFault("loop lost", stuck.colour, {"harms": stuck.values["harms"], "cut_off": cut})
    return replace(polarity, needed=True), lost


def _judged_loop(
    loops: AnyLoop, plays: Sequence[Samples], limits_A: Limits_A, cut: CutOff, delays_s: Sequence[float]
) -> tuple[Loop, tuple[Check, ...]]:
    """The rig's loop, what it may differ by, and the longest delay that does not swing; then a failed check, if any."""
    bank = loops.within(limits_A)
    rigs = _slowest_and_fastest(loops, bank, float(plays[0].command.mean()))
    slew = max(float(np.abs(np.diff(play.command)).max()) * play.rate_Hz for play in plays)
    own = loops.module.ensemble.rig.controller
    assert own is not None
    kp, ki = own.kp_A_per_K, own.ki_A_per_Ks
    for delay_s in delays_s:
        loop = Loop(
            _band(kp, WEAKER), _band(ki, WEAKER), own.kd_As_per_K, delay_s, own.lag_s, SENSOR_K, float(f"{slew:.3g}"),
            _band(kp, 1.0 - PLAYING), _band(ki, 1.0 - PLAYING), own.lag_s,
        )  # fmt: skip
        swings = (_swing(loops, bank, rigs, loop, play, cut) for play in plays)
        failed = tuple(itertools.islice((check for check in swings if not check.passed), 1))
        if not failed:
            break
    return loop, failed


def _slowest_and_fastest(loops: AnyLoop, bank: Bank, display_C: float) -> list[int]:
    """The rig as given, and the corners whose display a current moves the least and the most."""
    heat_W_per_A = (
        bank.plates[:, ALPHA] * (display_C + ZERO_C_IN_K) - bank.plates[:, LOWEST_A] * bank.plates[:, RESISTANCE]
    )
    speed = heat_W_per_A * loops.module.ensemble.gain / bank.plates[:, COLD_J_PER_K]
    return sorted({0, int(speed.argmin()), int(speed.argmax())})


def _band(gain: float, low: float) -> tuple[float, float]:
    """From a share of a gain to the greatest with which a loop may play."""
    return float(f"{low * gain:.4g}"), float(f"{(1.0 + PLAYING) * gain:.4g}")


def _swing(loops: AnyLoop, bank: Bank, rigs: Sequence[int], loop: Loop, play: Samples, cut: CutOff) -> Check:
    """How far a play leaves the display beyond its set-points, or swinging after the last of them, at worst."""
    period_s, end_s = 1.0 / loops.module.ensemble.rig.driver.update_Hz, float(play.time_s[-1])
    levels_C: Array = updates_of(play.until(end_s + SETTLING_S), period_s)
    displays_C = _followed_C(loops, bank, rigs, loop, levels_C)
    beyond_K = max(0.0, float(displays_C.max()) - levels_C.max(), levels_C.min() - float(displays_C.min()))
    late_C = displays_C[:, -max(2, round(1.0 / period_s)) :]
    swing_K = float(np.ptp(late_C, axis=1).max())
    room_K = min(cut.high - levels_C.max(), levels_C.min() - cut.low) - SENSOR_K
    value, limit = (beyond_K, room_K) if beyond_K > room_K or swing_K <= SWING_K else (swing_K, SWING_K)
    since_s = end_s if value > limit else None
    gains = f"{loop.kp_A_per_K[1]:g} A/K, {loop.ki_A_per_Ks[1]:g} A/(K·s)"
    what = f"a loop of {gains} and a lag of {loop.sensor_lag_at_most_s:g} s"
    cure = "so that its cut-off would act; use a smaller controller.kp_A_per_K or a faster sensor"
    return Check("swing of the display", "hard", value, limit, "K", end_s, since_s, cure, run=Scenario(what))


def _followed_C(loops: AnyLoop, bank: Bank, rigs: Sequence[int], loop: Loop, levels_C: Array) -> Array:
    """Displays (lanes, updates) of some corners under the weakest and the strongest loop, with wrong sensors."""
    module = loops.module
    goals = np.array([levels_C - SENSOR_K, levels_C + SENSOR_K])
    lanes = list(itertools.product(rigs, range(len(goals))))
    rests = [rest_of_a_loop(module.rigs[rig], float(goals[goal, 0])) for rig, goal in lanes]
    rig_of, goal_of = np.array(lanes, dtype=np.int64).T.copy()
    bias, states = np.array([rest[0] for rest in rests]), bank.states([rest[1] for rest in rests])
    bias = np.clip(bias, bank.plates[rig_of, LOWEST_A], bank.plates[rig_of, HIGHEST_A])
    displays_C, period_s = [], 1.0 / module.ensemble.rig.driver.update_Hz
    for kp, ki in zip(loop.kp_A_per_K, loop.ki_A_per_Ks, strict=True):
        flowing = np.zeros((len(bank.plates), 5))
        flowing[:, [KP, KI, KD]] = np.outer(module.ensemble.gain, [kp, ki, loop.kd_As_per_K])
        flowing[:, LAG_S], flowing[:, DELAY_S] = loop.sensor_lag_at_most_s, loop.delay_at_most_s
        displays_C.append(run_regulate(bank, rig_of, goal_of, period_s, goals, flowing, bias, states)[1])
    return np.concatenate(displays_C)
