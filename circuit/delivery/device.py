"""A device: the hardware that plays a drive."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import named_text, shipped_names
from thermicon.base.files.records import Record

from .commands import Scale
from .devicefile import DeviceError, DrivenBy, read_device_table
from .kinds import KINDS, Kind


@dataclass(frozen=True, slots=True)
class Device:
    """The hardware that plays a drive.

    Attributes
    ----------
    name, title
        Name of the device, and one line for people.
    driven_by
        What it puts out: volts (through the rig's transconductance), amperes, the duty of a bridge, segments of
        temperature set-points that a thermode follows, or temperatures against time for a controller around the module.
    codes
        How its codes are spaced.
    levels
        Whether its levels are fixed, or set to the peak of the waveform.
    duty_rule
        How a bridge realises a duty.
    streams
        Whether it plays while it receives, so that its memory does not limit a drive.
    dc_coupled
        Whether it puts out a constant voltage.
    played
        Whether thermicon has driven one.
    note
        What else to know.
    records
        All numbers, each with its source.

    Examples
    --------
    >>> Device.load("dac-16")
    Device('dac-16', volts, never played)
    >>> Device.load("dac-16").scale(7.0).step
    0.00030517578125
    """

    name: str
    title: str
    driven_by: DrivenBy
    codes: str
    levels: str
    duty_rule: str
    streams: bool
    dc_coupled: bool
    played: bool
    note: str
    records: tuple[Record, ...]

    def __repr__(self) -> str:
        return f"Device({self.name!r}, {self.driven_by}, {'' if self.played else 'never '}played)"

    @staticmethod
    @checked
    def load(source: str | Path) -> Device:
        """Return a shipped device by name, or a device from a `.toml` file; raises DeviceError with every fault.

        A file with the name of a shipped device is read in its place; a folder of that name is not.
        """
        return _build(*named_text(source, device_names(), "device", DeviceError))

    def record(self, quantity: str) -> Record | None:
        """Record of a quantity, as in `update rate`; None where the device does not state it."""
        return next((record for record in self.records if record.quantity == quantity), None)

    def interval(self, quantity: str) -> tuple[float, float]:
        """Low and high end of a quantity of the device; a missing low end is 0, a missing high end infinite."""
        record = self.record(quantity)
        if record is None:
            return 0.0, math.inf
        if record.low is None and record.high is None:
            return record.central, record.central
        return (0.0 if record.low is None else record.low), (math.inf if record.high is None else record.high)

    def most(self, quantity: str) -> float:
        """High end of a quantity, infinite where the device does not state it."""
        return self.interval(quantity)[1]

    @property
    def bridge_A(self) -> float:
        """Current in A of a bridge while it is on, either way: the nearer end of its output range."""
        low, high = self.interval("output range")
        return min(-low, high)

    @property
    def kind(self) -> Kind:
        """The kind of device that it is, by what it is driven by."""
        return KINDS[self.driven_by]

    @property
    def unit(self) -> str:
        """Unit of what it puts out: V, A, 1 (duty) or °C."""
        return self.kind.command.unit

    def scale(self, peak: float) -> Scale:
        """Return its codes for a waveform whose largest command has size `peak`, in the device's unit.

        Fixed levels do not depend on the waveform; others are set to its peak, rounded up to a thousandth.
        """
        return self.kind.scale(self, peak)


def device_names() -> tuple[str, ...]:
    """Return the names of the shipped devices."""
    return tuple(shipped_names("devices"))


def _build(text: str, where: str) -> Device:
    table = read_device_table(text, where)
    records = tuple(Record(**record.model_dump()) for record in table.record)
    return Device(**table.model_dump(exclude={"format", "record"}), records=records)
