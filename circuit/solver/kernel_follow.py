"""Compiled inverse: the current that makes the circuit follow a target; also a lab's PID loop on a display thermistor.

Both find the current that is held over each period of the driver; the state moves by the rule of `kernel`.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from ..rig.module import ZERO_C_IN_K
from . import network as net
from .kernel import COLD_SHARE, LONGEST_STEP_S, LUMPS, PLATES, WEIGHT, advance, begin, compiled, factor, room, weighed

greatest_cooling = compiled(net.greatest_cooling_A)
current_for_heat = compiled(net.current_for_heat_A)

CLOSE_A, ANY_A = 1e-10, 1e9
"""Tolerance of the search for a current, and what it gives where no current is enough: `limited` cuts that."""

FREE, MOST_CURRENT, LEAST_CURRENT, VOLTAGE, MODULE = range(5)
"""What limits a current: nothing, the driver's highest or lowest current, its voltage, the module's best cooling."""

LAG_S, KP, KI, KD, DELAY_S = range(5)
"""Places in a rig's gains: lag of the thermistor s, kp A/K, ki A/(K·s), kd A·s/K, delay from measuring to output s."""


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
                    period, x[PLATES, lane] + deep, x[PLATES, lanes + lane] + deep, sink[net.TEMPERATURE, lane],
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


@compiled
def regulate(
    wide, blocks, rig_of, cue_of, period, setpoint, gains, bias, bank, state, current_out, reached, why,
):  # fmt: skip
    """Find the held current of every period as the controller of each rig gives it.

    At the start of a period I = I_bias + kp·e + ki·∫e dt + kd·dT_felt/dt, with e = T_felt − set-point and T_felt the
    display as the thermistor feels it: dT_felt/dt = (T_display − T_felt)/lag. `setpoint` (cue, period) is in °C,
    `gains` (rig, 5) have the places LAG_S to DELAY_S, `bias` (lane,) is the current A that holds the start. A delay
    counts in whole periods, rounded up. All else is as in `follow`, for the display. The integral is not advanced while
    the current is at a limit and the error would push it further (anti-windup).
    """
    lanes = len(wide)
    x, p, skin, sink, y, total, first = room(wide, bank)
    rows, whole = np.empty((4, len(y), 2 * lanes)), np.empty((5, lanes))
    current, squared, demanded, error = np.empty(lanes), np.empty(lanes), np.empty(lanes), np.empty(lanes)
    decay, mean, display = np.empty(lanes), np.empty(lanes), np.empty(lanes)
    felt, before, integral = np.empty(lanes), np.empty(lanes), np.empty(lanes)
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    delay = np.ceil(gains[:, DELAY_S] / period - 1e-9).astype(np.int64)  # in periods
    past = np.empty((delay.max() + 1, lanes))
    for b in range(blocks.shape[0]):
        block = blocks[b]
        h = begin(wide, block, rig_of, bank, state, x, p, skin, sink)
        factor(wide, h, 0.5 * step, p, skin, rows, whole)
        weighed(wide, h, rows[WEIGHT], x, first)
        for lane in range(lanes):
            lag = gains[rig_of[block[lane]], LAG_S]
            decay[lane] = math.exp(-step / lag) if lag > 0.0 else 0.0
            mean[lane] = (1.0 - decay[lane]) * lag / step  # mean weight over a step in which the display is linear
            felt[lane] = before[lane] = x[PLATES, lanes + lane] + p[net.DEEP_C, lane]
            for k in range(len(past)):
                past[k, lane] = felt[lane]
            integral[lane] = 0.0
        for k in range(setpoint.shape[1]):
            for lane in range(lanes):
                r, deep = rig_of[block[lane]], p[net.DEEP_C, lane]
                past[k % len(past), lane] = felt[lane]
                seen = past[(k - delay[r]) % len(past), lane]
                error[lane] = seen - setpoint[cue_of[block[lane]], k]
                rate = (seen - before[lane]) / period
                demanded[lane] = bias[block[lane]] + gains[r, KP] * error[lane] + gains[r, KI] * integral[lane]
                demanded[lane] += gains[r, KD] * rate
                amperes, why[block[lane], k] = limited(
                    demanded[lane], x[PLATES, lane] + deep, x[PLATES, lanes + lane] + deep, sink[net.TEMPERATURE, lane],
                    p[:, lane],
                )  # fmt: skip
                current[lane], squared[lane], before[lane] = amperes, amperes * amperes, seen
                current_out[block[lane], k] = amperes
            for _ in range(pieces):
                for lane in range(lanes):
                    display[lane] = x[PLATES, lanes + lane] + p[net.DEEP_C, lane]
                advance(wide, h, step, current, squared, p, skin[1, 0], x, y, total, first, sink, rows, whole)
                for lane in range(lanes):
                    now = x[PLATES, lanes + lane] + p[net.DEEP_C, lane]
                    felt[lane] = decay[lane] * felt[lane] + (mean[lane] - decay[lane]) * display[lane]
                    felt[lane] += (1.0 - mean[lane]) * now
            for lane in range(lanes):
                if why[block[lane], k] == FREE or (demanded[lane] - current[lane]) * error[lane] < 0.0:
                    integral[lane] += error[lane] * period
                reached[block[lane], k] = x[PLATES, lanes + lane] + p[net.DEEP_C, lane]
