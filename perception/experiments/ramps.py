"""Ramps of many sizes on a bench, each played when it is first needed, and the size at which something is reached.

What a procedure measures rises with the size of the ramp, so that a threshold is bracketed by bisection: of 33 sizes
about six are played and felt.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..observer.channels import CHANNELS, Channel
from ..observer.observer import Observer
from ..sensation.bench import Bench, Stimulus, ramp
from ..sensation.detection import detect
from ..sensation.receptors import receptor_drive
from ..sensation.sensation import sensation
from .measured import Crowd

SIZES_K = np.geomspace(0.005, 8.0, 33)
"""Sizes that are played; what lies between them is interpolated on log size."""
SIZES_K.setflags(write=False)
LONGEST_S = 600.0
FEEBLE = 1e-12


@dataclass(frozen=True, eq=False)
class Ramps:
    """Ramps of one channel and rate (K/s) on a bench, each until the end of its own hold (s).

    Slow ramps take at most `LONGEST_S`, so that the largest sizes may be missing.
    """

    bench: Bench
    channel: Channel
    rate_K_per_s: float
    hold_s: float
    every_size_K: tuple[float, ...] = tuple(SIZES_K.tolist())
    _played: dict[int, Stimulus] = field(default_factory=dict, repr=False)

    @property
    def sizes_K(self) -> Array:
        """Sizes of the ramps (sizes,), K."""
        every = np.array(self.every_size_K)
        return every[LONGEST_S * self.rate_K_per_s >= every]

    def played(self, k: int) -> Stimulus:
        """The ramp of the k-th size."""
        if k not in self._played:
            size = self.every_size_K[k]
            end = np.ceil(100.0 * (size / self.rate_K_per_s + self.hold_s)) / 100.0
            self._played[k] = self.bench.play([ramp(self.channel, size, self.rate_K_per_s)], end)
        return self._played[k]

    def peak_drive(self, k: int, observer: Observer) -> float:
        """Largest drive of the ramps' own channel, in `observer.drive_unit`, of the k-th size."""
        played = self.played(k)
        received = played.received(observer.variable, self.channel)[0]
        return float(receptor_drive(received, played.dt_s, self.channel, observer).max())

    def peak(self, k: int, observer: Observer, crowd: Crowd) -> Array:
        """Largest sensation of either channel above rest (people,), d′, of the k-th size."""
        played = self.played(k)
        peaks = []
        for channel, threshold in zip(CHANNELS, (crowd.threshold_cold, crowd.threshold_warm), strict=True):
            drive = receptor_drive(played.received(observer.variable, channel)[0], played.dt_s, channel, observer)
            # Sensation rises with drive: its largest value is that of the largest drive.
            ends = np.broadcast_to([drive[0], drive.max()], (threshold.size, 2))
            felt = sensation(ends, channel, observer, area_m2=played.area_m2, site=played.site, threshold=threshold)
            peaks.append(felt[:, 1] - felt[:, 0])
        return np.maximum(*peaks)

    def reported(self, k: int, observer: Observer, crowd: Crowd) -> Array:
        """Probability (people,) that the k-th size is reported, corrected for false alarms."""
        played = self.played(k)
        cold, warm = played.felt(observer, crowd.threshold_cold, crowd.threshold_warm)
        multiples = [own[:, None] for own in crowd.criterion]
        report = detect(cold, warm, played.dt_s, observer, criterion_cold=multiples[0], criterion_warm=multiples[1])
        probability: Array = report.probability[:, 0]
        return probability


@lru_cache(maxsize=32)
def ramps(
    bench: Bench,
    channel: Channel,
    rate_K_per_s: float,
    hold_s: float,
    sizes_K: tuple[float, ...] = tuple(SIZES_K.tolist()),
) -> Ramps:
    """The ramps of a procedure, kept with what was played of them."""
    return Ramps(bench, channel, rate_K_per_s, hold_s, sizes_K)


def checked_sizes(procedure: str, sizes_K: Sequence[float], least: int) -> tuple[float, ...]:
    """Sizes in K, rising and above 0; a ValueError says what is wrong with others."""
    sizes = tuple(float(size) for size in sizes_K)
    if len(sizes) < least:
        raise ValueError(f"{procedure}: at least {least} sizes are needed, not {len(sizes)}: add to sizes_K")
    if not all(a < b for a, b in pairwise((0.0, *sizes))):
        listed = ", ".join(f"{size:g}" for size in sizes)
        raise ValueError(f"{procedure}: sizes_K must rise from above 0 K, not {listed}: they are without sign")
    return sizes


def size_reaching(at: Callable[[int], Array], sizes_K: Array, target: float) -> Array:
    """Size (people,) in K at which a number that rises with size reaches a target, on log size; inf where never.

    `at` gives the number of every person (people,) for the k-th size. Raises ValueError where the smallest size
    reaches the target: the answer lies outside of what was played.
    """
    values, logs, last = cache(at), np.log(sizes_K), sizes_K.size - 1
    reached = np.full(values(last // 2).size, np.inf)
    for person in range(reached.size):
        low, high = 0, sizes_K.size
        while low < high:
            middle = (low + high) // 2
            low, high = (low, middle) if values(middle)[person] >= target else (middle + 1, high)
        if low == 0:
            raise ValueError(
                f"a step of {sizes_K[0]:g} K is felt already: the threshold is smaller than what is played"
            )
        if low <= last:
            pair = [float(values(k)[person]) for k in (low - 1, low)]
            reached[person] = np.exp(np.interp(target, pair, logs[low - 1 : low + 1]))
    return reached
