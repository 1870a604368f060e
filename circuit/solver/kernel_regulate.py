"""Compiled regulation: a laboratory's PID loop on a display thermistor.

Its current is held over each period of the driver; the state moves by the rule of `kernel`.
"""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
import math

import numpy as np

from . import network as net
from .kernel import ANSWER, LONGEST_STEP_S, NEXT, WEIGHT, advance, begin, compiled, factor, plates_after, weighed
from .kernel_follow import FREE, limited

LAG_S, KP, KI, KD, DELAY_S = range(5)
"""Places in a rig's gains: lag of the thermistor s, kp A/K, ki A/(K·s), kd A·s/K, delay from measuring to output s."""


@compiled
def regulate(lanes, rig_of, cue_of, period, setpoint, gains, bias, rigs, state, current_out, reached, why):
    """Find the held current of every period as the controller of each rig gives it.

    At the start of a period I = I_bias + kp·e + ki·∫e dt + kd·dT_felt/dt, with e = T_felt − set-point and T_felt the
    display as the thermistor feels it: dT_felt/dt = (T_display − T_felt)/lag. `setpoint` (cue, period) is in °C,
    `gains` (rig, 5) have the places LAG_S to DELAY_S, `bias` (lane,) is the current A that holds the start. A delay
    counts in whole periods, rounded up. All else is as in `follow`, for the display. The integral is not advanced while
    the current is at a limit and the error would push it further (anti-windup).
    """
    rates, touches = rigs.rate_per_s, rigs.touch
    modes, factors = np.empty(rates.shape[1]), np.empty((4, rates.shape[1]))
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    delay = np.ceil(gains[:, DELAY_S] / period - 1e-9).astype(np.int64)  # in periods
    past = np.empty(delay.max() + 1)
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        p, g0, lag = rigs.plates[r], rigs.first_W_per_K[r], gains[r, LAG_S]
        hot, cold, sink = begin(lane, r, rigs, state, p, modes)
        whole = factor(0.5 * step, rates[r], touches[r], g0, p, factors)
        first, then = weighed(factors[WEIGHT], modes), weighed(factors[NEXT], modes)
        decay = math.exp(-step / lag) if lag > 0.0 else 0.0
        mean = (1.0 - decay) * lag / step  # mean weight over a step in which the display is linear
        felt, before, integral = cold, cold, 0.0
        past[:] = felt
        for k in range(setpoint.shape[1]):
            past[k % len(past)] = felt
            seen = past[(k - delay[r]) % len(past)]
            error, rate = seen - setpoint[c, k], (seen - before) / period
            demanded = bias[lane] + gains[r, KP] * error + gains[r, KI] * integral + gains[r, KD] * rate
            current, why[lane, k] = limited(demanded, hot, cold, sink, p)
            current_out[lane, k], before = current, seen
            for _ in range(pieces):
                hot_mid, cold_mid, sink_mid = plates_after(
                    whole, hot, cold, sink, first, current, current * current, g0, 0.5 * step, p
                )
                display = cold
                hot, cold, sink = 2.0 * hot_mid - hot, 2.0 * cold_mid - cold, 2.0 * sink_mid - sink
                above = cold_mid - p[net.DEEP_C]
                first = then + whole[ANSWER] * above
                then = advance(modes, factors, above)
                felt = decay * felt + (mean - decay) * display + (1.0 - mean) * cold
            if why[lane, k] == FREE or (demanded - current) * error < 0.0:
                integral += error * period
            reached[lane, k] = cold
