"""Displays that a fault holds and how long skin endures them.

A driver that is stuck at a current between its limits takes the display to a level at which it stays. Neither watchdog
nor cut-off acts where that lies inside the cut-off. So a display may stay just inside a cut-off for half an hour, or a
second cut-off acts where it stays beyond a temperature for longer than any healthy play does. The skin under a display
that is held depends on contact, room and deep tissue alone.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..rig.rig import Rig
from ..rig.rules import Limits
from ..solver.modes import FELT, SkinModes, modes_of
from .checks import Check
from .corners import contact_corners
from .demands import HeldCutOff
from .exposure import cem43_min
from .fault_limits import COLUMN_OF, FELT_COLUMNS, FaultLimits

BEYOND_K, LEAST_BEYOND_K = 1.0, 0.2
BEYONDS_K = BEYOND_K, 0.5, LEAST_BEYOND_K
"""Cut-offs are this far beyond what the display reaches in any corner, so that they act only on a fault; nearer where a
driver that gets stuck on a display without power would need a cut-off quicker than is practical."""
INSIDE_K = 0.1
"""So far inside a limit must stay what a display leads to that is held: for what follows until a cut-off has acted."""
STEP_K, STEP_S = 0.1, 0.1
"""Cut-offs are stated in such steps, rounded to the safe side."""
SENSOR_K = 0.3
"""Greatest offset of a sensor: what interchangeable thermistors promise (±0.2 K), and glue."""
LASTING_S = 1800.0
"""A fault is followed for so long: somebody has noticed by then."""
AFTER_S = 5.0
"""So long a dose counts after the output was put off, as if the display stayed: it then falls by kelvins in seconds."""
SLOWER, LEAST_S, LATE_S = 1.25, 5.0, 1.0
"""The second cut-off waits for so many times the longest healthy stay, and for so long at least, and acts so late."""
STEADY_SHARE = 0.8
"""Share of the dose that half an hour under a steady display may take: the rest is for skin that was warmer before."""
FARTHEST_K = 60.0
"""Levels are sought so far from the display before."""

Span = tuple[float, float]

STAYS = (
    "beyond it no cut-off both lets this play pass and stops a display that gets stuck before the skin under it has "
    "passed what a single fault may do"
)
"""Why a display that reaches farther is refused."""


@dataclass(frozen=True, slots=True, eq=False)
class HeldSkin:
    """Skin under a display that is held, in all corners of contact and room, and what a fault may do to it."""

    modes: tuple[SkinModes, ...]
    limits: FaultLimits

    @staticmethod
    def of(rig: Rig, limits: FaultLimits) -> HeldSkin:
        """The skin of a rig."""
        return HeldSkin(tuple(modes_of(corner.rig) for corner in contact_corners(rig)), limits)

    def lasting_C(self) -> Span:
        """Between which temperatures in °C a display may stay for half an hour, as a sensor shows it."""
        middle = float(np.mean([modes.deep_C for modes in self.modes]))
        steady = HeldSkin(self.modes, replace(self.limits, dose_min=STEADY_SHARE * self.limits.dose_min))
        low, high = (
            _farthest(middle, side, lambda level: steady.endures(level, level, LASTING_S)) for side in (-1.0, 1.0)
        )
        return inwards(low + SENSOR_K, high - SENSOR_K)

    def brief_C(self, lasting_C: Span, for_s: float) -> Span:
        """Between which temperatures in °C a display may be for a time in s, after any in which it may stay."""
        colder, warmer = lasting_C[0] - SENSOR_K, lasting_C[1] + SENSOR_K
        low = _farthest(colder, -1.0, lambda level: self.endures(level, colder, for_s))
        high = _farthest(warmer, 1.0, lambda level: self.endures(level, warmer, for_s))
        return inwards(low + SENSOR_K, high - SENSOR_K)

    def endures(self, level_C: float, before_C: float, for_s: float) -> bool:
        """Whether a display at a level for a time in s passes no limit, where skin was steady under another."""
        return all(
            self._limit_holds(modes, level_C, before_C, for_s)
            and self.dose_min(modes, level_C, before_C, for_s) <= self.limits.dose_min
            for modes in self.modes
        )

    def _limit_holds(self, modes: SkinModes, level_C: float, before_C: float, for_s: float) -> bool:
        felt = modes.relax(np.array([for_s]), level_C, modes.steady(before_C))[:, 0]
        for rule in self.limits.temperatures:
            column = COLUMN_OF[rule.quantity]
            if column in FELT_COLUMNS:
                inside_K = rule.limit - float(felt[FELT.index(column)])
                if (inside_K if rule.upper else -inside_K) < INSIDE_K:
                    return False
        return True

    @staticmethod
    def dose_min(modes: SkinModes, level_C: float, before_C: float, for_s: float) -> float:
        """Dose of skin in min CEM43 under a display at a level for a time in s and a little longer."""
        rows = np.concatenate([[0.0], np.geomspace(0.05, for_s + AFTER_S, 80)])
        skin = modes.relax(rows, level_C, modes.steady(before_C))[FELT.index("skin_C")]
        return float(cem43_min(rows, skin)[-1])

    def worst_dose_min(self, stages: Stages) -> float:
        """The largest dose in min CEM43 that a display adds which a fault holds inside the cut-offs."""
        lasting, brief = stages.lasting, stages.brief_s
        doses = [self.dose_min(modes, lasting[1] + SENSOR_K, lasting[1] + SENSOR_K, LASTING_S) for modes in self.modes]
        if brief is not None:
            level, before = stages.ends_C[1] + SENSOR_K, lasting[1] + SENSOR_K
            doses += [self.dose_min(modes, level, before, brief) for modes in self.modes]
        return max(doses)


@dataclass(frozen=True, slots=True)
class Stages:
    """Cut-offs around what a display reaches without a fault: the ends of the first, and the second if needed.

    `lasting`: between which temperatures in °C the display may stay for half an hour.
    """

    reach_C: Span
    ends_C: Span
    lasting: Span
    held: HeldCutOff | None = None
    failed: tuple[Check, ...] = ()

    @property
    def brief_s(self) -> float | None:
        """How long a fault may hold the display beyond the second cut-off, in s."""
        return None if self.held is None else self.held.longer_than_s + LATE_S


def one_stage(limits: Limits, reach_C: Span, lasting: Span, beyond_K: float) -> Stages:
    """A single cut-off, at which a display may stay; failed where the display reaches farther without a fault."""
    ends = around_C(limits, reach_C, lasting, beyond_K)
    return Stages(reach_C, ends, lasting, failed=stays(reach_C, lasting))


def two_stages(
    limits: Limits, skin: HeldSkin, reach_C: Span, lasting: Span, healthy_s: float, beyond_K: float
) -> Stages:
    """A second cut-off that acts after any healthy stay beyond `lasting`, and a first one as far out as that allows."""
    if healthy_s > LASTING_S / SLOWER:
        return one_stage(limits, reach_C, lasting, beyond_K)
    longer_s = round(STEP_S * math.ceil(max(LEAST_S, SLOWER * healthy_s) / STEP_S - 1e-9), 1)
    brief = skin.brief_C(lasting, longer_s + LATE_S)
    ends = around_C(limits, reach_C, brief, beyond_K)
    held = HeldCutOff(max(lasting[0], ends[0]), min(lasting[1], ends[1]), longer_s)
    return Stages(reach_C, ends, lasting, held, stays(reach_C, brief))


def _farthest(begin_C: float, side: float, endures: Callable[[float], bool]) -> float:
    """The level in °C farthest from another, on a side of it, that skin endures; the other where it endures none."""
    steps = range(1, round(FARTHEST_K / STEP_K))
    within = bisect_left(steps, 1, key=lambda step: int(not endures(begin_C + side * STEP_K * step)))
    return begin_C + side * STEP_K * within


def around_C(limits: Limits, display_C: Span, held: Span = (-math.inf, math.inf), beyond_K: float = BEYOND_K) -> Span:
    """Where a cut-off acts that lets the display pass between temperatures in °C, and stay at none outside `held`."""
    limit = {rule.upper: rule.limit for rule in limits.rules if rule.quantity == "display" and rule.always_hard}
    low = max(limit[False], display_C[0] - beyond_K, held[0])
    high = min(limit[True], display_C[1] + beyond_K, held[1])
    return inwards(low, high)


def inwards(low: float, high: float) -> Span:
    """Both ends of a cut-off in °C, in whole steps."""
    return round(STEP_K * math.ceil(low / STEP_K - 1e-6), 1), round(STEP_K * math.floor(high / STEP_K + 1e-6), 1)


def stays(display_C: Span, held: Span, why: str = STAYS) -> tuple[Check, ...]:
    """A check that fails for each side on which no cut-off passes what the display reaches and stops what is held."""
    return tuple(
        Check("display without a fault", "hard", reach, limit, "°C", math.nan, math.nan, why, upper=upper)
        for upper, reach, limit in (
            (False, display_C[0], held[0] + LEAST_BEYOND_K),
            (True, display_C[1], held[1] - LEAST_BEYOND_K),
        )
        if (limit - reach if upper else reach - limit) < 0.0
    )
