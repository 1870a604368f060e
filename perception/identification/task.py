"""The identification task: effects of the range of the set, of the preceding icon, and of favoured names.

In context coding (Durlach & Braida 1969) an intensity is remembered against the ends of the range in use, and the noise
of memory grows with that range. The one thermal record that we have, the rate task that memory noise is calibrated on,
hardly depends on its span: so by default the noise is constant. `context` says how much of it follows the range.

The rate task: Bergmann Tiest & Kappers (2009) found that people distinguish two rates when they differ by a fixed
fraction, whatever the rate and nearly whatever the span. Simulated through this observer's own distance, the fraction
sets memory noise.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from statistics import NormalDist
from typing import Any

import numpy as np

from thermicon.circuit import Rig
from thermicon.circuit.records import Record, Table

from ..arrays import Array
from ..observer.channels import CHANNELS, source_of
from ..observer.observer import NORMS, Norm, Observer, load_thresholds
from ..sensation.bench import Bench, Stimulus, ramp
from ..sensation.percept import perceive_many
from .episodes import Episodes, episode_distances

RIG = "thenar"
TAIL_S = 10.0
LOG_NOISE = (math.log(1e-3), math.log(20.0))
"""Logs of the least and largest noise that is tried."""


def memory_noise(known: Table, observer: Observer) -> Record:
    """Memory noise at which the rate task comes out as published."""
    fraction = known.one("rate Weber fraction")
    rates, spans = known.one("rate of the rate task").interval, known.one("span of the rate task").interval
    criteria = known.one("criterion of the rate task").interval
    cases = [Episodes.of(cold[None], warm[None], dt, observer) for cold, warm, dt in _felt(known, observer)]
    found = [[_noise_of(case, proportion, observer) for case in cases] for proportion in criteria]
    ends = [_root_mean_square(values) for values in found]
    every = [v for values in found for v in values]
    spread = max(max(values) / min(values) for values in found)
    conditions = (
        f"skin-surface coolings at {rates[0]:g} and {rates[1]:g} K/s over {spans[0]:g} and {spans[1]:g} K against "
        f"{1 + fraction.central:g} times the rate; {criteria[0]:g} and {criteria[1]:g} correct are the ends; "
        f"largest over smallest condition {spread:.3f}, all {min(every):.3f} to {max(every):.3f}"
    )
    made = memory_record(source_of(observer.variable), _root_mean_square(ends), min(ends), max(ends))
    return replace(made, source=f"calibrated on: {fraction.source}", conditions=conditions)


def memory_record(variant: str, value: float, low: float, high: float) -> Record:
    """A record of the memory noise of a variant, by the ending of its names; not calibrated yet."""
    return Record(
        quantity=f"memory noise{variant}",
        unit="log units",
        source="not calibrated yet",
        value=value,
        low=low,
        high=high,
        channel="both",
        method="episodes",
        confidence="low",
        use="calibrate",
    )


def _noise_of(episodes: Episodes, proportion: float, observer: Observer) -> float:
    """Memory noise at which a condition comes out with a proportion correct, Φ(d′/√2) in a two-interval choice.

    Intensity is remembered as well as rate.
    """
    from scipy.optimize import brentq

    wanted = math.sqrt(2.0) * NormalDist().inv_cdf(proportion)

    def missed(log_noise: float) -> float:
        memory = replace(observer.memory, timing=math.exp(log_noise), share=0.0)
        person = replace(observer, memory=memory)
        return float(episode_distances(episodes, episodes, person, "episodes")[0, 0, 1]) - wanted

    low, high = LOG_NOISE
    if missed(high) > 0.0 or missed(low) < 0.0:
        raise ValueError(
            f"no memory noise of {math.exp(low):.2g} to {math.exp(high):.2g} log units gives the rate task "
            f"{proportion:g} correct"
        )
    return math.exp(float(brentq(missed, low, high, xtol=1e-6)))


def _felt(known: Table, observer: Observer) -> Iterator[tuple[Array, Array, float]]:
    """Cold and warm sensations (2, n_time) of the published rate discrimination, and the step of their clock in s.

    Every rate and span, against a rate that is larger by the fraction.
    """
    fraction = known.one("rate Weber fraction").central
    rates, spans = known.one("rate of the rate task").interval, known.one("span of the rate task").interval
    for rate, span in itertools.product(rates, spans):
        played = _pair(span, rate, rate * (1.0 + fraction))
        at_cold, at_warm = (played.received(observer.variable, channel) for channel in CHANNELS)
        yield *perceive_many(at_cold, at_warm, played.dt_s, observer), played.dt_s


@lru_cache(maxsize=64)
def _pair(span_K: float, slow: float, fast: float) -> Stimulus:
    end = round(span_K / slow + TAIL_S, 2)
    return Bench(Rig.load(RIG)).play([ramp("cold", span_K, rate) for rate in (slow, fast)], end)


def _root_mean_square(values: Sequence[float]) -> float:
    """Noise of several conditions as one: variances are averaged."""
    return math.sqrt(sum(v * v for v in values) / len(values))


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
        return np.asarray(own * reach**self.context)

    def between(self, noise: Array, norm: Norm) -> Array:
        """Noise (people, icons, icons) between icons that also vary with what was felt before them."""
        if not self.carried:
            return noise
        own = np.array(self.carried[NORMS.index(norm)])
        return np.asarray(np.sqrt(noise**2 + 0.5 * (own[:, None] ** 2 + own[None, :] ** 2)))

    def louder(self, memory: Array, norm: Norm) -> Array | float:
        """Multiples (people, icons) of the noise of icons that also vary with what was felt before them."""
        if not self.carried:
            return 1.0
        own = np.array(self.carried[NORMS.index(norm)])
        return np.asarray(np.hypot(1.0, own[None, :] / memory[:, None]))

    def favour(self, first: int, people: int, icons: int, seed: int) -> Array | float:
        """Log likelihoods (people, icons) that favour names; those of a person do not depend on the other people."""
        if self.bias == 0.0:
            return 0.0
        streams = (np.random.SeedSequence([seed, 7], spawn_key=(first + person,)) for person in range(people))
        return self.bias * np.array([np.random.default_rng(stream).standard_normal(icons) for stream in streams])

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
    return np.asarray(np.maximum(*spans) / (observer.a * observer.p))


@lru_cache(maxsize=1)
def reference_range() -> float:
    """Range in log units of the task that memory noise is calibrated on: its ramps, simulated, by their peaks."""
    observer = Observer.load()
    peaks = np.concatenate([cold.max(axis=-1).ravel() for cold, _, _ in _felt(load_thresholds(), observer)])[np.newaxis]
    return float(range_of(peaks, np.zeros_like(peaks), observer)[0])
