"""Compiled stepping of the circuit in time under a changing current.

A lane is one cue on one rig. Every step of length δ is the trapezoidal rule in its midpoint form: an implicit step of
δ/2 with the step's mean current gives the state in the middle, x_mid, and x_new = 2·x_mid − x_old. The skin is linear
and steps in its own modes (`SkinsOfBank`), in K above the deep node: with the cold plate at T_c a mode obeys

    dq_i/dt = −λ_i·q_i + g_0·w_i·T_c,    first lump T_1 = Σ w_i·q_i,

so that no mode waits for another. What remains are two equations for the plates, which depend on the current
(`plates_after`). The factors of a step are computed once for each step length (`factor`).
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from thermicon.base.numbers.compiled import kernel

from ..rig.module import ZERO_C_IN_K
from . import network as net

compiled = kernel(nogil=True, fastmath={"contract", "reassoc"}, error_model="numpy")
inlined = kernel(nogil=True, fastmath={"contract", "reassoc"}, error_model="numpy", forceinline=True)

LONGEST_STEP_S = 0.01
SHORTEST_STEP_S = 0.25e-3
JUMP_A = 0.02
"""After a jump of the current, and at the start, steps begin at the shortest and grow with the time since."""

KEEP, DRIVE, NEXT, WEIGHT = range(4)
"""Rows of a factored skin (4, modes), see `factor`."""

SHARE, ANSWER, HOT_STORE, COLD_STORE = range(4)
"""Factors of a step that belong to no single mode: weights of the cold plate in the first lump of this step and of the
next, and C/(δ/2) of both plates in W/K."""


@compiled
def begin(lane, r, rigs, state, p, modes):
    """Load the modes of a lane's skin from its state (nodes,) in °C; returns hot and cold plate and sink in °C."""
    count, to_modes = rigs.lumps[r], rigs.to_modes
    for i in range(modes.size):
        total = 0.0
        for j in range(count):
            total += to_modes[r, i, j] * (state[lane, net.SKIN + j] - p[net.DEEP_C])
        modes[i] = total
    passive = p[net.SINK_AIR_W_PER_K] > 0.0
    return state[lane, net.HOT], state[lane, net.COLD], state[lane, count + 2] if passive else p[net.SINK_C]


@compiled
def finish(lane, r, rigs, hot, cold, sink, modes, p, final):
    """Fill a lane's row of `final` (lane, nodes) in °C."""
    count, from_modes = rigs.lumps[r], rigs.from_modes
    final[lane, net.HOT], final[lane, net.COLD] = hot, cold
    for j in range(count):
        total = 0.0
        for i in range(modes.size):
            total += from_modes[r, j, i] * modes[i]
        final[lane, net.SKIN + j] = total + p[net.DEEP_C]
    if p[net.SINK_AIR_W_PER_K] > 0.0:
        final[lane, count + 2] = sink
        final[lane, count + 3] = p[net.DEEP_C]
    else:
        final[lane, count + 2] = p[net.DEEP_C]


@compiled
def factor(half, rate, touch, g0, p, factors):
    """Factor a skin and its plates for trapezoidal steps of twice `half`; returns the factors from SHARE on.

    With T_c the cold plate in the middle of the step, modes become KEEP·q + DRIVE·T_c, and the first lump in the middle
    is Σ WEIGHT·q + SHARE·T_c of the old modes. In the middle of the next step it is then Σ NEXT·q + ANSWER·T_c before
    the part of that step's plate, so that a step need not wait for the modes of the last one.
    """
    share, answer = 0.0, 0.0
    for i in range(rate.size):
        damped = 1.0 / (1.0 + rate[i] * half)
        reached = damped * half * g0 * touch[i]
        factors[KEEP, i], factors[DRIVE, i] = 2.0 * damped - 1.0, 2.0 * reached
        factors[WEIGHT, i] = touch[i] * damped
        factors[NEXT, i] = factors[WEIGHT, i] * factors[KEEP, i]
        share += reached * touch[i]
        answer += factors[WEIGHT, i] * factors[DRIVE, i]
    return share, answer, p[net.HOT_J_PER_K] / half, p[net.COLD_J_PER_K] / half


@compiled
def weighed(weight, modes):
    """The sum of weight · mode."""
    total = 0.0
    for i in range(modes.size):
        total += weight[i] * modes[i]
    return total


@inlined
def plates_after(whole, hot, cold, sink, first, current, squared, g0, half, p):
    """Hot and cold plate and heat sink in °C in the middle of a step of twice `half`.

    `first` is the first lump in the middle of the step, in K above the deep node, less the cold plate's part; `whole`
    are the step's factors from SHARE on; `current` and `squared` its mean current and mean squared current. The plates
    obey

        C_h·dT_h/dt = αI·T_h + I²R/2 + (T_c − T_h)/Θ + (T_s − T_h)/R_s,
        C_c·dT_c/dt = −αI·T_c + I²R/2 + (T_h − T_c)/Θ + g_0·(T_1 − T_c),
        C_s·dT_s/dt = (T_air − T_s)/R_air + (T_h − T_s)/R_s where the heat sink is passive,

    T_h and T_c in kelvin in the Peltier terms; the implicit half step makes them a symmetric 2 × 2 system.
    """
    leak, out, free = p[net.CONDUCTANCE], p[net.SINK_W_PER_K], g0 * (1.0 - whole[SHARE])
    pump, joule = p[net.ALPHA] * current, 0.5 * p[net.RESISTANCE] * squared
    sink_share, from_air = 0.0, 0.0  # the heat sink's own implicit step: it stays where it is ideal
    if p[net.SINK_AIR_W_PER_K] > 0.0:
        sink_share = out / (p[net.SINK_J_PER_K] / half + out + p[net.SINK_AIR_W_PER_K])
        from_air = p[net.SINK_AIR_W_PER_K] * (p[net.SINK_C] - sink)
    to_sink = out * (1.0 - sink_share)
    a11, a22 = whole[HOT_STORE] + to_sink + leak - pump, whole[COLD_STORE] + leak + pump + free
    b1 = whole[HOT_STORE] * hot + to_sink * sink + sink_share * from_air + pump * ZERO_C_IN_K + joule
    b2 = whole[COLD_STORE] * cold + free * p[net.DEEP_C] - pump * ZERO_C_IN_K + joule + g0 * first
    inverse = 1.0 / (a11 * a22 - leak * leak)  # both off-diagonal elements are −1/Θ
    hot_mid, cold_mid = (b1 * a22 + leak * b2) * inverse, (a11 * b2 + leak * b1) * inverse
    return hot_mid, cold_mid, sink + sink_share * (from_air / out + hot_mid - sink)


@inlined
def advance(modes, factors, above):
    """Move the modes by one step with the cold plate `above` the deep node in its middle; returns Σ NEXT·q of them."""
    total = 0.0
    for i in range(modes.size):
        moved = factors[KEEP, i] * modes[i] + factors[DRIVE, i] * above
        modes[i] = moved
        total += factors[NEXT, i] * moved
    return total


@compiled
def forward(lanes, rig_of, cue_of, edges, start_A, end_A, row_of, rigs, readings, state, out, final):
    """Step every lane through the intervals between `edges`, and write the readings of rows.

    `rigs` are those of `Bank.modal`; `start_A`, `end_A` (interval, cue) are the currents at both ends
    of an interval; `row_of` (interval + 1,) the row to write at an edge, or −1; `readings` (rig, probe, 3 + modes) the
    weights of a constant, both plates and the modes; `state` (lane, nodes) the start in °C; `out` (probe, lane, row)
    and `final` (lane, nodes) are filled.
    """
    rates, touches = rigs.rate_per_s, rigs.touch
    modes, factors = np.empty(rates.shape[1]), np.empty((4, rates.shape[1]))
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        p, g0, read = rigs.plates[r], rigs.first_W_per_K[r], readings[r]
        hot, cold, sink = begin(lane, r, rigs, state, p, modes)
        factored, since, first, then = -1.0, 0.0, 0.0, 0.0
        whole = (0.0, 0.0, 0.0, 0.0)
        for k in range(edges.size):
            row = row_of[k]
            if row >= 0:
                for q in range(len(read)):
                    value = read[q, 0] + read[q, 1] * hot + read[q, 2] * cold
                    out[q, lane, row] = value + weighed(read[q, 3:], modes)
            if k == edges.size - 1:
                break
            if k > 0 and abs(start_A[k, c] - end_A[k - 1, c]) > JUMP_A:
                since = 0.0
            length, done = edges[k + 1] - edges[k], 0.0
            begins, rise_per_s = start_A[k, c], (end_A[k, c] - start_A[k, c]) / length
            while done < length - 1e-12:
                step, most = length - done, min(LONGEST_STEP_S, max(SHORTEST_STEP_S, 0.25 * since))
                if step > (1.0 + 1e-9) * most:
                    step /= math.ceil(step / most - 1e-9)
                if abs(step - factored) > 1e-12:
                    whole = factor(0.5 * step, rates[r], touches[r], g0, p, factors)
                    first, then = weighed(factors[WEIGHT], modes), weighed(factors[NEXT], modes)
                    factored = step
                # Means of I and I² over a step in which I is linear.
                i, e = begins + rise_per_s * done, begins + rise_per_s * (done + step)
                hot_mid, cold_mid, sink_mid = plates_after(
                    whole,
                    hot,
                    cold,
                    sink,
                    first,
                    0.5 * (i + e),
                    (i * i + i * e + e * e) * (1.0 / 3.0),
                    g0,
                    0.5 * step,
                    p,
                )
                hot, cold, sink = 2.0 * hot_mid - hot, 2.0 * cold_mid - cold, 2.0 * sink_mid - sink
                above = cold_mid - p[net.DEEP_C]
                first = then + whole[ANSWER] * above
                then = advance(modes, factors, above)
                done += step
                since += step
        finish(lane, r, rigs, hot, cold, sink, modes, p, final)
