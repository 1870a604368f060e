"""Delivery of a cue by a device.

A file of samples begins and ends at rest: its first update (`lead_s`) holds the baseline, its last row marks the end.
"""

import math

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.base.words.number_text import signed
from thermicon.icons import Icon

from ..rig.rig import Rig
from ..solver.displayed import judge_display, part_of, trace_of_display
from ..solver.drive import Drive, switched
from ..solver.inverse import Design, baseline_C, design, target_at
from ..solver.modes import modes_of
from ..solver.simulate import duration_s, rows_until, simulate_current
from ..solver.steady import steady_of
from ..solver.trace import Trace
from .delivered_drive import DeliveredDrive, ModuleDrive, Narrowed, ThermodeDrive
from .device import Device
from .devicefile import DeviceError
from .samples import Samples, led, rate_of, sample, within
from .setpoints import Setpoints, closed, display_of, setpoints_of
from .shaped import looped
from .temperatures import designed_until, follow_samples

ROWS_HZ = 100.0
"""Rows of a thermode's traces per second, as those of `simulate_current`."""

BRIDGE_ROUNDS = 3
"""Iterations between a bridge's duty and its hot plate; each leaves under a tenth of the previous error."""


def deliver_open(icon: Icon, rig: Rig, device: Device, tail_s: float) -> ModuleDrive:
    """Return a cue as a device delivers it whose current nothing corrects."""
    end, requested = duration_s(icon, rig) + tail_s, rig.driver.update_Hz
    plan = design(icon, rig, end)
    rate = rate_of(device, requested, end)
    narrow = within(device, rig)
    best = plan if narrow is rig else design(icon, narrow, end)
    possible = led(best, end, rate)
    model = simulate_current(possible, rig, start_C=plan.start_C)
    samples, warnings = _sampled(device, rig, possible, rate, model)
    narrowed = _narrowed(device, rig, narrow, plan, best)
    if narrowed is not None:
        warnings = (narrowed.text, *warnings)
    designed = designed_until(led(plan, end, rate), (len(samples.codes) - 1) / rate)
    model = simulate_current(designed, rig, start_C=plan.start_C)
    delivered = flow_of(device, rig, samples)
    trace = simulate_current(delivered, rig, start_C=start_of(device, rig, samples))
    return ModuleDrive(
        icon=icon, rig=rig, device=device, requested_Hz=requested, rate_Hz=rate, lead_s=1.0 / rate, played=samples,
        designed=designed, delivered=delivered, designed_trace=model, trace=trace, outcome=plan.outcome,
        device_warnings=warnings, narrowed=narrowed,
    )  # fmt: skip


def _sampled(
    device: Device, rig: Rig, possible: Drive, rate_Hz: float, model: Trace
) -> tuple[Samples, tuple[str, ...]]:
    """The codes of a drive; those of a bridge also compensate the heat that leaks back from its hotter hot plate."""
    kind, hotter = device.kind, np.zeros_like(model.time_s)
    found = sample(device, rig, possible, rate_Hz, (model.time_s, model.display_C, hotter))
    for _ in range(BRIDGE_ROUNDS if kind.switches and device.duty_rule == "equal heat" else 0):
        drive, start = flow_of(device, rig, found[0]), start_of(device, rig, found[0])
        hot = simulate_current(drive, rig, start_C=start)
        hotter = np.interp(model.time_s, hot.time_s, hot.hot_plate_C) - model.hot_plate_C
        found = sample(device, rig, possible, rate_Hz, (model.time_s, model.display_C, hotter))
    return found


def traces_until(delivery: DeliveredDrive, end_s: float) -> tuple[Trace, Trace]:
    """Return the traces (designed, delivered) until a time in s on the clock of the files, ending at rest."""
    rig, device = delivery.rig, delivery.device
    if isinstance(delivery, ThermodeDrive):
        return traces_of_setpoints(delivery.icon, rig, device, delivery.played, end_s)[:2]
    assert isinstance(delivery, ModuleDrive)
    designed = simulate_current(designed_until(delivery.designed, end_s), rig)
    drive = _cut(flow_of(device, rig, delivery.played.until(end_s)), end_s)
    return designed, simulate_current(drive, rig, start_C=start_of(device, rig, delivery.played))


def _cut(drive: Drive, end_s: float) -> Drive:
    """A held drive cut at a time in s: its last sample may end slightly later than what it is compared with."""
    if drive.time_s[-1] <= end_s + 1e-9:
        return drive
    times, currents = (column[drive.time_s < end_s - 1e-9] for column in (drive.time_s, drive.current_A))
    return Drive(np.append(times, end_s), np.append(currents, drive.current_A[-1]), held=True)


def _narrowed(device: Device, rig: Rig, narrow: Rig, plan: Design, best: Design) -> Narrowed | None:
    """The shortfall of a device's range for a design, with a cure; None where it is wide enough."""
    wanted_A, narrow_driver = plan.drive.current_A, narrow.driver
    if wanted_A.min() >= narrow_driver.current_min_A - 1e-9 and wanted_A.max() <= narrow_driver.current_max_A + 1e-9:
        return None
    most = max(narrow_driver.current_max_A, -narrow_driver.current_min_A)
    peak = float(wanted_A[np.argmax(np.abs(wanted_A))])
    if abs(peak) > (rig.driver.current_max_A if peak > 0 else -rig.driver.current_min_A) + 1e-9:
        text = (
            f"the rig's driver gives {signed(rig.driver.current_min_A)} … {signed(rig.driver.current_max_A)} A "
            f"(driver.current_limit_A), the cue needs {signed(peak, '.3g')} A; use less current, or raise the "
            f"limit if driver and module can"
        )
        return Narrowed(text, most, best.outcome)
    low, high = device.interval("output range")
    times = max(wanted_A.max() / narrow_driver.current_max_A, wanted_A.min() / (narrow_driver.current_min_A or -np.inf))
    unit, cure = device.kind.wider(rig, peak, times)
    if low >= 0.0 and wanted_A.min() < -1e-9:
        peak, cure = float(wanted_A.min()), "use a device of both signs"
    text = (
        f"{device.name} plays {signed(narrow_driver.current_min_A)} … {signed(narrow_driver.current_max_A)} A "
        f"({signed(low)} … {signed(high)} {unit}), the design needs up to {signed(peak, '.3g')} A; {cure}"
    )
    return Narrowed(text, most, best.outcome)


def deliver_setpoints(icon: Icon, rig: Rig, device: Device, tail_s: float) -> ThermodeDrive:
    """Return a cue as a thermode delivers it, from the start command on; DeviceError for what it cannot take."""
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
    designed, trace, undelayed = traces_of_setpoints(icon, rig, device, setpoints, end)
    rate = 1.0 / setpoints.tick_s
    return ThermodeDrive(
        icon=icon, rig=rig, device=device, requested_Hz=rate, rate_Hz=rate, played=setpoints,
        designed_trace=designed, trace=trace, prompt_trace=undelayed, outcome=outcome,
    )  # fmt: skip


def traces_of_setpoints(
    icon: Icon, rig: Rig, device: Device, setpoints: Setpoints, end_s: float
) -> tuple[Trace, Trace, Trace]:
    """Return the traces until a time in s: as designed, as delivered, and as delivered without the device's lag."""
    rows, base = rows_until(end_s, ROWS_HZ), baseline_C(icon, rig)
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
    """Times in s and the display in °C that takes the skin along a cue, within a device's range and ramp rate."""
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


def flow_of(device: Device, rig: Rig, samples: Samples) -> Drive:
    """The current in A: held from row to row, switched by a bridge, or what lets the display follow set-points.

    Raises DeviceError for a thermode, of which it is not known.
    """
    if device.driven_by == "set-points":
        raise DeviceError(f"{device.name} is a thermode: its current is not known")
    if device.driven_by == "temperatures":
        return follow_samples(looped(rig), samples)
    if device.driven_by == "duty":
        return switched(samples.command, samples.rate_Hz, device.most("carrier frequency"), device.bridge_A)
    rows = samples.rows()
    return Drive(samples.time_s[rows], samples.command[rows] * device.kind.unit_A(device, rig), held=True)


def start_of(device: Device, rig: Rig, samples: Samples, gain: float = 1.0) -> Array | None:
    """State in °C in which a play begins, at a gain of the current; None: the steady state of its first current.

    Of a bridge it is that of its first duty, without the ripple.
    """
    if device.driven_by == "duty":
        return steady_of(rig, float(samples.command[0]), device.bridge_A * gain)
    return None
