"""Compiled stepping of passive probes: a thermistor's lag, and insulated skin beside the skin in contact."""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np

from ..compiled import kernel


@kernel(nogil=True)
def lagged(time_s, value, lag_s, out):
    """Fill `out` (rows,) with a first-order lag of `value`, settled at first; exact where it is linear between rows."""
    out[0] = value[0]
    for k in range(time_s.size - 1):
        step = time_s[k + 1] - time_s[k]
        behind = (value[k + 1] - value[k]) / step * lag_s  # how far a settled lag trails a ramp
        out[k + 1] = value[k + 1] - behind + (out[k] - value[k] + behind) * math.exp(-step / lag_s)


@kernel(nogil=True)
def step_lateral_column(time_s, display, lumps, cap, g, perf, across, deep, state, upper, share, out):
    """Step a passive column of n lumps by the trapezoidal rule, and fill `out` (rows,) with one reading of it.

    `display` (rows,) and `lumps` (n, rows), the other column's, are taken as linear between rows. `cap`, `perf`,
    `across` (n,), `g` (n + 1,) are per unit area; `g[0]` joins the display, `across` the other column lump by lump.
    The reading is (1 − share) · state[upper] + share · state[upper + 1], where state 0 is the display and state n + 1
    the deep node; `state` (n + 2,) starts it all.
    """
    n = cap.size
    elim, known = np.empty(n), np.empty(n)
    out[0] = (1.0 - share) * state[upper] + share * state[upper + 1]
    for k in range(time_s.size - 1):
        half = 0.5 * (time_s[k + 1] - time_s[k])
        above, carried, conduct = 0.5 * (display[k] + display[k + 1]), 0.0, g[0]
        for i in range(n):  # an implicit half step with the forcing of its middle, then doubled
            store = cap[i] / half
            other = 0.5 * (lumps[i, k] + lumps[i, k + 1])
            right = store * state[i + 1] + across[i] * other + perf[i] * deep
            diagonal = store + across[i] + perf[i] + g[i] + g[i + 1]
            if i == 0:
                right += conduct * above
            else:
                right += g[i] * carried
                diagonal -= g[i] * elim[i - 1]
            elim[i] = g[i + 1] / diagonal
            known[i] = right / diagonal
            carried = known[i]
        below = deep
        for i in range(n - 1, -1, -1):
            below = known[i] + elim[i] * below
            state[i + 1] = 2.0 * below - state[i + 1]
        state[0] = display[k + 1]
        out[k + 1] = (1.0 - share) * state[upper] + share * state[upper + 1]
