"""Compiled loops of the chain, one recursion each; imported only when something is computed.

Every kernel runs over rows independently, so that splitting rows over threads changes no bit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel

SQRT_HALF = math.sqrt(0.5)
INV_SQRT_2PI = 1.0 / math.sqrt(2.0 * math.pi)


def _drive(
    x: Any, step: Any, sign: float, low: float, high: float, weight: float, scale: float, strength: float, drive: Any
) -> None:
    """Receptor drive; `step` holds decay and time constants of integration, slow part, fast part and gain."""
    decay_i, from_i, to_i, tau_i = step[0, 0], step[0, 1], step[0, 2], step[0, 3]
    decay_s, from_s, to_s, tau_s = step[1, 0], step[1, 1], step[1, 2], step[1, 3]
    decay_f, from_f, to_f, tau_f = step[2, 0], step[2, 1], step[2, 2], step[2, 3]
    decay_g, from_g, to_g = step[3, 0], step[3, 1], step[3, 2]
    gain_s = 1.0 / (tau_s - tau_i)
    gain_f = tau_f / (tau_f - tau_i)
    for row in range(x.shape[0]):
        x0 = x[row, 0]
        c0 = min(max(x0, low), high)
        input_i, input_f, clip_i, clip_s = x0, x0, c0, c0
        size0 = abs(x0 - c0) * (1.0 - weight)
        recent = size0
        for t in range(x.shape[1]):
            x1 = x[row, t]
            c1 = min(max(x1, low), high)
            if t > 0:
                input_i = decay_i * input_i + from_i * x0 + to_i * x1
                input_f = decay_f * input_f + from_f * x0 + to_f * x1
                clip_i = decay_i * clip_i + from_i * c0 + to_i * c1
                clip_s = decay_s * clip_s + from_s * c0 + to_s * c1
            slow = input_i - (tau_s * clip_s - tau_i * clip_i) * gain_s
            fast = gain_f * (input_i - input_f)
            y = sign * (slow + weight * (fast - slow))
            if strength > 0.0:
                if t > 0:
                    recent = decay_g * recent + from_g * size0 + to_g * abs(y)
                size0 = abs(y)
                if y > 0.0:
                    y *= (1.0 + recent / scale) ** -strength
            drive[row, t] = max(0.0, y)
            x0, c0 = x1, c1


def _sensation(drive: Any, scale: Any, a: float, b: float, psi: Any) -> None:
    """ψ = a·ln(1 + u²/b) of u = scale·drive."""
    for row in range(drive.shape[0]):
        factor = scale[row] * scale[row] / b
        for t in range(drive.shape[1]):
            x = drive[row, t]
            psi[row, t] = a * math.log1p(factor * x * x) if x > 0.0 else 0.0


def _blur(psi: Any, decay: float, blurred: Any) -> None:
    """Symmetric exponential smoothing; both ends are held."""
    gain = 1.0 - decay
    last = psi.shape[1] - 1
    for row in range(psi.shape[0]):
        y = psi[row, 0]
        for t in range(last + 1):
            y = decay * y + gain * psi[row, t]
            blurred[row, t] = y
        y = psi[row, last] + (y - psi[row, last]) / (1.0 + decay)
        blurred[row, last] = y
        for t in range(last - 1, -1, -1):
            y = decay * y + gain * blurred[row, t]
            blurred[row, t] = y


def _differences(cold: Any, warm: Any, dt: float, out: Any) -> None:
    """Largest, rms and integrated difference for every pair of icons of every person."""
    people, icons, n = cold.shape
    for p in range(people):
        pair = 0
        for i in range(icons):
            for j in range(i + 1, icons):
                largest = 0.0
                squares = 0.0
                total = 0.0
                for t in range(n):
                    c = cold[p, i, t] - cold[p, j, t]
                    w = warm[p, i, t] - warm[p, j, t]
                    d2 = c * c + w * w
                    largest = max(largest, d2)
                    squares += d2
                    total += math.sqrt(d2)
                out[p, pair, 0] = math.sqrt(largest)
                out[p, pair, 1] = math.sqrt(squares / n)
                out[p, pair, 2] = total * dt
                pair += 1


def _cumulative(x: float) -> float:
    return 0.5 * math.erfc(-x * SQRT_HALF)


def _detect(cold: Any, warm: Any, dt: float, criterion: float, tau: float, crossing: Any, missed: Any) -> None:
    """First crossing of each channel (s, NaN when never) and the log probability of no detection."""
    for row in range(cold.shape[0]):
        log_missed = 0.0
        for channel in range(2):
            psi = cold[row] if channel == 0 else warm[row]
            start = psi[0]
            crossing[row, channel] = math.nan
            log_missed += math.log(cumulative(criterion))
            x0 = 0.0
            for t in range(1, psi.shape[0]):
                x1 = abs(psi[t] - start)
                if math.isnan(crossing[row, channel]) and x1 >= criterion:
                    crossing[row, channel] = dt * (t - 1 + (criterion - x0) / (x1 - x0))
                if log_missed > -40.0:
                    h = criterion - 0.5 * (x0 + x1)
                    speed = (x1 - x0) / dt
                    z = speed * tau
                    mean_rise = INV_SQRT_2PI * math.exp(-0.5 * z * z) / tau + speed * cumulative(z)
                    below = cumulative(max(h, -8.0))
                    log_missed -= dt * mean_rise * INV_SQRT_2PI * math.exp(-0.5 * max(h, -8.0) ** 2) / below
                elif not math.isnan(crossing[row, channel]):
                    break
                x0 = x1
        missed[row] = log_missed


def _nearest(gram: Any, projected: Any, counts: Any) -> None:
    """Counts of the nearest point (presented, answer) for one person; the innermost loops run over presented points.

    `gram` (answer, presented) speaks for an answer without noise; `projected` (draw, answer) is what the noise adds.
    """
    icons = gram.shape[0]
    score, best = np.empty(icons), np.empty(icons)
    for s in range(projected.shape[0]):
        for i in range(icons):
            score[i] = gram[0, i] + projected[s, 0]
            best[i] = 0.0
        for j in range(1, icons):
            push, name = projected[s, j], float(j)
            for i in range(icons):
                value = gram[j, i] + push
                better = value > score[i]
                score[i] = value if better else score[i]
                best[i] = name if better else best[i]
        for i in range(icons):
            counts[i, int(best[i])] += 1.0


def _bend(points: Any, distances: Any, bent: Any) -> None:
    """Root of the summed squares of what the distances between points (person, icon, axis) miss the given ones by."""
    people, icons, axes = points.shape
    for p in range(people):
        total = 0.0
        for i in range(icons):
            for j in range(icons):
                square = 0.0
                for k in range(axes):
                    square += (points[p, i, k] - points[p, j, k]) ** 2
                total += (math.sqrt(square) - distances[p, i, j]) ** 2
        bent[p] = math.sqrt(total)


Loop = Callable[..., None]
_compile: Any = kernel(nogil=True)
_vector: Any = kernel(nogil=True, fastmath={"reassoc", "nsz"})
cumulative: Callable[[float], float] = _compile(_cumulative)
drive: Loop = _compile(_drive)
sensation: Loop = _compile(_sensation)
blur: Loop = _compile(_blur)
differences: Loop = _vector(_differences)
detect: Loop = _compile(_detect)
nearest: Loop = _compile(_nearest)
bend: Loop = _compile(_bend)
