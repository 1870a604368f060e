"""Compiled integrals of thermal dose and checks of runs against the rules for many lanes."""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from thermicon.base.numbers.compiled import kernel

from ..rig.module import ZERO_C_IN_K
from .quantities import BURN, DISPLAY, DOSE, RATE, SKIN

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


@kernel(nogil=True, fastmath={"nnan", "nsz"})
def extremes(values):
    """Least and greatest of finite values (rows,)."""
    least = greatest = values[0]
    for value in values:
        least, greatest = min(least, value), max(greatest, value)
    return least, greatest


@compiled
def bring_within(values, least, greatest, out):
    """Copy values (rows,), cut at both ends; what is not a number counts as the greatest."""
    for k in range(values.size):
        value = values[k]
        out[k] = least if value < least else (value if value <= greatest else greatest)


@compiled
def fill_rate(time_s, skin, out):
    """Fill `out` (rows,) with the rate in K/s since the row before; the first row has that of the second."""
    for k in range(1, skin.size):
        out[k] = (skin[k] - skin[k - 1]) / (time_s[k] - time_s[k - 1])
    out[0] = out[1]


@compiled
def fill_warmer(time_s, display, above_C, out):
    """Fill `out` (rows,) with the time in s for which the display, linear between rows, has been warmer than that."""
    out[0] = 0.0
    for k in range(display.size - 1):
        low, high = min(display[k], display[k + 1]), max(display[k], display[k + 1])
        share = 0.0 if high <= above_C else (high - above_C) / max(high - low, high - above_C)
        out[k + 1] = out[k] + share * (time_s[k + 1] - time_s[k])


@compiled
def first_near_last(values, level):
    """First row of values that never fall whose value is within `level` of the last."""
    for k in range(values.size - 1, -1, -1):
        if values[k] < values[values.size - 1] - level:
            return k + 1
    return 0


@compiled
def first_near(values, extreme, side, level):
    """First row whose value is within `level` of the extreme; `side` is 1 for the greatest, −1 for the least."""
    for k in range(values.size):
        if side * values[k] >= side * extreme - level:
            return k
    return 0


@compiled
def first_beyond(values, limit, side):
    """First row whose value is beyond a limit; one is."""
    for k in range(values.size):
        if side * (values[k] - limit) > 0.0:
            return k
    return 0


@compiled
def count(
    time_s, watched, quantity, above_C, known, span_C, level, plays, rule_of, limit, relative, upper, hard, rates, sums,
    drift, begun_C, totals, present, value, at_s, since_s,
):  # fmt: skip
    """Add WATCHED (4, lanes, rows) in °C at times (rows,) in s to the state of every rule.

    A quantity has a code (q,) and, if it is WARMER, its temperature `above_C` (q,); a rule is about the quantity
    `rule_of` (rules,). State: `totals` (q, lanes) of what adds up, and for each rule whether anything was counted,
    `present` (rules,), and extreme, its time and when the limit was first exceeded or NaN, each (rules, lanes).
    """
    columns, lanes, rows = watched.shape
    clean, scratch = np.empty((columns, rows)), np.empty(rows)
    counted = np.zeros(rule_of.size, dtype=np.bool_)
    for lane in range(lanes):
        for column in range(columns):
            bring_within(watched[column, lane], span_C[0], span_C[1], clean[column])
        for q in range(quantity.size):
            code, series = quantity[q], scratch
            if (code == RATE and not rates) or (code > RATE and not sums):
                continue
            if code < RATE:
                series = clean[code]
            elif code == RATE:
                fill_rate(time_s, clean[SKIN], scratch)
            else:
                if code == DOSE:
                    fill_dose(time_s, clean[SKIN], known, scratch)
                elif code == BURN:
                    fill_burn(time_s, clean[SKIN], known, scratch)
                else:
                    fill_warmer(time_s, clean[DISPLAY], above_C[q], scratch)
                for k in range(rows):
                    scratch[k] = plays * scratch[k] + totals[q, lane]
                totals[q, lane] = scratch[rows - 1]
            adds_up = code > RATE
            if adds_up:
                least, greatest = series[0], series[rows - 1]
            else:
                least, greatest = extremes(series)
            lowest_at, highest_at = -1, -1
            for r in range(rule_of.size):
                if rule_of[r] != q or (drift and (relative[r] or not hard[r])):
                    continue
                counted[r] = True
                if upper[r]:
                    if highest_at < 0:
                        highest_at = (
                            first_near_last(series, level) if adds_up else first_near(series, greatest, 1.0, level)
                        )
                    side, most, when = 1.0, greatest, time_s[highest_at]
                else:
                    if lowest_at < 0:
                        lowest_at = first_near(series, least, -1.0, level)
                    side, most, when = -1.0, least, time_s[lowest_at]
                if not present[r] or side * most > side * value[r, lane] + level:
                    at_s[r, lane] = when
                if not present[r] or side * most > side * value[r, lane]:
                    value[r, lane] = most
                border = begun_C[lane] + limit[r] if relative[r] else limit[r]
                if (not present[r] or math.isnan(since_s[r, lane])) and side * (most - border) > 0.0:
                    since_s[r, lane] = time_s[first_beyond(series, border, side)]
    for r in range(rule_of.size):
        present[r] |= counted[r]
