"""What a device makes of a cue: quantised, held, limited, and simulated again.

The file of every device begins with the rest: for one update (`lead_s`) the current, duty or set-point that holds the
baseline, which has been held for ever before. It ends with the rest again, in a row that marks the end.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from thermicon.circuit.delivery.device import Device
from thermicon.circuit.delivery.samples import Samples, current_of, rate_of, sample, within
from thermicon.circuit.delivery.setpoints import Setpoints, setpoints_of
from thermicon.circuit.inputs import signed
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.skin import Array
from thermicon.circuit.solver.batch_inputs import bank_of, run_follow
from thermicon.circuit.solver.drive import Drive
from thermicon.circuit.solver.inverse import Design, baseline_C, design
from thermicon.circuit.solver.pwm import steady_of
from thermicon.circuit.solver.simulate import duration_s, simulate_current
from thermicon.circuit.solver.steady import hold
from thermicon.circuit.solver.trace import Outcome, Trace
from thermicon.icons import Icon

NO_DRIVER = {"driver.current_min_A": -20.0, "driver.current_limit_A": 20.0, "driver.voltage_limit_V": 200.0}
"""A thermode has a driver of its own: that of the rig does not hold back what its set-points ask for."""

BRIDGE_ROUNDS = 3
"""Rounds in which a bridge's duty and its hot plate are fitted to each other; each leaves under a tenth of the rest."""


@dataclass(frozen=True, slots=True)
class Narrowed:
    """A device whose range is smaller than a design asks for: in words, the most it plays in A, and what that misses.

    `outcome` says whether the best design within the range reaches the target; None where the cue prescribes current.
    """

    text: str
    most_A: float
    outcome: Outcome | None


@dataclass(frozen=True, slots=True)
class Realised:
    """A cue as designed and as a device delivers it, on one clock, in which the cue begins at `lead_s`.

    The device gets the best that its range allows: a design within that range. `played` is what goes into files,
    `delivered` the current that then flows (for set-points: by which this rig's module would follow them), `trace` what
    it does; `designed` and `designed_trace` the same without the device.
    `outcome` says whether the design reaches its target, `narrowed` where the device's range is too small for it.
    """

    icon: Icon
    rig: Rig
    device: Device
    requested_Hz: float
    rate_Hz: float
    lead_s: float
    played: Samples | Setpoints
    designed: Drive
    delivered: Drive
    designed_trace: Trace
    trace: Trace
    outcome: Outcome | None
    warnings: tuple[str, ...]
    narrowed: Narrowed | None = None

    def __repr__(self) -> str:
        return (
            f"Realised({self.icon.name!r} on {self.device.name}, {self.trace.time_s[-1]:g} s at {self.rate_Hz:g} Hz, "
            f"skin {self.trace.skin_C.min():.2f} … {self.trace.skin_C.max():.2f} °C)"
        )

    @property
    def told(self) -> tuple[str, ...]:
        """What is to be known of the delivery: warnings, and what it asks of the rig's driver, where that plays it."""
        own = self.device.driven_by in ("duty", "set-points")
        return self.warnings if own else (*self.warnings, *self.trace.beyond)

    @property
    def end_s(self) -> float:
        """Time in s of the row that marks the end."""
        return float(self.delivered.time_s[-1])

    @property
    def file_s(self) -> float:
        """How long in s the file plays; one of set-points has no rest before it, which the simulation begins with."""
        return float(self.played.time_s[-1])


def realise(icon: Icon, rig: Rig, device: Device, *, tail_s: float = 0.0, rate_Hz: float = 100.0) -> Realised:
    """Return what a device makes of a cue on a rig; the traces have `rate_Hz` rows a second.

    Raises RigError where the baseline cannot be held, DeviceError where the device cannot play the cue at all.

    >>> from thermicon.icons import load_library
    >>> realise(load_library("six-icons")["cooling-step"], Rig.load("thenar"), Device.load("dac-12"))
    Realised('cooling-step' on dac-12, 8.01 s at 100 Hz, skin 26.91 … 32.03 °C)
    """
    end, requested = duration_s(icon, rig) + tail_s, rig.driver.update_Hz
    if device.driven_by == "set-points":
        return _by_setpoints(icon, rig, device, end, rate_Hz)
    plan = design(icon, rig, end)
    rate = rate_of(device, requested, end)
    narrow = within(device, rig)
    best = plan if narrow is rig else design(icon, narrow, end)
    possible = _led(best, end, rate)
    model = simulate_current(possible, rig, rate_Hz=rate_Hz, start_C=plan.start_C)
    samples, told = _sampled(device, rig, possible, rate, model)
    narrowed = _narrowed(device, rig, narrow, plan, best)
    if narrowed is not None:
        told = (narrowed.text, *told)
    designed = designed_until(_led(plan, end, rate), (len(samples.codes) - 1) / rate)
    model = simulate_current(designed, rig, rate_Hz=rate_Hz, start_C=plan.start_C)
    found = Realised(
        icon, rig, device, requested, rate, 1.0 / rate, samples, designed, current_of(device, rig, samples), model,
        model, plan.outcome, told, narrowed,
    )  # fmt: skip
    return replace(found, trace=simulate_current(found.delivered, rig, rate_Hz=rate_Hz, start_C=start_of(found)))


def _sampled(
    device: Device, rig: Rig, possible: Drive, rate_Hz: float, model: Trace
) -> tuple[Samples, tuple[str, ...]]:
    """The codes of a drive; those of a bridge also make up for the heat that its hotter hot plate lets back."""
    hotter = np.zeros_like(model.time_s)
    samples, told = sample(device, rig, possible, rate_Hz, (model.time_s, model.display_C, hotter))
    if device.driven_by != "duty" or device.duty_rule != "equal heat":
        return samples, told
    for _ in range(BRIDGE_ROUNDS):
        drive = current_of(device, rig, samples)
        hot = simulate_current(drive, rig, start_C=_start_of(device, rig, samples))
        hotter = np.interp(model.time_s, hot.time_s, hot.hot_plate_C) - model.hot_plate_C
        samples, told = sample(device, rig, possible, rate_Hz, (model.time_s, model.display_C, hotter))
    return samples, told


def start_of(realised: Realised) -> Array | None:
    """State in °C from which a delivered drive starts; None: the steady state of its first current."""
    return _start_of(realised.device, realised.rig, realised.played)


def _start_of(device: Device, rig: Rig, played: Samples | Setpoints) -> Array | None:
    if device.driven_by != "duty" or isinstance(played, Setpoints):
        return None
    low, high = device.interval("output range")
    return steady_of(rig, float(played.command[0]), min(-low, high))


def traces_until(realised: Realised, end_s: float, rate_Hz: float = 100.0) -> tuple[Trace, Trace]:
    """Return the traces (designed, delivered) until a time in s on the clock of the files, the rest held at the end."""
    rig, played = realised.rig, realised.played
    designed = simulate_current(designed_until(realised.designed, end_s), rig, rate_Hz=rate_Hz)
    if isinstance(played, Setpoints):
        delivered = designed_until(realised.delivered, end_s)
    else:
        delivered = _cut(current_of(realised.device, rig, played.until(end_s)), end_s)
    return designed, simulate_current(delivered, rig, rate_Hz=rate_Hz, start_C=start_of(realised))


def designed_until(drive: Drive, end_s: float) -> Drive:
    """The same drive with its last current held until a time in s."""
    if end_s <= drive.time_s[-1] + 1e-9:
        return drive
    return Drive(np.append(drive.time_s, end_s), np.append(drive.current_A, drive.current_A[-1]), drive.held)


def _cut(drive: Drive, end_s: float) -> Drive:
    """A held drive that ends at a time in s: its last sample may end a little later than what it is compared with."""
    if drive.time_s[-1] <= end_s + 1e-9:
        return drive
    kept = drive.time_s < end_s - 1e-9
    return Drive(np.append(drive.time_s[kept], end_s), np.append(drive.current_A[kept], drive.current_A[-1]), held=True)


def _narrowed(device: Device, rig: Rig, narrow: Rig, plan: Design, best: Design) -> Narrowed | None:
    """What a device's range lacks for a design, and the cure; None where the range is wide enough."""
    asked, held = plan.drive.current_A, narrow.driver
    if asked.min() >= held.current_min_A - 1e-9 and asked.max() <= held.current_max_A + 1e-9:
        return None
    most = max(held.current_max_A, -held.current_min_A)
    peak = float(asked[np.argmax(np.abs(asked))])
    low, high = device.interval("output range")
    through = f" ({signed(low)} … {signed(high)} A)"
    cure = f"use a device of {abs(peak):.3g} A or more"
    if device.driven_by == "volts":
        gain = rig.driver.transconductance_A_per_V
        least = gain * max(asked.max() / held.current_max_A, asked.min() / (held.current_min_A or -np.inf))
        through = f" ({signed(low)} … {signed(high)} V through driver.transconductance_A_per_V = {gain:g})"
        least = np.ceil(100 * least - 1e-6) / 100
        cure = f"raise that to {least:g} if the current source can, or use a device of more volts"
    text = (
        f"{device.name} plays {signed(held.current_min_A)} … {signed(held.current_max_A)} A{through}, the design asks "
        f"for up to {signed(peak, '.3g')} A; {cure}"
    )
    return Narrowed(text, most, best.outcome)


def _led(plan: Design, end_s: float, rate_Hz: float) -> Drive:
    """The design behind one update of rest, with the rest again from its end on."""
    lead, drive = 1.0 / rate_Hz, plan.drive
    if drive.held:
        kept = drive.time_s[:-1] < end_s - 1e-9
        times, currents = drive.time_s[:-1][kept], drive.current_A[:-1][kept]
        return Drive([0.0, *(times + lead), end_s + lead], [plan.rest_A, *currents, plan.rest_A], held=True)
    times, currents = drive.time_s + lead, drive.current_A
    return Drive([0.0, *times], [plan.rest_A, *currents])


def _by_setpoints(icon: Icon, rig: Rig, device: Device, end_s: float, rate_Hz: float) -> Realised:
    free = rig.with_(**NO_DRIVER)
    plan, update = design(icon, free, end_s), rig.driver.update_Hz
    lead = 1.0 / update
    designed = _led(plan, end_s, update)
    exact = icon.frame.control == "display"
    if exact:
        corners = icon.lower(baseline_C(icon, rig))
        times, levels = np.array(corners.time_s), np.array(corners.value)
        if end_s > times[-1] + 1e-9:
            times, levels = np.append(times, end_s), np.append(levels, levels[-1])
    else:
        fine = simulate_current(designed, rig, rate_Hz=1.0 / device.most("tick"), start_C=plan.start_C)
        inside = fine.time_s >= lead - 1e-9
        times, levels = fine.time_s[inside] - lead, fine.display_C[inside]
    setpoints = setpoints_of(device, times, levels, curve=not exact)
    end = max(lead + float(setpoints.time_s[-1]), float(designed.time_s[-1]))
    delivered = followed(free, setpoints, lead, end)
    designed = designed_until(designed, float(delivered.time_s[-1]))
    model = simulate_current(designed, rig, rate_Hz=rate_Hz, start_C=plan.start_C)
    return Realised(
        icon, rig, device, update, 1.0 / setpoints.tick_s, lead, setpoints, designed, delivered, model,
        simulate_current(delivered, rig, rate_Hz=rate_Hz), plan.outcome, (),
    )  # fmt: skip


def followed(rig: Rig, setpoints: Setpoints, lead_s: float, end_s: float) -> Drive:
    """Return the current by which the display follows set-points from `lead_s` on; RigError where there is no rest."""
    rest, state = hold(rig, "display", float(setpoints.level_C[0]))
    bank, one, period = bank_of(rig), np.zeros(1, dtype=np.int64), 1.0 / rig.driver.update_Hz
    count = int(np.ceil(end_s / period - 1e-9))
    times: Array = np.arange(count + 1, dtype=np.float64) * period
    target = setpoints.at(times[1:] - lead_s)
    currents, _, _ = run_follow(bank, one, one, period, target[np.newaxis], False, bank.states([state]))
    return Drive(times, [rest, *currents[0][1:], rest], held=True)
