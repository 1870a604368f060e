"""Demands against single faults in plays and before them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .demands import CutOff, SingleFault
from .held import Span
from .polarity import TEST_S, testing_A
from .single_faults import STUCK_SHARES, Faulty


@dataclass(frozen=True, slots=True)
class InPlays:
    """Demands against a host that hangs and a driver stuck at its limit in plays, with both faults."""

    watchdog_s: float
    cut_off: CutOff
    hangs: SingleFault
    stuck: SingleFault

    @property
    def within_s(self) -> Span:
        """How quickly watchdog and cut-off must act, in s."""
        return self.watchdog_s, self.cut_off.react_within_s


def found_in_plays(faulty: Faulty, hardest: list[int], ends_C: Span) -> InPlays:
    """What prevents faults in plays between bounds: found in the `hardest` corners, again where too slow."""
    for current_A in faulty.ends_A:
        faulty.ensemble.modes(current_A)  # once for all corners and icons
    few = faulty.at(hardest)
    moments = few.moments()
    watchdog_s, hangs = few.watchdog_s(moments)
    cut_off, stuck = few.cut_off(ends_C, moments, hangs=not watchdog_s)
    far_K = few.beyond_K(moments, watchdog_s, cut_off)
    worst = far_K.reshape(len(far_K), len(moments.instants), -1).max(axis=2).argmax(axis=1)
    everywhere = replace(faulty, instants=tuple(np.unique(worst).tolist()))
    moments = everywhere.moments()
    too_slow = (everywhere.beyond_K(moments, watchdog_s, cut_off) > 0.0).any(axis=0)
    if too_slow.any():
        there = faulty.at(np.unique(moments.rigs[too_slow]).tolist())
        moments = there.moments()
        watchdog_s, hangs = min((watchdog_s, hangs), there.watchdog_s(moments), key=lambda found: found[0])
        cut_off, stuck = min(
            (cut_off, stuck),
            there.cut_off(ends_C, moments, hangs=not watchdog_s),
            key=lambda found: found[0].react_within_s,
        )
    return InPlays(watchdog_s, cut_off, hangs, stuck)


def found_at_rest(faulty: Faulty, ends_C: Span) -> tuple[CutOff, SingleFault]:
    """Demands against a driver that gets stuck before a play, between the bounds or without power before."""
    ensemble, off = faulty.ensemble, faulty.ensemble.at_rest(0.0)
    test_A = testing_A(ensemble)
    unpowered = (off, faulty.rest_A), (ensemble.rest(test_A, off, TEST_S), test_A)
    return faulty.cut_off(ends_C, faulty.resting(unpowered), shares=STUCK_SHARES)
