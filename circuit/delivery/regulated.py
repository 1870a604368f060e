"""What a thermode delivers of a cue: set-points at its own tick, the display that follows them, and the skin under it.

Only skin, contact and air of the rig are used: its module, driver and heat sink are not those of the thermode.
"""

from __future__ import annotations

import math

import numpy as np

from thermicon.icons import Icon

from ..arrays import Array
from ..rig.rig import Rig
from ..solver.displayed import judge_display, part_of, trace_of_display
from ..solver.inverse import baseline_C, target_at
from ..solver.modes import modes_of
from ..solver.simulate import rows_until
from ..solver.trace import Trace
from .delivered_drive import DeliveredDrive
from .device import Device
from .devicefile import DeviceError
from .setpoints import Setpoints, closed, display_of, setpoints_of


def deliver_setpoints(icon: Icon, rig: Rig, device: Device, tail_s: float, rate_Hz: float) -> DeliveredDrive:
    """Return a cue as a thermode delivers it; its clock begins with the start command.

    Raises DeviceError where the cue prescribes a current, or set-points that the thermode cannot take.
    """
    if icon.context.control == "current":
        raise DeviceError(
            f"{device.name} is a thermode: it takes temperatures, and {icon.name} prescribes a current; use control "
            f"display or control skin, or a device driven by volts, amperes or duty"
        )
    base = baseline_C(icon, rig)
    end = float(icon.corners(base).duration_s) + tail_s
    setpoints = closed(device, _setpoints(icon, rig, device, base, end))
    end = max(end, float(setpoints.time_s[-1]))
    step, prompt = display_of(setpoints, device, lagged=False, end_s=end)
    prescribed = prompt[: round(setpoints.cue_s / step) + 1]  # without the way back after the cue
    outcome = judge_display(
        icon, modes_of(rig), base, step, prescribed, device.interval("set-point range"), device.most("ramp rate")
    )
    designed, trace, undelayed = traces_of_setpoints(icon, rig, device, setpoints, end, rate_Hz)
    rate = 1.0 / setpoints.tick_s
    return DeliveredDrive(
        icon, rig, device, rate, rate, 0.0, setpoints, None, designed, trace, outcome, (), undelayed
    )  # fmt: skip


def traces_of_setpoints(
    icon: Icon, rig: Rig, device: Device, setpoints: Setpoints, end_s: float, rate_Hz: float
) -> tuple[Trace, Trace, Trace]:
    """Return the traces until a time in s: as designed, as delivered, and as delivered without the device's lag."""
    rows, base = rows_until(end_s, rate_Hz), baseline_C(icon, rig)
    step, display = display_of(setpoints, device, lagged=True, end_s=end_s)
    _, prompt = display_of(setpoints, device, lagged=False, end_s=end_s)
    times: Array = np.arange(len(display), dtype=np.float64) * step
    ideal = target_at(icon, base, times)
    if icon.context.control == "skin":
        course_s, course_C = display_for(icon, rig, device, base, min(end_s, setpoints.cue_s))
        ideal = np.interp(times, course_s, course_C)
    if setpoints.closing:
        ideal = np.where(times > setpoints.cue_s, setpoints.at(times), ideal)
    target = target_at(icon, base, rows)

    def traced(display_C: Array) -> Trace:
        return trace_of_display(
            rig, step, display_C, rows, icon=icon.name, control=icon.context.control, target_C=target, outcome=None
        )

    return traced(ideal), traced(display), traced(prompt)


def display_for(icon: Icon, rig: Rig, device: Device, base_C: float, end_s: float) -> tuple[Array, Array]:
    """Return times in s and the display in °C that takes the skin along a cue, within a device's range and ramp rate.

    Resolution and lag are left out.
    """
    modes, step = modes_of(rig), part_of(device.most("tick"))
    times: Array = np.arange(math.ceil(end_s / step - 1e-9) + 1, dtype=np.float64) * step
    start = modes.display_holding_skin_C(base_C)
    limits = device.interval("set-point range")
    return times, modes.display_for_skin(target_at(icon, base_C, times), step, start, device.most("ramp rate"), limits)


def _setpoints(icon: Icon, rig: Rig, device: Device, base_C: float, end_s: float) -> Setpoints:
    if icon.context.control == "skin":
        times, levels = display_for(icon, rig, device, base_C, end_s)
        return setpoints_of(device, times, levels, curve=True)
    corners = icon.corners(base_C)
    times, levels = np.array(corners.time_s), np.array(corners.value)
    if end_s > times[-1] + 1e-9:
        times, levels = np.append(times, end_s), np.append(levels, levels[-1])
    return setpoints_of(device, times, levels, curve=False)
