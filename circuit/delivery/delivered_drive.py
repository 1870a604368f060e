"""A cue as designed and as a device delivers it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from thermicon.base.files.records import RecordTable, shipped_records
from thermicon.icons import Icon

from ..rig.rig import Rig
from ..solver.drive import Drive
from ..solver.trace import Outcome, Trace
from .device import Device
from .samples import Samples
from .setpoints import Setpoints


@dataclass(frozen=True, slots=True)
class Narrowed:
    """A range too small for a design: a sentence, the most it plays in A, and the outcome of the best within it."""

    text: str
    most_A: float
    outcome: Outcome | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DeliveredDrive:
    """A cue as designed and as a device delivers it, on one clock.

    `rate_Hz` and `requested_Hz` are the actual and requested rows per second, `lead_s` the time when the cue begins.
    `played` goes into files; `designed_trace` and `trace` are the simulation without the device, and with it; `outcome`
    says whether the design reaches the target. `element` is the one of several that plays it, empty where there is one.
    """

    icon: Icon
    rig: Rig
    device: Device
    requested_Hz: float
    rate_Hz: float
    lead_s: float = 0.0
    played: Samples | Setpoints
    designed_trace: Trace
    trace: Trace
    outcome: Outcome | None
    device_warnings: tuple[str, ...] = ()
    element: str = ""

    def __repr__(self) -> str:
        return (
            f"DeliveredDrive({self.icon.name!r} on {self.device.name}, {self.trace.time_s[-1]:g} s at "
            f"{self.rate_Hz:g} Hz, skin {self.trace.skin_C.min():.2f} … {self.trace.skin_C.max():.2f} °C)"
        )

    @property
    def name(self) -> str:
        """Name of the icon, and of its element where there are several."""
        return f"{self.icon.name} on {self.element}" if self.element else self.icon.name

    @property
    def deviation(self) -> DeliveryDeviation:
        """How far the delivery deviates from the design, without a constant lag."""
        return delivery_deviation(self.designed_trace, self.trace)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Limits of the device, and of the driver, which a bridge replaces."""
        return self.device_warnings if self.device.kind.switches else (*self.device_warnings, *self.trace.beyond)

    @property
    def end_s(self) -> float:
        """Time in s of the row that marks the end."""
        return float(self.trace.time_s[-1])

    @property
    def file_s(self) -> float:
        """Duration in s of the file; a file of set-points omits the rest with which the simulation begins."""
        return float(self.played.time_s[-1])


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ModuleDrive(DeliveredDrive):
    """The currents as `designed` and `delivered`; `narrowed`: what was changed for a range that is too small."""

    played: Samples
    designed: Drive
    delivered: Drive
    narrowed: Narrowed | None = None


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ThermodeDrive(DeliveredDrive):
    """A thermode's display; `prompt_trace` is without its lag, since a constant lag is a delay and not a loss."""

    played: Setpoints
    prompt_trace: Trace

    @property
    def deviation(self) -> DeliveryDeviation:
        """How far the delivery without its lag deviates from the design."""
        return delivery_deviation(self.designed_trace, self.prompt_trace)


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
    """Deviation of a delivered trace from the designed one, at the skin and at both receptors."""

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


def loss_table() -> RecordTable:
    """The stated losses, each with its source."""
    return shipped_records("loss.toml")


def loss_limit(quantity: str) -> float:
    """Return the limit of one kind of loss."""
    return loss_table().one(quantity).central
