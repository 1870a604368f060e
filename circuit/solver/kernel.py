"""Compiled stepping of the circuit in time under a changing current.

A lane is one cue on one rig. Every step of length δ is the trapezoidal rule in its midpoint form: an implicit step of
δ/2 with the step's mean current gives the state in the middle, x_mid, and x_new = 2·x_mid − x_old. The skin is a chain
of lumps,

    C_i·dT_i/dt = g_i·(T_{i−1} − T_i) + g_{i+1}·(T_{i+1} − T_i) + w_i·(T_deep − T_i),

a tridiagonal system that does not depend on the current and is factored once for each step length. What remains are
two equations for the plates, which do depend on it (`advance`).

A block is 1 or MANY lanes wide: `wide` is a tuple of that length, so that each width is compiled by itself. The skin of
each lane is eliminated from both ends to its middle, as two columns of h lumps each: a single lane is thus half as deep
a chain of operations, and many lanes fill the processor's vectors. Temperatures are in K above the deep node.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from thermicon.base.numbers.compiled import kernel

from ..rig.module import ZERO_C_IN_K
from . import network as net

compiled = kernel(nogil=True, fastmath={"contract"}, error_model="numpy")
inlined = kernel(nogil=True, fastmath={"contract"}, error_model="numpy", forceinline=True)

ONE, MANY = (0,), (0,) * 16
"""The widths of blocks, as the kernels take them: enough lanes to fill the vectors, few enough for the first cache."""

LONGEST_STEP_S = 0.01
SHORTEST_STEP_S = 0.25e-3
JUMP_A = 0.02
"""After a jump of the current, and at the start, steps begin at the shortest and grow with the time since."""

PLATES, DEEP, LUMPS = range(3)
"""Rows of a block's state (2 + h, 2 · lanes): hot plates then cold ones, zeros for the deep node, first lumps."""

KEEP, LINK, BACK, WEIGHT = range(4)
"""Rows of a factored skin (4, h, 2 · lanes), see `factor`."""

COLD_SHARE, MEET, HOT_STORE, COLD_STORE, SINK_SHARE = range(5)
"""Factors (5, lane) of a step that belong to no single lump: weight of the cold plate in the first lump, factor where
the halves meet, C/(δ/2) of both plates in W/K, and weight of the hot plate in the heat sink (0 where it is ideal)."""


@compiled
def place_of(k, n, h, lane, lanes):
    """Where a block's state holds state k (hot plate, cold plate, n lumps, deep node) of a lane, counted row by row."""
    if k < 2:
        return k * lanes + lane
    if k >= n + 2:
        return DEEP * 2 * lanes + lane
    i = k - 2
    return (LUMPS + i) * 2 * lanes + lane if i < h else (LUMPS + 2 * h - 1 - i) * 2 * lanes + lanes + lane


@compiled
def room(wide, bank):
    """Room for a block of rigs: state, plate numbers, skin (3, lumps + 1, lane), sinks, and scratch of a step."""
    lanes, h = len(wide), (bank[2].shape[1] + 1) // 2
    return (
        np.zeros((LUMPS + h, 2 * lanes)), np.empty((bank[1].shape[1], lanes)), np.empty((3, 2 * h + 1, lanes)),
        np.empty(lanes), np.empty((h + 2, 2 * lanes)), np.empty(2 * lanes), np.empty(lanes),
    )  # fmt: skip


@compiled
def begin(wide, block, rig_of, bank, state, x, p, skin, sink):
    """Load a block's rigs and states (lane, nodes) in °C; returns h, half the largest number of lumps.

    Shorter columns are padded at the deep end. The conductance to the deep node is added to the last lump's perfusion
    (blood and deep node have one temperature), so that g = 0 cuts the padding off. `sink` (lane,) gets the temperatures
    of the heat sinks, of which passive ones are part of the state.
    """
    lanes, h = len(wide), 0
    count, plates, capacity, conductance, perfusion = bank
    cap, g, perf = skin[0], skin[1], skin[2]
    for lane in range(lanes):
        h = max(h, (count[rig_of[block[lane]]] + 1) // 2)
    x.fill(0.0)
    cap.fill(1.0)
    g.fill(0.0)
    perf.fill(1.0)
    flat = x.reshape(-1)
    for lane in range(lanes):
        r = rig_of[block[lane]]
        n = count[r]
        for k in range(len(p)):
            p[k, lane] = plates[r, k]
        for k in range(n + 2):
            flat[place_of(k, n, h, lane, lanes)] = state[block[lane], k] - p[net.DEEP_C, lane]
        for i in range(n):
            cap[i, lane], g[i, lane], perf[i, lane] = capacity[r, i], conductance[r, i], perfusion[r, i]
        perf[n - 1, lane] += conductance[r, n]
        passive = p[net.SINK_AIR_W_PER_K, lane] > 0.0
        sink[lane] = state[block[lane], n + 2] if passive else p[net.SINK_C, lane]
    return h


@compiled
def factor(wide, h, half, p, skin, rows, whole):
    """Factor the skin of a block for implicit steps of length `half`.

    The upper halves are eliminated downwards from the cold plate and the lower ones upwards from the deep node, each
    lane's in a column of its own, so that one index j runs from both ends to the middle. From old values x the implicit
    step gives new ones T by elimination and back substitution (`advance`),

        y_j = KEEP_j·x_j + LINK_j·y_{j−1},    T_j = y_j + BACK_j·T_{j+1},

    with the cold plate and the deep node (0) as y_{−1}, and the other half's last lump as T_h. The first lump is also
    COLD_SHARE·T_c plus the sum of WEIGHT · x over all lumps. `whole` gets the factors from COLD_SHARE to SINK_SHARE.
    """
    lanes = len(wide)
    cap, g, perf = skin[0], skin[1], skin[2]
    keep, link, back, weight = rows[KEEP], rows[LINK], rows[BACK], rows[WEIGHT]
    share, product, from_cold = whole[COLD_SHARE], whole[MEET], whole[HOT_STORE]
    for lane in range(lanes):
        share[lane], product[lane], from_cold[lane] = 0.0, 1.0, 0.0
    for i in range(2 * h - 1, -1, -1):  # all of a lane from the deep end up, for the weights
        j, first = (i, 0) if i < h else (2 * h - 1 - i, lanes)
        for lane in range(lanes):
            store, below = cap[i, lane] / half, g[i + 1, lane]
            inverse = 1.0 / (store + g[i, lane] + below + perf[i, lane] - below * share[lane])
            share[lane] = g[i, lane] * inverse
            keep[j, first + lane], link[j, first + lane] = store * inverse, below * inverse
            back[j, first + lane] = share[lane]
    for i in range(2 * h):
        j, first = (i, 0) if i < h else (2 * h - 1 - i, lanes)
        for lane in range(lanes):
            weight[j, first + lane] = product[lane] * keep[j, first + lane]
            product[lane] *= link[j, first + lane]
    for i in range(h):  # the upper half again, this time from the cold plate down
        for lane in range(lanes):
            store, above = cap[i, lane] / half, g[i, lane]
            inverse = 1.0 / (store + above + g[i + 1, lane] + perf[i, lane] - above * from_cold[lane])
            from_cold[lane] = g[i + 1, lane] * inverse
            keep[i, lane], link[i, lane], back[i, lane] = store * inverse, above * inverse, from_cold[lane]
    for lane in range(lanes):
        whole[MEET, lane] = 1.0 / (1.0 - back[h - 1, lane] * back[h - 1, lanes + lane])
        whole[HOT_STORE, lane] = p[net.HOT_J_PER_K, lane] / half
        whole[COLD_STORE, lane] = p[net.COLD_J_PER_K, lane] / half
        sink_store = p[net.SINK_J_PER_K, lane] / half + p[net.SINK_W_PER_K, lane] + p[net.SINK_AIR_W_PER_K, lane]
        whole[SINK_SHARE, lane] = p[net.SINK_W_PER_K, lane] / sink_store if p[net.SINK_J_PER_K, lane] > 0.0 else 0.0


@compiled
def weighed(wide, h, weight, x, first):
    """Fill first (lane,): first lumps after an implicit step less the cold plate's part, the sum of weight · lump."""
    lanes = len(wide)
    for lane in range(lanes):
        first[lane] = 0.0
    for j in range(h):
        for lane in range(lanes):
            first[lane] += weight[j, lane] * x[LUMPS + j, lane] + weight[j, lanes + lane] * x[LUMPS + j, lanes + lane]


@inlined
def advance(wide, h, step, current, squared, p, g0, x, y, total, first, sink, rows, whole):
    """One trapezoidal step in place, with the step's mean current and mean squared current; factors are for step/2.

    `first` is `weighed` of the lumps, and becomes that of the new ones; `y` and `total` are scratch. The plates obey

        C_h·dT_h/dt = αI·T_h + I²R/2 + (T_c − T_h)/Θ + (T_s − T_h)/R_s,
        C_c·dT_c/dt = −αI·T_c + I²R/2 + (T_h − T_c)/Θ + g_0·(T_1 − T_c),
        C_s·dT_s/dt = (T_air − T_s)/R_air + (T_h − T_s)/R_s where the heat sink is passive,

    T_h and T_c in kelvin in the Peltier terms; the implicit half step makes them a symmetric 2 × 2 system.
    """
    lanes = len(wide)
    keep, link, back, weight = rows[KEEP], rows[LINK], rows[BACK], rows[WEIGHT]
    for lane in range(lanes):
        hot0, cold0, kelvin, leak = (
            x[PLATES, lane], x[PLATES, lanes + lane], ZERO_C_IN_K + p[net.DEEP_C, lane], p[net.CONDUCTANCE, lane],
        )  # fmt: skip
        pump, joule = p[net.ALPHA, lane] * current[lane], 0.5 * p[net.RESISTANCE, lane] * squared[lane]
        share = whole[SINK_SHARE, lane]  # the heat sink's in its own implicit step: 0 where it is ideal
        hot_store, cold_store, out = (
            whole[HOT_STORE, lane], whole[COLD_STORE, lane], p[net.SINK_W_PER_K, lane] * (1.0 - share),
        )  # fmt: skip
        sink_K = sink[lane] - p[net.DEEP_C, lane]
        from_air = p[net.SINK_AIR_W_PER_K, lane] * (p[net.SINK_C, lane] - sink[lane])
        a11, a22 = hot_store + out + leak - pump, cold_store + leak + pump + g0[lane] * (1.0 - whole[COLD_SHARE, lane])
        b1 = hot_store * hot0 + out * sink_K + share * from_air + pump * kelvin + joule
        b2 = cold_store * cold0 - pump * kelvin + joule + g0[lane] * first[lane]
        inverse = 1.0 / (a11 * a22 - leak * leak)  # both off-diagonal elements are −1/Θ
        hot, cold = (b1 * a22 + leak * b2) * inverse, (a11 * b2 + leak * b1) * inverse
        x[PLATES, lane], x[PLATES, lanes + lane] = 2.0 * hot - hot0, 2.0 * cold - cold0
        sink[lane] += 2.0 * share * (from_air / p[net.SINK_W_PER_K, lane] + hot - sink_K)
        y[0, lane], y[0, lanes + lane] = cold, 0.0
    for j in range(h):  # elimination of both halves, towards their meeting
        for c in range(2 * lanes):
            y[j + 1, c] = link[j, c] * y[j, c] + keep[j, c] * x[LUMPS + j, c]
    for lane in range(lanes):
        upper, lower = y[h, lane], y[h, lanes + lane]
        y[h + 1, lane] = (lower + back[h - 1, lanes + lane] * upper) * whole[MEET, lane]
        y[h + 1, lanes + lane] = (upper + back[h - 1, lane] * lower) * whole[MEET, lane]
        total[lane], total[lanes + lane] = 0.0, 0.0
    for j in range(h - 1, -1, -1):  # back substitution, away from the meeting
        for c in range(2 * lanes):
            y[j + 1, c] += back[j, c] * y[j + 2, c]
            moved = 2.0 * y[j + 1, c] - x[LUMPS + j, c]
            x[LUMPS + j, c] = moved
            total[c] += weight[j, c] * moved
    for lane in range(lanes):
        first[lane] = total[lane] + total[lanes + lane]


@compiled
def forward(
    wide, blocks, rig_of, cue_of, edges, start_A, end_A, row_of, bank, places, weights, state, out, final,
):  # fmt: skip
    """Step every lane in `blocks` (blocks, lanes) through the intervals between `edges`, and write the probes of rows.

    Lanes of a block share their steps. `bank` holds rigs as `Bank.arrays` gives them; `start_A`, `end_A` (interval,
    cue) are the currents at both ends of an interval; `row_of` (interval + 1,) the row to write at an edge, or −1;
    `state` (lane, nodes) the start in °C; `out` (probe, lane, row) and `final` (lane, nodes) are filled.
    """
    lanes, probes = len(wide), places.shape[1]
    x, p, skin, sink, y, total, first = room(wide, bank)
    rows, whole = np.empty((4, len(y), 2 * lanes)), np.empty((5, lanes))
    current, squared, flat = np.empty(lanes), np.empty(lanes), x.reshape(-1)
    at, weight = np.empty((probes, 3, lanes), dtype=np.int64), np.empty((probes, 4, lanes))
    for b in range(blocks.shape[0]):
        block = blocks[b]
        h = begin(wide, block, rig_of, bank, state, x, p, skin, sink)
        for lane in range(lanes):
            r = rig_of[block[lane]]
            for q in range(probes):
                weight[q, 3, lane] = 0.0
                for j in range(3):
                    at[q, j, lane] = place_of(places[r, q] + j, bank[0][r], h, lane, lanes)
                    weight[q, j, lane] = weights[r, q, j]
                    weight[q, 3, lane] += weights[r, q, j] * p[net.DEEP_C, lane]
        factored, since = -1.0, 0.0
        for k in range(edges.size):
            row = row_of[k]
            if row >= 0:
                for q in range(probes):
                    for lane in range(lanes):
                        value = weight[q, 3, lane]
                        for j in range(3):
                            value += weight[q, j, lane] * flat[at[q, j, lane]]
                        out[q, block[lane], row] = value
            if k == edges.size - 1:
                break
            if k > 0:
                for lane in range(lanes):
                    c = cue_of[block[lane]]
                    if abs(start_A[k, c] - end_A[k - 1, c]) > JUMP_A:
                        since = 0.0
            length, done = edges[k + 1] - edges[k], 0.0
            while done < length - 1e-12:
                left = length - done
                step = left / math.ceil(left / min(LONGEST_STEP_S, max(SHORTEST_STEP_S, 0.25 * since)) - 1e-9)
                if abs(step - factored) > 1e-12:
                    factor(wide, h, 0.5 * step, p, skin, rows, whole)
                    weighed(wide, h, rows[WEIGHT], x, first)
                    factored = step
                early, late = done / length, (done + step) / length
                for lane in range(lanes):  # means of I and I² over a step in which I is linear
                    c = cue_of[block[lane]]
                    begins, rise = start_A[k, c], end_A[k, c] - start_A[k, c]
                    i, e = begins + rise * early, begins + rise * late
                    current[lane], squared[lane] = 0.5 * (i + e), (i * i + i * e + e * e) * (1.0 / 3.0)
                advance(wide, h, step, current, squared, p, skin[1, 0], x, y, total, first, sink, rows, whole)
                done += step
                since += step
        for lane in range(lanes):
            n, deep, last = bank[0][rig_of[block[lane]]], p[net.DEEP_C, lane], final[block[lane]]
            for k in range(n + 2):
                last[k] = flat[place_of(k, n, h, lane, lanes)] + deep
            last[n + 2] = deep
            if p[net.SINK_AIR_W_PER_K, lane] > 0.0:
                last[n + 2], last[n + 3] = sink[lane], deep
