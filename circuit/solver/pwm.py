"""A bridge that switches the module: full current or none, and what that costs.

At duty D and current Ip the module pumps α·T·D·Ip, but its resistance heats with D·Ip², where a steady current of the
same mean heats with (D·Ip)². A slow cycle also ripples the plate.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..rig.module import ZERO_C_IN_K, Peltier
from ..rig.rig import Rig
from .drive import Drive
from .network import RESISTANCE, network_of
from .steady import state_under_current

SIMULATED_CARRIER_HZ = 500.0
"""Fastest switching that is simulated: at 500 Hz and 1.5 A the display already ripples by under 10 mK, and a faster
bridge ripples less, so that nothing is understated."""


def duty_of(
    rule: str, current_A: Array, peak_A: float, module: Peltier, cold_C: Array, hotter_K: Array | float = 0.0
) -> Array:
    """Signed duties (n,) that replace currents (n,) in A, with the cold plate at temperatures (n,) in °C.

    `mean current` keeps the mean, I/Ip. `equal heat` takes as much heat from the cold plate as the steady current does;
    where the bridge's own current is past the greatest cooling, there is no such duty, and the mean is kept. `hotter_K`
    (n,): how much hotter the bridge makes the hot plate, whose heat leaks back and is taken away as well.
    """
    mean = np.clip(current_A / peak_A, -1.0, 1.0)
    if rule == "mean current":
        return np.asarray(mean)
    pumped = module.seebeck_V_per_K * (cold_C + ZERO_C_IN_K)
    joule = 0.5 * module.resistance_ohm
    heat = pumped * current_A - joule * current_A**2 + np.asarray(hotter_K) / module.thermal_resistance_K_per_W
    per_duty = pumped * peak_A - np.sign(heat) * joule * peak_A**2
    duty = np.where(per_duty > 0, heat / np.where(per_duty > 0, per_duty, 1.0), mean)
    return np.asarray(np.clip(duty, -1.0, 1.0))


def switched(duty: Array, rate_Hz: float, carrier_Hz: float, peak_A: float) -> Drive:
    """The current of a bridge that holds duties (n + 1,) for one update each, the last for none; cycles begin with the
    on-time.

    A carrier above SIMULATED_CARRIER_HZ is simulated slower, at or below it.
    """
    cycles = round(min(carrier_Hz, max(rate_Hz, SIMULATED_CARRIER_HZ)) / rate_Hz)
    share = np.repeat(duty[:-1], cycles)
    begin = np.arange(len(share)) / (cycles * rate_Hz)
    times = np.stack([begin, begin + np.abs(share) / (cycles * rate_Hz)], axis=1)
    currents = np.stack([np.sign(share) * peak_A, np.zeros(len(share))], axis=1)
    nonempty = np.stack([share != 0, np.abs(share) < 1], axis=1)
    end = (len(duty) - 1) / rate_Hz
    return Drive(np.append(times[nonempty], end), np.append(currents[nonempty], duty[-1] * peak_A), held=True)


def steady_of(rig: Rig, duty: float, peak_A: float) -> Array:
    """Return the steady state in °C of a constant duty, without the ripple.

    The mean current is D·Ip and the mean of its square 1/D times the square of that, as if the resistance were R/D.
    """
    network = network_of(rig)
    if duty == 0:
        return state_under_current(network, 0.0)
    plates = network.plates.copy()
    plates[RESISTANCE] /= abs(duty)
    return state_under_current(replace(network, plates=plates), duty * peak_A)
