"""Distributions of response times, early false alarms among them, by the same rule as detection."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermicon.perception.arrays import Array, as_rows
from thermicon.perception.observer.observer import Observer
from thermicon.perception.sensation.detection import quarters, report_courses, time_of


@dataclass(frozen=True, slots=True)
class ResponseTimes:
    """One distribution a row: `time_s` (n_time,), `probability` (rows, n_time) of a response by then.

    `cold_share` (rows,) is the share of the responses that the cold channel gave.
    """

    time_s: Array
    probability: Array
    cold_share: Array

    def quantile(self, share: float = 0.5) -> Array:
        """Time (rows,) by which a response came in this share of trials, s; inf where it comes in fewer."""
        return np.array([time_of(given, self.time_s, share) for given in self.probability])


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
    """
    rows, samples = as_rows(psi_cold)[0].shape
    slowest = float(np.exp(quarters(observer.decision_noise)).max() * np.max(decision_s))
    latest = max(float(np.max(each)) for each in conduction_s) + slowest
    times = samples + int(np.ceil(latest / dt_s)) + 1
    _, given, share = report_courses(
        psi_cold, psi_warm, dt_s, observer, conduction_s, decision_s, criterion, times=times, corrected=False
    )
    return ResponseTimes(dt_s * np.arange(times), given.reshape(rows, times), share.reshape(rows))
