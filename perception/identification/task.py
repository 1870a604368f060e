"""The identification task: effects of the range of the set, of the preceding icon, and of favoured names.

In context coding (Durlach & Braida 1969) an intensity is remembered against the ends of the range in use, and the noise
of memory grows with that range. The one thermal record that we have, the rate task that memory noise is calibrated on,
hardly depends on its span: so by default the noise is constant. `context` says how much of it follows the range.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ..arrays import Array
from ..observer.observer import NORMS, Norm, Observer

NARROWEST = 0.25
"""Below a quarter of the calibrating task's range memory does not improve: then the trace itself is compared."""
LONGEST_GAP_S = 600.0
MOST_BIAS = 5.0


@dataclass(frozen=True, slots=True)
class Task:
    """An identification task; the default is constant memory noise, a long pause before every icon, and no bias.

    There is no thermal record of a `gap_s`, of a `bias`, or of a `context` above 0. The last three fields are filled in
    by `rank` for the icons at hand.

    Attributes
    ----------
    context
        Share of memory noise, in its logarithm, that follows the range of the set, 0–1 (Durlach & Braida 1969).
    gap_s
        Time from the end of one icon to the next, 0 to 600 s; None: all has faded.
    bias
        SD over people and names of the log likelihood that favours a name, 0 to 5.
    carried
        What the icons before change of each (norms, icons), d′.
    counted
        Places of the icons that will be played, which make up the range; none: all.
    places
        Places of the icons in the set that they come from, on which the bias depends.

    Raises
    ------
    ValueError
        For a number out of its range.

    Examples
    --------
    >>> Task(context=1.5)
    Traceback (most recent call last):
    ...
    ValueError: context = 1.5 must lie in 0 to 1: the share of memory noise that follows the range of the set
    """

    context: float = 0.0
    gap_s: float | None = None
    bias: float = 0.0
    carried: tuple[tuple[float, ...], ...] = ()
    counted: tuple[int, ...] = ()
    places: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if not 0.0 <= self.context <= 1.0:
            raise ValueError(
                f"context = {self.context:g} must lie in 0 to 1: the share of memory noise that follows the range of "
                "the set"
            )
        if self.gap_s is not None and not 0.0 <= self.gap_s <= LONGEST_GAP_S:
            raise ValueError(f"a gap of {self.gap_s:g} s between icons must lie in 0 to {LONGEST_GAP_S:g} s")
        if not 0.0 <= self.bias <= MOST_BIAS:
            raise ValueError(f"bias = {self.bias:g} must lie in 0 to {MOST_BIAS:g}: the SD of a log likelihood")

    @property
    def plain(self) -> bool:
        """Whether the task adds only constant memory noise."""
        return self == USUAL

    def asked(self) -> Task:
        """The task without what was filled in for particular icons."""
        return Task(self.context, self.gap_s, self.bias)

    def memory(self, own: Array, peaks: tuple[Array, Array], observer: Observer) -> Array:
        """Multiples of memory noise (people,) for a set with these peak sensations (people, icons), cold and warm."""
        if self.context == 0.0:
            return own
        cold, warm = (peak[:, list(self.counted)] if self.counted else peak for peak in peaks)
        reach = np.maximum(range_of(cold, warm, observer) / reference_range(), NARROWEST)
        found: Array = own * reach**self.context
        return found

    def between(self, noise: Array, norm: Norm) -> Array:
        """Noise (people, icons, icons) between icons that also vary with what was felt before them."""
        if not self.carried:
            return noise
        own = np.array(self.carried[NORMS.index(norm)])
        found: Array = np.sqrt(noise**2 + 0.5 * (own[:, None] ** 2 + own[None, :] ** 2))
        return found

    def louder(self, memory: Array, norm: Norm) -> Array | float:
        """Multiples (people, icons) of the noise of icons that also vary with what was felt before them."""
        if not self.carried:
            return 1.0
        own = np.array(self.carried[NORMS.index(norm)])
        found: Array = np.hypot(1.0, own[None, :] / memory[:, None])
        return found

    def favour(self, first: int, people: int, icons: int, seed: int) -> Array | float:
        """Log likelihoods (people, icons) that favour names; those of a person do not depend on the other people."""
        if self.bias == 0.0:
            return 0.0
        streams = (np.random.SeedSequence([seed, 7], spawn_key=(first + person,)) for person in range(people))
        drawn: Array = self.bias * np.array(
            [np.random.default_rng(stream).standard_normal(icons) for stream in streams]
        )
        return drawn

    def to_dict(self) -> dict[str, Any]:
        """Plain data for `rank --json`."""
        return {"context": self.context, "gap_s": self.gap_s, "bias": self.bias}


USUAL = Task()
"""Constant memory noise, a long pause before every icon, no bias."""


def range_of(psi_cold: Array, psi_warm: Array, observer: Observer) -> Array:
    """Range of a set (people,) in log units: of the peaks (people, icons) in the channel where they differ more.

    Sensation is about a·p·ln of the drive. An icon that a channel does not feel (peak under 1 d′) is not in its range.
    """
    spans = []
    for psi in (psi_cold, psi_warm):
        felt = psi >= 1.0
        low = np.where(felt, psi, math.inf).min(axis=1)
        high = np.where(felt, psi, -math.inf).max(axis=1)
        spans.append(np.where(high > low, high - low, 0.0))
    widest: Array = np.maximum(*spans) / (observer.a * observer.p)
    return widest


@lru_cache(maxsize=1)
def reference_range() -> float:
    """Range in log units of the task that memory noise is calibrated on: its ramps, simulated, by their peaks."""
    from ..observer.observer import load_thresholds
    from .rate_task import peaks_of_task

    observer = Observer.load()
    peaks = peaks_of_task(load_thresholds(), observer)[np.newaxis]
    return float(range_of(peaks, np.zeros_like(peaks), observer)[0])
