"""The gate for a controller around the rig's own module: its display at the set-points, and the module that follows.

A display that is exactly at its set-points bounds the temperatures of repetition. No module jumps as a set-point does,
so rates, and the hot plate, are those of the module that follows in each corner: in a play, on its return after the
last set-point, and in a second play after the pause.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.icons.number_text import signed

from ..arrays import Array
from ..delivery.delivered_drive import DeliveredDrive
from ..delivery.samples import Samples
from ..delivery.temperatures import follow_samples
from ..rig.corner import with_gain
from ..rig.rig import Rig
from ..safety.checks import Check, colour_of, findings_of, worst_of
from ..safety.corners import corners_of
from ..safety.demands import Demands, SingleFault
from ..safety.ensemble import Ensemble, LaneDrives
from ..safety.gate import Gate
from ..safety.repeated import Repeated, shortest_of
from ..safety.single import checks_of_lanes
from ..safety.single_faults import BEYOND_K, Faulty
from ..safety.tally import WATCHED
from ..safety.thermode import DisplayCourse, Under
from ..safety.thermode_gate import gate_shown
from ..solver.steady import check_sink

HELD = "every set-point reached"

SETTLING_S = 10.0
"""How long a module is followed after the last set-point, to which it returns at its own rate."""

LONGEST_BETWEEN_S = 15.0
"""Pause before the second play of a module at most: by then its display is at the baseline, and only skin is not."""

OF_THE_MODULE = ("rate of skin temperature", "hot plate")
"""What a display that is at its set-points does not bound."""


def gate_controlled(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """Check the set-points of cues that may be played repeatedly in any order by a controller around the rig's module.

    Raises PauseError for an impossible pause, and RigError where the module cannot be at rest.
    """
    rig, shows = deliveries[0].rig, [(_held(delivery),) for delivery in deliveries]
    device = deliveries[0].device
    verdicts = gate_shown(
        shows, rig, stuck_C=device.interval("set-point range"), pause_s=pause_s, rates=False, module=True
    )
    module, under = Module.of(rig), Under.of(rig)
    judged = []
    for delivery, verdict in zip(deliveries, verdicts, strict=True):
        samples = samples_of(delivery)
        once = worst_of([module.once(samples), verdict.once])
        repeated = _repeated(module, samples, verdict.repeated)
        verdict = replace(
            verdict,
            scenarios=verdict.scenarios + len(module.ensemble.corners),
            checks=worst_of([once, verdict.checks, repeated.checks]),
            once=once,
            repeated=repeated,
        )
        judged.append(replace(verdict, demands=_demands(verdict, module, delivery, under)))
    return tuple(judged)


def samples_of(delivery: DeliveredDrive) -> Samples:
    """The samples of a drive whose device plays samples."""
    assert isinstance(delivery.played, Samples)
    return delivery.played


def _held(delivery: DeliveredDrive) -> DisplayCourse:
    """A display that is exactly at its set-points, from one update to the next."""
    samples = samples_of(delivery)
    return DisplayCourse(HELD, 1.0 / samples.rate_Hz, samples.command)


@dataclass(frozen=True, slots=True, eq=False)
class Module:
    """The rig's module in the corners of its uncertainty, in which it follows set-points as fast as its driver can.

    A loop corrects the gain of its current source, but not the limit at which that saturates: `rigs` have the limits as
    they flow. A weaker source is slower, so only the strongest is judged.
    """

    ensemble: Ensemble
    rigs: tuple[Rig, ...]

    @staticmethod
    def of(rig: Rig) -> Module:
        """The rig as given, and its corners with the strongest source."""
        most = rig.uncertainty.gain_relative
        corners = tuple(corner for corner in corners_of(rig) if corner.nominal or corner.gain_relative == most)
        rigs = tuple(with_gain(corner.rig, corner.gain_relative) for corner in corners)
        return Module(Ensemble.on(rig, corners, None), rigs)

    def drives(self, samples: Samples) -> LaneDrives:
        """The currents by which each corner follows set-points, as commanded."""
        flows = [follow_samples(rig, samples, nearest=True) for rig in self.rigs]
        return LaneDrives(flows[0].time_s, np.array([flow.current_A for flow in flows]) / self.ensemble.gain[:, None])

    def checks(self, samples: Samples) -> tuple[Check, ...]:
        """Every rule in its worst corner and ending."""
        return checks_of_lanes(self.ensemble, self.drives(samples), self.ensemble.rig.limits)

    def once(self, samples: Samples) -> tuple[Check, ...]:
        """Every rule for one play, and for the module on its return after the last set-point."""
        arrived = self.checks(_then(samples, SETTLING_S))
        return worst_of([self.checks(samples), _during(arrived, "after the last set-point")])

    def again(self, samples: Samples, pause_s: float) -> tuple[Check, ...]:
        """The rules of `OF_THE_MODULE` in a second play, as far as a pause of that length leaves it away from rest."""
        between_s = min(pause_s, LONGEST_BETWEEN_S)
        twice = self.checks(_then(_then(samples, between_s, samples), SETTLING_S))
        when = f"in a second play {between_s:.4g} s after the first"
        return tuple(check for check in _during(twice, when) if check.quantity in OF_THE_MODULE)

    def unpowered_C(self) -> tuple[float, float]:
        """Between which temperatures in °C the display stands without power; RigError where the sink cannot."""
        off = self.ensemble.at_rest(0.0)
        for nodes in off.nodes_C:
            check_sink(self.ensemble.rig, nodes)
        values, _ = self.ensemble.hold(0.0, off, np.array([0.0, 1.0]))
        display: Array = values[WATCHED.index("display_C"), :, -1]
        return float(display.min()), float(display.max())

    def faulty(self, samples: Samples) -> Faulty:
        """Single faults of the rig as given."""
        nominal, drive = self.ensemble.only([0]), follow_samples(self.rigs[0], samples)
        rest_A = float(drive.current_A[0])
        return Faulty(nominal, drive, rest_A, nominal.at_rest(rest_A), self.ensemble.rig.limits)


def _repeated(module: Module, samples: Samples, shown: Repeated) -> Repeated:
    """The verdict on repeated plays: the display at its set-points, and the module in a second play."""

    def safe(pause_s: float) -> bool:
        return colour_of(findings_of(module.again(samples, pause_s))) != "red"

    again = {(check.quantity, check.severity, check.upper): check for check in module.again(samples, shown.pause_s)}
    with_module = (again.get((check.quantity, check.severity, check.upper), check) for check in shown.checks)
    shortest = least_s = shown.shortest_pause_s
    if least_s is not None and not safe(least_s):
        shortest = shortest_of(lambda pause_s: pause_s >= least_s and safe(pause_s))
    return replace(shown, checks=worst_of([shown.checks, tuple(with_module)]), shortest_pause_s=shortest)


def _then(samples: Samples, hold_s: float, after: Samples | None = None) -> Samples:
    """Samples whose last one, which marks the end, is held for `hold_s`, and what comes after."""
    held = np.full(math.ceil(hold_s * samples.rate_Hz - 1e-9), samples.codes[-1])
    rest = samples.codes[-1:] if after is None else after.codes
    return replace(samples, codes=np.concatenate([samples.codes[:-1], held, rest]))


def _during(checks: Sequence[Check], when: str) -> tuple[Check, ...]:
    """Checks whose scenarios say in which part of a sequence they are, before how it ends."""
    parts = ((check, *check.scenario.partition(", then ")) for check in checks)
    return tuple(replace(check, scenario=f"{corner}, {when}{then}{ending}") for check, corner, then, ending in parts)


def _demands(verdict: Gate, module: Module, delivery: DeliveredDrive, under: Under) -> Demands:
    """What set-points demand, and what a loop that loses its sensor or has its poles swapped does to the module.

    The cut-off leaves room for the display without power: a player starts from there, and returns there after a stop.
    """
    cut, unpowered_C, faulty = (
        verdict.demands.cut_off_display_C,
        module.unpowered_C(),
        module.faulty(samples_of(delivery)),
    )
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
    )


def _rest_s(under: Under, delivery: DeliveredDrive, unpowered_C: tuple[float, float]) -> float | None:
    """How long the loop must hold the baseline after a start without power until the skin is there, in every corner."""
    base = _held(delivery)
    rest = DisplayCourse(HELD, base.step_s, np.full(2, base.display_C[0]))
    times = [under.recovery_s(rest, under.steady(level)) for level in unpowered_C]
    known = [time for time in times if time is not None]
    return max(known) if len(known) == len(times) else None
