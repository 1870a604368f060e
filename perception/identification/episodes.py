"""Remembered episodes of icons: stretches of one quality with their features.

Two forms: `episodes` compares intensities in logarithms and places icons symmetrically; `naming` compares ratings.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermicon.base.checks.arguments import InputError
from thermicon.base.numbers.arrays import Array

from ..kernels.parallel import over_rows
from ..observer.channels import CHANNELS, Channel, MemoryForm
from ..observer.observer import Observer
from ..sensation.percept import Percept, on_one_clock

PARTS = ("direction", "intensity", "rate", "duration", "pause")
"""Parts of a distance in the order of the kernel: episodes of one icon alone, and the features of shared ones."""


class EpisodesError(InputError):
    """An icon that is felt as more episodes than are compared from memory."""

    def __init__(self, icon: str, felt: int, most: int) -> None:
        super().__init__(
            f"{icon}: felt as {felt} separate episodes of cold and warmth; memory is computed for at most {most} of an "
            "icon: give it fewer pulses, or make several icons of it"
        )


@dataclass(frozen=True, slots=True)
class Episode:
    """One episode as it is remembered, on the receptor clock; drives are multiples of threshold.

    The length is above half the peak, the pause since the episode before, or since the cue began. `cut` by the end of
    the trace, the length counts for nothing.
    """

    channel: Channel
    start_s: float
    peak: float
    rate_per_s: float
    length_s: float
    pause_s: float
    cut: bool


@dataclass(frozen=True, slots=True)
class Episodes:
    """Episodes: `features` (people, icons, most, features) in the columns of `kernels.episodes`, and their `counts`."""

    features: Array
    counts: NDArray[np.int64]

    @classmethod
    def of(
        cls, psi_cold: ArrayLike, psi_warm: ArrayLike, dt_s: float, observer: Observer, names: ArrayLike = ""
    ) -> Episodes:
        """Episodes of sensations (people, icons, n_time); `names` of the icons are for an `EpisodesError`."""
        from ..kernels import episodes as kernel

        cold, warm = (np.ascontiguousarray(psi, dtype=np.float64) for psi in (psi_cold, psi_warm))
        people, icons, _ = cold.shape
        features = np.zeros((people, icons, kernel.USUAL, kernel.FEATURES))
        counts = np.zeros((people, icons), dtype=np.int64)

        def work(part: slice) -> None:
            kernel.all_episodes(
                cold[part], warm[part], dt_s, observer.episode_bar, observer.a, observer.p, features[part], counts[part]
            )

        over_rows(work, people, cold.size)
        if (most := int(counts.max(initial=0))) > kernel.USUAL:
            if most > kernel.MOST:
                worst = np.unravel_index(counts.argmax(), counts.shape)
                raise EpisodesError(str(np.broadcast_to(names, counts.shape)[worst]) or "an icon", most, kernel.MOST)
            features = np.zeros((people, icons, most, kernel.FEATURES))
            over_rows(work, people, cold.size)
        return cls(features, counts)

    def __len__(self) -> int:
        return int(self.counts.shape[0])

    def listed(self, person: int, icon: int) -> tuple[Episode, ...]:
        """The episodes of one icon for one person."""
        from ..kernels import episodes as kernel

        listed = []
        for row in self.features[person, icon, : self.counts[person, icon]]:
            length, pause = math.exp(row[kernel.LENGTH]), math.exp(row[kernel.PAUSE]) - kernel.PAUSE_FROM_S
            peak, rate = math.exp(row[kernel.INTENSITY]), math.exp(row[kernel.RATE])
            channel = CHANNELS[int(row[kernel.QUALITY])]
            listed.append(
                Episode(channel, float(row[kernel.START]), peak, rate, length, max(pause, 0.0), bool(row[kernel.CUT]))
            )
        return tuple(listed)

    def scaled(self, form: MemoryForm, observer: Observer) -> Episodes:
        """The same with intensities on the scale of a form of memory: ln of drive, or ratings in points."""
        if form != "naming":
            return self
        from ..kernels import episodes as kernel

        features = self.features.copy()
        warm = features[..., kernel.QUALITY] == 1.0
        exponent = np.where(warm, observer.rating_exponent.warm, observer.rating_exponent.cold)
        unit = np.where(warm, observer.rating_at_threshold.warm, observer.rating_at_threshold.cold)
        rated = unit * np.exp(exponent * features[..., kernel.INTENSITY])
        features[..., kernel.NOISE] *= exponent * rated
        features[..., kernel.INTENSITY] = rated
        features[..., kernel.ONSET] = unit * np.exp(exponent * features[..., kernel.ONSET])
        return Episodes(features, self.counts)


def intensity_noise(form: MemoryForm, observer: Observer, memory: Array) -> Array:
    """σ_I (people, 2) of cold and warm on the scale of a form of memory; `memory` (people,) multiplies it."""
    noise = np.array([observer.intensity_noise(channel) for channel in CHANNELS])
    if form == "naming":
        noise = noise * (np.array(observer.rating_exponent) * np.array(observer.mean_rating))
    return np.asarray(memory[:, None] * noise[None, :])


def episode_distances(
    one: Episodes, other: Episodes, observer: Observer, form: MemoryForm, memory: ArrayLike = 1.0
) -> Array:
    """d′ from memory (people, n, m) of each icon of one to each of the other; `memory` (people,) multiplies noise."""
    from ..kernels import alignment

    people = len(one)
    own = np.broadcast_to(np.asarray(memory, dtype=np.float64), (people,))
    first = one.scaled(form, observer)
    second = first if other is one else other.scaled(form, observer)
    intensity, timing = intensity_noise(form, observer, own), observer.timing_noise * own
    apart = np.empty((people, one.counts.shape[1], other.counts.shape[1]))

    def work(part: slice) -> None:
        alignment.distances(
            first.features[part], first.counts[part], second.features[part], second.counts[part], other is one,
            intensity[part], timing[part], apart[part],
        )  # fmt: skip

    over_rows(work, people, apart.size * 20)
    return apart


def distance_shares(
    one: Episodes, i: int, other: Episodes, j: int, observer: Observer, form: MemoryForm
) -> dict[str, float]:
    """Parts of d′² between two icons for the first person, by the names of `PARTS`, without their sign.

    Where the alignment leaves out episodes of the same qualities in the same order, d′² is divided as the features are.
    """
    from ..kernels import alignment
    from ..kernels.episodes import QUALITY

    intensity, timing = intensity_noise(form, observer, np.ones(1))[0], observer.timing_noise
    shares, total, own = np.empty(alignment.SHARES), np.zeros(alignment.SHARES), np.empty(alignment.SHARES)
    first, second = (
        Episodes(held.features[:1, k : k + 1], held.counts[:1, k : k + 1]).scaled(form, observer).features[0, 0, :count]
        for held, k, count in ((one, i, one.counts[0, i]), (other, j, other.counts[0, j]))
    )
    alignment.aligned(first, len(first), second, len(second), intensity, timing, shares)
    if shares[alignment.MISSING] > 0.0 and np.array_equal(first[:, QUALITY], second[:, QUALITY]):
        for x, y in zip(first, second, strict=True):
            alignment.matched(x, y, intensity, timing, own)
            total += own
        shares = shares.sum() * total / total.sum()
    return dict(zip(PARTS, shares.tolist(), strict=True))


def remembered(percepts: Sequence[Percept], observer: Observer | None = None) -> Episodes:
    """Episodes of percepts on one clock for a nominal person (or `observer`); shorter ones are held at their end."""
    person = Observer.load() if observer is None else observer
    cold, warm, dt = on_one_clock(percepts)
    return Episodes.of(cold[None], warm[None], dt, person, [percept.icon or "" for percept in percepts])


def dprimes_from_memory(
    one: tuple[Array, Array],
    other: tuple[Array, Array],
    dt_s: float,
    observer: Observer,
    form: MemoryForm,
    names: tuple[ArrayLike, ArrayLike],
) -> Array:
    """d′ (n, m) of icons to icons for the nominal memory, from sensations (icons, n_time) of cold and of warm."""
    first, second = (
        Episodes.of(cold[None], warm[None], dt_s, observer, called)
        for (cold, warm), called in zip((one, other), names, strict=True)
    )
    return np.asarray(episode_distances(first, second, observer, form)[0])
