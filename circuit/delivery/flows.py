"""The current that flows when a device plays its samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..solver.drive import Drive, switched
from ..solver.steady import steady_of
from .devicefile import DeviceError
from .shaped import looped
from .temperatures import follow_samples

if TYPE_CHECKING:
    from thermicon.base.numbers.arrays import Array

    from ..rig.rig import Rig
    from .device import Device
    from .samples import Samples


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
