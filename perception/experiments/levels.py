"""The method of levels: a staircase of ramps, each answered with yes or no."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ..arrays import Array
from ..observer.channels import Channel
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.bench import Bench
from .classical import said_of
from .measured import Measurement, crowd_of
from .ramps import ramps


def method_of_levels(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    rate_K_per_s: float = 1.0,
    hold_s: float = 1.0,
    first_K: float = 2.0,
    last_K: float = 0.1,
    runs: int = 100,
    seed: int = 0,
    people: People | None = None,
) -> Measurement:
    """Measure a threshold by a staircase of ramps: smaller after yes, larger after no, in steps halved at every turn.

    A run ends when the step is below `last_K`, and counts the mean of its last reported and last unreported level.

    Parameters
    ----------
    observer, bench, channel
        The nominal person, what plays the ramps, and `cold` or `warm`.
    rate_K_per_s
        Rate of the ramps, K/s.
    hold_s
        How long each is held, s.
    first_K
        First level and first step, K.
    last_K
        Step below which a run ends, K.
    runs
        Runs of the nominal person; each of the people runs once.
    seed
        Seed of the answers.
    people
        Virtual people; None: the nominal person alone.

    Returns
    -------
    Measurement
        Threshold of each run, K; inf where even the largest ramp was not reported.

    Raises
    ------
    ValueError
        For no run, and for steps that are not above 0 with the last below the first.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> method_of_levels(Observer.load(), Bench(Rig.load("thenar")), "cold", runs=4).unit
    'K'
    """
    if runs < 1 or not 0.0 < last_K < first_K:
        raise ValueError(f"levels need a run and 0 < last_K < first_K, not {runs}, {last_K:g} and {first_K:g}")
    played, crowd = ramps(bench, channel, rate_K_per_s, hold_s), crowd_of(observer, bench.rig.site, people)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 3]))
    reported = _at_any_level(cache(lambda k: played.reported(k, observer, crowd)), played.sizes_K)
    largest, each = float(played.sizes_K[-1]), []
    for person in range(len(crowd)):
        each += [
            _staircase(reported, person, largest, first_K, last_K, rng)
            for _ in range(1 if people is not None else runs)
        ]
    conditions = f"{said_of(bench, rate_K_per_s)}, held {hold_s:g} s, from {first_K:g} K down to steps of {last_K:g} K"
    return Measurement("method of levels", channel, "K", np.array(each), conditions)


def _at_any_level(at: Callable[[int], Array], sizes_K: Array) -> Callable[[float], Array]:
    """Numbers of people (people,) at a level in K, on log size between the sizes that they are known for."""
    logs = np.log(sizes_K)

    @cache
    def between(level: float) -> Array:
        place = np.log(level)
        k = int(np.clip(np.searchsorted(logs, place), 1, logs.size - 1))
        pair = np.stack([at(k - 1), at(k)])
        return np.array([np.interp(place, logs[k - 1 : k + 1], own) for own in pair.T])

    return between


def _staircase(
    reported: Callable[[float], Array],
    person: int,
    largest_K: float,
    first_K: float,
    last_K: float,
    rng: np.random.Generator,
) -> float:
    """One run over the probability of a report at a level in K; inf when the largest level stays unreported."""
    level, step, last = first_K, first_K, {True: np.inf, False: 0.0}
    before: bool | None = None
    while step >= last_K:
        yes = bool(rng.random() < reported(level)[person])
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
