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
from ..rig.rig import Rig
from ..rig.rules import Limits
from ..safety.checks import Check, Scenario, worst_of
from ..safety.current import single_of_lanes
from ..safety.demanded import inside_fault, zero_current_s
from ..safety.demands import CutOff, Demands, Loop, PolarityCheck, SingleFault
from ..safety.display import DisplayCourse, DisplayPlant, for_good_C
from ..safety.ensemble import Ensemble
from ..safety.fault_limits import DOSE, FaultLimits
from ..safety.gate import Gate, gate_shown
from ..safety.held import LASTING_S, SENSOR_K, HeldSkin, Span, Stages, around_C, one_stage, two_stages
from ..safety.plant import recovery_s
from ..safety.polarity import least_fall_K, polarity_check, where_tests_begin
from ..safety.shown import Stay, healthy_C
from ..safety.tally import worst_of_lanes
from ..safety.ways_out import with_ways_out_of_set_points
from ..solver.batch_inputs import Bank, run_regulate
from ..solver.kernel_regulate import DELAY_S, KD, KI, KP, LAG_S
from ..solver.network import ALPHA, COLD_J_PER_K, HIGHEST_A, LOWEST_A, RESISTANCE
from .any_loop import BEYONDS_K, AnyLoop, Limits_A, narrowed_A
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
TAKEN_OVER_S = 60.0
"""A loop has brought a display that was without power to its baseline within this time, or is judged as if never."""
SETTLING_S, SWING_K = 10.0, 0.2
"""How long after the last set-point a loop may swing, and by how much a second before that."""


def gate_controlled(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """Check set-points that a controller around the rig's module may play in any order; PauseError, RigError."""
    rig, stuck_C = deliveries[0].rig, deliveries[0].device.interval("set-point range")
    courses = [(_beside(delivery, BESIDE_K), _beside(delivery, -BESIDE_K)) for delivery in deliveries]
    verdicts = gate_shown(courses, rig, stuck_C=stuck_C, pause_s=pause_s, module=True)
    module, under = FollowingModule.of(looped(rig)), DisplayPlant.of(rig, stuck_C)
    loops, plays = AnyLoop(module, past_most_cooling(module.rigs)), [samples_of(delivery) for delivery in deliveries]
    unpowered_C = module.unpowered_C()
    levels_C = [unpowered_C, *(ends_of(course) for pair in courses for course in pair)]
    reach_C = min(low for low, _ in levels_C), max(high for _, high in levels_C)
    limits_A, swings = loops.limits_A(CutOff(*around_C(rig.limits, reach_C), 0.0), plays)
    drives = [module.drives(play) for play in plays]
    flows = np.concatenate([drive.current_A for drive in drives], axis=1)
    used_A = min(0.0, float(flows.min())), max(0.0, float(flows.max()))
    may = FaultLimits.of(rig.limits, max(_dose_min(verdict) for verdict in verdicts))
    skin = HeldSkin.of(rig, may)
    lasting = skin.lasting_C()
    inside = healthy_C(lasting)
    weakest = loops.within(narrowed_A(limits_A, used_A))
    healthy_s = max(
        *(_beyond_s(course, inside) for pair in courses for course in pair),
        *(_from_no_power_s(loops, weakest, play, inside) for play in plays),
    )
    every = [_stages(rig.limits, skin, reach_C, lasting, healthy_s, beyond_K) for beyond_K in BEYONDS_K]
    cut, stages, limits_A, stuck = loops.cut_off(every, limits_A, used_A, may)
    loop, swung = _judged_loop(loops, plays, limits_A, cut, (LATE_S,) if rig.controller is None else DELAYS_S)
    beyond = stages.failed
    if beyond:
        shown_C = ends_of_traces(deliveries)
        contact = HeldSkin(skin.modes[:1], may).brief_C(lasting, stages.brief_s or LASTING_S)
        beyond = with_ways_out_of_set_points(beyond, shown_C, for_good_C(skin.modes, rig.limits), contact)
    failed = tuple(check for check in (*swings, *beyond, *stuck, *swung) if not check.passed)
    polarity, lost = _wiring(module, rig, plays, cut)
    proven = Demands(
        60.0, cut, polarity, None, None, None, (lost,),
        held_cut_off_display_C=stages.held, current_limit_A=limits_A, loop=loop,
    )  # fmt: skip
    judged = []
    for delivery, verdict, drive in zip(deliveries, verdicts, drives, strict=True):
        single = single_of_lanes(module.ensemble, drive, rig.limits)
        once, repeated = worst_of([worst_of_lanes(single.tallies), verdict.once]), verdict.repeated
        with_module = replace(
            verdict,
            scenarios=verdict.scenarios + len(module.ensemble.corners),
            checks=(*worst_of([once, verdict.checks]), *failed),
            once=(*once, *failed),
            repeated=replace(repeated, shortest_pause_s=None) if failed else repeated,
        )
        demands = _demands(with_module, proven, _rest_s(under, delivery, unpowered_C), unpowered_C)
        dose = _dose_min(verdict) / max(1, repeated.plays) + skin.worst_dose_min(stages)
        zero_s = zero_current_s(module.ensemble, rig.limits, single.end, dose)
        judged.append(replace(with_module, demands=replace(demands, zero_current_at_most_s=zero_s)))
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


def _dose_min(verdict: Gate) -> float:
    """The dose of a session in min CEM43."""
    return max(check.value for check in verdict.repeated.checks if check.quantity == DOSE)


def ends_of(course: DisplayCourse) -> Span:
    """Between which temperatures in °C a display is."""
    return float(course.display_C.min()), float(course.display_C.max())


def ends_of_traces(deliveries: Sequence[DeliveredDrive]) -> Span:
    """Between which temperatures in °C the display of the rig as given is."""
    lows = [float(one.trace.display_C.min()) for one in deliveries]
    highs = [float(one.trace.display_C.max()) for one in deliveries]
    return min(lows), max(highs)


def _beyond_s(course: DisplayCourse, inside_C: Span) -> float:
    """For how long in s a play is beyond temperatures without a break."""
    stay = Stay(inside_C)
    times_s: Array = course.step_s * np.arange(len(course.display_C), dtype=np.float64)
    stay.add(times_s, course.display_C[np.newaxis])
    return stay.beyond_s


def _from_no_power_s(loops: AnyLoop, bank: Bank, play: Samples, inside_C: Span) -> float:
    """For how long in s the weakest loop leaves a display that was without power beyond temperatures."""
    ensemble = loops.module.ensemble
    own, period = ensemble.rig.controller, 1.0 / ensemble.rig.driver.update_Hz
    assert own is not None
    weakest = WEAKER * own.kp_A_per_K, WEAKER * own.ki_A_per_Ks, own.kd_As_per_K
    gains = np.zeros((len(ensemble.corners), 5))
    gains[:, [KP, KI, KD]] = np.outer(ensemble.gain, weakest)
    gains[:, LAG_S] = own.lag_s
    times_s: Array = period * np.arange(round(TAKEN_OVER_S / period), dtype=np.float64)
    goals = np.full((1, len(times_s)), float(play.command[0]))
    lanes, begun = ensemble.lanes, ensemble.at_rest(0.0).nodes_C
    none = np.zeros_like(lanes)
    _, display, _ = run_regulate(bank, lanes, none, period, goals, gains, np.zeros(len(lanes)), begun.copy())
    stay = Stay(inside_C, since_s=0.0)
    stay.add(times_s, display)
    return stay.beyond_s


def _stages(limits: Limits, skin: HeldSkin, reach_C: Span, lasting: Span, healthy_s: float, beyond_K: float) -> Stages:
    """One cut-off where that suffices, else two."""
    first = one_stage(limits, reach_C, lasting, beyond_K)
    return two_stages(limits, skin, reach_C, lasting, healthy_s, beyond_K) if first.failed else first


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


def _demands(verdict: Gate, proven: Demands, rest_s: float | None, unpowered_C: Span) -> Demands:
    """Demands of set-points, with what was proven of every loop."""
    start = SingleFault("unpowered loop", "green", {"display_C": unpowered_C, "rest_s": rest_s})
    hangs, (lost,), cut = verdict.demands.faults[0], proven.faults, proven.cut_off_display_C
    inside = () if proven.held_cut_off_display_C is None else (inside_fault(proven.held_cut_off_display_C, cut),)
    return replace(
        proven,
        watchdog_s=verdict.demands.watchdog_s,
        rest_before_first_play_s=rest_s,
        pause_at_least_s=verdict.repeated.shortest_pause_s,
        faults=(hangs, start, *inside, lost),
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
