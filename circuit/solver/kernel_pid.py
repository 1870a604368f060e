"""Compiled closed loop: a PID controller on a display thermistor drives the circuit, as labs run it."""

# mypy: disable-error-code="no-untyped-def,misc"
# numba infers the types here, and its decorators have none.
from __future__ import annotations

import math

import numpy as np

from .kernel import LONGEST_STEP_S, advance, compiled, factor, limited, load, settle, weighed


@compiled
def regulate(
    lanes, rig_of, cue_of, period, setpoint, gains, bias, count, plates, cap, g, perf, state, current, reached, why
):
    """Find the held current of every period as the controller of each rig gives it.

    `setpoint` (cue, period) is what the display shall be at a period's start; `gains` (rig, 4) thermistor lag s,
    A/K, A/(K·s), A·s/K; `bias` (lane,) the current A that holds the start. `state`, `current`, `reached` and `why` are
    those of `kernel.follow`. The integral waits while the current is at a limit and the error would push it further.
    """
    most = cap.shape[1]
    upper, lower, whole = np.empty((5, most)), np.empty((5, most)), np.empty(5)
    y, z, x, sink = np.empty(most), np.empty(most), np.empty(most + 3), np.zeros(4)
    pieces = math.ceil(period / LONGEST_STEP_S - 1e-9)
    step = period / pieces
    for lane in lanes:
        r, c = rig_of[lane], cue_of[lane]
        n, p = count[r], plates[r]
        load(n, state[lane], p, x)
        top, low = x[2 : 2 + n // 2], x[2 + n // 2 : 2 + n]
        lag, kp, ki, kd = gains[r, 0], gains[r, 1], gains[r, 2], gains[r, 3]
        factor(n, 0.5 * step, cap[r], g[r], perf[r], p, upper, lower, whole)
        settle(state[lane, 0], p, sink)
        decay = math.exp(-step / lag) if lag > 0.0 else 0.0
        mean = (1.0 - decay) * lag / step  # of the old display temperature, for one linear within the step
        felt, before, total, first = x[1] + p[7], x[1] + p[7], 0.0, weighed(n, upper, lower, x)
        for k in range(setpoint.shape[1]):
            error = felt - setpoint[c, k]
            asked = bias[lane] + kp * error + ki * total + kd * (felt - before) / period
            amperes, code = limited(asked, x[0] + p[7], x[1] + p[7], sink[0], p)
            before = felt
            for _ in range(pieces):
                display = x[1] + p[7]
                first = advance(
                    n, amperes, amperes * amperes, step, p, g[r, 0], x, top, low, sink, upper, lower, whole, y, z, first
                )
                felt = decay * felt + (mean - decay) * display + (1.0 - mean) * (x[1] + p[7])
            if code == 0 or (asked - amperes) * error < 0.0:
                total += error * period
            current[lane, k], reached[lane, k], why[lane, k] = amperes, x[1] + p[7], code
