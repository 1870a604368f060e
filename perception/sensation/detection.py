"""Sensation → was it felt, when, and by which channel.

A yes/no observer says yes when sensation plus unit noise passes a criterion. The criterion is
set by how often noise alone passes it: both channels count, and the rate of upward crossings is
Rice's. Onset is the mean sensation's crossing plus conduction plus decision.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.observer import CHANNELS, Channel, Observer


@dataclass(frozen=True, slots=True)
class Detection:
    """Arrays over traces: `probability` (0–1), `onset_s` (NaN: never), `channel` (−1 none, 0 cold, 1 warm).

    `crossing_s` has a last axis of two, cold and warm: when the mean sensation at the receptor
    passed the criterion, before conduction and decision.
    """

    probability: Array
    onset_s: Array
    channel: NDArray[np.int64]
    crossing_s: Array


def detect(
    psi_cold: ArrayLike,
    psi_warm: ArrayLike,
    dt_s: float,
    observer: Observer,
    *,
    path_m: ArrayLike | None = None,
    velocity_cold_m_per_s: ArrayLike | None = None,
    velocity_warm_m_per_s: ArrayLike | None = None,
    decision_s: ArrayLike | None = None,
) -> Detection:
    """Run the yes/no procedure on sensations of shape (..., n_time).

    What is detected is the change of sensation from the first sample. `probability` is corrected
    for false alarms of the same length: 0 when there is nothing to feel. The four keywords
    replace the observer's values, one number or one for each leading index.
    """
    from ..kernels import kernels

    cold, shape = as_rows(psi_cold)
    warm, warm_shape = as_rows(psi_warm)
    if shape != warm_shape:
        raise ValueError(f"cold and warm sensation differ in shape: {shape} and {warm_shape}")
    crossing = np.empty((cold.shape[0], 2))
    log_missed = np.empty(cold.shape[0])

    def work(part: slice) -> None:
        tau = observer.noise_correlation_s
        kernels.detect(cold[part], warm[part], dt_s, observer.criterion, tau, crossing[part], log_missed[part])

    over_rows(work, cold.shape[0], cold.size)
    wait = dt_s * (cold.shape[1] - 1)
    silent = 2.0 * log_no_crossing(observer.criterion, observer.noise_correlation_s, wait)
    probability = np.clip(-np.expm1(log_missed - silent), 0.0, 1.0).reshape(shape[:-1])

    crossing = crossing.reshape(*shape[:-1], 2)
    path = np.asarray(observer.path_hand_m if path_m is None else path_m, dtype=np.float64)
    speeds = (
        observer.cold.velocity_m_per_s if velocity_cold_m_per_s is None else velocity_cold_m_per_s,
        observer.warm.velocity_m_per_s if velocity_warm_m_per_s is None else velocity_warm_m_per_s,
    )
    delay = observer.decision_s if decision_s is None else np.asarray(decision_s, dtype=np.float64)
    felt = np.stack([crossing[..., k] + path / np.asarray(speeds[k]) + delay for k in range(2)], axis=-1)
    first = np.where(np.isnan(felt), np.inf, felt)
    onset = first.min(axis=-1)
    channel = np.where(np.isinf(onset), -1, first.argmin(axis=-1)).astype(np.int64)
    return Detection(probability, np.where(np.isinf(onset), np.nan, onset), channel, crossing)


def channel_name(index: int) -> Channel | None:
    """Name of a channel index of `Detection.channel`; None where nothing was felt."""
    return None if index < 0 else CHANNELS[index]


def false_alarms(criterion: float, correlation_s: float, wait_s: float) -> float:
    """Probability that noise alone passes the criterion in one of two channels within `wait_s`.

    >>> 0.019 < false_alarms(3.34, 0.3, 5.0) < 0.021
    True
    """
    return -math.expm1(2.0 * log_no_crossing(criterion, correlation_s, wait_s))


def criterion_of(rate: float, correlation_s: float, wait_s: float) -> float:
    """Criterion (d′) whose false alarms in `wait_s` have probability `rate`, by bisection."""
    if not 0.0 < rate < 1.0:
        raise ValueError(f"the false-alarm rate must lie between 0 and 1, not {rate:g}")
    low, high = 0.0, 12.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if false_alarms(middle, correlation_s, wait_s) > rate else (low, middle)
    return 0.5 * (low + high)


def log_no_crossing(criterion: float, correlation_s: float, wait_s: float) -> float:
    """Log probability that one channel's noise stays below the criterion.

    The noise is unit Gaussian with autocorrelation e^(−t²/2τ²); crossings of a level not yet
    passed come at Rice's rate over the probability of being below.
    """
    below = 0.5 * math.erfc(-criterion / math.sqrt(2.0))
    rate = math.exp(-0.5 * criterion * criterion) / (2.0 * math.pi * correlation_s)
    return math.log(below) - wait_s * rate / below
