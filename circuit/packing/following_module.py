"""The rig's module that follows set-points in the corners of its uncertainty: once, on its return, in a sequence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..delivery.samples import Samples
from ..delivery.temperatures import follow_samples
from ..rig.corner import with_gain
from ..rig.rig import Rig
from ..safety.checks import Check, worst_of
from ..safety.corners import corners_of
from ..safety.ensemble import Ensemble, LaneDrives
from ..safety.single import checks_of_lanes
from ..safety.single_faults import Faulty
from ..safety.tally import WATCHED
from ..solver.simulate import simulate_current
from ..solver.steady import check_sink

SETTLING_S = 10.0
"""How long a module is followed after the last set-point, to which it returns at its own rate."""

LONGEST_BETWEEN_S = 15.0
"""Pause before the second play of a module at most: by then its display is at the baseline, and only skin is not."""

OF_THE_MODULE = ("rate of skin temperature", "hot plate")
"""What a display that is at its set-points does not bound."""


@dataclass(frozen=True, slots=True, eq=False)
class FollowingModule:
    """The rig's module in the corners of its uncertainty, in which it follows set-points as fast as its driver can.

    A loop corrects the gain of its current source, but not the limit at which that saturates: `rigs` have the limits as
    they flow. A weaker source is slower, so only the strongest is judged. Where a set-point cannot be reached the loop
    runs to that limit, since it does not know at which current its module cools most.
    """

    ensemble: Ensemble
    rigs: tuple[Rig, ...]

    @staticmethod
    def of(rig: Rig) -> FollowingModule:
        """The rig as given, and its corners with the strongest source."""
        most = rig.uncertainty.gain_relative
        corners = tuple(corner for corner in corners_of(rig) if corner.nominal or corner.gain_relative == most)
        rigs = tuple(with_gain(corner.rig, corner.gain_relative) for corner in corners)
        return FollowingModule(Ensemble.on(rig, corners, None), rigs)

    def drives(self, samples: Samples) -> LaneDrives:
        """The currents by which each corner follows set-points, as commanded."""
        flows = [follow_samples(rig, samples, to_the_limit=True) for rig in self.rigs]
        return LaneDrives(flows[0].time_s, np.array([flow.current_A for flow in flows]) / self.ensemble.gain[:, None])

    def checks(self, samples: Samples) -> tuple[Check, ...]:
        """Every rule in its worst corner and ending."""
        return checks_of_lanes(self.ensemble, self.drives(samples), self.ensemble.rig.limits)

    def once(self, samples: Samples) -> tuple[Check, ...]:
        """Every rule for one play, and for the module on its return after the last set-point."""
        arrived = self.checks(_then(samples, SETTLING_S))
        returned = (replace(check, part="return") for check in _during(arrived, "after the last set-point"))
        return worst_of([self.checks(samples), tuple(returned)])

    def again(self, play: Samples, pause_s: float, before: Samples) -> tuple[Check, ...]:
        """The rules of `OF_THE_MODULE` in a play after another one, as far as their pause leaves it away from rest."""
        between_s = min(pause_s, LONGEST_BETWEEN_S)
        checks = self.checks(_then(_then(_at_rate(before, play.rate_Hz), between_s, play), SETTLING_S))
        first = "the first" if before is play else "another icon of the set"
        when = f"in {'a second' if before is play else 'a'} play {between_s:.4g} s after {first}"
        return tuple(check for check in _during(checks, when) if check.quantity in OF_THE_MODULE)

    def left_K(self, play: Samples, pause_s: float) -> float:
        """How far from its first set-point a play and a pause leave the display of the rig as given."""
        drive = follow_samples(self.rigs[0], _then(play, min(pause_s, LONGEST_BETWEEN_S)))
        display = simulate_current(drive, self.ensemble.rig, rate_Hz=play.rate_Hz).display_C
        return float(display[-1] - display[0])

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


def _at_rate(samples: Samples, rate_Hz: float) -> Samples:
    """The same set-points at another rate of updates: those of a short buffer are fewer."""
    count = round((len(samples.codes) - 1) * rate_Hz / samples.rate_Hz)
    place = np.floor(np.arange(count) * samples.rate_Hz / rate_Hz + 1e-6).astype(np.int64)
    return replace(samples, rate_Hz=rate_Hz, codes=np.append(samples.codes[place], samples.codes[-1]))


def _then(samples: Samples, hold_s: float, after: Samples | None = None) -> Samples:
    """Samples whose last one, which marks the end, is held for `hold_s`, and what comes after."""
    held = np.full(math.ceil(hold_s * samples.rate_Hz - 1e-9), samples.codes[-1])
    rest = samples.codes[-1:] if after is None else after.codes
    return replace(samples, codes=np.concatenate([samples.codes[:-1], held, rest]))


def _during(checks: Sequence[Check], when: str) -> tuple[Check, ...]:
    """Checks whose scenarios say in which part of a sequence they are, before how it ends."""
    parts = ((check, *check.scenario.partition(", then ")) for check in checks)
    return tuple(replace(check, scenario=f"{corner}, {when}{then}{ending}") for check, corner, then, ending in parts)
