"""The rate task: what it says of the noise of memory.

Bergmann Tiest & Kappers (2009) found that people distinguish two rates when they differ by a fixed fraction, whatever
the rate and nearly whatever the span. Simulated through this observer's own distance, the fraction sets memory noise.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from statistics import NormalDist

import numpy as np

from thermicon.circuit import Rig
from thermicon.circuit.records import Record, Table

from ..arrays import Array
from ..observer.channels import CHANNELS
from ..observer.observer import Observer
from ..observer.variants import source_of
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
    cases = rate_task(known, observer)
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


def rate_task(known: Table, observer: Observer) -> list[Episodes]:
    """Episodes of the published rate discrimination: every rate and span, against a rate larger by the fraction."""
    return [Episodes.of(cold[None], warm[None], dt, observer) for cold, warm, dt in _felt(known, observer)]


def peaks_of_task(known: Table, observer: Observer) -> Array:
    """Peak cold sensations of all ramps of the rate task, in d′."""
    return np.concatenate([cold.max(axis=-1).ravel() for cold, _, _ in _felt(known, observer)])


def _felt(known: Table, observer: Observer) -> Iterator[tuple[Array, Array, float]]:
    """Cold and warm sensations (2, n_time) of the two ramps of every condition, and the step of their clock in s."""
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
