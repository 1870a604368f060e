"""The stepping of `kernel` for many lanes at once: blocks of LANES runs side by side in the processor's vectors.

The equations and the trapezoidal rule are those of `kernel`; the order of the arithmetic is not. Temperatures are in
°C, the skin is eliminated from the deep end up in one chain, the innermost loops run over the lanes of a block, and all
lanes of a block take the same steps.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np

from ..rig.module import ZERO_C_IN_K
from .kernel import (
    JUMP_A,
    LONGEST_STEP_S,
    SHORTEST_STEP_S,
    compiled,
    regulate_sink,
    settle,
    wanted,
)
from .kernel_legs import (
    ACROSSES,
    COOL,
    LANES,
    NEARS,
    WARM,
    block_ahead,
    block_factor,
    block_heat,
    block_load,
    block_sinks,
    block_step,
    block_store,
)
from .network import COLD, HOT, SKIN
from .plate import (
    ALPHA,
    COLD_J_PER_K,
    CONDUCTANCE,
    DEEP_C,
    HOT_J_PER_K,
    POWER,
    RESISTANCE,
    SINK_AIR_W_PER_K,
    SINK_J_PER_K,
    SINK_NUMBERS,
    SINK_W_PER_K,
    TEMPERATURE,
)

KEEP, GAIN, LINK, ELIM = range(4)
"""Rows of the factored skin, see `factor`."""

SHARE = SINK_NUMBERS
"""Place of the hot plate's weight in its heat sink's implicit step, behind the numbers that `kernel.settle` fills."""

THIRD = 1.0 / 3.0


@compiled
def factor(n, half, cap, g, perf, deep, m):
    """Factor the skin for an implicit step of length `half`; arrays are (lumps, lane), `m` is (4, lumps + 1, lane).

    After that step lump i is z_i + ELIM_i · (the state above it), where z_i = KEEP_i · its old value + GAIN_i (the part
    of blood) + LINK_i · z_{i+1}.
    """
    keep, gain, inv, elim = m[KEEP], m[GAIN], m[LINK], m[ELIM]
    for lane in range(LANES):
        inv[n, lane] = 0.0
        elim[n, lane] = 0.0
    for i in range(n - 1, -1, -1):
        for lane in range(LANES):
            below = g[i + 1, lane] * elim[i + 1, lane]
            inverse = 1.0 / (cap[i, lane] / half + g[i, lane] + g[i + 1, lane] + perf[i, lane] - below)
            elim[i, lane] = g[i, lane] * inverse
            inv[i, lane] = g[i + 1, lane] * inverse
            keep[i, lane] = cap[i, lane] / half * inverse
            gain[i, lane] = perf[i, lane] * deep[lane] * inverse


@compiled
def sweep(n, keep, gain, inv, x, z):
    """Fill z (lumps + 1, lane) from the deep end up, as `factor` defines it; z beyond the last lump is 0."""
    for i in range(n - 1, -1, -1):
        for lane in range(LANES):
            z[i, lane] = keep[i, lane] * x[i + 2, lane] + gain[i, lane] + inv[i, lane] * z[i + 1, lane]


@compiled
def foresee(n, m, weight, constant):
    """Fill weight (lumps, lane) and constant (lane,): z of the first lump as a weighted sum of the old lumps."""
    for lane in range(LANES):
        product, total = 1.0, 0.0
        for i in range(n):
            weight[i, lane] = product * m[KEEP, i, lane]
            total += product * m[GAIN, i, lane]
            product *= m[LINK, i, lane]
        constant[lane] = total


@compiled
def weighed(n, weight, constant, x, z0):
    """Fill z0 (lane,), the first lump less the cold plate's part: constant + Σ weight · lump."""
    for lane in range(LANES):
        z0[lane] = constant[lane]
    for i in range(n):
        for lane in range(LANES):
            z0[lane] += weight[i, lane] * x[i + 2, lane]


@compiled
def advance(n, step, current, squared, p, rig, g0, x, sink, m, z, above, leg, middle):
    """One trapezoidal step of a block in place; `x` (lumps + 3, lane) is the state in °C, hot plate to deep node.

    `p` (parameter, lane) and `rig` (lane, parameter) both hold `Network.plates`; `sink` (lane, 5) is each lane's heat
    sink as in `kernel.settle`, then SHARE. Plates and heat sinks obey the equations of `kernel.advance`; `middle`
    (lane,) is scratch for the cells of the legs.
    """
    half = 0.5 * step
    sweep(n, m[KEEP], m[GAIN], m[LINK], x, z)
    elim = m[ELIM]
    for lane in range(LANES):
        if p[SINK_J_PER_K, lane] > 0.0:
            regulate_sink(step, rig[lane], sink[lane])
            sink_store = p[SINK_J_PER_K, lane] / half + p[SINK_W_PER_K, lane] + p[SINK_AIR_W_PER_K, lane]
            sink[lane, SHARE] = p[SINK_W_PER_K, lane] / sink_store
    block_heat(squared, p, leg)
    for lane in range(LANES):
        hot0, cold0, leak = x[HOT, lane], x[COLD, lane], p[CONDUCTANCE, lane]
        pump, joule = p[ALPHA, lane] * current[lane], 0.5 * p[RESISTANCE, lane] * squared[lane]
        near, warm, cool = leak, joule, joule
        if leg is not None:
            near, leak, warm, cool = leg[2][NEARS, lane], leg[2][ACROSSES, lane], leg[2][WARM, lane], leg[2][COOL, lane]
        hot_store, cold_store = p[HOT_J_PER_K, lane] / half, p[COLD_J_PER_K, lane] / half
        share = sink[lane, SHARE]
        out = p[SINK_W_PER_K, lane] * (1.0 - share)
        a11 = hot_store + out + near - pump
        a22 = cold_store + near + pump + g0[lane] * (1.0 - elim[0, lane])
        b1 = hot_store * hot0 + out * sink[lane, TEMPERATURE] + share * sink[lane, POWER] + pump * ZERO_C_IN_K + warm
        b2 = cold_store * cold0 - pump * ZERO_C_IN_K + cool + g0[lane] * z[0, lane]
        determinant = 1.0 / (a11 * a22 - leak * leak)
        hot, cold = (b1 * a22 + leak * b2) * determinant, (a11 * b2 + leak * b1) * determinant
        x[HOT, lane], x[COLD, lane] = 2.0 * hot - hot0, 2.0 * cold - cold0
        sink_C = sink[lane, POWER] / p[SINK_W_PER_K, lane] + hot
        sink[lane, TEMPERATURE] += 2.0 * share * (sink_C - sink[lane, TEMPERATURE])
        above[lane] = cold
        if leg is not None:
            middle[lane] = hot
    block_step(squared, middle, above, p, leg)
    for i in range(n):
        for lane in range(LANES):
            value = z[i, lane] + elim[i, lane] * above[lane]
            above[lane] = value
            x[i + 2, lane] = 2.0 * value - x[i + 2, lane]


@compiled
def gather(block, rig_of, count, bank_plates, bank_cap, bank_g, bank_perf, state, p, rig, cap, g, perf, x, sink):
    """Load a block's rigs and states side by side; returns the largest number of lumps.

    Shorter columns are padded at the deep end. The conductance to the deep node is added to the last lump's perfusion
    (blood and deep node have one temperature), so that g = 0 cuts the padding off.
    """
    n = 0
    for lane in range(LANES):
        n = max(n, count[rig_of[block[lane]]])
    for lane in range(LANES):
        r = rig_of[block[lane]]
        own = count[r]
        for k in range(p.shape[0]):
            p[k, lane] = rig[lane, k] = bank_plates[r, k]
        x[HOT, lane], x[COLD, lane] = state[block[lane], HOT], state[block[lane], COLD]
        x[n + 2, lane] = bank_plates[r, DEEP_C]
        settle(x[HOT, lane], rig[lane], sink[lane])
        sink[lane, SHARE] = 0.0
        for i in range(n + 1):
            inside = i < own
            cap[i, lane] = bank_cap[r, i] if inside else 1.0
            perf[i, lane] = bank_perf[r, i] if inside else 1.0
            g[i, lane] = bank_g[r, i] if inside else 0.0
            x[i + 2, lane] = state[block[lane], i + 2] if inside else bank_plates[r, DEEP_C]
        perf[own - 1, lane] += bank_g[r, own]
    return n


@compiled
def forward(
    blocks, rig_of, cue_of, edges, start_A, end_A, row_of, count, bank_plates, bank_cap, bank_g, bank_perf, places,
    weights, state, sinks, out, final, cells, leg,
):  # fmt: skip
    """`kernel.forward` for blocks (blocks, LANES) of lanes; the last block is padded by repeating a lane."""
    most = bank_cap.shape[1] + 1
    cap, g, perf = np.empty((most, LANES)), np.empty((most, LANES)), np.empty((most, LANES))
    x, z, m = np.empty((most + 2, LANES)), np.zeros((most, LANES)), np.zeros((4, most, LANES))
    p, rig = np.empty((bank_plates.shape[1], LANES)), np.empty((LANES, bank_plates.shape[1]))
    sink = np.zeros((LANES, SINK_NUMBERS + 1))
    probes = places.shape[1]
    at, weight = np.empty((probes, LANES), dtype=np.int64), np.empty((probes, 3, LANES))
    same, value = np.empty(probes, dtype=np.bool_), np.empty(LANES)
    current, squared, above = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    middle = np.empty(LANES)
    for b in range(blocks.shape[0]):
        block = blocks[b]
        n = gather(block, rig_of, count, bank_plates, bank_cap, bank_g, bank_perf, state, p, rig, cap, g, perf, x, sink)
        block_load(cells, block, leg)
        for lane in range(LANES):
            if not math.isnan(sinks[block[lane], TEMPERATURE]):
                for j in range(SINK_NUMBERS):
                    sink[lane, j] = sinks[block[lane], j]
        for q in range(probes):
            same[q] = True
            for lane in range(LANES):
                at[q, lane] = places[rig_of[block[lane]], q]
                same[q] &= at[q, lane] == at[q, 0]
                for j in range(3):  # a third state below the deep node has weight 0
                    weight[q, j, lane] = weights[rig_of[block[lane]], q, j]
        factored, since = -1.0, 0.0
        for k in range(edges.size):
            row = row_of[k]
            if row >= 0:
                for q in range(probes):
                    i = at[q, 0]
                    if same[q]:
                        for lane in range(LANES):
                            value[lane] = (
                                weight[q, 0, lane] * x[i, lane]
                                + weight[q, 1, lane] * x[i + 1, lane]
                                + weight[q, 2, lane] * x[i + 2, lane]
                            )
                    else:
                        for lane in range(LANES):
                            i = at[q, lane]
                            value[lane] = (
                                weight[q, 0, lane] * x[i, lane]
                                + weight[q, 1, lane] * x[i + 1, lane]
                                + weight[q, 2, lane] * x[i + 2, lane]
                            )
                    for lane in range(LANES):
                        out[q, block[lane], row] = value[lane]
            if k == edges.size - 1:
                break
            if k > 0:
                for lane in range(LANES):
                    c = cue_of[block[lane]]
                    if abs(start_A[k, c] - end_A[k - 1, c]) > JUMP_A:
                        since = 0.0
            length, done = edges[k + 1] - edges[k], 0.0
            while done < length - 1e-12:
                left = length - done
                step = left / math.ceil(left / min(LONGEST_STEP_S, max(SHORTEST_STEP_S, 0.25 * since)) - 1e-9)
                early, late = done / length, (done + step) / length
                for lane in range(LANES):
                    c = cue_of[block[lane]]
                    first, rise = start_A[k, c], end_A[k, c] - start_A[k, c]
                    a, e = first + rise * early, first + rise * late
                    current[lane], squared[lane] = 0.5 * (a + e), (a * a + a * e + e * e) * THIRD
                if abs(step - factored) > 1e-12:
                    factor(n, 0.5 * step, cap, g, perf, p[DEEP_C], m)
                    block_factor(0.5 * step, p, leg)
                    factored = step
                advance(n, step, current, squared, p, rig, g[0], x, sink, m, z, above, leg, middle)
                done += step
                since += step
        block_store(cells, block, leg)
        for lane in range(LANES):
            for j in range(SINK_NUMBERS):
                sinks[block[lane], j] = sink[lane, j]
            for i in range(count[rig_of[block[lane]]] + 2):
                final[block[lane], i] = x[i, lane]
            final[block[lane], count[rig_of[block[lane]]] + 2] = p[DEEP_C, lane]


@compiled
def follow(
    blocks, rig_of, cue_of, period, target, skin_control, face_share, count, bank_plates, bank_cap, bank_g, bank_perf,
    state, current_out, reached, why, cells, warm, leg, period_leg, ahead,
):  # fmt: skip
    """`kernel.follow` for blocks (blocks, LANES) of lanes."""
    most = bank_cap.shape[1] + 1
    cap, g, perf = np.empty((most, LANES)), np.empty((most, LANES)), np.empty((most, LANES))
    x, z, weight = np.empty((most + 2, LANES)), np.zeros((most, LANES)), np.empty((most, LANES))
    m, mp = np.zeros((4, most, LANES)), np.zeros((4, most, LANES))
    p, rig = np.empty((bank_plates.shape[1], LANES)), np.empty((LANES, bank_plates.shape[1]))
    sink, constant, z0 = np.zeros((LANES, SINK_NUMBERS + 1)), np.empty(LANES), np.empty(LANES)
    current, squared, above = np.zeros(LANES), np.empty(LANES), np.empty(LANES)
    middle = np.empty(LANES)
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for b in range(blocks.shape[0]):
        block = blocks[b]
        n = gather(block, rig_of, count, bank_plates, bank_cap, bank_g, bank_perf, state, p, rig, cap, g, perf, x, sink)
        factor(n, 0.5 * step, cap, g, perf, p[DEEP_C], m)
        factor(n, period, cap, g, perf, p[DEEP_C], mp)
        block_sinks(warm, block, sink)
        block_load(cells, block, leg)
        block_factor(0.5 * step, p, leg)
        block_factor(period, p, period_leg)
        foresee(n, mp, weight, constant)
        for k in range(target.shape[1]):
            weighed(n, weight, constant, x, z0)
            for lane in range(LANES):
                block_ahead(lane, p, leg, period_leg, ahead)
                share, elim = face_share[rig_of[block[lane]]], mp[ELIM, 0, lane]
                amperes, code = wanted(
                    target[cue_of[block[lane]], k], skin_control, share, z0[lane], elim, g[0, lane], period,
                    x[HOT, lane], x[COLD, lane], sink[lane, TEMPERATURE], current[lane], rig[lane],
                    ahead,
                )  # fmt: skip
                current[lane], squared[lane] = amperes, amperes * amperes
                current_out[block[lane], k], why[block[lane], k] = amperes, code
            for _ in range(pieces):
                advance(n, step, current, squared, p, rig, g[0], x, sink, m, z, above, leg, middle)
            for lane in range(LANES):
                share = face_share[rig_of[block[lane]]] if skin_control else 1.0
                reached[block[lane], k] = share * x[COLD, lane] + (1.0 - share) * x[SKIN, lane]
