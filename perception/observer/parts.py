"""Parts of an observer: receptors and conduction, the transducer of sensation, and memory.

Conduction comes before the decision, delay = path/v_nerve + spine/v_spine. Cold travels in myelinated fibres of the
nerve and in a fast tract, warmth in unmyelinated fibres and a slow tract.

Receptor drive in multiples of threshold becomes sensation in d′: a power near threshold, a logarithm far above it.

    ψ(u) = a·ln(1 + u^p/b),  b = 1/(e^(1/a) − 1),  so that ψ(1) = 1

Near threshold ψ ≈ u^p: p = 1 is a linear observer, p = 2 the square law of energy, under which a pedestal helps.
Far above it equal ratios add equally. Neither a nor p has a thermal source: both are inferred.

Of memory, the rate task says how well a rate is remembered. Nothing published says it of intensity: the noise of the
rate task carried over, and the scatter of repeated ratings, differ by a factor of 1.5 to 2.5; λ lies between the two.

    σ_I = σ_T^(1 − λ) · σ_rated^λ,   σ_rated = scatter / (n·rated)   in log units of drive, for ratings g·u^n

No thermal source says that features of episodes and not traces are remembered. No published posterior has constants of
memory, but draws of one laboratory may: they stand in columns of these names.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from .channels import Channel


@dataclass(frozen=True, slots=True)
class Receptor:
    """Constants of one channel: times s, velocity m/s, exponents and factors 1.

    `limit_C` is the temperature above which there is no cold, or below which there is no warmth, and `softness_K` how
    gradually it sets in (None: no limit). `threshold_drive` is the drive that feels like a threshold, in K or W/m²,
    as the observer's variant has it. `forearm_factor` multiplies thresholds at sites of the forearm.
    `neutral_flux` (W/m² into the skin) bounds complete adaptation where heat flow is what is felt.
    """

    adaptation_s: float
    threshold_drive: float
    velocity_m_per_s: float
    area_exponent: float
    limit_C: float | None = None
    softness_K: float = 0.5
    forearm_factor: float = 1.0
    neutral_flux: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("adaptation_s", "threshold_drive", "velocity_m_per_s", "softness_K", "forearm_factor"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} = {getattr(self, name):g} must be above 0")
        if self.neutral_flux is not None and not self.neutral_flux[0] < self.neutral_flux[1]:
            low, high = self.neutral_flux
            raise ValueError(f"the neutral heat flow {low:g} to {high:g} W/m² is empty")


SPINE_M = 0.225
"""From the cord at the arm's segments to the brain, m; 0.2 to 0.25, assumed for an adult."""

SPINAL_M_PER_S: dict[Channel, float] = {"cold": 12.0, "warm": 2.0}
"""Leone et al. 2020, evoked potentials of healthy people; 1.4 and 2.5 m/s for warmth in a study of 2011."""


def conduction_s(channel: Channel, velocity_m_per_s: float, path_m: ArrayLike) -> Array:
    """Time (s) from the receptor over a nerve path to the cord (m), and from there to the brain.

    >>> float(conduction_s("warm", 1.0, 0.55).round(4))
    0.6625
    """
    found: Array = np.asarray(path_m, dtype=np.float64) / velocity_m_per_s + SPINE_M / SPINAL_M_PER_S[channel]
    return found


@dataclass(frozen=True, slots=True)
class Transducer:
    """Slope `a` (d′) and exponent `p` of sensation, both above 0."""

    a: float
    p: float

    @property
    def b(self) -> float:
        """Constant that makes ψ(1) = 1."""
        return 1.0 / math.expm1(1.0 / self.a)

    def psi(self, multiple: ArrayLike) -> Array:
        """Sensation in d′ of drives in multiples of threshold (0 or more), of the same shape."""
        return np.asarray(self.a * np.log1p(np.asarray(multiple, dtype=np.float64) ** self.p / self.b))

    def multiple(self, psi: ArrayLike) -> Array:
        """Drive in multiples of threshold whose sensation is `psi` in d′.

        >>> Transducer(12.0, 1.5).multiple(Transducer(12.0, 1.5).psi(3.0)).round(9)
        np.float64(3.0)
        """
        return np.asarray((self.b * np.expm1(np.asarray(psi, dtype=np.float64) / self.a)) ** (1.0 / self.p))

    def difference_threshold(self, pedestal: ArrayLike) -> Array:
        """Increment that adds d′ = 1 to a pedestal when nothing but sensory noise counts, in multiples of threshold."""
        base = np.asarray(pedestal, dtype=np.float64)
        return self.multiple(self.psi(base) + 1.0) - base


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


@dataclass(frozen=True, slots=True)
class EpisodeMemory:
    """Noise of remembered episodes: `timing` σ_T of rate, length and pause, `share` λ of the scatter of ratings.

    `bar` is the sensation in d′ that a stretch must reach, and by which a valley must part two, to be remembered.
    `missing` is the cost of a felt episode that a name lacks, beyond its size, when names are given directly: the
    number of features whose noise it would have cost to match it.
    """

    timing: float
    share: float
    missing: float
    bar: float
    cold: Ratings
    warm: Ratings

    def __post_init__(self) -> None:
        for name, value in ((BAR, self.bar), (NOISE, self.timing), (SHARE, self.share), (MISSING, self.missing)):
            if why := objection_to(name, value):
                raise ValueError(f"{name} = {value:g} {why}")

    def ratings(self, channel: Channel) -> Ratings:
        """Ratings of one channel."""
        return self.cold if channel == "cold" else self.warm

    def intensity(self, channel: Channel) -> float:
        """σ_I of a channel in log units of drive."""
        own = self.ratings(channel)
        return float(self.timing ** (1.0 - self.share) * (own.scatter / (own.exponent * own.rated)) ** self.share)


def objection_to(name: str, value: float) -> str | None:
    """Why a constant of memory, or one that is positive, cannot have this value; None where it can."""
    if name in LIMITS:
        low, high = LIMITS[name]
        if low <= value <= high:
            return None
        return f"must lie in {low:g} to {high:g}" if math.isfinite(high) else f"must be {low:g} or more"
    return None if value > 0.0 else "must be above 0"
