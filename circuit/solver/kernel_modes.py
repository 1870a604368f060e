"""Compiled sums of modes of the linear circuit.

Skin under a display that is linear between periods is a sum of responses to
one ramp: a display whose slope changes by s_j K per period at period k_j leads to readings

    y(k) = y(0) + Σ_j s_j · R(k − k_j),

where R is the response to a display that rises by 1 K per period. The module is not linear: `playable` goes through
the current that such a display needs, and says whether driver and module allow it with a margin.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from ..rig.module import ZERO_C_IN_K
from . import network as net
from .kernel import compiled
from .kernel_follow import FREE, limited

MARGIN_A, MARGIN = 0.01, 0.02
"""A display counts as playable where this much more current either way, in A and as a share, is free of limits too."""


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


@compiled
def rise(direct, weight, rate_per_s, step_s, out):
    """Fill `out` (rows,) with the response to a display that rises by 1 K/s, from modes' weights and rates (m,)."""
    left, decay, share = np.ones(rate_per_s.size), np.exp(-rate_per_s * step_s), weight / rate_per_s
    steady = direct + weight.sum()
    for k in range(out.size):
        lost = 0.0
        for m in range(rate_per_s.size):
            lost += share[m] * (1.0 - left[m])
            left[m] *= decay[m]
        out[k] = steady * step_s * k - lost


@compiled
def ramp_responses(count, cap, g, perf, period_s, places, weights, response):
    """Fill `response` (rigs, readings + 1, periods + 1): readings in K, then the heat flow in W from skin to display.

    The display rises by 1 K per period from 0 on. Readings are three neighbouring states from `places` (rigs, readings)
    with `weights` (rigs, readings, 3), as in `Network`; each period is one trapezoidal step, as `kernel` takes it.
    """
    readings, rows, most = places.shape[1], response.shape[2], cap.shape[1]
    x, y = np.empty(most + 5), np.empty(most)
    keep, link, elim = np.empty(most), np.empty(most), np.empty(most)
    half = 0.5 * period_s
    for r in range(count.size):
        n = count[r]
        share = 0.0
        for i in range(n - 1, -1, -1):  # T_i = keep·x_i + link·y_{i+1} + elim·T_{i−1} after an implicit half step
            inverse = 1.0 / (cap[r, i] / half + g[r, i] + g[r, i + 1] + perf[r, i] - g[r, i + 1] * share)
            share = g[r, i] * inverse
            keep[i], link[i], elim[i] = cap[r, i] / half * inverse, g[r, i + 1] * inverse, share
        for i in range(x.size):
            x[i] = 0.0
        for k in range(rows):
            for q in range(readings):
                at = places[r, q]
                response[r, q, k] = (
                    weights[r, q, 0] * x[at] + weights[r, q, 1] * x[at + 1] + weights[r, q, 2] * x[at + 2]
                )
            response[r, readings, k] = g[r, 0] * (x[net.SKIN] - k)
            below = 0.0
            for i in range(n - 1, -1, -1):
                below = keep[i] * x[net.SKIN + i] + link[i] * below
                y[i] = below
            above = k + 0.5
            for i in range(n):
                above = y[i] + elim[i] * above
                x[net.SKIN + i] = 2.0 * above - x[net.SKIN + i]
            x[net.COLD] = k + 1.0


@compiled
def playable(display, flow, hot, p, period_s):
    """Whether driver and module produce a display (periods + 1,) in °C, with a margin.

    The cold plate's balance gives the current of each period from the heat `flow` (periods + 1,) out of the skin,

        αI·T_c − I²R/2 = flow − C_c·dT_c/dt + (T_h − T_c)/Θ,

    and the hot plate, which begins at `hot` in °C, follows by implicit steps.
    """
    alpha, ohm, leak, out = p[net.ALPHA], p[net.RESISTANCE], p[net.CONDUCTANCE], p[net.SINK_W_PER_K]
    hot_store, cold_store = p[net.HOT_J_PER_K] / period_s, p[net.COLD_J_PER_K] / period_s
    for k in range(1, display.size):
        cold = display[k]
        taken = flow[k] - cold_store * (cold - display[k - 1])
        half = alpha * (cold + ZERO_C_IN_K)
        root = half * half - 2.0 * ohm * (taken + leak * (hot - cold))
        if root <= 0.0:
            return False
        amperes = (half - math.sqrt(root)) / ohm
        spare = MARGIN_A + MARGIN * abs(amperes)
        _, above = limited(amperes + spare, hot, cold, p[net.SINK_C], p)
        _, below = limited(amperes - spare, hot, cold, p[net.SINK_C], p)
        if above != FREE or below != FREE:
            return False
        warm = hot_store * hot + out * p[net.SINK_C] + leak * cold + alpha * amperes * ZERO_C_IN_K
        hot = (warm + 0.5 * ohm * amperes * amperes) / (hot_store + out + leak - alpha * amperes)
    return True


@compiled
def superpose(
    lanes, rig_of, cue_of, corner_at, corner_K, response, begin, row_at, display, hot_C, plates, period_s, out, fine
):
    """Fill `out` (readings, lane, rows) at the ends `row_at` (rows,) of periods, and `fine` (lane,), see `playable`.

    `corner_at` and `corner_K` (cue, corners) are the periods at which the slope changes (−1: no more corners), and its
    change in K per period; `begin` (lane, readings + 1) is what is read at the start, and then the heat flow.
    """
    readings, periods = out.shape[0], display.shape[1]
    course = np.empty(periods)
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        for q in range(readings + 1):
            unit = response[r, q]
            for k in range(periods):
                course[k] = begin[lane, q]
            for j in range(corner_at.shape[1]):
                first, slope = corner_at[c, j], corner_K[c, j]
                if first < 0:
                    break
                for k in range(first, periods):
                    course[k] += slope * unit[k - first]
            if q < readings:
                for k in range(row_at.size):
                    out[q, lane, k] = course[row_at[k]]
        fine[lane] = playable(display[c], course, hot_C[lane], plates[r], period_s)
