"""Compiled reports: by when a person has reported an icon, from the first passage of two noisy channels.

    P(t) = mean over gains g and decision times d of 1 − exp(L_cold(t − d − δ_cold) + L_warm(t − d − δ_warm))

L is the log probability of not having passed the criterion (`passage.survive`), δ the conduction of a channel. A drive
that is g times as large has the sensation a·ln(1 + g^p·(e^(ψ/a) − 1)).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel

from .passage import CERTAIN, GAP_FROM, GAP_STEP, MILLS, RISE, Z_MIDDLE, crossing_rate, cumulative, looked_up


def _report(
    cold: Any, warm: Any, dt: float, criterion: Any, tau: float, a: float, raised: Any, late: Any, decision: Any,
    corrected: bool, every: int, probability: Any, reported: Any, cold_share: Any,
) -> None:  # fmt: skip
    """Fill the `probability` (rows,) of a report at all, of one by each time (rows, times), and the share by cold.

    Sensations (rows, n_time) in d′ are `dt` apart and times `every` · `dt`; `criterion` (rows, 2) in d′; `raised`
    (gains,) are sizes of gain to the power p; `late` (rows, 2) and `decision` (rows, decisions) in s. Without times
    (`reported` of no columns) only the probability is filled in. The last time holds all reports, however late.
    """
    samples, times = cold.shape[1], reported.shape[1]
    risen, risen_until = np.empty((2, samples)), np.zeros(2, dtype=np.int64)
    logs, arrived = np.empty((2, samples)), np.empty(times)
    for row in range(cold.shape[0]):
        for channel in range(2):
            risen_until[channel] = 0
        unreported, by_cold = 0.0, 0.0
        arrived[:] = 0.0
        for gain in range(raised.size):
            for channel in range(2):
                psi = cold[row] if channel == 0 else warm[row]
                risen_until[channel] = survive_louder(
                    psi, raised[gain], a, risen[channel], risen_until[channel], dt, criterion[row, channel], tau,
                    corrected, logs[channel],
                )  # fmt: skip
            unreported += math.exp(logs[0, samples - 1] + logs[1, samples - 1]) / raised.size
            last_cold, last_warm, last_left = 0.0, 0.0, 1.0
            for k in range(times):
                now_cold = course_at(logs[0], every * k - late[row, 0] / dt)
                now_warm = course_at(logs[1], every * k - late[row, 1] / dt)
                fallen = now_cold + now_warm != last_cold + last_warm
                left = math.exp(now_cold + now_warm) if fallen else last_left
                arrived[k] += (1.0 - left) / raised.size
                from_cold, from_warm = max(last_cold - now_cold, 0.0), max(last_warm - now_warm, 0.0)
                if from_cold + from_warm > 0.0:
                    by_cold += (last_left - left) * from_cold / (from_cold + from_warm) / raised.size
                last_cold, last_warm, last_left = now_cold, now_warm, left
        probability[row] = min(max(1.0 - unreported, 0.0), 1.0)
        if times == 0:
            continue
        given = arrived[times - 1]
        cold_share[row] = min(max(by_cold / given, 0.0), 1.0) if given > 0.0 else 0.0
        reported[row] = 0.0
        for d in range(decision.shape[1]):
            for k in range(times):
                reported[row, k] += course_at(arrived, k - decision[row, d] / (every * dt)) / decision.shape[1]
        reported[row, times - 1] = probability[row]


def _survive_louder(
    psi: Any, raised: float, a: float, risen: Any, until: int, dt: float, criterion: float, tau: float, corrected: bool,
    log_left: Any,
) -> int:  # fmt: skip
    """`passage.survive` of a sensation whose drive is larger; each sample is computed when the course reaches it.

    `risen` (n_time,) is filled with e^(ψ/a) − 1 `until` a sample, and further where needed; returns how far it is.
    A strong icon is certain to be reported soon after it begins, and what comes later is never computed.
    """
    silent = RISE[Z_MIDDLE] / tau * looked_up(MILLS, criterion, GAP_FROM, GAP_STEP)
    spared = silent if corrected else 0.0
    left, last, first = 0.0 if corrected else math.log(cumulative(criterion)), 0.0, 0.0
    for t in range(psi.size):
        if t >= until:
            risen[t] = math.expm1(psi[t] / a) if psi[t] != 0.0 else 0.0
            until = t + 1
        louder = psi[t]
        if raised != 1.0:
            louder = a * math.log1p(raised * risen[t]) if risen[t] else 0.0
        if t == 0:
            first = louder
            log_left[0] = left
            continue
        now = abs(louder - first)
        rate = silent if now == 0.0 and last == 0.0 else crossing_rate(last, now, dt, criterion, tau)
        left -= dt * (rate - spared)
        log_left[t] = left
        last = now
        if left < CERTAIN:
            log_left[t:] = left
            break
    return until


def _course_at(course: Any, place: float) -> float:
    """A course between its samples: 0 before the first, held after the last."""
    if place < 0.0:
        return 0.0
    k = int(place)
    if k >= course.size - 1:
        return float(course[course.size - 1])
    return float(course[k] + (place - k) * (course[k + 1] - course[k]))


_compile: Any = kernel(nogil=True)
course_at: Callable[..., float] = _compile(_course_at)
survive_louder: Callable[..., int] = _compile(_survive_louder)
report: Callable[..., None] = _compile(_report)
