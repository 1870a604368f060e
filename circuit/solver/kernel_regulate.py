"""Compiled regulation: a laboratory's PID loop on a display thermistor.

Its current is held over each period of the driver; the state moves by the rule of `kernel`.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from . import network as net
from .kernel import LONGEST_STEP_S, PLATES, WEIGHT, advance, begin, compiled, factor, room, weighed
from .kernel_follow import FREE, limited

LAG_S, KP, KI, KD, DELAY_S = range(5)
"""Places in a rig's gains: lag of the thermistor s, kp A/K, ki A/(K·s), kd A·s/K, delay from measuring to output s."""


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
                    demanded[lane], x[PLATES, lane] + deep, x[PLATES, lanes + lane] + deep, sink[lane],
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
