"""Compiled inverse: the current that makes the circuit follow a target.

It is the current that is held over each period of the driver; the state moves by the rule of `kernel`.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from ..rig.module import ZERO_C_IN_K
from . import network as net
from .kernel import ANSWER, LONGEST_STEP_S, NEXT, SHARE, WEIGHT, advance, begin, compiled, factor, plates_after, weighed
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
def follow(lanes, rig_of, cue_of, period, target, face_share, rigs, state, current_out, reached, why):
    """Find the held current of every period that takes skin or display to its target at the period's end.

    `target` (cue, period) in °C; `face_share` (rig,) is the weight of the cold plate in what follows it, 1 for the
    display; `state` (lane, nodes) is a steady state; `current_out`, `reached` and `why` (lane, period) get the current
    A, the controlled temperature °C at the period's end, and the code of what limited the current. The current comes
    from a damped prediction (one implicit step over the period); the state moves by the accurate rule.
    """
    rates, touches = rigs.rate_per_s, rigs.touch
    modes, factors, over_period = (
        np.empty(rates.shape[1]), np.empty((4, rates.shape[1])), np.empty((4, rates.shape[1])),
    )  # fmt: skip
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        p, g0, controlled, current = rigs.plates[r], rigs.first_W_per_K[r], face_share[r], 0.0
        deep = p[net.DEEP_C]
        hot, cold, sink = begin(lane, r, rigs, state, p, modes)
        whole = factor(0.5 * step, rates[r], touches[r], g0, p, factors)
        elim = factor(period, rates[r], touches[r], g0, p, over_period)[SHARE]
        first, then = weighed(factors[WEIGHT], modes), weighed(factors[NEXT], modes)
        for k in range(target.shape[1]):
            z0 = weighed(over_period[WEIGHT], modes) + deep * (1.0 - elim)
            current, why[lane, k] = wanted(target[c, k], controlled, z0, elim, g0, period, hot, cold, sink, current, p)
            current_out[lane, k] = current
            for _ in range(pieces):
                hot_mid, cold_mid, sink_mid = plates_after(
                    whole, hot, cold, sink, first, current, current * current, g0, 0.5 * step, p
                )
                hot, cold, sink = 2.0 * hot_mid - hot, 2.0 * cold_mid - cold, 2.0 * sink_mid - sink
                above = cold_mid - deep
                first = then + whole[ANSWER] * above
                then = advance(modes, factors, above)
            reached[lane, k] = controlled * cold
            if controlled < 1.0:
                reached[lane, k] += (1.0 - controlled) * (weighed(touches[r], modes) + deep)
