"""A cue as designed and as a device delivers it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np

from thermicon.icons import Icon

from ..records import Table, load_records
from ..rig.rig import Rig
from ..solver.drive import Drive
from ..solver.trace import Outcome, Trace
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

    `rate_Hz` and `requested_Hz` are the actual and requested rows per second, `lead_s` the time when the cue begins.
    `played` goes into files: the best design within the range of the device. `drives` are the currents designed and
    delivered, None for a thermode; `designed_trace` and `trace` the simulation without the device, and with it;
    `outcome` whether the design reaches the target. `prompt_trace` is the delivery of a thermode without its lag: a
    constant lag is a delay and not a loss. `narrowed` says what was changed where the device's range is too small.
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


PLACES = {"skin": "skin_C", "cold receptor": "cold_receptor_C", "warm receptor": "warm_receptor_C"}


@dataclass(frozen=True, slots=True)
class Deviation:
    """Delivered minus designed at one place: largest difference in K (signed) and its time in s, rms in K."""

    place: str
    largest_K: float
    at_s: float
    rms_K: float


@dataclass(frozen=True, slots=True)
class DeliveryDeviation:
    """How far a delivered trace deviates from the designed one, at the skin and at both receptors."""

    places: tuple[Deviation, ...]

    @property
    def lost(self) -> tuple[Deviation, ...]:
        """The deviation at each receptor where its rms is over the stated loss."""
        limit = loss_limit("receptor difference")
        return tuple(place for place in self.places if "receptor" in place.place and place.rms_K > limit)


def delivery_deviation(designed: Trace, delivered: Trace) -> DeliveryDeviation:
    """Return how far the delivered trace deviates from the designed one; both have the same rows."""
    deviations = []
    for place, column in PLACES.items():
        deviation_K = getattr(delivered, column) - getattr(designed, column)
        most = int(np.argmax(np.abs(deviation_K)))
        rms = float(np.sqrt(np.mean(deviation_K**2)))
        deviations.append(Deviation(place, float(deviation_K[most]), float(designed.time_s[most]), rms))
    return DeliveryDeviation(tuple(deviations))


@cache
def loss_table() -> Table:
    """The stated losses, each with its source."""
    return load_records(resources.files("thermicon.circuit") / "data" / "loss.toml")


def loss_limit(quantity: str) -> float:
    """Return the limit of one kind of loss."""
    return loss_table().one(quantity).central
