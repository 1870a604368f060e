"""How control loops take over a display that was without power."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..safety.checks import Check
from ..safety.demands import CutOff
from ..safety.held import SENSOR_K, Span, around_C
from ..solver.batch_inputs import Bank, run_regulate
from ..solver.kernel_regulate import KD, KI, KP, LAG_S
from ..solver.network import COLD, HIGHEST_A, LOWEST_A
from .any_loop import AnyLoop, Limits_A
from .samples import Samples
from .shaped import PLAYING

WEAKER = 0.5
"""Share of the gains from which on a loop is judged."""
TAKEN_OVER_S = 60.0
"""A loop has brought a display that was without power to its baseline within this time, or is judged as if never."""


def ends_of(display_C: Array) -> Span:
    """Between which temperatures in °C a display is."""
    return float(display_C.min()), float(display_C.max())


@dataclass(frozen=True, slots=True, eq=False)
class TakeOver:
    """How loops take over a display that was without power: `displays_C` (lanes, updates) of each baseline, what
    displays reach in plays or without power (`played_C`) and then too, and current limits for that.
    """

    displays_C: list[Array]
    played_C: Span
    reach_C: Span
    limits_A: Limits_A

    @staticmethod
    def of(loops: AnyLoop, plays: Sequence[Samples], ends_C: Sequence[Span]) -> tuple[TakeOver, tuple[Check, ...]]:
        """Current limits decide how far a display goes beyond its baseline, and the cut-offs around that the limits."""
        rig = loops.module.ensemble.rig

        def limited(spans_C: Sequence[Span]) -> tuple[Span, Limits_A, tuple[Check, ...]]:
            reach_C = min(low for low, _ in spans_C), max(high for _, high in spans_C)
            return reach_C, *loops.limits_A(CutOff(*around_C(rig.limits, reach_C), 0.0), plays)

        played_C, limits_A, _ = limited(ends_C)
        for most_A in (limits_A, (rig.driver.current_min_A, rig.driver.current_max_A)):
            taken_C = [
                taken_over_C(loops, loops.within(most_A), level_C, is_wound_up=True) for level_C in baselines_C(plays)
            ]
            reach_C, limits_A, checks = limited([*ends_C, *map(ends_of, taken_C)])
            if most_A[0] <= limits_A[0] and limits_A[1] <= most_A[1]:
                break
        return TakeOver(taken_C, played_C, reach_C, limits_A), checks


def baselines_C(plays: Sequence[Samples]) -> list[float]:
    """Where displays are held before plays, in °C."""
    return sorted({float(play.command[0]) for play in plays})


def taken_over_C(loops: AnyLoop, bank: Bank, baseline_C: float, is_wound_up: bool) -> Array:
    """Displays (lanes, updates) that loops take over after no power, by slow integrals and sensors that are wrong.

    Some loops hold an integral at the limit of current, from where it takes its time to come back, instead of stopping
    it: `is_wound_up` begins at the limit towards the baseline, so that the display goes beyond that.
    """
    ensemble, period = loops.module.ensemble, 1.0 / loops.module.ensemble.rig.driver.update_Hz
    own, count, begun = ensemble.rig.controller, len(ensemble.corners), ensemble.at_rest(0.0).nodes_C
    assert own is not None
    lanes, sides = np.tile(ensemble.lanes, 2), np.repeat([0, 1], count).astype(np.int64)
    limits_A = np.where(begun[:, COLD] > baseline_C, bank.plates[:, HIGHEST_A], bank.plates[:, LOWEST_A])
    bias, updates = np.tile(limits_A, 2) * is_wound_up, round(TAKEN_OVER_S / period)
    goals = np.repeat([[baseline_C - SENSOR_K], [baseline_C + SENSOR_K]], updates, axis=1)
    displays_C = []
    for share in (WEAKER, 1.0 + PLAYING):
        gains = np.zeros((count, 5))
        gains[:, [KP, KI, KD]] = np.outer(
            ensemble.gain, [share * own.kp_A_per_K, WEAKER * own.ki_A_per_Ks, own.kd_As_per_K]
        )
        gains[:, LAG_S] = own.lag_s
        displays_C.append(run_regulate(bank, lanes, sides, period, goals, gains, bias, np.tile(begun, (2, 1)))[1])
    return np.concatenate(displays_C)
