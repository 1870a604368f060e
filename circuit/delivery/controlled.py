"""The gate for a controller around the rig's own module.

Doses of repetition, and the temperatures of a loop that works, are bounded by a display that is off by the error of
its sensor. What holds for every loop is in `loop_proof.py`; a simulation of the one that plays shows how a play ends.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from thermicon.base.words.number_text import signed

from ..safety.checks import worst_of
from ..safety.current import single_of_lanes
from ..safety.demanded import zero_current_s
from ..safety.demands import Demands, SingleFault
from ..safety.display import DisplayCourse, DisplayPlant
from ..safety.fault_limits import DOSE
from ..safety.gate import Gate, gate_shown
from ..safety.plant import recovery_s
from ..safety.tally import worst_of_lanes
from .delivered_drive import DeliveredDrive
from .formats.form import samples_of
from .loop_proof import LoopProof

BESIDE_K = 0.5
"""How far beside its set-points a display is judged: a wrong sensor, and what a loop swings by on the average."""


def gate_controlled(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """Check set-points that a controller around the rig's module may play in any order; PauseError, RigError."""
    judged, proof = _together(deliveries, pause_s)
    if not proof.failed or len(deliveries) == 1:
        return judged
    alone = [gate_controlled([delivery], pause_s)[0] for delivery in deliveries]
    safe = [delivery for delivery, verdict in zip(deliveries, alone, strict=True) if verdict.safe]
    if len(safe) == len(deliveries):
        return judged
    again = iter(gate_controlled(safe, pause_s) if safe else ())  # what is refused by itself is never played
    return tuple(next(again) if verdict.safe else verdict for verdict in alone)


def _together(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[tuple[Gate, ...], LoopProof]:
    """The verdicts on set-points that one controller may play in any order, with what was proven of its module."""
    rig, stuck_C = deliveries[0].rig, deliveries[0].device.interval("set-point range")
    courses = [(_beside(delivery, BESIDE_K), _beside(delivery, -BESIDE_K)) for delivery in deliveries]
    verdicts = gate_shown(courses, rig, stuck_C=stuck_C, pause_s=pause_s, module=True)
    dose_min = max(_dose_min(verdict) for verdict in verdicts)
    proof = LoopProof.of(deliveries, [course for pair in courses for course in pair], dose_min)
    under = DisplayPlant.of(rig, stuck_C)
    joined = tuple(
        _joined(verdict, proof, number, _rest_s(under, delivery, proof.unpowered_C))
        for number, (delivery, verdict) in enumerate(zip(deliveries, verdicts, strict=True))
    )
    return joined, proof


def _joined(verdict: Gate, proof: LoopProof, number: int, rest_s: float | None) -> Gate:
    """The verdict on one display's course with what was proven of its module under any loop."""
    ensemble, limits, repeated = proof.module.ensemble, verdict.limits, verdict.repeated
    single = single_of_lanes(ensemble, proof.drives[number], limits)
    once = worst_of([worst_of_lanes(single.tallies), verdict.once])
    shortest_s = None if proof.failed else repeated.shortest_pause_s
    return replace(
        verdict,
        scenarios=verdict.scenarios + len(ensemble.corners),
        checks=(*worst_of([once, verdict.checks]), *proof.failed),
        once=(*once, *proof.failed),
        repeated=replace(repeated, shortest_pause_s=shortest_s),
        demands=_demands(verdict, proof, rest_s, shortest_s),
    )


def _demands(verdict: Gate, proof: LoopProof, rest_s: float | None, pause_s: float | None) -> Demands:
    """What was proven of the module, with the times that its display demands and the faults of that."""
    hangs = verdict.demands.faults[0]
    start = SingleFault("unpowered loop", "green", {"display_C": proof.unpowered_C, "rest_s": rest_s})
    dose_min = _dose_min(verdict) / max(1, verdict.repeated.plays) + proof.dose_min
    return replace(
        proof.demands,
        watchdog_s=verdict.demands.watchdog_s,
        rest_before_first_play_s=rest_s,
        pause_at_least_s=pause_s,
        zero_current_at_most_s=zero_current_s(proof.module.ensemble, verdict.limits, proof.warmest, dose_min),
        faults=(hangs, start, *proof.inside, *proof.demands.faults),
    )


def _beside(delivery: DeliveredDrive, beside_K: float = 0.0) -> DisplayCourse:
    """A display that is this far beside its set-points or what the loop makes of them, whichever is farther out."""
    samples, beyond = samples_of(delivery), np.maximum if beside_K >= 0.0 else np.minimum
    shown = np.interp(samples.time_s, delivery.trace.time_s, delivery.trace.display_C)
    display = beyond(samples.command, shown) + beside_K
    return DisplayCourse(f"display {signed(beside_K, '+g')} K", 1.0 / samples.rate_Hz, display)


def _dose_min(verdict: Gate) -> float:
    """The dose of a session in min CEM43."""
    return max(check.value for check in verdict.repeated.checks if check.quantity == DOSE)


def _rest_s(under: DisplayPlant, delivery: DeliveredDrive, unpowered_C: tuple[float, float]) -> float | None:
    """How long the loop must hold the baseline after a start without power until the skin is there, in every corner."""
    base = _beside(delivery)
    rest = DisplayCourse(base.way, base.step_s, np.full(2, base.display_C[0]))
    times = [recovery_s(under, rest, under.rest(rest), under.steady(level)) for level in unpowered_C]
    known = [time for time in times if time is not None]
    return max(known) if len(known) == len(times) else None
