"""A rig without power: a heat sink with a controller of its own loses it, an ideal one stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.skin import Array
from thermicon.circuit.solver.network import Network, network_of

SINK_C, SINK_LIMIT_W = 5, 14
"""Places among `Network.plates`."""


def unpowered(rig: Rig, time_s: Array, hot_C: Array) -> Network:
    """Return the network of a rig without power, after a run with this hot plate (rows,) in °C.

    A controlled sink is where the run has brought it and has no more power.
    """
    network = network_of(rig)
    if rig.heat_sink.controller is None:
        return network
    plates = network.plates.copy()
    plates[SINK_C], plates[SINK_LIMIT_W] = sink_at_end_C(rig, time_s, hot_C), 0.0
    return replace(network, plates=plates)


def sink_at_end_C(rig: Rig, time_s: Array, hot_C: Array) -> float:
    """Return the temperature in °C of a heat sink at the end of a run with this hot plate (rows,) in °C.

    The steps of its controller are those of the kernel, one for each row.
    """
    sink, own = rig.heat_sink, rig.heat_sink.controller
    if own is None:
        return sink.temperature_C
    now, integral, out = sink.temperature_C, 0.0, 1.0 / sink.resistance_K_per_W
    rest = -out * (float(hot_C[0]) - now)
    for step, begin, end in zip(np.diff(time_s).tolist(), hot_C[:-1].tolist(), hot_C[1:].tolist(), strict=True):
        miss = sink.temperature_C - now
        asked = rest + own.kp_W_per_K * miss + own.ki_W_per_Ks * integral
        power = min(max(asked, -own.power_limit_W), own.power_limit_W)
        if asked == power or asked * miss < 0.0:
            integral += miss * step
        share = out / (own.capacity_J_per_K / (0.5 * step) + out)
        now += 2.0 * share * (power / out + 0.5 * (begin + end) - now)
    return now
