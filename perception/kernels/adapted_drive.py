"""Compiled receptor stage: limits of quality, integration, adaptation.

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
