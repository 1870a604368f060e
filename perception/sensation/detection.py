"""Sensation → was it felt, when, and by which channel.

A yes/no observer says yes when the change of sensation plus unit noise passes a criterion, which is inferred from
published answers. Crossings come at Rice's rate, as in `first_passage`; how often noise alone passes a criterion is
`false_alarms`. Onset is the mean sensation's crossing plus conduction plus decision.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, as_rows
from ..kernels.parallel import over_rows
from ..observer.observer import CHANNELS, Channel, Observer
from .first_passage import quarters


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
    criterion_cold: ArrayLike = 1.0,
    criterion_warm: ArrayLike = 1.0,
    decision_s: ArrayLike | None = None,
) -> Detection:
    """Run the yes/no procedure on sensations of shape (..., n_time).

    What is detected is the change of sensation from the first sample, whose gain differs from presentation to
    presentation. `probability` is corrected for false alarms of the same length: 0 when there is nothing to feel.
    The criteria are multiples of the observer's; the four keywords are one number or one for each leading index.
    """
    from ..kernels import kernels

    cold, shape = as_rows(psi_cold)
    warm, warm_shape = as_rows(psi_warm)
    if shape != warm_shape:
        raise ValueError(f"cold and warm sensation differ in shape: {shape} and {warm_shape}")
    crossing = np.empty((cold.shape[0], 2))
    log_missed = np.empty(cold.shape[0])
    multiples = [np.broadcast_to(each, shape[:-1]).reshape(-1) for each in (criterion_cold, criterion_warm)]
    criteria = observer.criterion * np.stack(multiples, axis=-1)
    tau, raised = observer.noise_correlation_s, np.exp(observer.p * quarters(observer.gain_noise))

    def work(part: slice) -> None:
        kernels.detect(
            cold[part], warm[part], dt_s, criteria[part], tau, observer.a, raised, crossing[part], log_missed[part]
        )

    over_rows(work, cold.shape[0], cold.size)
    wait = dt_s * (cold.shape[1] - 1)
    silent = log_no_crossings(criteria, tau, wait).sum(axis=-1)
    probability = np.clip(-np.expm1(log_missed - silent), 0.0, 1.0).reshape(shape[:-1])

    crossing = crossing.reshape(*shape[:-1], 2)
    path = np.asarray(observer.path_hand_m if path_m is None else path_m, dtype=np.float64)
    delay = observer.decision_s if decision_s is None else np.asarray(decision_s, dtype=np.float64)
    conduction = [observer.delays_s(channel, path) for channel in CHANNELS]
    felt = np.stack([crossing[..., k] + conduction[k] + delay for k in range(2)], axis=-1)
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
    return float(log_no_crossings(np.array(criterion), correlation_s, wait_s))


def log_no_crossings(criteria: Array, correlation_s: float, wait_s: float) -> Array:
    """The same for criteria (...,)."""
    from scipy.special import ndtr

    below = ndtr(criteria)
    rate = np.exp(-0.5 * criteria * criteria) / (2.0 * np.pi * correlation_s)
    logs: Array = np.log(below) - wait_s * rate / below
    return logs
