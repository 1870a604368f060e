"""What a device makes of a cue: quantised, held, limited, and simulated again.

The file of a device that plays samples begins with the rest: for one update (`lead_s`) the current or duty that holds
the baseline, which has been held for ever before. It ends with the rest again, in a row that marks the end.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from thermicon.circuit.delivery.device import Device
from thermicon.circuit.delivery.realised import Realised
from thermicon.circuit.delivery.regulated import realise_setpoints, traces_of_setpoints
from thermicon.circuit.delivery.samples import current_of, led, rate_of, sample, within
from thermicon.circuit.delivery.setpoints import Setpoints
from thermicon.circuit.delivery.temperatures import designed_until, follow_samples, realise_temperatures
from thermicon.circuit.inputs import signed
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.skin import Array
from thermicon.circuit.solver.batch_inputs import bank_of, run_follow
from thermicon.circuit.solver.drive import Drive
from thermicon.circuit.solver.inverse import design
from thermicon.circuit.solver.pwm import steady_of
from thermicon.circuit.solver.simulate import duration_s, simulate_current
from thermicon.circuit.solver.steady import hold
from thermicon.circuit.solver.trace import Trace
from thermicon.icons import Icon

__all__ = ["Realised", "designed_until", "followed", "realise", "start_of", "traces_until"]


def realise(icon: Icon, rig: Rig, device: Device, *, tail_s: float = 0.0, rate_Hz: float = 100.0) -> Realised:
    """Return what a device makes of a cue on a rig; the traces have `rate_Hz` rows a second.

    Raises RigError where the baseline cannot be held, DeviceError where the device cannot play the cue at all.

    >>> from thermicon.icons import load_library
    >>> realise(load_library("six-icons")["cooling-step"], Rig.load("thenar"), Device.load("dac-12"))
    Realised('cooling-step' on dac-12, 8.01 s at 100 Hz, skin 26.91 … 32.03 °C)
    """
    if device.driven_by == "set-points":
        return realise_setpoints(icon, rig, device, tail_s, rate_Hz)
    if device.driven_by == "temperatures":
        return realise_temperatures(icon, rig, device, tail_s, rate_Hz)
    end, requested = duration_s(icon, rig) + tail_s, rig.driver.update_Hz
    plan = design(icon, rig, end)
    rate = rate_of(device, requested, end)
    narrow = within(device, rig)
    possible = led(plan if narrow is rig else design(icon, narrow, end), end, rate)
    model = simulate_current(possible, rig, rate_Hz=rate_Hz, start_C=plan.start_C)
    samples, told = sample(device, rig, possible, rate, (model.time_s, model.display_C))
    asked, least, most = plan.drive.current_A, narrow.driver.current_min_A, narrow.driver.current_max_A
    if asked.min() < least - 1e-9 or asked.max() > most + 1e-9:
        told = (_narrower(device, rig, narrow), *told)
    designed = designed_until(led(plan, end, rate), (len(samples.codes) - 1) / rate)
    model = simulate_current(designed, rig, rate_Hz=rate_Hz, start_C=plan.start_C)
    found = Realised(
        icon, rig, device, requested, rate, 1.0 / rate, samples, (designed, current_of(device, rig, samples)), model,
        model, plan.outcome, told,
    )  # fmt: skip
    return replace(found, trace=simulate_current(found.delivered, rig, rate_Hz=rate_Hz, start_C=start_of(found)))


def start_of(realised: Realised) -> Array | None:
    """State in °C from which a delivered drive starts; None: the steady state of its first current."""
    played, device = realised.played, realised.device
    if device.driven_by != "duty" or isinstance(played, Setpoints):
        return None
    low, high = device.interval("output range")
    return steady_of(realised.rig, float(played.command[0]), min(-low, high))


def traces_until(realised: Realised, end_s: float, rate_Hz: float = 100.0) -> tuple[Trace, Trace]:
    """Return the traces (designed, delivered) until a time in s on the clock of the files, the rest held at the end."""
    rig, played = realised.rig, realised.played
    if isinstance(played, Setpoints):
        designed, delivered, _ = traces_of_setpoints(realised.icon, rig, realised.device, played, end_s, rate_Hz)
        return designed, delivered
    designed = simulate_current(designed_until(realised.designed, end_s), rig, rate_Hz=rate_Hz)
    if realised.device.driven_by == "temperatures":
        drive = follow_samples(rig, played.until(end_s))
    else:
        drive = current_of(realised.device, rig, played.until(end_s))
    return designed, simulate_current(drive, rig, rate_Hz=rate_Hz, start_C=start_of(realised))


def _narrower(device: Device, rig: Rig, narrow: Rig) -> str:
    wide, held = rig.driver, narrow.driver
    cure = "use another device"
    if device.driven_by == "volts":
        gain = wide.transconductance_A_per_V * max(
            wide.current_max_A / held.current_max_A,
            wide.current_min_A / held.current_min_A if held.current_min_A else 1,
        )
        cure = f"raise driver.transconductance_A_per_V to {gain:.3g}, if the current source can"
    return (
        f"{device.name}: asks for {signed(held.current_min_A)} … {signed(held.current_max_A)} A at most, the driver "
        f"would give {signed(wide.current_min_A)} … {signed(wide.current_max_A)} A; {cure}"
    )


def followed(rig: Rig, setpoints: Setpoints, lead_s: float, end_s: float) -> Drive:
    """Return the current by which the display follows set-points from `lead_s` on; RigError where there is no rest."""
    rest, state = hold(rig, "display", float(setpoints.level_C[0]))
    bank, one, period = bank_of(rig), np.zeros(1, dtype=np.int64), 1.0 / rig.driver.update_Hz
    count = int(np.ceil(end_s / period - 1e-9))
    times: Array = np.arange(count + 1, dtype=np.float64) * period
    target = setpoints.at(times[1:] - lead_s)
    currents, _, _ = run_follow(bank, one, one, period, target[np.newaxis], False, bank.states([state]))
    return Drive(times, [rest, *currents[0][1:], rest], held=True)
