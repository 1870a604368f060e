"""When a noisy sensation first passes the criterion: a distribution of times, not one crossing.

Sensation is its mean plus unit noise of autocorrelation e^(−t²/2τ²). The rate of first crossings of
a criterion not passed yet is Rice's for a moving mean, over the probability of being below it; this
takes crossings as independent, good as long as they are rare or the rise is fast (tests compare it
with drawn noise). A response comes later by the conduction of its channel and by decision.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows
from ..observer.channels import CHANNELS
from ..observer.observer import Observer

FARTHEST = -8.0
"""Criterion minus mean, in d′, beyond which the noise is surely above it; keeps the density finite."""


def log_survival(psi: ArrayLike, dt_s: float, criterion: ArrayLike, observer: Observer) -> Array:
    """Log probability (..., n_time) that a channel has not passed its criterion (one, or one a row) by each sample.

    What counts is the change of sensation from its first sample, in either direction.
    """
    from scipy.special import ndtr

    rows, shape = as_rows(psi)
    correlation_s = observer.noise_correlation_s
    criteria = _each(criterion, rows.shape[0])[:, None]
    change = np.abs(rows - rows[:, :1])
    gap = np.maximum(criteria - 0.5 * (change[:, 1:] + change[:, :-1]), FARTHEST)
    speed = np.diff(change, axis=1) / dt_s
    z = speed * correlation_s
    rise = np.exp(-0.5 * z * z) / (np.sqrt(2.0 * np.pi) * correlation_s) + speed * ndtr(z)
    rate = rise * np.exp(-0.5 * gap * gap) / (np.sqrt(2.0 * np.pi) * ndtr(gap))
    start = np.log(ndtr(criteria))
    survived: Array = start - np.concatenate([np.zeros_like(start), np.cumsum(dt_s * rate, axis=1)], axis=1)
    return survived.reshape(shape)


@dataclass(frozen=True, slots=True)
class ResponseTimes:
    """Distributions of response times, one a row: `time_s` (n_time,), `probability` (rows, n_time) of one by then.

    `cold_share` (rows,) is the share of the responses that the cold channel gave.
    """

    time_s: Array
    probability: Array
    cold_share: Array

    def __post_init__(self) -> None:
        for name in ("time_s", "probability", "cold_share"):
            own = np.array(getattr(self, name), dtype=np.float64)
            own.setflags(write=False)
            object.__setattr__(self, name, own)
        if self.probability.shape != (self.cold_share.size, self.time_s.size):
            raise ValueError(f"response times: {self.probability.shape} probabilities for {self.time_s.size} times")

    def quantile(self, share: float = 0.5) -> Array:
        """Time (rows,) by which a response came in this share of trials, s; inf where it comes in fewer.

        Early false alarms count, as they do in an experiment.
        """
        if not 0.0 < share < 1.0:
            raise ValueError(f"a share of trials lies between 0 and 1, not {share:g}")
        found = np.full(self.cold_share.shape, np.inf)
        for row, given in enumerate(self.probability):
            if given[-1] >= share:
                k = max(int(np.searchsorted(given, share)), 1)
                found[row] = np.interp(share, given[k - 1 : k + 1], self.time_s[k - 1 : k + 1])
        return found

    def __repr__(self) -> str:
        low, middle, high = (float(np.median(self.quantile(share))) for share in (0.25, 0.5, 0.75))
        by = f"quarters by {low:.2f}, {middle:.2f} and {high:.2f} s"
        return f"ResponseTimes({self.cold_share.size} rows: {by})"


def response_times(
    psi_cold: ArrayLike,
    psi_warm: ArrayLike,
    dt_s: float,
    observer: Observer,
    *,
    conduction_s: tuple[ArrayLike, ArrayLike],
    decision_s: ArrayLike,
    criterion: tuple[ArrayLike, ArrayLike] = (1.0, 1.0),
) -> ResponseTimes:
    """Response to whichever channel's crossing arrives first; sensations of shape (..., n_time).

    `conduction_s` (cold, warm), `decision_s` in s and `criterion` (cold, warm), in multiples of the observer's, are one
    number or one for each leading index. Gain and decision differ from trial to trial. Times run on past the end of
    the sensations by the slowest delay, so that none is cut off.

    >>> import numpy as np
    >>> rise = np.minimum(np.arange(0.0, 2.0, 0.01) * 20.0, 20.0)
    >>> found = response_times(rise, 0 * rise, 0.01, Observer.load(), conduction_s=(0.3, 1.4), decision_s=0.2)
    >>> bool(0.5 < found.quantile()[0] < 0.9)
    True
    """
    felt = {c: as_rows(psi)[0] for c, psi in zip(CHANNELS, (psi_cold, psi_warm), strict=True)}
    rows, samples = felt["cold"].shape
    criteria = {c: observer.criterion * _each(own, rows) for c, own in zip(CHANNELS, criterion, strict=True)}
    conduction = {c: _each(own, rows) for c, own in zip(CHANNELS, conduction_s, strict=True)}
    decisions = [_each(decision_s, rows) * np.exp(spread) for spread in quarters(observer.decision_noise)]
    latest = max(float(each.max()) for each in conduction.values()) + max(float(each.max()) for each in decisions)
    time = dt_s * np.arange(samples + int(np.ceil(latest / dt_s)) + 1)
    still, by_cold, trials = np.zeros((rows, time.size)), np.zeros(rows), 0
    for gain in quarters(observer.gain_noise):
        logs = {c: log_survival(_with_gain(felt[c], gain, observer), dt_s, criteria[c], observer) for c in CHANNELS}
        for decision in decisions:
            trials += 1
            arrived = {
                c: np.stack([_arrived(logs[c][k], time, dt_s, conduction[c][k] + decision[k]) for k in range(rows)])
                for c in CHANNELS
            }
            left = np.exp(arrived["cold"] + arrived["warm"])
            still += left
            by_cold += (-np.diff(arrived["cold"], axis=1) * 0.5 * (left[:, 1:] + left[:, :-1])).sum(axis=1)
    still, by_cold = still / trials, by_cold / trials
    given = 1.0 - still[:, -1]
    share = np.divide(by_cold, given, out=np.zeros(rows), where=given > 0.0)
    return ResponseTimes(time, 1.0 - still, np.clip(share, 0.0, 1.0))


def quarters(sd: float) -> Array:
    """A normal number of mean 0 at the middles of four equal parts of its distribution; 0 alone where it has no spread.

    >>> quarters(1.0).round(2)
    array([-1.15, -0.32,  0.32,  1.15])
    """
    if sd == 0.0:
        return np.zeros(1)
    return sd * np.array([NormalDist().inv_cdf(share) for share in (0.125, 0.375, 0.625, 0.875)])


def _with_gain(psi: Array, log_gain: float, observer: Observer) -> Array:
    """Sensations of drives that are larger by a gain: u^p/b is e^(ψ/a) − 1."""
    if log_gain == 0.0:
        return psi
    louder: Array = observer.a * np.log1p(np.exp(observer.p * log_gain) * np.expm1(psi / observer.a))
    return louder


def _each(values: ArrayLike, rows: int) -> Array:
    return np.broadcast_to(np.asarray(values, dtype=np.float64).reshape(-1), (rows,))


def _arrived(log_survived: Array, time: Array, dt_s: float, late_s: float) -> Array:
    """Log probability that no crossing has arrived by each time; before the delay nothing has."""
    then = time - late_s
    held: Array = np.interp(then, dt_s * np.arange(log_survived.size), log_survived, left=0.0)
    return held
