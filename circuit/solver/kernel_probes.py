"""Compiled stepping of a probe: the lag of a thermistor."""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

from ..compiled import kernel


@kernel(nogil=True)
def lagged(time_s, value, lag_s, out):
    """Fill `out` (rows,) with a first-order lag of `value`, settled at first; exact where it is linear between rows."""
    out[0] = value[0]
    for k in range(time_s.size - 1):
        step = time_s[k + 1] - time_s[k]
        behind = (value[k + 1] - value[k]) / step * lag_s  # how far a settled lag trails a ramp
        out[k + 1] = value[k + 1] - behind + (out[k] - value[k] + behind) * math.exp(-step / lag_s)
