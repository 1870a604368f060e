"""Compiled recursions of the chain from receptor temperature to answers.

Every kernel runs over rows independently, so that splitting rows over threads changes no bit.

For a channel with sign s (−1 cold, +1 warm), receptor temperature T, limit L and softness δ:

    q = L + s·δ·ln(1 + e^(s·(T − L)/δ))                      quality: no cold above L, no warmth below it
    dq_i/dt = (q − q_i)/τ_i,   dA/dt = (clip(q) − A)/τ_s      integration; adaptation inside the neutral zone
    y = max(0, s·(q_i − A))                                  receptor drive in K

Integration and adaptation are exact for q that is linear between samples.
"""

import math
from typing import Any

import numpy as np

from thermicon.base.numbers.compiled import kernel
from thermicon.base.numbers.vector_math import LEAST, exp, log, log1p, vectorised


def _adapted_drive(
    temperature: Any,
    dt: float,
    sign: float,
    limit: float,
    softness: float,
    low: float,
    high: float,
    coldest_rest: float,
    warmest_rest: float,
    integration_s: float,
    adaptation_s: float,
    drive: Any,
) -> None:
    """Receptor drive (rows, n_time) in K, 0 at rest, the first sample; rest beyond its ends counts as at the nearer."""
    # Weights of the old state, the old and the new input over one step.
    decay_i, decay_a = math.exp(-dt / integration_s), math.exp(-dt / adaptation_s)
    mean_i, mean_a = (
        -math.expm1(-dt / integration_s) * integration_s / dt,
        -math.expm1(-dt / adaptation_s) * adaptation_s / dt,
    )
    samples = temperature.shape[1]
    quality = np.empty(samples)
    for row in range(temperature.shape[0]):
        rest = temperature[row, 0]
        shift = min(max(rest, coldest_rest), warmest_rest) - rest
        for t in range(samples):
            felt = temperature[row, t] + shift
            x = sign * (felt - limit) / softness
            nearest = felt if x > 0.0 else limit
            quality[t] = nearest + sign * softness * log1p(exp(-abs(x)))  # ln(1 + e^x) = max(x, 0) + ln(1 + e^−|x|)
        # States are counted from the first sample, to which the receptor is adapted: rest leaves them at 0, unrounded.
        first = quality[0]
        first_clipped = min(max(first, low), high)
        q, clipped, integrated, level = 0.0, 0.0, 0.0, 0.0
        for t in range(samples):
            if t > 0:
                last_q, last_clipped = q, clipped
                q = quality[t] - first
                clipped = min(max(quality[t], low), high) - first_clipped
                integrated = decay_i * integrated + ((mean_i - decay_i) * last_q + (1.0 - mean_i) * q)
                level = decay_a * level + ((mean_a - decay_a) * last_clipped + (1.0 - mean_a) * clipped)
            y = sign * (integrated - level)
            drive[row, t] = y if y > 0.0 else 0.0


adapted_drive: Any = vectorised(_adapted_drive)


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
            for s in range(count):
                score[s], best[s] = -np.inf, 0
            for j in range(icons):
                name, near, noise = np.int32(j), nearness[j, i], projected[j, start : start + count]
                for s in range(count):
                    value = near + noise[s]
                    nearer = value > score[s]
                    best[s] = name if nearer else best[s]
                    score[s] = value if nearer else score[s]
            for s in range(count):
                counts[i, best[s]] += 1.0


sensation: Any = vectorised(_sensation)
nearest: Any = kernel(nogil=True, fastmath={"reassoc", "nsz"})(_nearest)
