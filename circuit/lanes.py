"""The stepping of `kernel` for many lanes at once: blocks of LANES runs side by side in the processor's vectors.

The arithmetic is that of `kernel`; the innermost loops run over lanes, and a block shares its step lengths.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np
from numba import njit

from thermicon.circuit.kernel import (
    JUMP_A,
    LONGEST_STEP_S,
    SHORTEST_STEP_S,
    wanted,
)
from thermicon.circuit.module import ZERO_C_IN_K

LANES = 16
"""Runs in a block: enough to fill the vectors, few enough for the first-level cache."""

compiled = njit(cache=True, nogil=True, fastmath={"contract"}, error_model="numpy")


@compiled
def factor(n, half, cap, g, perf, deep, m):
    """Eliminate the skin for an implicit step of length `half`; arrays (lumps, lane), `m` as `sweep` reads it."""
    keep, gain, inv, elim = m[0], m[1], m[2], m[3]
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
    """Fill z (lumps + 1, lane): a lump after the implicit step is z + elim · (the state above it)."""
    for i in range(n - 1, -1, -1):
        for lane in range(LANES):
            z[i, lane] = keep[i, lane] * x[i, lane] + gain[i, lane] + inv[i, lane] * z[i + 1, lane]


@compiled
def advance(n, step, current, squared, p, g0, plates, x, m, z, above):
    """One trapezoidal step of a block in place; `plates` (2, lane) hot and cold, `x` (lumps, lane) the skin."""
    half = 0.5 * step
    sweep(n, m[0], m[1], m[2], x, z)
    elim = m[3]
    for lane in range(LANES):
        hot0, cold0 = plates[0, lane], plates[1, lane]
        pump, joule = p[0, lane] * current[lane], 0.5 * p[1, lane] * squared[lane]
        hot_store, cold_store = p[3, lane] / half, p[4, lane] / half
        a11 = hot_store + p[6, lane] + p[2, lane] - pump
        a22 = cold_store + p[2, lane] + pump + g0[lane] * (1.0 - elim[0, lane])
        b1 = hot_store * hot0 + p[6, lane] * p[5, lane] + pump * ZERO_C_IN_K + joule
        b2 = cold_store * cold0 - pump * ZERO_C_IN_K + joule + g0[lane] * z[0, lane]
        determinant = 1.0 / (a11 * a22 - p[2, lane] * p[2, lane])
        hot, cold = (b1 * a22 + p[2, lane] * b2) * determinant, (a11 * b2 + p[2, lane] * b1) * determinant
        plates[0, lane], plates[1, lane] = 2.0 * hot - hot0, 2.0 * cold - cold0
        above[lane] = cold
    for i in range(n):
        for lane in range(LANES):
            value = z[i, lane] + elim[i, lane] * above[lane]
            above[lane] = value
            x[i, lane] = 2.0 * value - x[i, lane]


@compiled
def gather(block, rig_of, count, bank_plates, bank_cap, bank_g, bank_perf, state, p, cap, g, perf, plates, x):
    """Load a block's rigs and states side by side; returns the most lumps. Short columns are padded at the deep end.

    The deep node joins the perfusion of the last lump (both are at one temperature), so padding is cut off by g = 0.
    """
    n = 0
    for lane in range(LANES):
        n = max(n, count[rig_of[block[lane]]])
    for lane in range(LANES):
        r = rig_of[block[lane]]
        own = count[r]
        for k in range(p.shape[0]):
            p[k, lane] = bank_plates[r, k]
        plates[0, lane], plates[1, lane] = state[block[lane], 0], state[block[lane], 1]
        for i in range(n + 1):
            inside = i < own
            cap[i, lane] = bank_cap[r, i] if inside else 1.0
            perf[i, lane] = bank_perf[r, i] if inside else 1.0
            g[i, lane] = bank_g[r, i] if inside else 0.0
            x[i, lane] = state[block[lane], i + 2] if inside else bank_plates[r, 7]
        perf[own - 1, lane] += bank_g[r, own]
    return n


@compiled
def forward(
    blocks, rig_of, cue_of, edges, start_A, end_A, row_of, count, bank_plates, bank_cap, bank_g, bank_perf, places,
    weights, state, out,
):  # fmt: skip
    """`kernel.forward` for blocks (blocks, LANES) of lanes; a lane may stand in for padding more than once."""
    most = bank_cap.shape[1] + 1
    cap, g, perf = np.empty((most, LANES)), np.empty((most, LANES)), np.empty((most, LANES))
    x, z, m = np.empty((most, LANES)), np.zeros((most, LANES)), np.zeros((4, most, LANES))
    p, plates = np.empty((bank_plates.shape[1], LANES)), np.empty((2, LANES))
    current, squared, above = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    for b in range(blocks.shape[0]):
        block = blocks[b]
        n = gather(block, rig_of, count, bank_plates, bank_cap, bank_g, bank_perf, state, p, cap, g, perf, plates, x)
        factored, since = -1.0, 0.0
        for k in range(edges.size):
            row = row_of[k]
            if row >= 0:
                for q in range(places.shape[1]):
                    for lane in range(LANES):
                        r = rig_of[block[lane]]
                        value = 0.0
                        for j in range(3):
                            at, weight = places[r, q] + j, weights[r, q, j]
                            if weight != 0.0:
                                if at < 2:
                                    value += weight * plates[at, lane]
                                elif at < count[r] + 2:
                                    value += weight * x[at - 2, lane]
                                else:
                                    value += weight * p[7, lane]
                        out[q, block[lane], row] = value
            if k == edges.size - 1:
                break
            if k > 0:
                for lane in range(LANES):
                    c = cue_of[block[lane]]
                    if abs(start_A[c, k] - end_A[c, k - 1]) > JUMP_A:
                        since = 0.0
            length, done = edges[k + 1] - edges[k], 0.0
            while done < length - 1e-12:
                left = length - done
                step = left / math.ceil(left / min(LONGEST_STEP_S, max(SHORTEST_STEP_S, 0.25 * since)) - 1e-9)
                for lane in range(LANES):
                    c = cue_of[block[lane]]
                    first, rise = start_A[c, k], (end_A[c, k] - start_A[c, k]) / length
                    a, e = first + rise * done, first + rise * (done + step)
                    current[lane], squared[lane] = 0.5 * (a + e), (a * a + a * e + e * e) / 3.0
                if abs(step - factored) > 1e-12:
                    factor(n, 0.5 * step, cap, g, perf, p[7], m)
                    factored = step
                advance(n, step, current, squared, p, g[0], plates, x, m, z, above)
                done += step
                since += step


@compiled
def follow(
    blocks, rig_of, cue_of, period, target, skin_control, face_share, count, bank_plates, bank_cap, bank_g, bank_perf,
    state, current_out, reached, why,
):  # fmt: skip
    """`kernel.follow` for blocks (blocks, LANES) of lanes."""
    most = bank_cap.shape[1] + 1
    cap, g, perf = np.empty((most, LANES)), np.empty((most, LANES)), np.empty((most, LANES))
    x, z, zp = np.empty((most, LANES)), np.zeros((most, LANES)), np.zeros((most, LANES))
    m, mp = np.zeros((4, most, LANES)), np.zeros((4, most, LANES))
    p, plates = np.empty((bank_plates.shape[1], LANES)), np.empty((2, LANES))
    current, squared, above = np.zeros(LANES), np.empty(LANES), np.empty(LANES)
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for b in range(blocks.shape[0]):
        block = blocks[b]
        n = gather(block, rig_of, count, bank_plates, bank_cap, bank_g, bank_perf, state, p, cap, g, perf, plates, x)
        factor(n, 0.5 * step, cap, g, perf, p[7], m)
        factor(n, period, cap, g, perf, p[7], mp)
        for k in range(target.shape[1]):
            sweep(n, mp[0], mp[1], mp[2], x, zp)
            for lane in range(LANES):
                share, elim = face_share[rig_of[block[lane]]], mp[3, 0, lane]
                amperes, code = wanted(
                    target[cue_of[block[lane]], k], skin_control, share, zp[0, lane], elim, g[0, lane], period,
                    plates[0, lane], plates[1, lane], p[:, lane],
                )  # fmt: skip
                current[lane], squared[lane] = amperes, amperes * amperes
                current_out[block[lane], k], why[block[lane], k] = amperes, code
            for _ in range(pieces):
                advance(n, step, current, squared, p, g[0], plates, x, m, z, above)
            for lane in range(LANES):
                share = face_share[rig_of[block[lane]]] if skin_control else 1.0
                reached[block[lane], k] = share * plates[1, lane] + (1.0 - share) * x[0, lane]
