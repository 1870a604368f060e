"""Set-points that a loop follows so that the display follows the design.

A loop that is calm in every corner of a rig is too slow to follow a cue. So its set-points lead: where the simulated
display misses the design, the set-point in force a little earlier is corrected by as much, a few times.
The loop depends on the rig alone: its own, or one that suits its module. All icons share it, and the gate judges it.
"""

import math
from dataclasses import replace

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from ..rig.module import ZERO_C_IN_K
from ..rig.rig import Rig
from ..safety.corners import corners_of
from ..solver.batch_inputs import bank_of
from ..solver.inverse import regulated
from ..solver.kernel_follow import FREE
from ..solver.network import ALPHA, COLD_J_PER_K, LOWEST_A, RESISTANCE, network_of
from ..solver.steady import steady_state
from .samples import Samples

SENSOR_LAG_S, LATE_S = 0.1, 0.02
"""Sensor and delay of a loop that the rig does not state: a bead glued to a plate, two turns of a loop of 100 Hz."""
CALM = 0.7
"""kp · K/s per A · (lag + delay): an integrator that is late by so much overshoots by some percent."""
RESET_PER_S = 0.25
"""ki/kp: slower than such a loop itself in every corner, so that it does not swing, and settled within 10 s."""
PLAYING = 0.05
"""Share by which gains may differ from those shaped through; skin is then within 60 mK rms of the design, as tested."""
ROUNDS, CLOSE_K, AHEAD_S = 12, 0.02, 0.05
"""Corrections of set-points, the rms of the display at which they end, and how much earlier than a miss each begins.

More rounds, or more than the loop's own delay, make set-points swing; none are needed within 20 mK.
"""
LEAD_K = 4.0
"""How far set-points may lead a cue: a calm loop then sends all of a usual driver's current; a weaker one misses."""


def looped(rig: Rig) -> Rig:
    """The rig with the loop that plays its set-points: its own, or the strongest that is calm in every corner."""
    if rig.controller is not None:
        return rig
    speed = 0.0
    for corner in corners_of(rig):
        plates, gain = network_of(corner.rig).plates, 1.0 + corner.gain_relative
        pumped_W_per_A = plates[ALPHA] * (rig.skin.rest_C + ZERO_C_IN_K) - plates[LOWEST_A] * gain * plates[RESISTANCE]
        speed = max(speed, float(pumped_W_per_A * gain / plates[COLD_J_PER_K]))
    kp = float(f"{CALM / (speed * (SENSOR_LAG_S + LATE_S)) / (1.0 + PLAYING):.2g}")
    gains = {"kp_A_per_K": kp, "ki_A_per_Ks": float(f"{RESET_PER_S * kp:.2g}"), "kd_As_per_K": 0.0}
    return rig.with_(controller={"lag_s": SENSOR_LAG_S, **gains})


def places_of(samples: Samples, period_s: float) -> Index:
    """The index of the sample in force at each update of the driver."""
    count = max(1, math.ceil(float(samples.time_s[-1]) / period_s - 1e-9))
    place = np.floor(np.arange(count) * (period_s * samples.rate_Hz) + 1e-6).astype(np.int64)
    return np.asarray(np.minimum(place, len(samples.codes) - 1))


def shaped(rig: Rig, samples: Samples, time_s: Array, display_C: Array) -> Samples:
    """The set-points after which the display, by the loop of `looped`, is nearest to a designed one; rests stay."""
    loop, period, scale = looped(rig), 1.0 / rig.driver.update_Hz, samples.scale
    rest, end_s = steady_state(rig, "display", float(samples.command[0])), float(samples.time_s[-1])
    place = np.minimum(places_of(samples.until(end_s + AHEAD_S), period), len(samples.codes) - 1)
    goal = np.interp(period * np.arange(1, len(place) + 1), time_s, display_C)
    count, late = np.bincount(place, minlength=len(samples.codes)), round(AHEAD_S / period)
    levels, best, least_K = samples.command, samples, math.inf
    for _ in range(ROUNDS + 1):
        codes = np.clip(np.rint(levels / scale.step).astype(np.int64), scale.lowest, scale.highest)
        tried = replace(samples, codes=codes)
        _, shown, why = regulated(loop, bank_of(rig), tried.command[place], rest)
        rms_K = float(np.sqrt(np.mean((goal - shown) ** 2)))
        if rms_K < least_K:
            best, least_K = tried, rms_K
        if rms_K <= CLOSE_K:
            break
        miss = np.where(why == FREE, goal - shown, 0.0)
        ahead = np.append(miss[late:], np.zeros(min(late, len(miss))))
        levels = levels + np.bincount(place, ahead, len(count)) / np.maximum(count, 1)
        levels = np.clip(levels, samples.command - LEAD_K, samples.command + LEAD_K)
        levels[[0, -1]] = samples.command[[0, -1]]
    return best
