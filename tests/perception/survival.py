"""Answers of one person to a course of sensation, written out without tables or compiled loops."""

import numpy as np
from scipy.stats import norm

from thermicon.base.numbers.arrays import Array
from thermicon.perception import Observer
from thermicon.perception.sensation.detection import quarters


def log_survival(psi: Array, dt_s: float, criterion: float, observer: Observer) -> Array:
    """Log probability (..., n_time) that a change from the first sample has not passed a criterion by each sample."""
    tau, change = observer.noise_correlation_s, np.abs(psi - psi[..., :1])
    gap = criterion - 0.5 * (change[..., 1:] + change[..., :-1])
    z = np.diff(change) / dt_s * tau
    rate = (norm.pdf(z) + z * norm.cdf(z)) / tau * np.exp(norm.logpdf(gap) - norm.logcdf(gap))
    start = np.full((*psi.shape[:-1], 1), norm.logcdf(criterion))
    return np.asarray(np.concatenate([start, start - np.cumsum(dt_s * rate, axis=-1)], axis=-1))


def answered(
    cold: Array, warm: Array, dt_s: float, observer: Observer, late_s: tuple[float, float], decision_s: float,
    caution: float = 1.0,
) -> tuple[Array, Array]:  # fmt: skip
    """Times (s) and the probability that a trial was answered by then, whichever channel passes first."""
    time = dt_s * np.arange(cold.size + 10.0 / dt_s)
    passed = np.zeros_like(time)
    for gain in np.exp(quarters(observer.gain_noise)).tolist():
        left = np.zeros_like(time)
        for psi, late in zip((cold, warm), late_s, strict=True):
            louder = observer.psi(gain * observer.multiple(psi))
            logs = log_survival(louder, dt_s, caution * observer.criterion, observer)
            left += np.interp(time - late, dt_s * np.arange(psi.size), logs, left=0.0)
        passed += (1.0 - np.exp(left)) / quarters(observer.gain_noise).size
    decided = [
        np.interp(time - decision_s * more, time, passed, left=0.0)
        for more in np.exp(quarters(observer.decision_noise)).tolist()
    ]
    return time, np.mean(decided, axis=0)
