"""Compiled stepping: the circuit forward in time, and the current that makes it follow a target.

Every step is the trapezoidal rule in its midpoint form: an implicit half step with the step's mean current, doubled.
Skin lumps are eliminated from the deep end up, so that only the two plates depend on the current.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np
from numba import njit

from thermicon.circuit import plate
from thermicon.circuit.module import ZERO_C_IN_K

compiled = njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")
greatest_cooling = compiled(plate.greatest_cooling_A)
current_for_heat = compiled(plate.current_for_heat_A)

LONGEST_STEP_S = 0.01
SHORTEST_STEP_S = 0.25e-3
CLOSE_A = 1e-10
KEEP, LINK, BACK, SLOPE, WEIGHT = range(5)
JUMP_A = 0.02
"""After a jump of the current, and at the start, steps begin at the shortest and grow with the time since."""


@compiled
def factor(n, half, cap, g, perf, p, f):
    """Factor the skin for implicit steps of length `half`, into f (5, n + 1); temperatures are above the deep node's.

    The upper half is eliminated downwards and the lower half upwards: two short chains instead of a long one. A lump
    is KEEP of itself, LINK of the neighbour before it in its chain, BACK of the one after it and, in the upper half,
    SLOPE of the cold plate. WEIGHT gives the first lump from all lumps. Column n holds the cold plate's share in the
    first lump, the factor where the halves meet, and hot plate, cold plate and heat sink over the step.
    """
    middle = n // 2
    share = 0.0
    for i in range(n - 1, -1, -1):
        inverse = 1.0 / (cap[i] / half + g[i] + g[i + 1] + perf[i] - g[i + 1] * share)
        share = g[i] * inverse
        f[KEEP, i], f[LINK, i], f[BACK, i] = cap[i] / half * inverse, g[i + 1] * inverse, share
    product = 1.0
    for i in range(n):
        f[WEIGHT, i] = product * f[KEEP, i]
        product *= f[LINK, i]
    f[KEEP, n] = share
    share, product = 0.0, 1.0
    for i in range(middle):
        inverse = 1.0 / (cap[i] / half + g[i] + g[i + 1] + perf[i] - g[i] * share)
        share = g[i + 1] * inverse
        product *= g[i] * inverse
        f[KEEP, i], f[LINK, i], f[BACK, i], f[SLOPE, i] = cap[i] / half * inverse, g[i] * inverse, share, product
    f[LINK, n] = 1.0 / (1.0 - f[BACK, middle] * share)
    f[BACK, n], f[SLOPE, n] = p[3] / half, p[4] / half
    f[WEIGHT, n] = p[6] / (p[11] / half + p[6]) if p[11] > 0.0 else 0.0


@njit(cache=True, nogil=True, fastmath={"contract", "reassoc"})
def weighed(n, f, x):
    """Weighted sum of the lumps: the part of the first lump, after an implicit step, that the cold plate has not."""
    total = 0.0
    for i in range(n):
        total += f[WEIGHT, i] * x[i + 2]
    return total


@compiled
def settle(hot, p, sink):
    """Start the heat sink at its set-point: temperature °C, integral K·s, power W now and at rest."""
    sink[0], sink[1] = p[5], 0.0
    sink[2] = sink[3] = -p[6] * (hot - p[5]) if p[11] > 0.0 else 0.0


@compiled
def regulate_sink(step, p, sink):
    """Power of a hot plate's own controller for the next step; the integral waits at limits."""
    error = p[5] - sink[0]
    power = sink[3] + p[12] * error + p[13] * sink[1]
    sink[2] = min(max(power, -p[14]), p[14])
    if power == sink[2] or power * error < 0.0:
        sink[1] += error * step


@compiled
def advance(n, current, squared, step, p, g0, x, sink, f, y, first):
    """One trapezoidal step in place, with the step's mean current and mean squared current; f is for step/2.

    `x` (n + 2,) is hot plate, cold plate and lumps above the deep temperature p[7]; `y` (n,) is scratch. `first` is
    `weighed` of the lumps; what it is for the next step comes back, summed on the way.
    """
    middle, share = n // 2, f[WEIGHT, n]  # the heat sink's share in its own implicit step: 0 where it is ideal
    if share > 0.0:
        regulate_sink(step, p, sink)
    hot0, cold0, kelvin = x[0], x[1], ZERO_C_IN_K + p[7]
    pump, joule = p[0] * current, 0.5 * p[1] * squared
    hot_store, cold_store, out = f[BACK, n], f[SLOPE, n], p[6] * (1.0 - share)
    a11, a22 = hot_store + out + p[2] - pump, cold_store + p[2] + pump + g0 * (1.0 - f[KEEP, n])
    b1 = hot_store * hot0 + out * (sink[0] - p[7]) + share * sink[2] + pump * kelvin + joule
    b2 = cold_store * cold0 - pump * kelvin + joule + g0 * first
    inverse = 1.0 / (a11 * a22 - p[2] * p[2])
    hot, cold = (b1 * a22 + p[2] * b2) * inverse, (a11 * b2 + p[2] * b1) * inverse
    x[0], x[1] = 2.0 * hot - hot0, 2.0 * cold - cold0
    if share > 0.0:
        sink[0] += 2.0 * share * (sink[2] / p[6] + hot + p[7] - sink[0])
    above, below = 0.0, 0.0
    for j in range(middle):
        i = n - 1 - j
        above = f[LINK, j] * above + f[KEEP, j] * x[j + 2]
        below = f[LINK, i] * below + f[KEEP, i] * x[i + 2]
        y[j], y[i] = above, below
    if n > 2 * middle:
        below = f[LINK, middle] * below + f[KEEP, middle] * x[middle + 2]
    above = above + f[SLOPE, middle - 1] * cold if middle > 0 else cold
    above = below = (below + f[BACK, middle] * above) * f[LINK, n]
    moved = 2.0 * above - x[middle + 2]
    x[middle + 2] = moved
    upper, lower = 0.0, f[WEIGHT, middle] * moved
    for j in range(1, n - middle):
        i = middle + j
        below = y[i] + f[BACK, i] * below
        moved = 2.0 * below - x[i + 2]
        x[i + 2] = moved
        lower += f[WEIGHT, i] * moved
        i = middle - j
        above = y[i] + f[SLOPE, i] * cold + f[BACK, i] * above
        moved = 2.0 * above - x[i + 2]
        x[i + 2] = moved
        upper += f[WEIGHT, i] * moved
    if middle > 0 and n == 2 * middle:
        above = y[0] + f[SLOPE, 0] * cold + f[BACK, 0] * above
        x[2] = 2.0 * above - x[2]
        upper += f[WEIGHT, 0] * x[2]
    return upper + lower


@compiled
def load(state, p, x):
    """Copy a lane's state (°C) into x, above the deep temperature."""
    for i in range(state.size):
        x[i] = state[i] - p[7]


@compiled
def forward(
    lanes, rig_of, cue_of, edges, start_A, end_A, row_of, count, plates, cap, g, perf, places, weights, state, out
):
    """Step every lane in `lanes` through the intervals between `edges`, and write the probes of each row.

    `start_A`, `end_A` (interval, cue): current at both ends of an interval; `row_of` (interval + 1,): row to write at
    an edge, or −1; `state` (lane, n + 3); `out` (probe, lane, row).
    """
    most = cap.shape[1]
    f, y, x, sink = np.empty((5, most + 1)), np.empty(most), np.empty(most + 3), np.zeros(4)
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p = count[r], plates[r]
        load(state[lane], p, x)
        settle(state[lane, 0], p, sink)
        factored, since, before, first = -1.0, 0.0, start_A[0, c], 0.0
        for k in range(edges.size):
            row = row_of[k]
            if row >= 0:
                for q in range(places.shape[1]):
                    at, w = places[r, q], weights[r, q]
                    out[q, lane, row] = w[0] * x[at] + w[1] * x[at + 1] + w[2] * x[at + 2] + (w[0] + w[1] + w[2]) * p[7]
            if k == edges.size - 1:
                break
            length = edges[k + 1] - edges[k]
            begin, last = start_A[k, c], end_A[k, c]
            if abs(begin - before) > JUMP_A:
                since = 0.0
            done = 0.0
            while done < length - 1e-12:
                step = length - done
                longest = min(LONGEST_STEP_S, max(SHORTEST_STEP_S, 0.25 * since))
                if step > longest * (1.0 + 1e-9):
                    step /= math.ceil(step / longest - 1e-9)
                if abs(step - factored) > 1e-12:
                    factor(n, 0.5 * step, cap[r], g[r], perf[r], p, f)
                    factored, first = step, weighed(n, f, x)
                mean, square = begin, begin * begin
                if begin != last:
                    a, b = begin + (last - begin) * (done / length), begin + (last - begin) * ((done + step) / length)
                    mean, square = 0.5 * (a + b), (a * a + a * b + b * b) / 3.0
                first = advance(n, mean, square, step, p, g[r, 0], x, sink, f, y, first)
                done += step
                since += step
            before = last


@compiled
def wanted(target, skin_control, share, z0, elim0, g0, period, hot, cold, sink, guess, p):
    """Current for the next period and the code of what limits it, from one implicit step over the period.

    After that step the first lump is z0 + elim0 · (cold plate), which makes the target one of the cold plate, and the
    cold plate's balance one equation for the current. The smallest of all limits is taken.
    """
    alpha, ohm, leak = p[0], p[1], p[2]
    aim = target
    if skin_control:
        aim = (target - (1.0 - share) * z0) / (share + (1.0 - share) * elim0)
    heat = g0 * (z0 + (elim0 - 1.0) * aim) - p[4] / period * (aim - cold)
    base, total = p[3] / period * hot + p[6] * sink + leak * aim, p[3] / period + p[6] + leak
    return limited(current_for_heat(heat, aim, base, total, alpha, ohm, leak, 1e9, guess, CLOSE_A), hot, cold, sink, p)


@compiled
def limited(amperes, hot, cold, sink, p):
    """The current that the driver and the module allow, and the code of what held it back (0: nothing)."""
    alpha, ohm, leak, code = p[0], p[1], p[2], 0
    if amperes > p[9]:
        amperes, code = p[9], 1
    if amperes < p[8]:
        amperes, code = p[8], 2
    seebeck = alpha * (hot - cold)
    if amperes > (p[10] - seebeck) / ohm:
        amperes, code = (p[10] - seebeck) / ohm, 3
    if amperes < (-p[10] - seebeck) / ohm:
        amperes, code = (-p[10] - seebeck) / ohm, 3
    if amperes > 0.5 * alpha * (cold + ZERO_C_IN_K) / ohm:  # below half of αTc/R the optimum is never near
        most = greatest_cooling(cold, p[6] * sink + leak * cold, p[6] + leak, alpha, ohm, leak)
        if amperes > most:
            amperes, code = most, 4
    return amperes, code


@compiled
def follow(
    lanes,
    rig_of,
    cue_of,
    period,
    target,
    skin_control,
    face_share,
    count,
    plates,
    cap,
    g,
    perf,
    state,
    current,
    reached,
    why,
):
    """Find the held current of every period that takes skin or display to its target at the period's end.

    `target` (cue, period); `state` (lane, n + 3) starts steady; `current`, `reached`, `why`
    (lane, period) get the current A, the controlled temperature °C at the end and the limit that held it back.
    The current comes from a damped prediction (one implicit step over the period); the state moves by
    the accurate rule.
    """
    most = cap.shape[1]
    f, ahead, y, x, sink = (
        np.empty((5, most + 1)),
        np.empty((5, most + 1)),
        np.empty(most),
        np.empty(most + 3),
        np.zeros(4),
    )
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p, share = count[r], plates[r], face_share[r]
        load(state[lane], p, x)
        factor(n, 0.5 * step, cap[r], g[r], perf[r], p, f)
        factor(n, period, cap[r], g[r], perf[r], p, ahead)
        elim, amperes, first = ahead[KEEP, n], 0.0, weighed(n, f, x)
        settle(state[lane, 0], p, sink)
        for k in range(target.shape[1]):
            z0 = weighed(n, ahead, x) + p[7] * (1.0 - elim)
            hot, cold = x[0] + p[7], x[1] + p[7]
            amperes, code = wanted(
                target[c, k], skin_control, share, z0, elim, g[r, 0], period, hot, cold, sink[0], amperes, p
            )
            for _ in range(pieces):
                first = advance(n, amperes, amperes * amperes, step, p, g[r, 0], x, sink, f, y, first)
            current[lane, k] = amperes
            reached[lane, k] = (share * x[1] + (1.0 - share) * x[2] if skin_control else x[1]) + p[7]
            why[lane, k] = code
