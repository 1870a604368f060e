"""Compiled stepping: the circuit forward in time, and the current that makes it follow a target.

Every step is the trapezoidal rule in its midpoint form: an implicit half step with the step's mean current, doubled.
Skin lumps are eliminated from the deep end up, so that only the two plates depend on the current.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np

from ..compiled import kernel
from ..rig.module import ZERO_C_IN_K
from . import plate

compiled = kernel(nogil=True, fastmath={"contract"}, error_model="numpy")
greatest_cooling = compiled(plate.greatest_cooling_A)
current_for_heat = compiled(plate.current_for_heat_A)

LONGEST_STEP_S = 0.01
SHORTEST_STEP_S = 0.25e-3
CLOSE_A = 1e-10
KEEP, LINK, BACK, SLOPE, WEIGHT = range(5)
JUMP_A = 0.02
"""After a jump of the current, and at the start, steps begin at the shortest and grow with the time since."""


@compiled
def factor(n, half, cap, g, perf, p, upper, lower, whole):
    """Factor the skin for implicit steps of length `half`; temperatures are above the deep node's.

    The upper half (n // 2 lumps) is eliminated downwards and the lower half upwards: two short chains instead of a
    long one. The lower half stands in reverse, so that both run with one index. A lump is KEEP of itself, LINK of the
    neighbour before it in its chain, BACK of the one after it and, in the upper half, SLOPE of the cold plate; WEIGHT
    gives the first lump from all. `whole` gets what is not of one lump: the cold plate's share in the first lump, the
    factor where the halves meet, and hot plate, cold plate and heat sink over the step.
    """
    middle = n // 2
    share = 0.0
    for i in range(n - 1, -1, -1):
        inverse = 1.0 / (cap[i] / half + g[i] + g[i + 1] + perf[i] - g[i + 1] * share)
        share = g[i] * inverse
        row, j = (upper, i) if i < middle else (lower, n - 1 - i)
        row[KEEP, j], row[LINK, j], row[BACK, j] = cap[i] / half * inverse, g[i + 1] * inverse, share
    product = 1.0
    for i in range(n):
        row, j = (upper, i) if i < middle else (lower, n - 1 - i)
        row[WEIGHT, j] = product * row[KEEP, j]
        product *= row[LINK, j]
    whole[0] = share
    share, product = 0.0, 1.0
    for i in range(middle):
        inverse = 1.0 / (cap[i] / half + g[i] + g[i + 1] + perf[i] - g[i] * share)
        share = g[i + 1] * inverse
        product *= g[i] * inverse
        upper[KEEP, i], upper[LINK, i] = cap[i] / half * inverse, g[i] * inverse
        upper[BACK, i], upper[SLOPE, i] = share, product
    whole[1] = 1.0 / (1.0 - lower[BACK, n - middle - 1] * share)
    whole[2], whole[3] = p[3] / half, p[4] / half
    whole[4] = p[6] / (p[11] / half + p[6]) if p[11] > 0.0 else 0.0


@kernel(nogil=True, fastmath={"contract", "reassoc"})
def weighed(n, upper, lower, x):
    """Weighted sum of the lumps: the part of the first lump, after an implicit step, that the cold plate has not."""
    total = 0.0
    for j in range(n // 2):
        total += upper[WEIGHT, j] * x[j + 2]
    for j in range(n - n // 2):
        total += lower[WEIGHT, j] * x[n // 2 + j + 2]
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
def advance(n, current, squared, step, p, g0, x, top, low, sink, upper, lower, whole, y, z, first):
    """One trapezoidal step in place, with the step's mean current and mean squared current; factors are for step/2.

    `x` is the state as `load` lays it out, `top` and `low` its lumps; `y`, `z` are scratch. `first` is `weighed` of the
    lumps; what it is for the next step comes back, summed on the way.
    """
    middle, share = n // 2, whole[4]  # the heat sink's share in its own implicit step: 0 where it is ideal
    if share > 0.0:
        regulate_sink(step, p, sink)
    hot0, cold0, kelvin = x[0], x[1], ZERO_C_IN_K + p[7]
    pump, joule = p[0] * current, 0.5 * p[1] * squared
    hot_store, cold_store, out = whole[2], whole[3], p[6] * (1.0 - share)
    a11, a22 = hot_store + out + p[2] - pump, cold_store + p[2] + pump + g0 * (1.0 - whole[0])
    b1 = hot_store * hot0 + out * (sink[0] - p[7]) + share * sink[2] + pump * kelvin + joule
    b2 = cold_store * cold0 - pump * kelvin + joule + g0 * first
    inverse = 1.0 / (a11 * a22 - p[2] * p[2])
    hot, cold = (b1 * a22 + p[2] * b2) * inverse, (a11 * b2 + p[2] * b1) * inverse
    x[0], x[1] = 2.0 * hot - hot0, 2.0 * cold - cold0
    if share > 0.0:
        sink[0] += 2.0 * share * (sink[2] / p[6] + hot + p[7] - sink[0])
    above, below = 0.0, 0.0
    for j in range(middle):
        above = upper[LINK, j] * above + upper[KEEP, j] * top[j]
        below = lower[LINK, j] * below + lower[KEEP, j] * low[j]
        y[j], z[j] = above, below
    if n > 2 * middle:
        below = lower[LINK, middle] * below + lower[KEEP, middle] * low[middle]
    above = above + upper[SLOPE, middle - 1] * cold if middle > 0 else cold
    last = n - middle - 1  # where the halves meet: the last of the lower half
    above = below = (below + lower[BACK, last] * above) * whole[1]
    moved = 2.0 * below - low[last]
    low[last] = moved
    sum_top, sum_low, j = 0.0, lower[WEIGHT, last] * moved, last - 1
    if n == 2 * middle and middle > 0:  # the upper half has one more to go
        above = y[middle - 1] + upper[SLOPE, middle - 1] * cold + upper[BACK, middle - 1] * above
        moved = 2.0 * above - top[middle - 1]
        top[middle - 1] = moved
        sum_top = upper[WEIGHT, middle - 1] * moved
    for j in range(last - 1, -1, -1):
        above = y[j] + upper[SLOPE, j] * cold + upper[BACK, j] * above
        below = z[j] + lower[BACK, j] * below
        moved, other = 2.0 * above - top[j], 2.0 * below - low[j]
        top[j], low[j] = moved, other
        sum_top += upper[WEIGHT, j] * moved
        sum_low += lower[WEIGHT, j] * other
    return sum_top + sum_low


@compiled
def place_of(k, n):
    """Where state k (hot plate, cold plate, lumps from the surface down, deep node) stands in what `load` lays out."""
    return k if k < 2 + n // 2 or k > n + 1 else n // 2 + n + 3 - k


@compiled
def load(n, state, p, x):
    """Lay a lane's state (°C) out above the deep temperature: plates, upper half, lower half in reverse, deep node."""
    for k in range(n + 3):
        x[place_of(k, n)] = state[k] - p[7]


@compiled
def forward(
    lanes, rig_of, cue_of, edges, start_A, end_A, row_of, count, plates, cap, g, perf, places, weights, state, sinks,
    out, final,
):  # fmt: skip
    """Step every lane in `lanes` through the intervals between `edges`, and write the probes of each row.

    `start_A`, `end_A` (interval, cue): current at both ends of an interval; `row_of` (interval + 1,): row to write at
    an edge, or −1; `state` (lane, n + 3); `out` (probe, lane, row). `final` (lane, n + 3) gets the state at the end;
    `sinks` (lane, 4) has each lane's heat sink as in `settle`, or NaN to start it at its set-point, and gets the last.
    """
    most = cap.shape[1]
    upper, lower, whole = np.empty((5, most)), np.empty((5, most)), np.empty(5)
    y, z, x, sink = np.empty(most), np.empty(most), np.empty(most + 3), np.zeros(4)
    probes = places.shape[1]
    at, offset = np.empty((probes, 3), dtype=np.int64), np.empty(probes)
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p = count[r], plates[r]
        load(n, state[lane], p, x)
        top, low = x[2 : 2 + n // 2], x[2 + n // 2 : 2 + n]
        for q in range(probes):
            offset[q] = (weights[r, q, 0] + weights[r, q, 1] + weights[r, q, 2]) * p[7]
            for j in range(3):
                at[q, j] = place_of(places[r, q] + j, n)
        if math.isnan(sinks[lane, 0]):
            settle(state[lane, 0], p, sink)
        else:
            sink[:] = sinks[lane]
        factored, since, before, first = -1.0, 0.0, start_A[0, c], 0.0
        for k in range(edges.size):
            row = row_of[k]
            if row >= 0:
                for q in range(probes):
                    w = weights[r, q, 0] * x[at[q, 0]] + weights[r, q, 1] * x[at[q, 1]] + weights[r, q, 2] * x[at[q, 2]]
                    out[q, lane, row] = w + offset[q]
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
                    factor(n, 0.5 * step, cap[r], g[r], perf[r], p, upper, lower, whole)
                    factored, first = step, weighed(n, upper, lower, x)
                mean, square = begin, begin * begin
                if begin != last:
                    a, b = begin + (last - begin) * (done / length), begin + (last - begin) * ((done + step) / length)
                    mean, square = 0.5 * (a + b), (a * a + a * b + b * b) / 3.0
                first = advance(n, mean, square, step, p, g[r, 0], x, top, low, sink, upper, lower, whole, y, z, first)
                done += step
                since += step
            before = last
        sinks[lane] = sink
        for k in range(n + 3):
            final[lane, k] = x[place_of(k, n)] + p[7]


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
    upper, lower, whole = np.empty((5, most)), np.empty((5, most)), np.empty(5)
    upper_p, lower_p, whole_p = np.empty((5, most)), np.empty((5, most)), np.empty(5)
    y, z, x, sink = np.empty(most), np.empty(most), np.empty(most + 3), np.zeros(4)
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p, share = count[r], plates[r], face_share[r]
        load(n, state[lane], p, x)
        top, low = x[2 : 2 + n // 2], x[2 + n // 2 : 2 + n]
        factor(n, 0.5 * step, cap[r], g[r], perf[r], p, upper, lower, whole)
        factor(n, period, cap[r], g[r], perf[r], p, upper_p, lower_p, whole_p)
        elim, amperes, first = whole_p[0], 0.0, weighed(n, upper, lower, x)
        settle(state[lane, 0], p, sink)
        for k in range(target.shape[1]):
            z0 = weighed(n, upper_p, lower_p, x) + p[7] * (1.0 - elim)
            hot, cold = x[0] + p[7], x[1] + p[7]
            amperes, code = wanted(
                target[c, k], skin_control, share, z0, elim, g[r, 0], period, hot, cold, sink[0], amperes, p
            )
            for _ in range(pieces):
                first = advance(
                    n, amperes, amperes * amperes, step, p, g[r, 0], x, top, low, sink, upper, lower, whole, y, z, first
                )
            current[lane, k] = amperes
            reached[lane, k] = (share * x[1] + (1.0 - share) * x[place_of(2, n)] if skin_control else x[1]) + p[7]
            why[lane, k] = code
