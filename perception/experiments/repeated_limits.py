"""The method of limits with repeated trials: every press of every person, and how much people scatter."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, own_arrays
from ..observer.channels import Channel
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.bench import Bench
from .classical import change_at, ramp_responses

PROCEDURE = "repeated limits"
LN10 = math.log(10.0)


@dataclass(frozen=True, slots=True)
class RepeatedLimits:
    """Changes at which people pressed, trial by trial.

    Attributes
    ----------
    channel
        `cold` or `warm`.
    each_K
        Change at the press (people, trials), K without sign; NaN for an anticipation, inf where nobody pressed.
    conditions
        What was played.

    See Also
    --------
    repeated_limits : presses at the first change.

    """

    channel: Channel
    each_K: Array
    conditions: str

    def __post_init__(self) -> None:
        own_arrays(self, "each_K")
        if self.each_K.ndim != 2 or not self.each_K.size:
            raise ValueError(f"{PROCEDURE}: presses must have people and trials, not shape {self.each_K.shape}")

    @property
    def anticipated(self) -> float:
        """Share of trials that were taken for anticipations."""
        return float(np.isnan(self.each_K).mean())

    @property
    def person_K(self) -> Array:
        """Geometric mean over the trials of each person (people,), K; NaN for one with none that counts."""
        return np.exp(self._mean_log())

    @property
    def within_sd_log10(self) -> float:
        """SD over trials of the log10 threshold of the median person; needs two trials that count."""
        counted = np.isfinite(self.each_K).sum(axis=1) > 1
        if not counted.any():
            raise ValueError(f"{PROCEDURE}: an SD within people needs two trials or more that count: raise `trials`")
        return float(np.median(self._variance()[counted] ** 0.5)) / LN10

    @property
    def between_sd_log10(self) -> float:
        """SD over people of log10 thresholds, without what scatter of trials adds to it."""
        means, trials = self._mean_log(), np.isfinite(self.each_K).sum(axis=1)
        felt = np.isfinite(means)
        if felt.sum() < 2:
            raise ValueError(f"{PROCEDURE}: a spread between people needs two who pressed: give `people`")
        noise = np.divide(self._variance(), trials, out=np.zeros(len(trials)), where=trials > 1)
        return math.sqrt(max(float(means[felt].var(ddof=1) - noise[felt].mean()), 0.0)) / LN10

    def _logs(self) -> Array:
        logs: Array = np.log(np.where(np.isfinite(self.each_K), self.each_K, np.nan))
        return logs

    def _mean_log(self) -> Array:
        counted = np.isfinite(self.each_K)
        total, number = np.where(counted, self._logs(), 0.0).sum(axis=1), counted.sum(axis=1)
        means: Array = np.divide(total, number, out=np.full(len(number), np.nan), where=number > 0)
        return means

    def _variance(self) -> Array:
        """Variance over trials (people,) of log thresholds; 0 where fewer than two count."""
        counted = np.isfinite(self.each_K)
        apart = np.where(counted, self._logs() - self._mean_log()[:, None], 0.0)
        number = counted.sum(axis=1) - 1
        variance: Array = np.divide((apart**2).sum(axis=1), number, out=np.zeros(len(number)), where=number > 0)
        return variance

    def __repr__(self) -> str:
        people, trials = self.each_K.shape
        return (
            f"RepeatedLimits({self.channel}: {np.nanmedian(self.person_K):.3g} K, {people} people, {trials} trials; "
            f"{self.conditions})"
        )


def repeated_limits(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    trials: int = 3,
    rate_K_per_s: float = 1.0,
    limit_K: float = 12.0,
    anticipation_K: float = 0.2,
    seed: int = 0,
    people: People | None = None,
) -> RepeatedLimits:
    """Press at the first change, several times: thresholds, scatter within and between people.

    Parameters
    ----------
    observer
        The nominal person.
    bench
        Rig, baseline and surface.
    channel
        `cold` or `warm`.
    trials
        Trials of each person that count.
    rate_K_per_s
        Rate of the ramp, K/s.
    limit_K
        Where the ramp ends, K.
    anticipation_K
        Presses at a change of no more than this are dropped as anticipations, K.
    seed
        Seed of the trials.
    people
        Persons who press; None for the nominal one alone.

    Returns
    -------
    RepeatedLimits
        Every press, with geometric means and spreads.

    Raises
    ------
    ValueError
        For no trial, or an anticipation that is not below the limit.

    See Also
    --------
    method_of_limits : the median of one person's distribution.

    Notes
    -----
    After E3 of the evidence: 1 K/s, three trials after a demonstration, changes up to 0.2 K dropped. The change is that
    of the bench's surface at the press.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> pressed = repeated_limits(Observer.load(), Bench(Rig.load("forearm"), surface="display"), "cold", trials=50)
    >>> pressed.each_K.shape, bool(0.02 < pressed.within_sd_log10 < 0.2)
    ((1, 50), True)

    """
    if trials < 1:
        raise ValueError(f"{PROCEDURE}: at least one trial is needed, not {trials}")
    if not 0.0 <= anticipation_K < limit_K:
        raise ValueError(
            f"{PROCEDURE}: anticipation_K = {anticipation_K:g} K must be 0 or more and below limit_K, {limit_K:g} K"
        )
    played, answered = ramp_responses(observer, bench, channel, rate_K_per_s, limit_K, people)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 5]))
    times = np.stack([_drawn(given, answered.time_s, rng.random(trials)) for given in answered.probability])
    pressed = change_at(times, played, bench, limit_K / rate_K_per_s)
    pressed = np.where(pressed > anticipation_K, pressed, np.nan)
    said = f"{rate_K_per_s:g} K/s at the {bench.surface} from {bench.baseline_C:g} °C up to {limit_K:g} K"
    return RepeatedLimits(channel, pressed, f"{said}, {bench.rig.name}")


def _drawn(given: Array, time_s: Array, shares: Array) -> Array:
    """Times (trials,) at which a distribution of answers reaches shares; inf where it never does."""
    after = np.clip(np.searchsorted(given, shares), 1, given.size - 1)
    step = np.maximum(given[after] - given[after - 1], 1e-300)
    part = np.clip((shares - given[after - 1]) / step, 0.0, 1.0)
    times: Array = time_s[after - 1] + part * (time_s[after] - time_s[after - 1])
    return np.where(shares <= given[-1], times, np.inf)
