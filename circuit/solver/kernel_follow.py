"""Compiled inverse: the current that makes the circuit follow a target.

It is the current that is held over each period of the driver; the state moves by the rule of `kernel`.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from ..rig.module import ZERO_C_IN_K
from . import network as net
from .kernel import COLD_SHARE, LONGEST_STEP_S, LUMPS, PLATES, WEIGHT, advance, begin, compiled, factor, room, weighed
from .plates import current_for_heat_A, greatest_cooling_A

greatest_cooling = compiled(greatest_cooling_A)
current_for_heat = compiled(current_for_heat_A)

CLOSE_A, ANY_A = 1e-10, 1e9
"""Tolerance of the search for a current, and what it gives where no current is enough: `limited` cuts that."""

FREE, MOST_CURRENT, LEAST_CURRENT, VOLTAGE, MODULE = range(5)
"""What limits a current: nothing, the driver's highest or lowest current, its voltage, the module's best cooling."""


@compiled
def limited(amperes, hot, cold, sink, p):
    """The current that driver and module allow, and the code of the last limit that reduced it."""
    alpha, ohm, leak, code = p[net.ALPHA], p[net.RESISTANCE], p[net.CONDUCTANCE], FREE
    if amperes > p[net.HIGHEST_A]:
        amperes, code = p[net.HIGHEST_A], MOST_CURRENT
    if amperes < p[net.LOWEST_A]:
        amperes, code = p[net.LOWEST_A], LEAST_CURRENT
    seebeck = alpha * (hot - cold)  # voltage at the module: α(T_h − T_c) + I·R
    if amperes > (p[net.COMPLIANCE_V] - seebeck) / ohm:
        amperes, code = (p[net.COMPLIANCE_V] - seebeck) / ohm, VOLTAGE
    if amperes < (-p[net.COMPLIANCE_V] - seebeck) / ohm:
        amperes, code = (-p[net.COMPLIANCE_V] - seebeck) / ohm, VOLTAGE
    capped = p[net.PAST_MOST_COOLING] == 0.0
    if capped and amperes > 0.5 * alpha * (cold + ZERO_C_IN_K) / ohm:  # the best cooling is never below half of αT_c/R
        most = greatest_cooling(
            cold, p[net.SINK_W_PER_K] * sink + leak * cold, p[net.SINK_W_PER_K] + leak, alpha, ohm, leak
        )
        if amperes > most:
            amperes, code = most, MODULE
    return amperes, code


@compiled
def wanted(target, share, z0, elim0, g0, period, hot, cold, sink, guess, p):
    """Current for the next period and the code of what limits it, from one implicit step over the period.

    After that step the first lump is z0 + elim0 · (cold plate), and what is controlled is `share` of the cold plate and
    the rest of that lump, so that its target becomes one of the cold plate, T_aim. Its balance is then an equation for
    the current alone (`network.current_for_heat_A`):

        αI·T_aim − I²R/2 − (T_h − T_aim)/Θ = g_0·(z0 + (elim0 − 1)·T_aim) − C_c·(T_aim − T_c)/period.
    """
    alpha, ohm, leak = p[net.ALPHA], p[net.RESISTANCE], p[net.CONDUCTANCE]
    aim = (target - (1.0 - share) * z0) / (share + (1.0 - share) * elim0)
    heat = g0 * (z0 + (elim0 - 1.0) * aim) - p[net.COLD_J_PER_K] / period * (aim - cold)
    out, hot_store = p[net.SINK_W_PER_K], p[net.HOT_J_PER_K] / period
    base, total = hot_store * hot + out * sink + leak * aim, hot_store + out + leak
    amperes = current_for_heat(heat, aim, base, total, alpha, ohm, leak, ANY_A, guess, CLOSE_A)
    return limited(amperes, hot, cold, sink, p)


@compiled
def follow(
    wide, blocks, rig_of, cue_of, period, target, face_share, bank, state, current_out, reached, why,
):  # fmt: skip
    """Find the held current of every period that takes skin or display to its target at the period's end.

    `target` (cue, period) in °C; `face_share` (rig,) is the weight of the cold plate in what follows it, 1 for the
    display; `state` (lane, nodes) is a steady state; `current_out`, `reached` and `why` (lane, period) get the current
    A, the controlled temperature °C at the period's end, and the code of what limited the current. The current comes
    from a damped prediction (one implicit step over the period); the state moves by the accurate rule.
    """
    lanes = len(wide)
    x, p, skin, sink, y, total, first = room(wide, bank)
    rows, whole = np.empty((4, len(y), 2 * lanes)), np.empty((5, lanes))
    period_rows, period_whole = np.empty((4, len(y), 2 * lanes)), np.empty((5, lanes))
    current, squared, z0 = np.empty(lanes), np.empty(lanes), np.empty(lanes)
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for b in range(blocks.shape[0]):
        block = blocks[b]
        h = begin(wide, block, rig_of, bank, state, x, p, skin, sink)
        factor(wide, h, 0.5 * step, p, skin, rows, whole)
        factor(wide, h, period, p, skin, period_rows, period_whole)
        weighed(wide, h, rows[WEIGHT], x, first)
        current.fill(0.0)
        for k in range(target.shape[1]):
            weighed(wide, h, period_rows[WEIGHT], x, z0)
            for lane in range(lanes):
                share, elim, deep = face_share[rig_of[block[lane]]], period_whole[COLD_SHARE, lane], p[net.DEEP_C, lane]
                amperes, code = wanted(
                    target[cue_of[block[lane]], k], share, z0[lane] + deep * (1.0 - elim), elim, skin[1, 0, lane],
                    period, x[PLATES, lane] + deep, x[PLATES, lanes + lane] + deep, sink[lane],
                    current[lane], p[:, lane],
                )  # fmt: skip
                current[lane], squared[lane] = amperes, amperes * amperes
                current_out[block[lane], k], why[block[lane], k] = amperes, code
            for _ in range(pieces):
                advance(wide, h, step, current, squared, p, skin[1, 0], x, y, total, first, sink, rows, whole)
            for lane in range(lanes):
                share = face_share[rig_of[block[lane]]]
                face = share * x[PLATES, lanes + lane] + (1.0 - share) * x[LUMPS, lane]
                reached[block[lane], k] = face + p[net.DEEP_C, lane]
