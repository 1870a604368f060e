"""Compiled sums over modes: each decays by itself, and a reading is a weighted sum of all."""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np

from ..compiled import kernel
from .constant_current import FARTHEST

FADED = 48.0
"""Beyond this exponent a mode has decayed to less than the rounding of a temperature."""

SAME_S, MOST_ROWS = 1e-11, 64
"""Up to 64 rows in equal steps share one exponential and the powers of a factor: rounding stays within 1e-14."""

compiled = kernel(nogil=True, error_model="numpy")


@compiled
def pieces_of(times_s, first_row):
    """Fill the first rows of pieces of time with equal steps; returns their number. The last row + 1 ends them all."""
    count, row = 0, 0
    while row < times_s.size:
        first_row[count] = row
        count, last = count + 1, row + 1
        if last < times_s.size:
            step = times_s[last] - times_s[row]
            while (
                last < times_s.size
                and last - row < MOST_ROWS
                and abs(times_s[last] - times_s[last - 1] - step) <= SAME_S
            ):
                last += 1
        row = last
    first_row[count] = times_s.size
    return count


@compiled
def relax(rigs, times_s, rate_per_s, modes, reading, level, out):
    """Fill `out` (probes, lanes, times) with readings of modes (lanes, m) that decay for times from now in s.

    A lane is on the rig `rigs` (lanes,), with rates (rigs, m), `reading` (rigs, probes, m) and `level` (rigs, probes),
    which is read when all modes have decayed. Times increase.
    """
    probes, lanes, rows = out.shape
    first_row, powers = np.empty(rows + 1, dtype=np.int64), np.empty(MOST_ROWS)
    pieces = pieces_of(times_s, first_row)
    for lane in range(lanes):
        rig = rigs[lane]
        for p in range(probes):
            for t in range(rows):
                out[p, lane, t] = level[rig, p]
        for m in range(modes.shape[1]):
            rate, before = rate_per_s[rig, m], -1.0
            powers[0] = 1.0
            for piece in range(pieces):
                first, last = first_row[piece], first_row[piece + 1]
                if rate * times_s[first] > FADED:
                    break
                step = times_s[first + 1] - times_s[first] if last > first + 1 else before
                if abs(step - before) > SAME_S:
                    before, factor = step, math.exp(min(-rate * step, FARTHEST))
                    for j in range(1, MOST_ROWS):
                        powers[j] = powers[j - 1] * factor
                decay = math.exp(min(-rate * times_s[first], FARTHEST))
                for p in range(probes):
                    share, row = reading[rig, p, m] * modes[lane, m] * decay, out[p, lane]
                    for j in range(last - first):
                        row[first + j] += share * powers[j]


@compiled
def follow_display(above_K, keep, now, then, drive_per_s, reading, direct, offset_C, modes, out):
    """Fill `out` (readings, rows) for a display (rows,) in K above the deep node, linear between rows.

    Modes (m,) are taken on to the end: each keeps the share `keep` (m,) over a step, and is driven by the display at
    its beginning and its end with the weights `now` and `then` (m,) in s. `reading` (readings, m).
    """
    readings, rows = out.shape
    for q in range(readings):
        for k in range(rows):
            out[q, k] = direct[q] * above_K[k] + offset_C[q]
    for m in range(modes.size):
        mode = modes[m]
        for q in range(readings):
            out[q, 0] += reading[q, m] * mode
        for k in range(1, rows):
            mode = drive_per_s[m] * (now[m] * above_K[k - 1] + then[m] * above_K[k]) + keep[m] * mode
            for q in range(readings):
                out[q, k] += reading[q, m] * mode
        modes[m] = mode
