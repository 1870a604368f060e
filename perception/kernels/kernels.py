"""Compiled loops of the chain, one recursion each; imported only when something is computed.

Every kernel runs over rows independently, so that splitting rows over threads changes no bit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel
from thermicon.circuit.vector_math import LEAST, exp, log, log1p, vectorised

DRAWS_AT_ONCE = 512


def _sensation(drive: Any, scale: Any, a: float, p: float, b: float, psi: Any) -> None:
    """ψ = a·ln(1 + u^p/b) of u = scale·drive; 0 without drive. It may be written over the drive."""
    samples = drive.shape[1]
    course = np.empty(samples)
    for row in range(drive.shape[0]):
        first, end = 0, samples
        while first < end and drive[row, first] == 0.0:
            first += 1
        while end > first and drive[row, end - 1] == 0.0:
            end -= 1
        psi[row, :first] = 0.0
        psi[row, end:] = 0.0
        given, own = drive[row, first:end], psi[row, first:end]
        for t in range(given.size):
            course[t] = exp(p * log(max(scale[row] * given[t], LEAST))) / b
        for t in range(given.size):
            course[t] = a * log1p(course[t])
        for t in range(given.size):
            own[t] = course[t] if given[t] > 0.0 else 0.0


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


def _nearest(nearness: Any, projected: Any, counts: Any) -> None:
    """Counts of the nearest point (presented, answer) for one person; the innermost loops run over draws.

    `nearness` (answer, presented) speaks for an answer without noise; `projected` (answer, draw) is what noise adds.
    Both are in single precision, of which the processor's vectors hold twice as many.
    """
    icons, draws = projected.shape
    score, best = np.empty(DRAWS_AT_ONCE, dtype=np.float32), np.empty(DRAWS_AT_ONCE, dtype=np.int32)
    for start in range(0, draws, DRAWS_AT_ONCE):
        count = min(DRAWS_AT_ONCE, draws - start)
        for i in range(icons):
            noise = projected[0, start : start + count]
            for s in range(count):
                score[s] = nearness[0, i] + noise[s]
                best[s] = 0
            for j in range(1, icons):
                noise = projected[j, start : start + count]
                name, near = np.int32(j), nearness[j, i]
                for s in range(count):
                    value = near + noise[s]
                    nearer = value > score[s]
                    best[s] = name if nearer else best[s]
                    score[s] = value if nearer else score[s]
            for s in range(count):
                counts[i, best[s]] += 1.0


def _bend(points: Any, distances: Any, bent: Any) -> None:
    """Root of the summed squares of what the distances between points (person, icon, axis) miss the given ones by."""
    people, icons, axes = points.shape
    for p in range(people):
        total = 0.0
        for i in range(icons):
            for j in range(i):
                square = 0.0
                for k in range(axes):
                    square += (points[p, i, k] - points[p, j, k]) ** 2
                total += 2.0 * (math.sqrt(square) - distances[p, i, j]) ** 2
        bent[p] = math.sqrt(total)


Loop = Callable[..., None]
_compile: Any = kernel(nogil=True)
_vector: Any = kernel(nogil=True, fastmath={"reassoc", "nsz"})
sensation: Loop = vectorised(_sensation)
blur: Loop = _compile(_blur)
differences: Loop = _vector(_differences)
nearest: Loop = _vector(_nearest)
bend: Loop = _compile(_bend)
