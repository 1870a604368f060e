"""Magnitude rating: how strong does it feel, on a scale of 0 to 100?

A rating is a power of the largest drive in multiples of threshold. Its scatter has two parts: the scatter of ratings as
such, and gain that differs from presentation to presentation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.circuit.records import Table

from ..arrays import Array, own_arrays
from ..observer.channels import Channel
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.bench import Bench
from ..sensation.sensation import sensitivity
from .measured import crowd_of
from .ramps import checked_sizes, ramps
from .task_constants import task_constant

PROCEDURE = "magnitude rating"
RATED_K = (2.75, 5.5, 11.0)
"""The size of the published ratings, 11 K, its half and its quarter."""


@dataclass(frozen=True, slots=True)
class Ratings:
    """Ratings of ramps of several sizes by several people, in points of 100.

    Attributes
    ----------
    channel
        What was rated, `cold` or `warm`.
    sizes_K
        Sizes of the ramps (sizes,), K, without sign.
    mean, sd
        Mean rating and SD within a person (people, sizes), points. The scale is open: a mean may pass 100.
    conditions
        What was played.

    See Also
    --------
    magnitude_rating : rates ramps.

    """

    channel: Channel
    sizes_K: Array
    mean: Array
    sd: Array
    conditions: str

    def __post_init__(self) -> None:
        own_arrays(self, "sizes_K", "mean", "sd")
        if self.mean.shape != self.sd.shape or self.mean.shape[1:] != self.sizes_K.shape:
            raise ValueError(f"ratings: means {self.mean.shape} and SDs {self.sd.shape} of {self.sizes_K.size} sizes")

    @property
    def exponent(self) -> Array:
        """Slope (people,) of the log mean rating over log size."""
        x = np.log(self.sizes_K) - np.log(self.sizes_K).mean()
        slope: Array = np.log(self.mean) @ x / (x @ x)
        return slope

    def d_prime(self, first: int = 0, second: int = -1) -> Array:
        """Difference of the mean ratings of two sizes, by their numbers, over the pooled SD (people,)."""
        pooled = np.sqrt(0.5 * (self.sd[:, first] ** 2 + self.sd[:, second] ** 2))
        apart: Array = (self.mean[:, second] - self.mean[:, first]) / pooled
        return apart

    def __repr__(self) -> str:
        means = ", ".join(f"{each:.3g}" for each in np.median(self.mean, axis=0))
        sizes = ", ".join(f"{each:g}" for each in self.sizes_K)
        return (
            f"Ratings({self.channel}: {means} points for {sizes} K, exponent {np.median(self.exponent):.2f}; "
            f"{len(self.mean)} people; {self.conditions})"
        )


def magnitude_rating(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    sizes_K: Sequence[float] = RATED_K,
    rate_K_per_s: float = 5.0,
    hold_s: float = 0.7,
    records: Table | None = None,
    people: People | None = None,
) -> Ratings:
    """Rate ramps of several sizes on a scale of 0 to 100.

    Parameters
    ----------
    observer
        The nominal person.
    bench
        Rig, baseline and surface.
    channel
        `cold` or `warm`.
    sizes_K
        Sizes of the ramps, rising, K without sign.
    rate_K_per_s
        Rate of the ramps, K/s.
    hold_s
        How long the end of a ramp is held before the rating, s.
    records
        Records with the constants of ratings; None for the shipped ones.
    people
        Persons who rate; None for the nominal one alone.

    Returns
    -------
    Ratings
        Means, SDs, exponent, and d′ between sizes.

    Raises
    ------
    ValueError
        For fewer than two sizes, or sizes that do not rise; and where the records lack a constant of ratings.

    Notes
    -----
    After E2 of the evidence. The unit of a rating, its exponent and its scatter were inferred from that experiment
    alone: another laboratory's scale may differ by a factor.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> rated = magnitude_rating(Observer.load(), Bench(Rig.load("forearm"), 31.0), "cold")
    >>> rated.mean.shape, bool(0.3 < rated.exponent[0] < 0.7), bool(rated.d_prime()[0] > 1.0)
    ((1, 3), True, True)

    """
    sizes = checked_sizes(PROCEDURE, sizes_K, 2)
    unit, exponent = (
        task_constant(PROCEDURE, quantity, observer, records, channel)
        for quantity in ("rating at threshold", "rating exponent")
    )
    scatter = task_constant(PROCEDURE, "scatter of ratings", observer, records)
    played, crowd = ramps(bench, channel, rate_K_per_s, hold_s, sizes), crowd_of(observer, bench.rig.site, people)
    per_drive = sensitivity(channel, observer, bench.rig.contact.area_m2, bench.rig.site)
    per_drive /= observer.receptor(channel).threshold_drive
    peaks = np.array([played.peak_drive(k, observer) for k in range(len(sizes))])
    thresholds = crowd.threshold_cold if channel == "cold" else crowd.threshold_warm
    mean = unit * (per_drive * peaks[None] / thresholds[:, None]) ** exponent
    sd = np.hypot(scatter, exponent * mean * observer.gain_noise)
    said = f"{rate_K_per_s:g} K/s from {bench.baseline_C:g} °C, held {hold_s:g} s, {bench.rig.name}"
    if not math.isfinite(mean.sum()) or not (mean > 0.0).all():
        raise ValueError(f"{PROCEDURE}: a change of {sizes[0]:g} K is not felt at all, {said}: leave it out of sizes_K")
    return Ratings(channel, np.array(sizes), mean, sd, said)
