"""A nominal person asked on a bench, through circuit, skin and observer: how validation plays published experiments.

Published thresholds differ tenfold by method. A forced choice needs no criterion; yes/no, limits, levels and reaction
times have one, set by its false alarms. A bench has a display that may not follow, which `measure` leaves out; where it
follows, both give the same thresholds within 2 %.
Changes are in K at the surface of the bench, without sign; inf: the strongest stimulus is not felt. What is measured
rises with the size of a ramp, so that a threshold is bracketed by bisection: of 33 sizes about six are played and felt.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from statistics import NormalDist

import numpy as np

from ..arrays import Array
from ..observer.channels import CHANNELS, Channel
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.bench import Bench, Stimulus, ramp
from ..sensation.detection import ResponseTimes, detect, response_times
from ..sensation.sensation import receptor_drive, sensation

LEVELS_FIRST_K, LEVELS_LAST_K, LEVELS_HOLD_S = 2.0, 0.1, 1.0
"""First level and first step of a staircase, step below which a run ends, and hold of each ramp at 1 K/s."""
EARLY = 1.0 / 3.0
"""Share of a ramp by whose end nearly everybody has answered: the rest is computed only for those who have not."""


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
    _played: dict[int, Stimulus] = field(default_factory=dict, repr=False)

    @property
    def sizes_K(self) -> Array:
        """Sizes of the ramps (sizes,), K."""
        return SIZES_K[LONGEST_S * self.rate_K_per_s >= SIZES_K]

    def played(self, k: int) -> Stimulus:
        """The ramp of the k-th size."""
        if k not in self._played:
            size = float(SIZES_K[k])
            end = np.ceil(100.0 * (size / self.rate_K_per_s + self.hold_s)) / 100.0
            self._played[k] = self.bench.play([ramp(self.channel, size, self.rate_K_per_s)], end)
        return self._played[k]

    def peak(self, k: int, observer: Observer) -> float:
        """Largest sensation of either channel above rest, d′, of the k-th size."""
        played = self.played(k)
        peaks = []
        for channel in CHANNELS:
            drive = receptor_drive(played.received(observer.variable, channel)[0], played.dt_s, channel, observer)
            # Sensation rises with drive: its largest value is that of the largest drive.
            ends = np.array([drive[0], drive.max()])
            felt = sensation(ends, channel, observer, area_m2=played.area_m2, site=played.site)
            peaks.append(float(felt[1] - felt[0]))
        return max(peaks)

    def reported(self, k: int, observer: Observer) -> float:
        """Probability that the k-th size is reported, corrected for false alarms."""
        played = self.played(k)
        cold, warm = (psi[0, 0] for psi in played.felt(observer))
        return float(detect(cold, warm, played.dt_s, observer, times=False).probability)


@lru_cache(maxsize=32)
def ramps(bench: Bench, channel: Channel, rate_K_per_s: float, hold_s: float) -> Ramps:
    """The ramps of a procedure, kept with what was played of them."""
    return Ramps(bench, channel, rate_K_per_s, hold_s)


def size_reaching(at: Callable[[int], float], sizes_K: Array, target: float) -> float:
    """Size in K at which a number that rises with size reaches a target, on log size; inf where never.

    `at` gives the number for the k-th size. Raises ValueError where the smallest size reaches the target: the answer
    lies outside of what was played.
    """
    value, logs = cache(at), np.log(sizes_K)
    low, high = 0, sizes_K.size
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if value(middle) >= target else (middle + 1, high)
    if low == 0:
        raise ValueError(f"a step of {sizes_K[0]:g} K is felt already: the threshold is smaller than what is played")
    if low == sizes_K.size:
        return float(np.inf)
    return float(np.exp(np.interp(target, [value(low - 1), value(low)], logs[low - 1 : low + 1])))


def forced_choice(
    observer: Observer, bench: Bench, channel: Channel, *, rate_K_per_s: float = 1.0, hold_s: float = 3.0
) -> float:
    """Threshold in a choice of two intervals, one with a ramp that is held: d′ = 1, correct in Φ(1/√2) = 76 %.

    d′ is the largest sensation of either channel above rest. Raises ValueError for a threshold below what is played.

    >>> from thermicon.circuit import Rig
    >>> round(forced_choice(Observer.load(), Bench(Rig.load("thenar")), "cold"), 3)
    0.121
    """
    played = ramps(bench, channel, rate_K_per_s, hold_s)
    # d′ = 1 from its proportion correct and back, to the last digit as calibration has it.
    d_prime = np.sqrt(2.0) * NormalDist().inv_cdf(NormalDist().cdf(2.0**-0.5))

    def log_peak(k: int) -> float:
        return float(np.log(np.maximum(played.peak(k, observer), FEEBLE)))

    return size_reaching(log_peak, played.sizes_K, float(np.log(d_prime)))


def yes_no(
    observer: Observer, bench: Bench, channel: Channel, *, rate_K_per_s: float = 1.0, hold_s: float = 3.0
) -> float:
    """Size of a held ramp that is reported in half of the trials beyond false alarms, by the observer's criterion."""
    played = ramps(bench, channel, rate_K_per_s, hold_s)
    return size_reaching(lambda k: played.reported(k, observer), played.sizes_K, 0.5)


def method_of_limits(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    rate_K_per_s: float = 1.0,
    limit_K: float = 12.0,
    people: People | None = None,
) -> Array:
    """How far (people,) a steady ramp has come when half of the trials are answered; inf: its end comes first.

    The answer waits for criterion, conduction and decision; it may be a false alarm. People differ here in thresholds,
    conduction and decision, not in skin or touch; None is the nominal person.
    """
    played = _ramp(bench, channel, rate_K_per_s, limit_K)
    early = int(EARLY * played.rows)
    pressed = _responses(played, observer, people, rows=early).quantile(0.5)
    late = pressed >= played.dt_s * (early - 1)
    if late.any():
        pressed = np.where(late, _responses(played, observer, people).quantile(0.5), pressed)
    moved = np.abs(played.surface_C(bench.surface)[0] - bench.baseline_C)
    inside = pressed <= limit_K / rate_K_per_s
    return np.where(inside, np.interp(np.where(inside, pressed, 0.0), played.time_s, moved), np.inf)


def choice_reaction_time(
    observer: Observer, bench: Bench, channel: Channel, *, rate_K_per_s: float = 5.0, size_K: float = 8.0
) -> ResponseTimes:
    """Times from the start of a ramp to the answer warm or cold, a distribution of one row."""
    played = _ramp(bench, channel, rate_K_per_s, size_K)
    return _responses(played, observer, None, choice_s=observer.choice_s)


def method_of_levels(observer: Observer, bench: Bench, channel: Channel, *, runs: int = 100, seed: int = 0) -> Array:
    """Thresholds (runs,) by staircases of ramps: smaller after yes, larger after no, in steps halved at every turn.

    A run ends when the step is below LEVELS_LAST_K, and counts the mean of its last reported and last unreported level.
    """
    played = ramps(bench, channel, 1.0, LEVELS_HOLD_S)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 3]))
    reported = _at_any_level(cache(lambda k: played.reported(k, observer)), played.sizes_K)
    return np.array([_staircase(reported, float(played.sizes_K[-1]), rng) for _ in range(runs)])


def _at_any_level(at: Callable[[int], float], sizes_K: Array) -> Callable[[float], float]:
    """A number at a level in K, on log size between the sizes that it is known for."""
    logs = np.log(sizes_K)

    @cache
    def between(level: float) -> float:
        place = np.log(level)
        k = int(np.clip(np.searchsorted(logs, place), 1, logs.size - 1))
        return float(np.interp(place, logs[k - 1 : k + 1], [at(k - 1), at(k)]))

    return between


def _staircase(reported: Callable[[float], float], largest_K: float, rng: np.random.Generator) -> float:
    """One run over the probability of a report at a level in K; inf when the largest level stays unreported."""
    level, step, last = LEVELS_FIRST_K, LEVELS_FIRST_K, {True: np.inf, False: 0.0}
    before: bool | None = None
    while step >= LEVELS_LAST_K:
        yes = bool(rng.random() < reported(level))
        if not yes and level >= largest_K:
            return float(np.inf)
        step = 0.5 * step if before is not None and yes != before else step
        last[yes], before = level, yes
        nearer = level - step if yes else min(level + step, largest_K)
        while nearer <= 0.0:
            step *= 0.5
            nearer = level - step
        level = nearer
    return 0.5 * (last[True] + last[False])


@lru_cache(maxsize=32)
def _ramp(bench: Bench, channel: Channel, rate_K_per_s: float, size_K: float) -> Stimulus:
    return bench.play([ramp(channel, size_K, rate_K_per_s)], round(size_K / rate_K_per_s + 2.0, 2))


def _responses(
    played: Stimulus, observer: Observer, people: People | None, *, choice_s: float = 0.0, rows: int | None = None
) -> ResponseTimes:
    """Answers to a ramp, or to its first rows, by people or the nominal person; `choice_s` is what a choice adds, s."""
    who = replace(People.nominal(), decision_s=np.array([observer.decision_s])) if people is None else people
    path = observer.path_m(played.site) * who.path
    cold, warm = (psi[:, 0, :rows] for psi in played.felt(observer, who.threshold_cold, who.threshold_warm))
    return response_times(
        cold,
        warm,
        played.dt_s,
        observer,
        conduction_s=(observer.delay_s("cold", path), observer.delay_s("warm", path)),
        decision_s=who.decision_s + choice_s,
        criterion=(who.criterion_cold, who.criterion_warm),
    )
