"""Compiled integrals of thermal dose over rows that are linear in time between each other; see `exposure`."""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

from ..compiled import kernel
from ..rig.module import ZERO_C_IN_K

LEVEL_K = 1e-5
"""Rows closer than this count as level, since a difference of primitives would be rounding noise."""

SMALL_K = 0.05
"""The longest piece of a ramp over which the Henriques rate is expanded about its middle."""

START_C, REFERENCE_C, BASE_HIGH, BASE_LOW, LOG_FACTOR, ACTIVATION_K = range(6)
"""Constants of both measures, in the order of `exposure.constants`; the activation energy is over the gas constant."""

compiled = kernel(nogil=True, error_model="numpy")


@compiled
def dose_primitive(warm, known):
    """Integral of the CEM43 rate over temperature from far below, in s: what a ramp of 1 K/s gives."""
    reference, start = known[REFERENCE_C], known[START_C]
    high, low = known[BASE_HIGH], known[BASE_LOW]
    inside = min(max(warm, start), reference)
    below = (low ** (reference - inside) - low ** (reference - start)) / -math.log(low)
    if warm <= reference:
        return below
    return below + (high ** (reference - warm) - 1.0) / -math.log(high)


@compiled
def fill_dose(time_s, warm, known, out):
    """Fill `out` (rows,) with the cumulative CEM43 in min of temperatures (rows,) in °C."""
    start, reference, total = known[START_C], known[REFERENCE_C], 0.0
    out[0] = 0.0
    primitive, of_row = 0.0, -1
    for k in range(warm.size - 1):
        begin, end = warm[k], warm[k + 1]
        if begin >= start or end >= start:
            rise = end - begin
            if abs(rise) < LEVEL_K:
                middle = begin + 0.5 * rise
                base = known[BASE_HIGH] if middle >= reference else known[BASE_LOW]
                per_s = 0.0 if middle < start else base ** (reference - middle)
            else:
                before = primitive if of_row == k else dose_primitive(begin, known)
                primitive, of_row = dose_primitive(end, known), k + 1
                per_s = (primitive - before) / rise
            total += per_s * (time_s[k + 1] - time_s[k]) / 60.0
        out[k + 1] = total


@compiled
def burn_rate(middle, rise, known):
    """Mean Henriques rate in 1/s over a small linear rise about a middle, to the fourth order of the rise."""
    inverse = 1.0 / (middle + ZERO_C_IN_K)
    exponent = known[ACTIVATION_K] * inverse
    first, second = exponent * inverse, exponent * inverse * inverse
    return math.exp(known[LOG_FACTOR] - exponent) * (1.0 + rise * rise * (first * first / 24.0 - second / 12.0))


@compiled
def fill_burn(time_s, warm, known, out):
    """Fill `out` (rows,) with the cumulative Henriques integral of temperatures (rows,) in °C."""
    total = 0.0
    out[0] = 0.0
    for k in range(warm.size - 1):
        rise = warm[k + 1] - warm[k]
        middle = warm[k] + 0.5 * rise
        if abs(rise) <= SMALL_K:
            per_s = burn_rate(middle, rise, known)
        else:
            per_s, pieces = 0.0, math.ceil(abs(rise) / SMALL_K)
            for piece in range(pieces):
                per_s += burn_rate(middle + rise * ((piece + 0.5) / pieces - 0.5), rise / pieces, known)
            per_s /= pieces
        total += per_s * (time_s[k + 1] - time_s[k])
        out[k + 1] = total


@compiled
def fill_doses(time_s, warm, known, out):
    """`fill_dose` for each lane of temperatures (lanes, rows)."""
    for lane in range(len(warm)):
        fill_dose(time_s, warm[lane], known, out[lane])


@compiled
def fill_burns(time_s, warm, known, out):
    """`fill_burn` for each lane of temperatures (lanes, rows)."""
    for lane in range(len(warm)):
        fill_burn(time_s, warm[lane], known, out[lane])
