"""The display of a thermode: its set-points at its tick, limited by its ramp rate and delayed by its lag.

The rig is not involved: a thermode measures its own surface and corrects it.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..solver.displayed import part_of
from ..solver.prescribed import shown
from .device import Device
from .setpoints import Setpoints


def lag_of(device: Device) -> float:
    """Return the lag in s by which a thermode's surface follows its set-points; 0 where it states none.

    >>> lag_of(Device.load("qst-tcs2"))
    0.21
    """
    record = device.record("lag")
    return 0.0 if record is None else record.central


def display_of(
    setpoints: Setpoints, device: Device, *, lagged: bool, end_s: float | None = None
) -> tuple[float, Array]:
    """Return a step in s and the display (rows,) in °C at every step from 0 to the end of set-points, or to `end_s`.

    The step is the tick or a whole fraction of it, and the set-points are linear from tick to tick; the last is held.
    The device's ramp rate limits the display. `lagged` adds its lag (first order, from rest); without it
    the display is as fast as the device can make it, which is the worse case for the skin.

    >>> step, display = display_of(Setpoints(0.01, 0.1, 320, ((2, 300),)), Device.load("qst-tcs2"), lagged=False)
    >>> step, display.tolist()
    (0.01, [32.0, 31.0, 30.0])
    """
    step = part_of(setpoints.tick_s)
    end = float(setpoints.time_s[-1]) if end_s is None else end_s
    times: Array = np.arange(math.ceil(end / step - 1e-9) + 1, dtype=np.float64) * step
    lag = lag_of(device) if lagged else 0.0
    return step, shown(setpoints.at(times), step, lag, device.most("ramp rate"))
