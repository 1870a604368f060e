"""Compiled response of skin to a prescribed surface: ramps as sums of modes, and courses as sums of ramps.

A unit ramp of the surface from time 0 on gives s·t − Σ_m w_m·(1 − e^(−λ_m·t))/λ_m at a depth; on a uniform clock each
exponential is the last one times e^(−λ_m·dt). A course with corners is a sum of ramps that start later.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from thermicon.circuit.compiled import kernel


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
