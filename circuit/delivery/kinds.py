"""The five kinds of device, each with its output, delivery, gate, players."""

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.icons import Icon

from ..rig.rig import Rig
from ..safety.gate import Gate, gate_set, gate_shown
from ..solver.drive import Drive, duty_of, switched
from ..solver.steady import steady_of
from .controlled import gate_controlled
from .deliver import deliver_open, deliver_setpoints
from .delivered_drive import DeliveredDrive, ModuleDrive
from .device import Device, Scale
from .devicefile import DeviceError, DrivenBy
from .formats.form import Column
from .samples import Samples
from .shaped import looped
from .temperatures import deliver_temperatures, follow_samples
from .worstcase import ways_of

FINEST_SETPOINT_K = 0.001
"""Step of set-points where a controller states none: a tenth of the resolution of the best display thermistors."""
RIPPLES_BELOW_HZ = 100.0
"""A carrier below this ripples a plate of a few J/K by more than some tens of millikelvins, and is played as it is."""


class Kind:
    """A kind of device by its output; this base puts out a current that nothing corrects.

    `command` is the column of its commands, in their unit. A device of a `regulated` kind measures its display and
    corrects it. One that `switches` puts out all its current or none. `player` is how the exported player plays it:
    `ni` (a voltage), `tcs2` (its serial line), or `send`, by functions of the laboratory.
    """

    command: ClassVar[Column]
    player: ClassVar[str] = "send"
    regulated: ClassVar[bool] = False
    switches: ClassVar[bool] = False

    def deliver(self, icon: Icon, rig: Rig, device: Device, tail_s: float) -> DeliveredDrive:
        """What a device delivers of a cue, and of a time in s after it."""
        return deliver_open(icon, rig, device, tail_s)

    def judge(self, deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
        """Check what one device delivers of cues on one rig, which may be played repeatedly in any order."""
        drives = [one.delivered for one in deliveries if isinstance(one, ModuleDrive)]
        return gate_set([(one, float(one.current_A[0])) for one in drives], deliveries[0].rig, pause_s=pause_s)

    def scale(self, device: Device, peak: float) -> Scale:
        """Codes for a waveform whose largest command has size `peak`: of its bits, over the range of its commands."""
        record, (low, high), unit = device.record("resolution"), self.ends(device), self.command.unit
        assert record is not None
        bits = round(record.central)
        if device.levels == "waveform":
            reach = min(max(math.ceil(peak * 1e3 - 1e-9) / 1e3, 1e-3), high, -low)
            low, high = -reach, reach
        if device.codes == "symmetric":
            most = 2 ** (bits - 1) - 1
            return Scale(0.5 * (low + high), (high - low) / (2 * most), -most, most, unit)
        if device.codes == "from zero":
            return Scale(low, (high - low) / (2**bits - 1), 0, 2**bits - 1, unit)
        return Scale(0.5 * (low + high), (high - low) / 2**bits, -(2 ** (bits - 1)), 2 ** (bits - 1) - 1, unit)

    def ends(self, device: Device) -> tuple[float, float]:
        """Least and greatest command."""
        return device.interval("output range")

    def unit_A(self, device: Device, rig: Rig) -> float:
        """Current in A for which a command of 1 stands; a controller commands amperes."""
        return 1.0

    def commands(self, device: Device, rig: Rig, current_A: Array, cold_C: Array, hotter_K: Array) -> Array:
        """Commands for currents, at a cold plate of temperatures in °C and a hot plate hotter by K than designed."""
        return current_A / self.unit_A(device, rig)

    def flow(self, device: Device, rig: Rig, samples: Samples) -> Drive:
        """The current in A that flows when a device plays its samples, held from row to row."""
        rows = samples.rows()
        return Drive(samples.time_s[rows], samples.command[rows] * self.unit_A(device, rig), held=True)

    def start(self, device: Device, rig: Rig, samples: Samples, gain: float = 1.0) -> Array | None:
        """State in °C in which a play begins, at a gain of the current; None: the steady state of its first current."""
        return None

    def wider(self, rig: Rig, peak_A: float, times: float) -> tuple[str, str]:
        """The unit of its range, and how a range that has to be some times as wide becomes so."""
        return "A", f"use a device of {abs(peak_A):.3g} A or more"


class Volts(Kind):
    """A voltage that commands the rig's current source."""

    command = Column("command_V", "V", "voltage that the device puts out, held until the next row")
    player = "ni"

    def unit_A(self, device: Device, rig: Rig) -> float:
        """The gain of the current source in A/V."""
        return rig.driver.transconductance_A_per_V

    def wider(self, rig: Rig, peak_A: float, times: float) -> tuple[str, str]:
        """By the gain of the current source."""
        gain = rig.driver.transconductance_A_per_V
        least = np.ceil(100 * gain * times - 1e-6) / 100
        cure = f"raise that to {least:g} if the current source can, or use a device of more volts"
        return f"V through driver.transconductance_A_per_V = {gain:g}", cure


class Amperes(Kind):
    """A current."""

    command = Column("command_A", "A", "current that the device puts out, held until the next row")


class Duty(Kind):
    """A bridge that switches its full current either way, for a share of each cycle."""

    command = Column("duty", "1", "share of a cycle that the bridge is on; negative: reversed, held until the next row")
    switches = True

    def judge(self, deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
        """By the mean of each update, unless the carrier is so slow that the plate ripples."""
        device, drives = deliveries[0].device, []
        peak, averaged = device.bridge_A, device.most("carrier frequency") >= RIPPLES_BELOW_HZ
        for one in deliveries:
            assert isinstance(one, ModuleDrive)
            means = Drive(one.played.time_s, one.played.command * peak, held=True)
            drives.append((means if averaged else one.delivered, float(one.played.command[0]) * peak))
        return gate_set(drives, deliveries[0].rig, bridge_A=peak, pause_s=pause_s, averaged=averaged)

    def ends(self, device: Device) -> tuple[float, float]:
        """Always on, either way."""
        return -1.0, 1.0

    def unit_A(self, device: Device, rig: Rig) -> float:
        """The full current."""
        return device.bridge_A

    def commands(self, device: Device, rig: Rig, current_A: Array, cold_C: Array, hotter_K: Array) -> Array:
        """Duties by the device's rule."""
        return duty_of(device.duty_rule, current_A, device.bridge_A, rig.module, cold_C, hotter_K)

    def flow(self, device: Device, rig: Rig, samples: Samples) -> Drive:
        """The full current in each cycle of the carrier, then none."""
        return switched(samples.command, samples.rate_Hz, device.most("carrier frequency"), device.bridge_A)

    def start(self, device: Device, rig: Rig, samples: Samples, gain: float = 1.0) -> Array:
        """The steady state of its first duty, without the ripple."""
        return steady_of(rig, float(samples.command[0]), device.bridge_A * gain)


class Temperatures(Kind):
    """Set-points against time, which a controller around the rig's module measures and corrects."""

    command = Column("display_C", "°C", "set-point that the controller gets for the display, held until the next row")
    regulated = True

    def deliver(self, icon: Icon, rig: Rig, device: Device, tail_s: float) -> DeliveredDrive:
        """Means of the designed display, which the module follows."""
        return deliver_temperatures(icon, rig, device, tail_s)

    def judge(self, deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
        """By the display at its set-points, the module that follows, and what any loop around that may do."""
        return gate_controlled(deliveries, pause_s)

    def scale(self, device: Device, peak: float) -> Scale:
        """Steps of temperature within the range."""
        (low, high), record = device.interval("set-point range"), device.record("set-point step")
        step = FINEST_SETPOINT_K if record is None else record.central
        return Scale(0.0, step, math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9), self.command.unit)

    def flow(self, device: Device, rig: Rig, samples: Samples) -> Drive:
        """The current by which the display follows."""
        return follow_samples(looped(rig), samples)


class SetPoints(Temperatures):
    """Segments of set-points that a thermode follows; neither module nor driver of a rig take part."""

    player = "tcs2"

    def deliver(self, icon: Icon, rig: Rig, device: Device, tail_s: float) -> DeliveredDrive:
        """The corners of a cue, or of what its skin needs."""
        return deliver_setpoints(icon, rig, device, tail_s)

    def judge(self, deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
        """By its display, which follows at once or with its lag, or is stuck anywhere in its range."""
        rig, stuck_C = deliveries[0].rig, deliveries[0].device.interval("set-point range")
        return gate_shown([ways_of(one) for one in deliveries], rig, stuck_C=stuck_C, pause_s=pause_s)

    def flow(self, device: Device, rig: Rig, samples: Samples) -> Drive:
        """Raises DeviceError: what flows in a thermode is not known."""
        raise DeviceError(f"{device.name} is a thermode: its current is not known")


KINDS: Mapping[DrivenBy, Kind] = {
    "volts": Volts(),
    "amperes": Amperes(),
    "duty": Duty(),
    "set-points": SetPoints(),
    "temperatures": Temperatures(),
}
"""Each kind by its name in device files."""
