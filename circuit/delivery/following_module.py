"""The rig's module that follows set-points in the corners of its uncertainty, as fast as its driver can."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..rig.corner import with_gain
from ..rig.rig import Rig
from ..safety.checks import Check
from ..safety.corners import corners_of
from ..safety.current import checks_of_lanes
from ..safety.ensemble import Ensemble, LaneDrives
from ..safety.single_faults import Faulty
from ..safety.tally import WATCHED
from ..solver.steady import check_sink
from .samples import Samples
from .temperatures import follow_samples


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

    def checks(self, drives: LaneDrives) -> tuple[Check, ...]:
        """Every rule in its worst corner and ending."""
        return checks_of_lanes(self.ensemble, drives, self.ensemble.rig.limits)

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
