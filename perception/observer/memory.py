"""How well episodes are remembered: noise of their intensity, and of their rate, length and pauses.

The rate task says how well a rate is remembered. Nothing published says it of intensity: the noise of the rate task
carried over, and the scatter of repeated ratings, differ by a factor of 1.5 to 2.5; λ lies between the two.

    σ_I = σ_T^(1 − λ) · σ_rated^λ,   σ_rated = scatter / (n·rated)   in log units of drive, for ratings g·u^n

No thermal source says that features of episodes and not traces are remembered. No published posterior has constants of
memory, but draws of one laboratory may: they stand in columns of these names.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

from .channels import Channel

NOISE, SHARE = "memory noise (episodes)", "share of the scatter of ratings"
MISSING, BAR = "cost of a missing episode", "bar of an episode"
MEMORY_NAMES = (NOISE, SHARE, MISSING, BAR)
"""Every constant of memory that a table of draws may have a column for."""
OF_MEMORY: Mapping[str, str] = {"timing": NOISE, "share": SHARE, "missing": MISSING, "bar": BAR}
"""Fields of memory by these names."""
LIMITS: Mapping[str, tuple[float, float]] = {
    SHARE: (0.0, 1.0), MISSING: (0.0, math.inf), "correlation of cold and warm": (-1.0, 1.0),
}  # fmt: skip
"""Least and largest value of constants that may be 0; the others must be above 0."""


@dataclass(frozen=True, slots=True)
class Ratings:
    """Ratings g·u^n of drive u in multiples of threshold, in points of 100, and their scatter.

    `at_threshold` is g, `exponent` n, `rated` the mean rating at which they scatter by `scatter` (SD, points).
    """

    at_threshold: float
    exponent: float
    rated: float
    scatter: float

    def __post_init__(self) -> None:
        for field in fields(self):
            if not getattr(self, field.name) > 0.0:
                raise ValueError(f"ratings need {field.name} above 0, not {getattr(self, field.name):g}")

    @property
    def log_scatter(self) -> float:
        """Scatter of the drive that is rated, SD in log units."""
        return self.scatter / (self.exponent * self.rated)


@dataclass(frozen=True, slots=True)
class EpisodeMemory:
    """Noise of remembered episodes: `timing` σ_T of rate, length and pause, `share` λ of the scatter of ratings.

    `bar` is the sensation in d′ that a stretch must reach, and by which a valley must part two, to be remembered.
    `missing` is the cost of a felt episode that a name lacks, beyond its size, when names are given directly: the
    number of features whose noise it would have cost to match it.

    >>> memory = EpisodeMemory(0.3, 0.5, 3.0, 1.0, Ratings(6.0, 0.5, 40.0, 12.0), Ratings(2.3, 0.7, 30.0, 12.0))
    >>> round(memory.intensity("cold"), 3)
    0.424
    """

    timing: float
    share: float
    missing: float
    bar: float
    cold: Ratings
    warm: Ratings

    def __post_init__(self) -> None:
        if not self.bar > 0.0:
            raise ValueError(f"the bar of an episode must be above 0 d′, not {self.bar:g}")
        if not self.timing > 0.0:
            raise ValueError(f"memory noise of episodes must be above 0, not {self.timing:g}")
        if not 0.0 <= self.share <= 1.0:
            raise ValueError(f"the share of the scatter of ratings must lie in 0 to 1, not {self.share:g}")
        if not self.missing >= 0.0:
            raise ValueError(f"the cost of a missing episode must be 0 or more, not {self.missing:g}")

    def ratings(self, channel: Channel) -> Ratings:
        """Ratings of one channel."""
        return self.cold if channel == "cold" else self.warm

    def intensity(self, channel: Channel) -> float:
        """σ_I of a channel in log units of drive."""
        noise: float = self.timing ** (1.0 - self.share) * self.ratings(channel).log_scatter ** self.share
        return noise


def objection_to(name: str, value: float) -> str | None:
    """Why a constant of memory, or one that is positive, cannot have this value; None where it can.

    >>> objection_to("share of the scatter of ratings", 1.5)
    'must lie in 0 to 1'
    """
    if name in LIMITS:
        low, high = LIMITS[name]
        if low <= value <= high:
            return None
        return f"must lie in {low:g} to {high:g}" if math.isfinite(high) else f"must be {low:g} or more"
    return None if value > 0.0 else "must be above 0"
