"""Compiled ways from a prescribed surface to receptor drive: response of the skin, then the receptor stage.

A unit ramp of the surface from time 0 on gives s·t − Σ_m w_m·(1 − e^(−λ_m·t))/λ_m at a depth; on a uniform clock each
exponential is the last one times e^(−λ_m·dt). A course with corners is a sum of ramps that start later.

For a channel with sign s (−1 cold, +1 warm), receptor temperature T, limit L and softness δ:

    q = L + s·δ·ln(1 + e^(s·(T − L)/δ))                      quality: no cold above L, no warmth below it
    dq_i/dt = (q − q_i)/τ_i,   dA/dt = (clip(q) − A)/τ_s      integration; adaptation inside the neutral zone
    y = max(0, s·(q_i − A))                                  receptor drive in K

Integration and adaptation are exact for q that is linear between samples.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel
from thermicon.circuit.vector_math import exp, log1p, vectorised


def _adapted_drive(
    temperature: Any,
    dt: float,
    sign: float,
    limit: float,
    softness: float,
    low: float,
    high: float,
    integration_s: float,
    adaptation_s: float,
    drive: Any,
) -> None:
    """Receptor drive (rows, n_time) in K; the receptor is adapted at the first sample, as far as the neutral zone."""
    # Weights of the old state, the old and the new input over one step.
    decay_i, decay_a = math.exp(-dt / integration_s), math.exp(-dt / adaptation_s)
    mean_i, mean_a = (
        -math.expm1(-dt / integration_s) * integration_s / dt,
        -math.expm1(-dt / adaptation_s) * adaptation_s / dt,
    )
    samples = temperature.shape[1]
    quality = np.empty(samples)
    for row in range(temperature.shape[0]):
        for t in range(samples):
            x = sign * (temperature[row, t] - limit) / softness
            nearest = temperature[row, t] if x > 0.0 else limit
            quality[t] = nearest + sign * softness * log1p(exp(-abs(x)))  # ln(1 + e^x) = max(x, 0) + ln(1 + e^−|x|)
        # States are counted from the first sample, where what does not change leaves them at 0 without rounding.
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
            y = sign * ((integrated - level) + (first - first_clipped))
            drive[row, t] = y if y > 0.0 else 0.0


adapted_drive: Any = vectorised(_adapted_drive)


def _ramp_response(steady: float, weight: Any, rate: Any, dt: float, response: Any) -> None:
    """Response (n_time,) to a unit ramp, for the modes' weights and rates (n,) in 1/s."""
    left, decay, share = np.ones(rate.size), np.exp(-rate * dt), weight / rate
    for t in range(response.size):
        lost = 0.0
        for m in range(rate.size):
            lost += share[m] * (1.0 - left[m])
            left[m] *= decay[m]
        response[t] = steady * dt * t - lost


def _superpose(unit: Any, dt: float, starts: Any, slopes: Any, course: Any) -> None:
    """Add to a course (n_time,) ramps that start at `starts` and change the slope by `slopes`, both (n,)."""
    for k in range(starts.size):
        first = max(math.ceil(starts[k] / dt - 1e-9), 0)
        for t in range(first, course.size):
            place = t - starts[k] / dt
            whole = max(int(place), 0)
            part = place - whole
            later = unit[min(whole + 1, unit.size - 1)]
            course[t] += slopes[k] * ((1.0 - part) * unit[whole] + part * later)


_vector: Any = kernel(nogil=True, fastmath={"reassoc", "nsz", "contract"})
_compile: Any = kernel(nogil=True)
ramp_response: Any = _vector(_ramp_response)
superpose: Any = _compile(_superpose)
