"""The gate for a controller around the rig's own module: its display at the set-points, and the module that follows.

A display that is exactly at its set-points bounds the temperatures of repetition. No module jumps as a set-point does,
so rates, and the hot plate, are those of the module that follows in each corner: in a play, on its return after the
last set-point, and in a play after itself or after those of the set that leave the display farthest away.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thermicon.icons.number_text import signed

from ..delivery.delivered_drive import DeliveredDrive
from ..delivery.formats.form import samples_of
from ..delivery.samples import Samples
from ..safety.checks import Check, colour_of, findings_of, worst_of
from ..safety.demands import Demands, SingleFault
from ..safety.gate import Gate
from ..safety.repeated import RECOVERED_K, Repeated, shortest_of
from ..safety.single_faults import BEYOND_K
from ..safety.thermode import DisplayCourse, Under
from ..safety.thermode_gate import gate_shown
from .following_module import FollowingModule

HELD = "every set-point reached"


def gate_controlled(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """Check the set-points of cues that may be played repeatedly in any order by a controller around the rig's module.

    Raises PauseError for an impossible pause, and RigError where the module cannot be at rest.
    """
    rig, shows = deliveries[0].rig, [(_held(delivery),) for delivery in deliveries]
    device = deliveries[0].device
    verdicts = gate_shown(
        shows, rig, stuck_C=device.interval("set-point range"), pause_s=pause_s, rates=False, module=True
    )
    module, under, plays = FollowingModule.of(rig), Under.of(rig), [samples_of(delivery) for delivery in deliveries]
    onces = [worst_of([module.once(play), verdict.once]) for play, verdict in zip(plays, verdicts, strict=True)]
    repeats = _repeated(module, plays, [_safe(once) for once in onces], [verdict.repeated for verdict in verdicts])
    judged = []
    for delivery, verdict, once, repeated in zip(deliveries, verdicts, onces, repeats, strict=True):
        with_module = replace(
            verdict,
            scenarios=verdict.scenarios + len(module.ensemble.corners),
            checks=worst_of([once, verdict.checks, repeated.checks]),
            once=once,
            repeated=repeated,
        )
        judged.append(replace(with_module, demands=_demands(with_module, module, delivery, under)))
    return tuple(judged)


def _held(delivery: DeliveredDrive) -> DisplayCourse:
    """A display that is exactly at its set-points, from one update to the next."""
    samples = samples_of(delivery)
    return DisplayCourse(HELD, 1.0 / samples.rate_Hz, samples.command)


def _repeated(
    module: FollowingModule, plays: Sequence[Samples], safe: Sequence[bool], shown: Sequence[Repeated]
) -> list[Repeated]:
    """The verdicts on repeated plays in any order: the display at its set-points, and the module in one after another.

    A play that is not safe by itself is never written, so never part of a sequence, and no pause makes it safe.
    """
    together = [play for play, alone in zip(plays, safe, strict=True) if alone]

    def safe_with(pause_s: float) -> bool:
        return all(_safe(checks) for checks in _in_sequence(module, together, pause_s))

    shortest = least_s = shown[0].shortest_pause_s
    if least_s is not None and not safe_with(least_s):
        shortest = shortest_of(lambda pause_s: pause_s >= least_s and safe_with(pause_s))
    sequences = iter(_in_sequence(module, together, shown[0].pause_s))
    repeats = []
    for repeated, alone in zip(shown, safe, strict=True):
        if alone:
            again = {(check.quantity, check.severity, check.upper): check for check in next(sequences)}
            of_module = (again.get((check.quantity, check.severity, check.upper), check) for check in repeated.checks)
            checks = worst_of([repeated.checks, tuple(of_module)])
            repeats.append(replace(repeated, checks=checks, shortest_pause_s=shortest, faultless_pause_s=shortest))
        else:
            repeats.append(replace(repeated, shortest_pause_s=None))
    return repeats


def _in_sequence(module: FollowingModule, plays: Sequence[Samples], pause_s: float) -> list[tuple[Check, ...]]:
    """Each play after itself, and after those that leave the display farthest above and below the baseline."""
    away: set[int] = set()
    if len(plays) > 1:
        left_K = [module.left_K(play, pause_s) for play in plays]
        extremes = max(left_K), min(left_K)
        away = {left_K.index(extreme) for extreme in extremes if abs(extreme) > RECOVERED_K}
    return [
        worst_of(module.again(play, pause_s, plays[before]) for before in sorted({number, *away}))
        for number, play in enumerate(plays)
    ]


def _safe(checks: Sequence[Check]) -> bool:
    return colour_of(findings_of(checks)) != "red"


def _demands(verdict: Gate, module: FollowingModule, delivery: DeliveredDrive, under: Under) -> Demands:
    """What set-points demand, and what a loop that loses its sensor or has its poles swapped does to the module.

    The cut-off leaves room for the display without power: a player starts from there, and returns there after a stop.
    """
    cut, faulty = verdict.demands.cut_off_display_C, module.faulty(samples_of(delivery))
    unpowered_C = module.unpowered_C()
    reach = (min(cut.low + BEYOND_K, unpowered_C[0]), max(cut.high - BEYOND_K, unpowered_C[1]))
    cut_off, stuck = faulty.cut_off(reach)
    rest_s = _rest_s(under, delivery, unpowered_C)
    duration = "10 min or more" if rest_s is None else f"{rest_s:g} s"
    start = SingleFault(
        "first play on a display that was without power",
        "green",
        f"the display is between {signed(unpowered_C[0], '.1f')} and {signed(unpowered_C[1], '.1f')} °C",
        f"holding the baseline for {duration} before the first play",
    )
    polarity, _ = faulty.polarity()
    lost = replace(stuck, fault="sensor lost or poles swapped: the loop runs to the driver's limit")
    return replace(
        verdict.demands,
        cut_off_display_C=cut_off,
        polarity_check=replace(polarity, needed=True),
        rest_before_first_play_s=rest_s,
        pause_at_least_s=verdict.repeated.shortest_pause_s,
        faults=(*verdict.demands.faults[:1], start, lost),
        current_limit_A=(delivery.rig.driver.current_min_A, delivery.rig.driver.current_max_A),
    )


def _rest_s(under: Under, delivery: DeliveredDrive, unpowered_C: tuple[float, float]) -> float | None:
    """How long the loop must hold the baseline after a start without power until the skin is there, in every corner."""
    base = _held(delivery)
    rest = DisplayCourse(HELD, base.step_s, np.full(2, base.display_C[0]))
    times = [under.recovery_s(rest, under.steady(level)) for level in unpowered_C]
    known = [time for time in times if time is not None]
    return max(known) if len(known) == len(times) else None
