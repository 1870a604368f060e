"""Compiled first passage: when noisy sensation first exceeds a criterion, for many people and sizes of gain at once.

Noise of unit SD and autocorrelation e^(−t²/2τ²) is added to a sensation ψ that rises at the rate r. The criterion c
that has not been passed yet is passed, per unit of time, at Rice's rate over the probability of being below it:

    (φ(z) + z·Φ(z))/τ · φ(g)/Φ(g),   z = r·τ,   g = c − ψ
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel

SQRT_HALF = math.sqrt(0.5)
INV_SQRT_2PI = 1.0 / math.sqrt(2.0 * math.pi)


def _cumulative(x: float) -> float:
    return 0.5 * math.erfc(-x * SQRT_HALF)


def _passage(
    log_drive: Any, dt: float, log_gain: Any, criterion: Any, tau: float, psi_table: Any, shares: Any, times: Any
) -> Any:
    """Times (lanes, shares) in s at which these shares of trials have passed the criterion; inf where they never do.

    A lane is a person and a size of gain: `log_gain` (lanes,) of 1/K, `criterion` (lanes,) in d′; `log_drive` (n_time,)
    of K; `psi_table` holds ψ over ln u. Returns the probability (lanes,) of having passed by the end.
    """
    passed = np.empty(log_gain.size)
    targets = np.log(1.0 - shares)
    for lane in range(log_gain.size):
        c = criterion[lane]
        log_left = math.log(cumulative(c))
        k = 0
        while k < shares.size and log_left <= targets[k]:
            times[lane, k] = 0.0
            k += 1
        last = looked_up(psi_table, log_gain[lane] + log_drive[0], LOG_U_FROM, LOG_U_STEP)
        for t in range(1, log_drive.size):
            psi = looked_up(psi_table, log_gain[lane] + log_drive[t], LOG_U_FROM, LOG_U_STEP)
            before = log_left
            log_left -= dt * crossing_rate(last, psi, dt, c, tau)
            while k < shares.size and log_left <= targets[k]:
                times[lane, k] = dt * (t - 1 + (before - targets[k]) / (before - log_left))
                k += 1
            last = psi
            if log_left < SURE:
                break
        for rest in range(k, shares.size):
            times[lane, rest] = np.inf
        passed[lane] = 1.0 - math.exp(log_left)
    return passed


def _survive(psi: Any, dt: float, criterion: float, tau: float, corrected: bool, log_left: Any) -> None:
    """Fill the log probability (n_time,) that the change of a sensation from its first sample has not passed yet.

    Corrected, it is relative to that of no change at all: the crossings of noise alone are left out.
    """
    silent = RISE[Z_MIDDLE] / tau * looked_up(MILLS, criterion, GAP_FROM, GAP_STEP)
    spared = silent if corrected else 0.0
    left, last = 0.0 if corrected else math.log(cumulative(criterion)), 0.0
    log_left[0] = left
    for t in range(1, psi.size):
        now = abs(psi[t] - psi[0])
        rate = silent if now == 0.0 and last == 0.0 else crossing_rate(last, now, dt, criterion, tau)
        left -= dt * (rate - spared)
        log_left[t] = left
        last = now
        if left < CERTAIN:
            log_left[t:] = left
            break


def _crossing_rate(last: float, now: float, dt: float, criterion: float, tau: float) -> float:
    """Rate of first crossings in 1/s over a step in which sensation goes from `last` to `now`."""
    z = (now - last) / dt * tau
    rise = z if z > Z_TO else looked_up(RISE, z, Z_FROM, Z_STEP)
    return float(rise / tau * looked_up(MILLS, criterion - 0.5 * (now + last), GAP_FROM, GAP_STEP))


def _looked_up(table: Any, x: float, start: float, step: float) -> float:
    place = (x - start) / step
    if place <= 0.0:
        return float(table[0])
    k = int(place)
    if k >= table.size - 1:
        return float(table[table.size - 1])
    return float(table[k] + (place - k) * (table[k + 1] - table[k]))


LOG_U_FROM, LOG_U_STEP, LOG_U_POINTS = -8.0, 0.04, 401
GAP_FROM, GAP_STEP, GAP_POINTS = -6.0, 0.01, 1401
Z_FROM, Z_STEP, Z_TO = -4.0, 0.01, 4.0
Z_MIDDLE = 400
CERTAIN = -16.0
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


_compile: Any = kernel(nogil=True)
cumulative: Any = _compile(_cumulative)
looked_up: Any = _compile(_looked_up)
crossing_rate: Any = _compile(_crossing_rate)
survive: Any = _compile(_survive)
passage: Any = _compile(_passage)
