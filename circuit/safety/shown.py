"""The display in healthy plays: how far it goes, and how long it stays beyond a temperature."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array

Span = tuple[float, float]

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
