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

greatest_cooling = njit(cache=True, nogil=True)(plate.greatest_cooling_A)
current_for_heat = njit(cache=True, nogil=True)(plate.current_for_heat_A)

LONGEST_STEP_S = 0.01
SHORTEST_STEP_S = 0.25e-3
JUMP_A = 0.02
"""After a jump of the current, and at the start, steps begin at the shortest and grow with the time since."""


@njit(cache=True, nogil=True)
def factor(n, half, cap, g, perf, deep, inv, elim, keep, gain):
    """Eliminate the skin for an implicit step of length `half`: what `sweep` multiplies with is filled, all (n,)."""
    below, carried = 0.0, g[n] * deep
    for i in range(n - 1, -1, -1):
        inverse = 1.0 / (cap[i] / half + g[i] + g[i + 1] + perf[i] - below)
        elim[i] = g[i] * inverse
        below = g[i] * elim[i]
        inv[i] = g[i + 1] * inverse if i < n - 1 else 0.0
        keep[i] = cap[i] / half * inverse
        gain[i] = (perf[i] * deep + carried) * inverse
        carried = 0.0


@njit(cache=True, nogil=True)
def sweep(n, state, inv, keep, gain, z):
    """Fill z (n,): lump i after the implicit step is z[i] + elim[i] · (the state above it)."""
    below = 0.0
    for i in range(n - 1, -1, -1):
        below = keep[i] * state[i + 2] + gain[i] + inv[i] * below
        z[i] = below


@njit(cache=True, nogil=True)
def advance(n, step, current, squared, p, g0, state, inv, elim, keep, gain, z):
    """One trapezoidal step in place, with the step's mean current and mean squared current; factors are for step/2."""
    half = 0.5 * step
    sweep(n, state, inv, keep, gain, z)
    hot0, cold0 = state[0], state[1]
    pump, joule = p[0] * current, 0.5 * p[1] * squared
    hot_store, cold_store = p[3] / half, p[4] / half
    a11, a22 = hot_store + p[6] + p[2] - pump, cold_store + p[2] + pump + g0 * (1.0 - elim[0])
    b1 = hot_store * hot0 + p[6] * p[5] + pump * ZERO_C_IN_K + joule
    b2 = cold_store * cold0 - pump * ZERO_C_IN_K + joule + g0 * z[0]
    determinant = a11 * a22 - p[2] * p[2]
    hot = (b1 * a22 + p[2] * b2) / determinant
    cold = (a11 * b2 + p[2] * b1) / determinant
    state[0], state[1] = 2.0 * hot - hot0, 2.0 * cold - cold0
    above = cold
    for i in range(n):
        above = z[i] + elim[i] * above
        state[i + 2] = 2.0 * above - state[i + 2]


@njit(cache=True, nogil=True)
def forward(
    lanes, rig_of, cue_of, edges, start_A, end_A, row_of, count, plates, cap, g, perf, places, weights, state, out
):
    """Step every lane in `lanes` through the intervals between `edges`, and write the probes of each row.

    `start_A`, `end_A` (cue, interval): current at both ends of an interval; `row_of` (interval + 1,): row to write at
    an edge, or −1; `state` (lane, n + 3); `out` (probe, lane, row).
    """
    most = cap.shape[1]
    work = np.empty((5, most))
    inv, elim, keep, gain, z = work[0], work[1], work[2], work[3], work[4]
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p, x = count[r], plates[r], state[lane]
        factored, since, before = -1.0, 0.0, start_A[c, 0]
        for k in range(edges.size):
            row = row_of[k]
            if row >= 0:
                for q in range(places.shape[1]):
                    at = places[r, q]
                    out[q, lane, row] = (
                        weights[r, q, 0] * x[at] + weights[r, q, 1] * x[at + 1] + weights[r, q, 2] * x[at + 2]
                    )
            if k == edges.size - 1:
                break
            length = edges[k + 1] - edges[k]
            first, last = start_A[c, k], end_A[c, k]
            if abs(first - before) > JUMP_A:
                since = 0.0
            done = 0.0
            while done < length - 1e-12:
                left = length - done
                step = min(LONGEST_STEP_S, max(SHORTEST_STEP_S, 0.25 * since))
                pieces = math.ceil(left / step - 1e-9)
                step = left / pieces
                a = first + (last - first) * (done / length)
                b = first + (last - first) * ((done + step) / length)
                if abs(step - factored) > 1e-12:
                    factor(n, 0.5 * step, cap[r], g[r], perf[r], p[7], inv, elim, keep, gain)
                    factored = step
                advance(n, step, 0.5 * (a + b), (a * a + a * b + b * b) / 3.0, p, g[r, 0], x, inv, elim, keep, gain, z)
                done += step
                since += step
            before = last


@njit(cache=True, nogil=True)
def wanted(target, skin_control, share, z0, elim0, g0, period, hot, cold, p):
    """Current for the next period and the code of what limits it, from one implicit step over the period.

    After that step the first lump is z0 + elim0 · (cold plate), which makes the target one of the cold plate, and the
    cold plate's balance one equation for the current. The smallest of all limits is taken.
    """
    alpha, ohm, leak = p[0], p[1], p[2]
    aim = target
    if skin_control:
        aim = (target - (1.0 - share) * z0) / (share + (1.0 - share) * elim0)
    heat = g0 * (z0 + (elim0 - 1.0) * aim) - p[4] / period * (aim - cold)
    base, total = p[3] / period * hot + p[6] * p[5] + leak * aim, p[3] / period + p[6] + leak
    amperes, code = current_for_heat(heat, aim, base, total, alpha, ohm, leak, 1e9), 0
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
        most = greatest_cooling(cold, p[6] * p[5] + leak * cold, p[6] + leak, alpha, ohm, leak)
        if amperes > most:
            amperes, code = most, 4
    return amperes, code


@njit(cache=True, nogil=True)
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
    work, other = np.empty((5, most)), np.empty((4, most))
    inv, elim, keep, gain, z = work[0], work[1], work[2], work[3], work[4]
    inv_p, elim_p, keep_p, gain_p = other[0], other[1], other[2], other[3]
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p, x = count[r], plates[r], state[lane]
        share = face_share[r]
        factor(n, 0.5 * step, cap[r], g[r], perf[r], p[7], inv, elim, keep, gain)
        factor(n, period, cap[r], g[r], perf[r], p[7], inv_p, elim_p, keep_p, gain_p)
        for k in range(target.shape[1]):
            sweep(n, x, inv_p, keep_p, gain_p, z)
            amperes, code = wanted(target[c, k], skin_control, share, z[0], elim_p[0], g[r, 0], period, x[0], x[1], p)
            for _ in range(pieces):
                advance(n, step, amperes, amperes * amperes, p, g[r, 0], x, inv, elim, keep, gain, z)
            current[lane, k] = amperes
            reached[lane, k] = share * x[1] + (1.0 - share) * x[2] if skin_control else x[1]
            why[lane, k] = code
