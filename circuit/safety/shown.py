"""The range of a display without a fault and its time beyond a temperature."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..solver.batch_inputs import State
from .held import SENSOR_K, Span
from .polarity import TEST_S
from .single_faults import Faulty
from .tally import WATCHED

DISPLAY = WATCHED.index("display_C")
PAUSE_ROWS_S = np.concatenate([np.arange(50) * 0.1, 5.0 + np.arange(55) * 1.0, 60.0 + np.arange(55) * 10.0])
"""Times after a play, or from the beginning of a rest, at which a display is looked at: up to 10 min."""


@dataclass(frozen=True, slots=True)
class Shown:
    """Between which temperatures in °C a display is without a fault, and for how long in s beyond others at most."""

    low_C: float
    high_C: float
    beyond_s: float

    @property
    def reach_C(self) -> Span:
        """Both temperatures."""
        return self.low_C, self.high_C

    @staticmethod
    def of(every: Iterable[Shown]) -> Shown:
        """What several plays reach together."""
        plays = list(every)
        return Shown(
            min(play.low_C for play in plays),
            max(play.high_C for play in plays),
            max(play.beyond_s for play in plays),
        )


@dataclass(slots=True, eq=False)
class Stay:
    """The longest time without a break for which lanes are beyond two temperatures, added stretch by stretch.

    `since_s` is when lanes were last inside before the first row; a lane that begins beyond the temperatures otherwise,
    or has not come back in the end, may have been and stay there without end.
    """

    span_C: Span
    since_s: float = -math.inf
    longest_s: float = 0.0
    _inside_s: Array | None = None
    _ended: bool = True

    def add(self, time_s: Array, display_C: Array) -> None:
        """Add a display (lanes, rows) in °C at times in s (rows,), which continue those before."""
        inside = (display_C >= self.span_C[0]) & (display_C <= self.span_C[1])
        before_s = np.full(len(display_C), self.since_s) if self._inside_s is None else self._inside_s
        since_s = np.maximum(np.where(inside, time_s, -math.inf), before_s[:, np.newaxis])
        since_s = np.maximum.accumulate(since_s, axis=1)
        self.longest_s = max(self.longest_s, float((time_s - since_s).max()))
        self._inside_s, self._ended = since_s[:, -1], bool(inside[:, -1].all())

    @property
    def beyond_s(self) -> float:
        """The longest time in s; infinite where a lane is beyond them in the end."""
        return self.longest_s if self._ended else math.inf


def healthy_C(lasting: Span) -> Span:
    """Inside of which a sensor that is wrong does not show a display beyond where it may stay."""
    return lasting[0] + SENSOR_K, lasting[1] - SENSOR_K


def longest_rest_s(drives: Sequence[Faulty], left: tuple[State, State], span_C: Span) -> float:
    """For how long in s a rest, after a test of the polarity, leaves a display beyond temperatures while current flows.

    `left` is what it may begin from; infinite where the rest itself is beyond them.
    """
    ensemble, longest_s = drives[0].ensemble, 0.0
    for rest_A in {one.rest_A for one in drives if one.rest_A != 0.0}:
        for state in left:
            stay = Stay(span_C, since_s=0.0)
            stay.add(PAUSE_ROWS_S, ensemble.watch(rest_A, state, PAUSE_ROWS_S, ensemble.lanes, ("display_C",))[0])
            longest_s = max(longest_s, stay.beyond_s)
    return longest_s + TEST_S if longest_s else 0.0


def shown_between(faulty: Faulty, span_C: Span, pause_s: float) -> Shown:
    """What the display reaches in plays that begin between bounds, and how long it is beyond `span_C` with current."""
    ensemble, low_C, high_C, longest_s = faulty.ensemble, math.inf, -math.inf, 0.0
    rows_s = np.append(PAUSE_ROWS_S[pause_s - 1e-6 > PAUSE_ROWS_S], pause_s)
    for begun in faulty.bounds:
        stay = Stay(span_C) if faulty.rest_A else Stay(span_C, since_s=0.0)
        for (times_s, values), state in ensemble.play(faulty.drive, begun):
            display = values[DISPLAY]
            low_C, high_C = min(low_C, float(np.nanmin(display))), max(high_C, float(np.nanmax(display)))
            stay.add(times_s, display)
            after = state
        if faulty.rest_A:
            pause = ensemble.watch(faulty.rest_A, after, rows_s, ensemble.lanes, ("display_C",))[0]
            stay.add(float(faulty.drive.time_s[-1]) + rows_s, pause)
            longest_s = max(longest_s, stay.beyond_s)
        else:
            longest_s = max(longest_s, stay.longest_s)
    return Shown(low_C, high_C, longest_s)
