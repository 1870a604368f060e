"""Compiled stepping: the circuit forward in time, and the current that makes it follow a target.

Every step of length δ is the trapezoidal rule in its midpoint form: an implicit step of δ/2 with the step's mean
current gives the state in the middle, x_mid, and x_new = 2·x_mid − x_old. The skin is a chain of lumps,

    C_i·dT_i/dt = g_i·(T_{i−1} − T_i) + g_{i+1}·(T_{i+1} − T_i) + w_i·(T_deep − T_i),

a tridiagonal system that does not depend on the current and is factored once for each step length. What remains are
two equations for the plates, which do depend on it (`advance`).
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np

from ..compiled import kernel
from ..rig.module import ZERO_C_IN_K
from . import plate
from .kernel_legs import (
    begin_sink,
    factor_legs,
    legs_ahead,
    legs_heat,
    load_legs,
    step_legs,
    store_legs,
)
from .network import COLD, HOT, SKIN
from .plate import (
    ALPHA,
    COLD_J_PER_K,
    COMPLIANCE_V,
    CONDUCTANCE,
    DEEP_C,
    HIGHEST_A,
    HOT_J_PER_K,
    INTEGRAL,
    LOWEST_A,
    PAST_MOST_COOLING,
    POWER,
    RESISTANCE,
    REST_POWER,
    SINK_AIR_W_PER_K,
    SINK_C,
    SINK_J_PER_K,
    SINK_KI,
    SINK_KP,
    SINK_NUMBERS,
    SINK_POWER_W,
    SINK_W_PER_K,
    TEMPERATURE,
)

compiled = kernel(nogil=True, fastmath={"contract"}, error_model="numpy")
inlined = kernel(nogil=True, fastmath={"contract"}, error_model="numpy", forceinline=True)  # a call has 100 arguments
greatest_cooling = compiled(plate.greatest_cooling_A)
current_for_heat = compiled(plate.current_for_heat_A)

LONGEST_STEP_S = 0.01
SHORTEST_STEP_S = 0.25e-3
JUMP_A = 0.02
"""After a jump of the current, and at the start, steps begin at the shortest and grow with the time since."""

CLOSE_A, ANY_A = 1e-10, 1e9
"""Tolerance of the search for a current, and what it gives where no current is enough: `limited` cuts that."""

KEEP, LINK, BACK, SLOPE, WEIGHT = range(5)
"""Rows of a factored half of the skin, see `factor`."""

COLD_SHARE, MEET, HOT_STORE, COLD_STORE, SINK_SHARE = range(5)
"""Factors of a step that belong to no single lump: weight of the cold plate in the first lump, factor where the halves
meet, C/(δ/2) of both plates in W/K, and weight of the hot plate in the heat sink (0 where the sink is ideal)."""

FREE, MOST_CURRENT, LEAST_CURRENT, VOLTAGE, MODULE = range(5)
"""What limits a current: nothing, the driver's highest or lowest current, its voltage, the module's best cooling."""


@compiled
def factor(n, half, cap, g, perf, p, upper, lower, whole):
    """Factor the skin for implicit steps of length `half`; temperatures are above the deep node's.

    The upper half (n // 2 lumps) is eliminated downwards and the lower half upwards: two short chains instead of a
    long one. The lower half is stored in reverse, so that one index j runs through both. From old values x the
    implicit step gives new ones T by elimination and back substitution (`advance`),

        y_j = KEEP_j·x_j + LINK_j·y_{j−1},    T_j = y_j + BACK_j·T_{j+1}  (+ SLOPE_j·T_c in the upper half),

    where a chain continues beyond its last lump with that of the other half. The first lump is COLD_SHARE·T_c plus the
    sum of WEIGHT · x over all lumps. `whole` gets the factors from COLD_SHARE to SINK_SHARE.
    """
    middle = n // 2
    share = 0.0
    for i in range(n - 1, -1, -1):  # from the deep end up: T_i = y_i + share·T_{i−1}, y_i = keep·x_i + link·y_{i+1}
        inverse = 1.0 / (cap[i] / half + g[i] + g[i + 1] + perf[i] - g[i + 1] * share)
        share = g[i] * inverse
        row, j = (upper, i) if i < middle else (lower, n - 1 - i)
        row[KEEP, j], row[LINK, j], row[BACK, j] = cap[i] / half * inverse, g[i + 1] * inverse, share
    product = 1.0
    for i in range(n):
        row, j = (upper, i) if i < middle else (lower, n - 1 - i)
        row[WEIGHT, j] = product * row[KEEP, j]
        product *= row[LINK, j]
    whole[COLD_SHARE] = share
    share, product = 0.0, 1.0
    for i in range(middle):  # the upper half again, this time from the cold plate down
        inverse = 1.0 / (cap[i] / half + g[i] + g[i + 1] + perf[i] - g[i] * share)
        share = g[i + 1] * inverse
        product *= g[i] * inverse
        upper[KEEP, i], upper[LINK, i] = cap[i] / half * inverse, g[i] * inverse
        upper[BACK, i], upper[SLOPE, i] = share, product
    whole[MEET] = 1.0 / (1.0 - lower[BACK, n - middle - 1] * share)
    whole[HOT_STORE], whole[COLD_STORE] = p[HOT_J_PER_K] / half, p[COLD_J_PER_K] / half
    sink_store = p[SINK_J_PER_K] / half + p[SINK_W_PER_K] + p[SINK_AIR_W_PER_K]
    whole[SINK_SHARE] = p[SINK_W_PER_K] / sink_store if p[SINK_J_PER_K] > 0.0 else 0.0


@kernel(nogil=True, fastmath={"contract", "reassoc"})
def weighed(n, upper, lower, x):
    """First lump after an implicit step, less the cold plate's part: the sum of weight · lump."""
    total = 0.0
    for j in range(n // 2):
        total += upper[WEIGHT, j] * x[j + 2]
    for j in range(n - n // 2):
        total += lower[WEIGHT, j] * x[n // 2 + j + 2]
    return total


@compiled
def settle(hot, p, sink):
    """Start the heat sink at its set-point, with the power that holds it there."""
    sink[TEMPERATURE], sink[INTEGRAL] = p[SINK_C], 0.0
    sink[POWER] = sink[REST_POWER] = -p[SINK_W_PER_K] * (hot - p[SINK_C]) if p[SINK_J_PER_K] > 0.0 else 0.0


@compiled
def regulate_sink(step, p, sink):
    """Power of the heat sink's own controller for the next step: P = P_rest + kp·e + ki·∫e dt within its limits.

    The sink then obeys C_s·dT_s/dt = P + (T_h − T_s)/R_s, which `advance` steps together with the plates.
    The integral is not advanced while the power is at a limit and the error would push it further (anti-windup).
    """
    error = p[SINK_C] - sink[TEMPERATURE]
    power = sink[REST_POWER] + p[SINK_KP] * error + p[SINK_KI] * sink[INTEGRAL]
    sink[POWER] = min(max(power, -p[SINK_POWER_W]), p[SINK_POWER_W])
    if power == sink[POWER] or power * error < 0.0:
        sink[INTEGRAL] += error * step


@inlined
def advance(n, current, squared, step, p, g0, x, top, low, sink, upper, lower, whole, y, z, first, leg):
    """One trapezoidal step in place, with the step's mean current and mean squared current; factors are for step/2.

    `x` is the state as `load` stores it, `top` and `low` are views of its lumps, `y` and `z` scratch. `first` is
    `weighed` of the lumps; the function returns `weighed` of the new lumps, summed on the way. The plates obey

        C_h·dT_h/dt = αI·T_h + I²R/2 + (T_c − T_h)/Θ + (T_s − T_h)/R_s,
        C_c·dT_c/dt = −αI·T_c + I²R/2 + (T_h − T_c)/Θ + g_0·(T_1 − T_c),

    T_h and T_c in kelvin in the Peltier terms; the implicit half step makes them a symmetric 2 × 2 system. With
    cells in the legs (`leg` is not None) the terms in Θ and R/2 are those of `kernel_legs`, which keeps the form.
    """
    middle, share = n // 2, whole[SINK_SHARE]  # the heat sink's share in its own implicit step: 0 where it is ideal
    if share > 0.0:
        regulate_sink(step, p, sink)
    hot0, cold0, kelvin, leak = x[HOT], x[COLD], ZERO_C_IN_K + p[DEEP_C], p[CONDUCTANCE]
    pump, joule = p[ALPHA] * current, 0.5 * p[RESISTANCE] * squared
    if leg is None:
        near, warm, cool = leak, joule, joule
    else:
        near, leak, warm, cool = legs_heat(squared, p, leg)
    hot_store, cold_store, out = whole[HOT_STORE], whole[COLD_STORE], p[SINK_W_PER_K] * (1.0 - share)
    a11, a22 = hot_store + out + near - pump, cold_store + near + pump + g0 * (1.0 - whole[COLD_SHARE])
    b1 = hot_store * hot0 + out * (sink[TEMPERATURE] - p[DEEP_C]) + share * sink[POWER] + pump * kelvin + warm
    b2 = cold_store * cold0 - pump * kelvin + cool + g0 * first
    inverse = 1.0 / (a11 * a22 - leak * leak)  # both off-diagonal elements are −1/Θ, or −ACROSS
    hot, cold = (b1 * a22 + leak * b2) * inverse, (a11 * b2 + leak * b1) * inverse
    step_legs(squared, hot, cold, p, leg)
    x[HOT], x[COLD] = 2.0 * hot - hot0, 2.0 * cold - cold0
    if share > 0.0:
        sink[TEMPERATURE] += 2.0 * share * (sink[POWER] / p[SINK_W_PER_K] + hot + p[DEEP_C] - sink[TEMPERATURE])
    above, below = 0.0, 0.0
    for j in range(middle):  # forward elimination of both halves, towards their meeting
        above = upper[LINK, j] * above + upper[KEEP, j] * top[j]
        below = lower[LINK, j] * below + lower[KEEP, j] * low[j]
        y[j], z[j] = above, below
    if n > 2 * middle:
        below = lower[LINK, middle] * below + lower[KEEP, middle] * low[middle]
    above = above + upper[SLOPE, middle - 1] * cold if middle > 0 else cold
    last = n - middle - 1  # where the halves meet: the last of the lower half
    above = below = (below + lower[BACK, last] * above) * whole[MEET]
    moved = 2.0 * below - low[last]
    low[last] = moved
    sum_top, sum_low, j = 0.0, lower[WEIGHT, last] * moved, last - 1
    if n == 2 * middle and middle > 0:  # the upper half has one more to go
        above = y[middle - 1] + upper[SLOPE, middle - 1] * cold + upper[BACK, middle - 1] * above
        moved = 2.0 * above - top[middle - 1]
        top[middle - 1] = moved
        sum_top = upper[WEIGHT, middle - 1] * moved
    for j in range(last - 1, -1, -1):  # back substitution, away from the meeting
        above = y[j] + upper[SLOPE, j] * cold + upper[BACK, j] * above
        below = z[j] + lower[BACK, j] * below
        moved, other = 2.0 * above - top[j], 2.0 * below - low[j]
        top[j], low[j] = moved, other
        sum_top += upper[WEIGHT, j] * moved
        sum_low += lower[WEIGHT, j] * other
    return sum_top + sum_low


@compiled
def place_of(k, n):
    """Index that `load` gives to state k (hot plate, cold plate, lumps from the surface down, deep node)."""
    return k if k < 2 + n // 2 or k > n + 1 else n // 2 + n + 3 - k


@compiled
def load(n, state, p, x):
    """Store a lane's state (°C) as K above the deep node: plates, upper half, lower half in reverse, deep node."""
    for k in range(n + 3):
        x[place_of(k, n)] = state[k] - p[DEEP_C]


@compiled
def forward(
    lanes, rig_of, cue_of, edges, start_A, end_A, row_of, count, plates, cap, g, perf, places, weights, state, sinks,
    out, final, cells, leg,
):  # fmt: skip
    """Step every lane in `lanes` through the intervals between `edges`, and write the probes of each row.

    `start_A`, `end_A` (interval, cue) are the currents at both ends of an interval; `row_of` (interval + 1,) the row to
    write at an edge, or −1; `state` (lane, n + 3) the start in °C; `out` (probe, lane, row) and `final` (lane, n + 3)
    are filled. `sinks` (lane, 4) holds each lane's heat sink (NaN: start at its set-point), and is left as it ends; so
    are the cells of its legs, `cells` (lane, m) in °C or None; `leg` is `kernel_legs.leg_room` for them.
    """
    most = cap.shape[1]
    upper, lower, whole = np.empty((5, most)), np.empty((5, most)), np.empty(5)
    y, z, x, sink = np.empty(most), np.empty(most), np.empty(most + 3), np.zeros(SINK_NUMBERS)
    probes = places.shape[1]
    at, offset = np.empty((probes, 3), dtype=np.int64), np.empty(probes)
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p = count[r], plates[r]
        load(n, state[lane], p, x)
        load_legs(cells, lane, p, leg)
        top, low = x[SKIN : SKIN + n // 2], x[SKIN + n // 2 : SKIN + n]
        for q in range(probes):
            offset[q] = (weights[r, q, 0] + weights[r, q, 1] + weights[r, q, 2]) * p[DEEP_C]
            for j in range(3):
                at[q, j] = place_of(places[r, q] + j, n)
        if math.isnan(sinks[lane, TEMPERATURE]):
            settle(state[lane, 0], p, sink)
        else:
            for j in range(SINK_NUMBERS):  # a slice as target would compile the text of its errors as well
                sink[j] = sinks[lane, j]
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
                    factor_legs(0.5 * step, p, leg)
                    factored, first = step, weighed(n, upper, lower, x)
                mean, square = begin, begin * begin
                if begin != last:  # means of I and I² over a step in which I is linear
                    a, b = begin + (last - begin) * (done / length), begin + (last - begin) * ((done + step) / length)
                    mean, square = 0.5 * (a + b), (a * a + a * b + b * b) / 3.0
                first = advance(
                    n, mean, square, step, p, g[r, 0], x, top, low, sink, upper, lower, whole, y, z, first, leg
                )
                done += step
                since += step
            before = last
        for j in range(SINK_NUMBERS):
            sinks[lane, j] = sink[j]
        store_legs(cells, lane, p, leg)
        for k in range(n + 3):
            final[lane, k] = x[place_of(k, n)] + p[DEEP_C]


@compiled
def wanted(target, skin_control, share, z0, elim0, g0, period, hot, cold, sink, guess, p, ahead):
    """Current for the next period and the code of what limits it, from one implicit step over the period.

    After that step the first lump is z0 + elim0 · (cold plate), so that a target of the skin becomes one of the cold
    plate, T_aim. Its balance is then an equation for the current alone (`plate.current_for_heat_A`):

        αI·T_aim − I²R/2 − (T_h − T_aim)/Θ = g_0·(z0 + (elim0 − 1)·T_aim) − C_c·(T_aim − T_c)/period.

    `ahead` has what stands in place of the terms in Θ and R where legs store heat (`kernel_legs.legs_ahead`).
    """
    alpha, ohm, leak = p[ALPHA], p[RESISTANCE], p[CONDUCTANCE]
    hot_store, cold_store, out = p[HOT_J_PER_K] / period, p[COLD_J_PER_K] / period, p[SINK_W_PER_K]
    aim = target
    if skin_control:
        aim = (target - (1.0 - share) * z0) / (share + (1.0 - share) * elim0)
    heat = g0 * (z0 + (elim0 - 1.0) * aim) - cold_store * (aim - cold)
    if ahead is not None:
        near, across, ohm, warm, cool = ahead
        base, total = hot_store * hot + out * sink + across * aim + warm, hot_store + out + near
        heat += cool - (near - across) * aim
        amperes = current_for_heat(heat, aim, base, total, alpha, ohm, across, ANY_A, guess, CLOSE_A)
        return limited(amperes, hot, cold, sink, p)
    base, total = hot_store * hot + out * sink + leak * aim, hot_store + out + leak
    amperes = current_for_heat(heat, aim, base, total, alpha, ohm, leak, ANY_A, guess, CLOSE_A)
    return limited(amperes, hot, cold, sink, p)


@compiled
def limited(amperes, hot, cold, sink, p):
    """The current that driver and module allow, and the code of the last limit that reduced it."""
    alpha, ohm, leak, code = p[ALPHA], p[RESISTANCE], p[CONDUCTANCE], FREE
    if amperes > p[HIGHEST_A]:
        amperes, code = p[HIGHEST_A], MOST_CURRENT
    if amperes < p[LOWEST_A]:
        amperes, code = p[LOWEST_A], LEAST_CURRENT
    seebeck = alpha * (hot - cold)  # voltage at the module: α(T_h − T_c) + I·R
    if amperes > (p[COMPLIANCE_V] - seebeck) / ohm:
        amperes, code = (p[COMPLIANCE_V] - seebeck) / ohm, VOLTAGE
    if amperes < (-p[COMPLIANCE_V] - seebeck) / ohm:
        amperes, code = (-p[COMPLIANCE_V] - seebeck) / ohm, VOLTAGE
    capped = p[PAST_MOST_COOLING] == 0.0
    if capped and amperes > 0.5 * alpha * (cold + ZERO_C_IN_K) / ohm:  # the best cooling is never below half of αT_c/R
        most = greatest_cooling(cold, p[SINK_W_PER_K] * sink + leak * cold, p[SINK_W_PER_K] + leak, alpha, ohm, leak)
        if amperes > most:
            amperes, code = most, MODULE
    return amperes, code


@compiled
def follow(
    lanes, rig_of, cue_of, period, target, skin_control, face_share, count, plates, cap, g, perf, state, current,
    reached, why, cells, warm, leg, period_leg, ahead,
):  # fmt: skip
    """Find the held current of every period that takes skin or display to its target at the period's end.

    `target` (cue, period) in °C; `state` (lane, n + 3) is a steady state; `current`, `reached` and `why` (lane, period)
    get the current A, the controlled temperature °C at the period's end, and the code of what limited the current. The
    current comes from a damped prediction (one implicit step over the period); the state moves by the accurate rule.
    `cells` (lane, m) are those of the legs and `warm` (lane,) passive heat sinks at the start, in °C; `leg`,
    `period_leg` and `ahead` (5,) are room for cells. None without them.
    """
    most = cap.shape[1]
    upper, lower, whole = np.empty((5, most)), np.empty((5, most)), np.empty(5)
    upper_p, lower_p, whole_p = np.empty((5, most)), np.empty((5, most)), np.empty(5)
    y, z, x, sink = np.empty(most), np.empty(most), np.empty(most + 3), np.zeros(SINK_NUMBERS)
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p, share = count[r], plates[r], face_share[r]
        load(n, state[lane], p, x)
        top, low = x[SKIN : SKIN + n // 2], x[SKIN + n // 2 : SKIN + n]
        factor(n, 0.5 * step, cap[r], g[r], perf[r], p, upper, lower, whole)
        factor(n, period, cap[r], g[r], perf[r], p, upper_p, lower_p, whole_p)
        elim, amperes, first = whole_p[COLD_SHARE], 0.0, weighed(n, upper, lower, x)
        settle(state[lane, 0], p, sink)
        begin_sink(warm, lane, sink)
        load_legs(cells, lane, p, leg)
        factor_legs(0.5 * step, p, leg)
        factor_legs(period, p, period_leg)
        for k in range(target.shape[1]):
            z0 = weighed(n, upper_p, lower_p, x) + p[DEEP_C] * (1.0 - elim)
            hot, cold = x[HOT] + p[DEEP_C], x[COLD] + p[DEEP_C]
            legs_ahead(p, leg, period_leg, ahead)
            amperes, code = wanted(
                target[c, k], skin_control, share, z0, elim, g[r, 0], period, hot, cold, sink[TEMPERATURE], amperes, p,
                ahead,
            )  # fmt: skip
            for _ in range(pieces):
                first = advance(
                    n, amperes, amperes * amperes, step, p, g[r, 0], x, top, low, sink, upper, lower, whole, y, z,
                    first, leg,
                )  # fmt: skip
            current[lane, k] = amperes
            controlled = share * x[COLD] + (1.0 - share) * x[place_of(SKIN, n)] if skin_control else x[COLD]
            reached[lane, k] = controlled + p[DEEP_C]
            why[lane, k] = code
