"""Compiled receptor stage: limits of quality, integration, adaptation.

For a channel with sign s (−1 cold, +1 warm), receptor temperature T, limit L and softness δ:

    q = L + s·δ·ln(1 + e^(s·(T − L)/δ))                      quality: no cold above L, no warmth below it
    dq_i/dt = (q − q_i)/τ_i,   dA/dt = (clip(q) − A)/τ_s      integration; adaptation inside the neutral zone
    y = max(0, s·(q_i − A))                                  receptor drive in K
"""

from __future__ import annotations

import math
from typing import Any

from thermicon.circuit.compiled import kernel

FAR = 30.0
"""Softnesses beyond its limit at which a soft limit is none."""


def _limited(temperature: float, limit: float, softness: float, sign: float) -> float:
    x = sign * (temperature - limit) / softness
    return temperature if x > FAR else limit + sign * softness * math.log1p(math.exp(x))


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
    to_input, to_level = 1.0 - math.exp(-dt / integration_s), 1.0 - math.exp(-dt / adaptation_s)
    for row in range(temperature.shape[0]):
        q = limited(temperature[row, 0], limit, softness, sign)
        integrated = q
        level = min(max(q, low), high)
        for t in range(temperature.shape[1]):
            before = q
            q = limited(temperature[row, t], limit, softness, sign)
            # The mean of both ends makes the first-order steps second-order accurate.
            middle = 0.5 * (before + q)
            integrated += to_input * (middle - integrated)
            level += to_level * (min(max(middle, low), high) - level)
            y = sign * (integrated - level)
            drive[row, t] = y if y > 0.0 else 0.0


_compile: Any = kernel(nogil=True)
limited: Any = _compile(_limited)
adapted_drive: Any = _compile(_adapted_drive)
