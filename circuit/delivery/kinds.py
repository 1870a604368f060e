"""The five kinds of device by what they put out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..solver.drive import duty_of
from .commands import Column, Scale

if TYPE_CHECKING:
    from thermicon.base.numbers.arrays import Array

    from ..rig.rig import Rig
    from .device import Device
    from .devicefile import DrivenBy

FINEST_SETPOINT_K = 0.001
"""Step of set-points where a controller states none: a tenth of the resolution of the best display thermistors."""


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

    def ends(self, device: Device) -> tuple[float, float]:
        """Always on, either way."""
        return -1.0, 1.0

    def unit_A(self, device: Device, rig: Rig) -> float:
        """The full current."""
        return device.bridge_A

    def commands(self, device: Device, rig: Rig, current_A: Array, cold_C: Array, hotter_K: Array) -> Array:
        """Duties by the device's rule."""
        return duty_of(device.duty_rule, current_A, device.bridge_A, rig.module, cold_C, hotter_K)


class Temperatures(Kind):
    """Set-points against time, which a controller around the rig's module measures and corrects."""

    command = Column("display_C", "°C", "set-point that the controller gets for the display, held until the next row")
    regulated = True

    def scale(self, device: Device, peak: float) -> Scale:
        """Steps of temperature within the range."""
        (low, high), record = device.interval("set-point range"), device.record("set-point step")
        step = FINEST_SETPOINT_K if record is None else record.central
        return Scale(0.0, step, math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9), self.command.unit)


class SetPoints(Temperatures):
    """Segments of set-points that a thermode follows; neither module nor driver of a rig take part."""

    player = "tcs2"


KINDS: Mapping[DrivenBy, Kind] = {
    "volts": Volts(),
    "amperes": Amperes(),
    "duty": Duty(),
    "set-points": SetPoints(),
    "temperatures": Temperatures(),
}
"""Each kind by its name in device files."""
