"""Cut-off temperatures: outside the display's fault-free range, but tolerable for skin without a time limit.

A driver that is stuck at a current between its limits takes the display to a level at which it stays. Neither watchdog
nor cut-off acts where that lies inside the cut-off, so a display held there must be safe by itself. The skin under a
display that is held depends on contact, room and deep tissue alone, and is linear in the level.
"""

from __future__ import annotations

import math

import numpy as np

from ..rig.rig import Rig
from ..rig.rules import Limits
from ..solver.modes import FELT, modes_of
from .checks import Check
from .corners import contact_corners

BEYOND_K, LEAST_BEYOND_K = 1.0, 0.2
BEYONDS_K = BEYOND_K, 0.5, LEAST_BEYOND_K
"""Cut-offs are this far beyond what the display reaches in any corner, so that they act only on a fault; nearer where a
driver that gets stuck on a display without power would need a cut-off quicker than is practical."""
INSIDE_K = 0.1
"""So far inside a limit must stay what a display leads to that is held: for what follows until a cut-off has acted."""
STEP_K = 0.1
"""Cut-offs are stated in such steps, rounded inwards."""

Span = tuple[float, float]

COLUMN_OF = {"skin surface": "skin_C", "cold-receptor depth": "cold_receptor_C"}

STAYS = (
    "beyond it the skin under a display that stays there passes its own limit, so that no cut-off both lets this play "
    "pass and stops a display that gets stuck: use a smaller or shorter change"
)


def held_C(rig: Rig, limits: Limits) -> Span:
    """Between which temperatures in °C a display may stay without limit of time, in all corners of contact and room."""
    low, high = -math.inf, math.inf
    for corner in contact_corners(rig):
        modes = modes_of(corner.rig)
        at_0, at_1 = (modes.relax(np.zeros(1), level, modes.steady(level))[:, 0] for level in (0.0, 1.0))
        for rule in limits.rules:
            if rule.severity == "hard" and not rule.relative and rule.above_C is None and rule.quantity in COLUMN_OF:
                row = FELT.index(COLUMN_OF[rule.quantity])
                side = -INSIDE_K if rule.upper else INSIDE_K
                level = float((rule.limit + side - at_0[row]) / (at_1[row] - at_0[row]))
                low, high = (low, min(high, level)) if rule.upper else (max(low, level), high)
    return low, high


def around_C(limits: Limits, display_C: Span, held: Span = (-math.inf, math.inf), beyond_K: float = BEYOND_K) -> Span:
    """Where a cut-off acts that lets the display pass between temperatures in °C, and stay at none outside `held`."""
    hard = [rule for rule in limits.rules if rule.quantity == "display" and rule.severity == "hard"]
    limit = {rule.upper: rule.limit for rule in hard if rule.above_C is None}
    low = max(limit[False], display_C[0] - beyond_K, held[0])
    high = min(limit[True], display_C[1] + beyond_K, held[1])
    return inwards(low, high)


def inwards(low: float, high: float) -> Span:
    """Both ends of a cut-off in °C, in whole steps."""
    return round(STEP_K * math.ceil(low / STEP_K - 1e-6), 1), round(STEP_K * math.floor(high / STEP_K + 1e-6), 1)


def stays(display_C: Span, held: Span) -> tuple[Check, ...]:
    """A check that fails for each side on which no cut-off passes what the display reaches and stops what is held."""
    return tuple(
        Check("display without a fault", "hard", reach, limit, "°C", math.nan, math.nan, STAYS, upper=upper)
        for upper, reach, limit in (
            (False, display_C[0], held[0] + LEAST_BEYOND_K),
            (True, display_C[1], held[1] - LEAST_BEYOND_K),
        )
        if (limit - reach if upper else reach - limit) < 0.0
    )
