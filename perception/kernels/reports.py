"""Compiled reports: the probability that a change is reported by each time.

    P(t) = mean over gains g and decision times d of 1 − exp(L_cold(t − d − δ_cold) + L_warm(t − d − δ_warm))

L is the log probability that the change of a sensation from its first sample has not passed the criterion yet, relative
to that of no change at all (`crossing`): crossings of noise alone are left out. δ is the conduction of a channel.
"""

import math
from typing import Any

import numpy as np

from thermicon.base.numbers.compiled import kernel
from thermicon.base.numbers.vector_math import LEAST, exp, expm1, log1p, vectorised

from .crossing import CERTAIN, survive

AT_ONCE = 64
"""Samples that go through the processor's vectors before it is asked whether a report is certain."""

COLD, WARM = range(2)


def _report(
    cold: Any, warm: Any, dt: float, criterion: Any, tau: float, a: float, raised: Any, late: Any, decision: Any,
    every: int, probability: Any, reported: Any, cold_share: Any,
) -> None:  # fmt: skip
    """Fill the `probability` (rows,) of a report at all, of one by each time (rows, times), and the share by cold.

    Sensations (rows, n_time) in d′ are `dt` apart and times `every` · `dt`; `criterion` (rows, 2) in d′; `raised`
    (gains,) are sizes of gain to the power p; `late` (rows, 2) and `decision` (rows, decisions) in s. Without times
    (`reported` of no columns) only the probability is filled in. The last time holds all reports, however late.
    """
    samples, times = cold.shape[1], reported.shape[1]
    risen, logs, room = np.empty((2, samples)), np.empty((2, samples)), np.empty((2, AT_ONCE + 1))
    passed, left = np.zeros((2, times + 1)), np.empty(times + 1)  # their first column is the time before the first
    arrived, decided = np.empty(times), np.empty(times)
    begin, end = np.empty(2, dtype=np.int64), np.empty(2, dtype=np.int64)
    share, steps = 1.0 / raised.size, np.full(samples, dt)
    for row in range(cold.shape[0]):
        # Between these times something changes; before them nothing has, and after them all stays as it is.
        first, last = times, 0
        for channel in range(2):
            psi = cold[row] if channel == COLD else warm[row]
            begin[channel], end[channel] = changing(psi)
            own, delay = risen[channel], late[row, channel] / dt
            for t in range(samples):
                own[t] = expm1(psi[t] / a)
            if begin[channel] < samples:
                first = min(first, int((begin[channel] - 1 + delay) / every))
                last = max(last, int((end[channel] + delay) / every) + 2)
        last = min(last, times)
        unreported, by_cold = 0.0, 0.0
        arrived[:] = 0.0
        left[:] = 1.0
        for gain in range(raised.size):
            for channel in range(2):
                if gain > 0 and begin[channel] == samples:
                    continue  # without change, all gains give the same
                own, logs[channel, 0] = risen[channel], 0.0
                survive(
                    own, raised[gain], a, begin[channel], end[channel], steps, criterion[row, channel], tau,
                    a * log1p(raised[gain] * own[0]), 1.0, CERTAIN, room, logs[channel],
                )  # fmt: skip
                delayed(logs[channel], every, late[row, channel] / dt, passed[channel, 1:])
            unreported += share * math.exp(logs[COLD, samples - 1] + logs[WARM, samples - 1])
            if first < last:
                by_cold += share * reports_by_cold(
                    passed[COLD, first : last + 1], passed[WARM, first : last + 1], left[first : last + 1]
                )
                for k in range(first, last):
                    arrived[k] += share * (1.0 - left[k + 1])
                for k in range(last, times):
                    arrived[k] += share * (1.0 - left[last])
        probability[row] = min(max(1.0 - unreported, 0.0), 1.0)
        if times == 0:
            continue
        given = arrived[times - 1]
        cold_share[row] = min(max(by_cold / given, 0.0), 1.0) if given > 0.0 else 0.0
        answered = reported[row]
        answered[:] = 0.0
        for d in range(decision.shape[1]):
            delayed(arrived, np.int64(1), decision[row, d] / (every * dt), decided)
            for k in range(times):
                answered[k] += decided[k] / decision.shape[1]
        answered[times - 1] = probability[row]


def _changing(psi: Any) -> tuple[int, int]:
    """The first sample that differs from the one at the start (`psi.size`: none does), and the end of such samples.

    The end is one past the sample at which the course is back where it started, if it is.
    """
    first, end = 1, psi.size
    while first < psi.size and psi[first] == psi[0]:
        first += 1
    while end > first and psi[end - 1] == psi[0]:
        end -= 1
    return first, min(end + 1, psi.size)


def _delayed(course: Any, every: int, delay: float, found: Any) -> None:
    """Fill `found` (times,) with every k-th sample of a course that comes so many samples later, linear in between.

    It is 0 before the first sample, and held after the last.
    """
    whole, times = math.ceil(delay), found.size
    part = whole - delay
    first = min((whole + every - 1) // every, times)
    last = min(max((course.size - 2 + whole) // every + 1, first), times)
    found[:first] = 0.0
    if first < last:
        here, own = course[every * first - whole :], found[first:last]
        after = here[1:]
        if every == 1:  # a loop of its own, since the compiler knows then that samples are neighbours
            for k in range(own.size):
                own[k] = here[k] + part * (after[k] - here[k])
        else:
            for k in range(own.size):
                own[k] = here[every * k] + part * (after[every * k] - here[every * k])
    found[last:] = course[course.size - 1]


def _reports_by_cold(cold: Any, warm: Any, left: Any) -> float:
    """Fill `left` (times + 1,) after its first from the logs of two channels; the probability of a report by cold."""
    now_cold, now_warm, now_left = cold[1:], warm[1:], left[1:]
    for k in range(now_left.size):
        now_left[k] = exp(now_cold[k] + now_warm[k])
    by_cold = 0.0
    for k in range(now_left.size):
        from_cold, from_warm = max(cold[k] - now_cold[k], 0.0), max(warm[k] - now_warm[k], 0.0)
        by_cold += (left[k] - now_left[k]) * from_cold / max(from_cold + from_warm, LEAST)
    return by_cold


_sum: Any = kernel(nogil=True, error_model="numpy", fastmath={"reassoc", "nsz", "contract", "arcp"})
changing: Any = vectorised(_changing)
delayed: Any = vectorised(_delayed)
reports_by_cold: Any = _sum(_reports_by_cold)
report: Any = _sum(_report)
