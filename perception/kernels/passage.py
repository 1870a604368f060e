"""Compiled first passage: when noisy sensation first exceeds a criterion, for many people and sizes of gain at once.

Noise of unit SD and autocorrelation e^(−t²/2τ²) is added to a sensation ψ that rises at the rate r. The criterion c
that has not been passed yet is passed, per unit of time, at Rice's rate over the probability of being below it:

    (φ(z) + z·Φ(z))/τ · φ(g)/Φ(g),   z = r·τ,   g = c − ψ

Psychometric functions are read here too: sizes at which each person reports given shares, guesses taken out.
"""

import math
from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel

SQRT_HALF = math.sqrt(0.5)
INV_SQRT_2PI = 1.0 / math.sqrt(2.0 * math.pi)
GUESSED = 0.999
"""Share of the reports at the smallest size that counts as guessed; less than all, so that none is divided by 0."""
LEAST_RISE = 1e-9
"""Added from size to size, so that no share stands at two sizes."""


def _cumulative(x: float) -> float:
    return 0.5 * math.erfc(-x * SQRT_HALF)


def _passage(
    log_drive: Any, time: Any, log_gain: Any, criterion: Any, tau: float, psi_table: Any, shares: Any, times: Any
) -> Any:
    """Times (lanes, shares) in s at which these shares of trials have passed the criterion; inf where they never do.

    A lane is a person and a size of gain: `log_gain` (lanes,) of 1/K, `criterion` (lanes,) in d′; `log_drive` (n_time,)
    of K at `time` (n_time,) in s, in steps of any size; `psi_table` holds ψ over ln u. Returns the probability (lanes,)
    of having passed by the end. Lanes go through time in blocks, so that the look-ups run in the processor's vectors.
    """
    lanes, samples = log_gain.size, log_drive.size
    passed, targets = np.empty(lanes), np.log(1.0 - shares)
    left, now, rise = np.empty((samples, BLOCK)), np.empty(BLOCK), np.empty(BLOCK)
    last, c, gain = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    for first in range(0, lanes, BLOCK):
        count = min(BLOCK, lanes - first)
        for i in range(BLOCK):
            lane = first + min(i, count - 1)
            c[i], gain[i] = criterion[lane], log_gain[lane]
            left[0, i] = math.log(cumulative(c[i]))
        # As long as every criterion of the block is out of reach, nothing happens.
        within_reach = LOG_U_FROM + LOG_U_STEP * first_below(-psi_table, OUT_OF_REACH - c.min(), psi_table.size - 1)
        start = 1
        while (
            c.min() > OUT_OF_REACH and start < samples - 1 and log_drive[start] + gain.max() < within_reach - LOG_U_STEP
        ):
            left[start] = left[0]
            start += 1
        for i in range(BLOCK):
            last[i] = between(psi_table, (gain[i] + log_drive[start - 1] - LOG_U_FROM) / LOG_U_STEP)
        end = samples - 1
        for t in range(start, samples):
            dt = time[t] - time[t - 1]
            for i in range(BLOCK):
                now[i] = between(psi_table, (gain[i] + log_drive[t] - LOG_U_FROM) / LOG_U_STEP)
            for i in range(BLOCK):
                z = (now[i] - last[i]) * (tau / dt)
                rise[i] = max(between(RISE, (z - Z_FROM) / Z_STEP), z)
            for i in range(BLOCK):
                gap = c[i] - 0.5 * (now[i] + last[i])
                rise[i] *= (dt / tau) * between(MILLS, (gap - GAP_FROM) / GAP_STEP)
            least = -np.inf
            for i in range(BLOCK):
                left[t, i] = left[t - 1, i] - rise[i]
                last[i] = now[i]
                least = max(least, left[t, i])
            if least < SURE:
                end = t
                break
        for i in range(count):
            passed[first + i] = 1.0 - math.exp(left[first_below(left[:, i], SURE, end), i])
            for k in range(shares.size):
                t = first_below(left[:, i], targets[k], end)
                if left[t, i] > targets[k]:
                    times[first + i, k] = np.inf
                elif t == 0:
                    times[first + i, k] = 0.0
                else:
                    share = (left[t - 1, i] - targets[k]) / (left[t - 1, i] - left[t, i])
                    times[first + i, k] = time[t - 1] + share * (time[t] - time[t - 1])
    return passed


def _first_below_index(falling: Any, level: float, end: int) -> int:
    """Index of the first number of a falling column that is at or below a level; `end` where none is."""
    low, high = 0, end
    while low < high:
        middle = (low + high) // 2
        if falling[middle] <= level:
            high = middle
        else:
            low = middle + 1
    return low


def _between(table: Any, place: float) -> float:
    """A table at a place between its entries, without branches: what lies outside counts as its end."""
    within = min(max(place, 0.0), table.size - 1.000001)
    k = np.uint32(np.int32(within))
    return float(table[k] + (within - k) * (table[k + np.uint32(1)] - table[k]))


BLOCK = 16
"""Lanes that go through time together."""
LOG_U_FROM, LOG_U_STEP, LOG_U_POINTS = -8.0, 0.04, 401
GAP_FROM, GAP_STEP, GAP_POINTS = -6.0, 0.01, 1401
Z_FROM, Z_STEP, Z_TO = -4.0, 0.01, 4.0
Z_MIDDLE = 400
CERTAIN = -16.0
OUT_OF_REACH = 5.0
"""Gap in d′ above which a criterion is passed less than once in a day."""
SURE = -5.0
"""Log probabilities of not having answered below which an answer is certain: of one course, and of one lane."""


def _mills_table() -> Any:
    """φ(g)/(√(2π)·Φ(g)) over the gap g between criterion and sensation: Rice's rate over being below."""
    gaps = GAP_FROM + GAP_STEP * np.arange(GAP_POINTS)
    below = np.array([0.5 * math.erfc(-gap / math.sqrt(2.0)) for gap in gaps.tolist()])
    return INV_SQRT_2PI * np.exp(-0.5 * gaps * gaps) / below


def _rise_table() -> Any:
    """φ(z) + z·Φ(z): the mean of the rising part of a Gaussian slope with mean z and SD 1."""
    z = np.arange(Z_FROM, Z_TO + 2 * Z_STEP, Z_STEP)
    below = np.array([0.5 * math.erfc(-each / math.sqrt(2.0)) for each in z.tolist()])
    return INV_SQRT_2PI * np.exp(-0.5 * z * z) + z * below


MILLS, RISE = _mills_table(), _rise_table()


def _psychometric(reported: Any, log_sizes: Any, shares: Any, logs: Any) -> None:
    """Logs (people, shares) of the sizes at which corrected reports (people, sizes) reach these shares, linear between.

    A share that is not reached by the largest size lies beyond it, as far as the rest is missing.
    """
    people, sizes = reported.shape
    for person in range(people):
        guesses = GUESSED * reported[person, 0]
        for k in range(shares.size):
            share = shares[k]
            below, reached, place = 0.0, False, log_sizes[0]
            highest = -1.0
            for j in range(sizes):
                highest = max(highest, (reported[person, j] - guesses) / (1.0 - guesses))
                corrected = highest + LEAST_RISE * j
                if not reached and corrected >= share:
                    reached = True
                    if j > 0:
                        part = (share - below) / (corrected - below)
                        place = log_sizes[j - 1] + part * (log_sizes[j] - log_sizes[j - 1])
                below = corrected
            logs[person, k] = place if reached else log_sizes[sizes - 1] + share - below


_compile: Any = kernel(nogil=True)
_vector: Any = kernel(nogil=True, error_model="numpy", fastmath={"reassoc", "nsz", "contract", "arcp"})
cumulative: Any = _compile(_cumulative)
between: Any = _vector(_between)
first_below: Any = _compile(_first_below_index)
passage: Any = _vector(_passage)
psychometric: Any = _compile(_psychometric)
