"""The gate for a controller around the rig's own module: its display at the set-points, and what any loop may do.

A display that is as far from its set-points as the loop's sensor may be wrong bounds the doses of repetition, and the
temperatures of a loop that works. What no loop may pass, in any play after any other, is in `any_loop.py`; which loops
play the set-points without swinging in `judged_loop.py`. The module that follows shows how a play ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thermicon.icons.number_text import signed

from ..safety.checks import worst_of
from ..safety.demands import CutOff, Demands, Loop, SingleFault
from ..safety.first_plays import polarity_check
from ..safety.gate import Gate
from ..safety.single_faults import BEYOND_K
from ..safety.thermode import DisplayCourse, Under
from ..safety.thermode_gate import gate_shown
from .any_loop import AnyLoop, Limits_A
from .delivered_drive import DeliveredDrive
from .following_module import FollowingModule
from .formats.form import samples_of
from .judged_loop import judged_loop

BESIDE_K = 0.5
"""How far beside its set-points a display is judged: a wrong sensor, and what a loop swings by on the average."""


def gate_controlled(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """Check the set-points of cues that may be played repeatedly in any order by a controller around the rig's module.

    Raises PauseError for an impossible pause, and RigError where the module cannot be at rest.
    """
    rig, device = deliveries[0].rig, deliveries[0].device
    verdicts = gate_shown(
        [(_beside(delivery, BESIDE_K), _beside(delivery, -BESIDE_K)) for delivery in deliveries],
        rig, stuck_C=device.interval("set-point range"), pause_s=pause_s, module=True,
    )  # fmt: skip
    module, under, plays = FollowingModule.of(rig), Under.of(rig), [samples_of(delivery) for delivery in deliveries]
    loops, shown = AnyLoop.of(module), verdicts[0].demands.cut_off_display_C
    reach_C = shown.low + BEYOND_K, shown.high - BEYOND_K
    unpowered_C = module.unpowered_C()
    reach_C = min(reach_C[0], unpowered_C[0]), max(reach_C[1], unpowered_C[1])
    around = CutOff(reach_C[0] - BEYOND_K, reach_C[1] + BEYOND_K, 0.0)
    limits_A, swings = loops.limits_A(around, plays)
    drives = [module.drives(play) for play in plays]
    flows = np.concatenate([drive.current_A for drive in drives], axis=1)
    used_A = min(0.0, float(flows.min())), max(0.0, float(flows.max()))
    cut, limits_A, held = loops.cut_off(reach_C, limits_A, used_A)
    loop, swung = judged_loop(loops, plays, limits_A, cut)
    failed = tuple(check for check in (*swings, *held, *swung) if not check.passed)
    judged = []
    for delivery, verdict, drive in zip(deliveries, verdicts, drives, strict=True):
        once, repeated = worst_of([module.checks(drive), verdict.once]), verdict.repeated
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
    """A display that is this far beside its set-points, from one update to the next."""
    samples = samples_of(delivery)
    return DisplayCourse(f"display {signed(beside_K, '+g')} K", 1.0 / samples.rate_Hz, samples.command + beside_K)


def _demands(
    verdict: Gate,
    module: FollowingModule,
    delivery: DeliveredDrive,
    under: Under,
    unpowered_C: tuple[float, float],
    proven: tuple[Loop, Limits_A, CutOff],
) -> Demands:
    """What set-points demand, and what a loop that loses its sensor or has its poles swapped does to the module.

    The cut-off leaves room for the display without power: a player starts from there, and returns there after a stop.
    """
    loop, limits_A, cut = proven
    rest_s = _rest_s(under, delivery, unpowered_C)
    duration = "10 min or more" if rest_s is None else f"{rest_s:g} s"
    start = SingleFault(
        "first play on a display that was without power",
        "green",
        f"the display is between {signed(unpowered_C[0], '.1f')} and {signed(unpowered_C[1], '.1f')} °C",
        f"holding the baseline for {duration} before the first play",
    )
    faulty = module.faulty(samples_of(delivery))
    polarity, _ = polarity_check(faulty)
    _, stuck = faulty.cut_off((cut.low + BEYOND_K, cut.high - BEYOND_K))
    lost = SingleFault(
        "sensor lost or poles swapped: the loop runs to the driver's limit",
        stuck.colour,
        stuck.text,
        f"a cut-off at {cut.low:g} and {cut.high:g} °C on a second sensor of its own, within {cut.react_within_s:g} s",
    )
    return replace(
        verdict.demands,
        cut_off_display_C=cut,
        polarity_check=replace(polarity, needed=True),
        rest_before_first_play_s=rest_s,
        pause_at_least_s=verdict.repeated.shortest_pause_s,
        faults=(*verdict.demands.faults[:1], start, lost),
        current_limit_A=limits_A,
        loop=loop,
    )


def _rest_s(under: Under, delivery: DeliveredDrive, unpowered_C: tuple[float, float]) -> float | None:
    """How long the loop must hold the baseline after a start without power until the skin is there, in every corner."""
    base = _beside(delivery)
    rest = DisplayCourse(base.way, base.step_s, np.full(2, base.display_C[0]))
    times = [under.recovery_s(rest, under.steady(level)) for level in unpowered_C]
    known = [time for time in times if time is not None]
    return max(known) if len(known) == len(times) else None
