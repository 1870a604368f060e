"""Compiled closed loop: a PID controller on a display thermistor drives the circuit, as labs run it."""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np

from .kernel import (
    FREE,
    LONGEST_STEP_S,
    advance,
    compiled,
    factor,
    limited,
    load,
    settle,
    weighed,
)
from .kernel_legs import begin_sink, factor_legs, load_legs
from .network import COLD, HOT, SKIN
from .plate import DEEP_C, SINK_NUMBERS, TEMPERATURE

LAG_S, KP, KI, KD, DELAY_S = range(5)
"""Places in a rig's gains: lag of the thermistor s, kp A/K, ki A/(K·s), kd A·s/K, delay from measuring to output s."""


@compiled
def regulate(
    lanes, rig_of, cue_of, period, setpoint, gains, bias, count, plates, cap, g, perf, state, current, reached, why,
    cells, warm, leg,
):  # fmt: skip
    """Find the held current of every period as the controller of each rig gives it.

    At the start of a period I = I_bias + kp·e + ki·∫e dt + kd·dT_felt/dt, with e = T_felt − set-point and T_felt the
    display as the thermistor feels it: dT_felt/dt = (T_display − T_felt)/lag. `setpoint` (cue, period) is in °C,
    `gains` (rig, 5) have the places LAG_S to DELAY_S, `bias` (lane,) is the current A that holds the start. A delay
    counts in whole periods, rounded up.
    `state` and what follows it are those of `kernel.follow`. The integral is not advanced while the current
    is at a limit and the error would push it further (anti-windup).
    """
    most = cap.shape[1]
    upper, lower, whole = np.empty((5, most)), np.empty((5, most)), np.empty(5)
    y, z, x, sink = np.empty(most), np.empty(most), np.empty(most + 3), np.zeros(SINK_NUMBERS)
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p = count[r], plates[r]
        load(n, state[lane], p, x)
        top, low = x[SKIN : SKIN + n // 2], x[SKIN + n // 2 : SKIN + n]
        lag, kp, ki, kd = gains[r, LAG_S], gains[r, KP], gains[r, KI], gains[r, KD]
        factor(n, 0.5 * step, cap[r], g[r], perf[r], p, upper, lower, whole)
        settle(state[lane, 0], p, sink)
        begin_sink(warm, lane, sink)
        load_legs(cells, lane, p, leg)
        factor_legs(0.5 * step, p, leg)
        decay = math.exp(-step / lag) if lag > 0.0 else 0.0
        mean = (1.0 - decay) * lag / step  # mean weight over a step in which the display is linear
        felt, before, total, first = x[COLD] + p[DEEP_C], x[COLD] + p[DEEP_C], 0.0, weighed(n, upper, lower, x)
        past = np.full(math.ceil(gains[r, DELAY_S] / period - 1e-9) + 1, felt)
        for k in range(setpoint.shape[1]):
            past[k % len(past)] = felt
            seen = past[(k + 1) % len(past)]
            error = seen - setpoint[c, k]
            demanded = bias[lane] + kp * error + ki * total + kd * (seen - before) / period
            amperes, code = limited(demanded, x[HOT] + p[DEEP_C], x[COLD] + p[DEEP_C], sink[TEMPERATURE], p)
            before = seen
            for _ in range(pieces):
                display = x[COLD] + p[DEEP_C]
                first = advance(
                    n, amperes, amperes * amperes, step, p, g[r, 0], x, top, low, sink, upper, lower, whole, y, z,
                    first, leg,
                )  # fmt: skip
                felt = decay * felt + (mean - decay) * display + (1.0 - mean) * (x[COLD] + p[DEEP_C])
            if code == FREE or (demanded - amperes) * error < 0.0:
                total += error * period
            current[lane, k], reached[lane, k], why[lane, k] = amperes, x[COLD] + p[DEEP_C], code
