"""A cue as designed and as a device delivers it."""

from __future__ import annotations

from dataclasses import dataclass

from thermicon.icons import Icon

from ..rig.rig import Rig
from ..solver.drive import Drive
from ..solver.trace import Outcome, Trace
from .delivery_deviation import DeliveryDeviation, delivery_deviation
from .device import Device
from .devicefile import DeviceError
from .samples import Samples
from .setpoints import Setpoints


@dataclass(frozen=True, slots=True)
class Narrowed:
    """A device whose range is too small for a design: a sentence, the most it plays in A, and the resulting outcome.

    `outcome` is that of the best design within the range; None where the cue prescribes current.
    """

    text: str
    most_A: float
    outcome: Outcome | None


@dataclass(frozen=True, slots=True)
class DeliveredDrive:
    """A cue as designed and as a device delivers it, on one clock.

    Attributes
    ----------
    icon, rig, device
        The cue, the rig that it is designed for, and the device that plays it.
    requested_Hz, rate_Hz
        Requested and actual rows of the traces per second.
    lead_s
        Time in s at which the cue begins.
    played
        What goes into files: the best design within the range of the device.
    drives
        The currents designed and delivered; None for a thermode.
    designed_trace, trace
        The simulation without the device, and with it.
    outcome
        Whether the design reaches the target.
    device_warnings
        Sentences about limits of the device.
    prompt_trace
        The delivery of a thermode without its lag: a constant lag is a delay and not a loss.
    narrowed
        What was changed where the range of the device is too small; None where it is not.

    Examples
    --------
    >>> from thermicon.circuit import Device
    >>> from thermicon.circuit.delivery.deliver import deliver
    >>> from thermicon.icons import load_library
    >>> delivery = deliver(load_library("six-icons")["cooling-step"], Rig.load("thenar"), Device.load("dac-12"))
    >>> delivery.delivered
    Drive(802 rows, ...)
    """

    icon: Icon
    rig: Rig
    device: Device
    requested_Hz: float
    rate_Hz: float
    lead_s: float
    played: Samples | Setpoints
    drives: tuple[Drive, Drive] | None
    designed_trace: Trace
    trace: Trace
    outcome: Outcome | None
    device_warnings: tuple[str, ...]
    prompt_trace: Trace | None = None
    narrowed: Narrowed | None = None

    def __repr__(self) -> str:
        return (
            f"DeliveredDrive({self.icon.name!r} on {self.device.name}, {self.trace.time_s[-1]:g} s at "
            f"{self.rate_Hz:g} Hz, skin {self.trace.skin_C.min():.2f} … {self.trace.skin_C.max():.2f} °C)"
        )

    @property
    def designed(self) -> Drive:
        """The current as designed; raises DeviceError for a thermode."""
        return self._drives[0]

    @property
    def delivered(self) -> Drive:
        """The current that flows; raises DeviceError for a thermode."""
        return self._drives[1]

    @property
    def _drives(self) -> tuple[Drive, Drive]:
        if self.drives is None:
            raise DeviceError(f"{self.device.name} is a thermode: its current is not known")
        return self.drives

    @property
    def deviation(self) -> DeliveryDeviation:
        """How far the delivery deviates from the design, without a constant lag."""
        return delivery_deviation(self.designed_trace, self.prompt_trace or self.trace)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to know about the delivery: limits of the device, and of the driver, which a bridge replaces."""
        return self.device_warnings if self.device.driven_by == "duty" else (*self.device_warnings, *self.trace.beyond)

    @property
    def end_s(self) -> float:
        """Time in s of the row that marks the end."""
        return float(self.trace.time_s[-1] if self.drives is None else self.delivered.time_s[-1])

    @property
    def file_s(self) -> float:
        """Duration in s of the file; a file of set-points omits the rest with which the simulation begins."""
        return float(self.played.time_s[-1])
