"""The gate of safety for what a device delivers: how each kind of device meets the corners of a rig's uncertainty.

Volts and amperes are played open loop, so the gain of the current source counts. A bridge switches its full current,
so its rest and its last value are means. A thermode shows its own set-points at its own tick: they are judged as they
stand, with its lag and without, and neither module nor driver nor heat sink of a rig take part. A controller around
the rig's module is judged in `controlled.py`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..safety.gate import Gate, gate_set
from ..safety.thermode import DisplayCourse
from ..safety.thermode_gate import gate_shown
from ..solver.drive import Drive
from .controlled import gate_controlled
from .delivered_drive import DeliveredDrive
from .formats.form import samples_of
from .setpoints import Setpoints, display_of, lag_of

AT_ONCE, LAGGED = "followed at once", "followed with its lag"

RIPPLES_BELOW_HZ = 100.0
"""A carrier below this ripples a plate of a few J/K by more than some tens of millikelvins, and is played as it is."""

SETTLED_LAGS = 12.0
"""After this many lags a display is within 1e-5 of its last step."""


def worst_case(delivery: DeliveredDrive, pause_s: float | None = None) -> Gate:
    """Check what a device delivers against every rule of safety, for one play and for repeated plays with a pause.

    See `gate`. Raises PauseError for an impossible pause.

    >>> from thermicon.circuit import Device, Rig
    >>> from thermicon.circuit.delivery.deliver import deliver
    >>> from thermicon.icons import load_library
    >>> icon, rig = load_library("six-icons")["cooling-step"], Rig.load("thenar")
    >>> worst_case(deliver(icon, rig, Device.load("dac-12")))
    Gate(green: 22 rules in 195 scenarios on thenar)
    >>> worst_case(deliver(icon, rig, Device.load("qst-tcs2")))
    Gate(green: 21 rules in 20 scenarios on thenar)
    """
    return worst_cases([delivery], pause_s)[0]


def worst_cases(deliveries: Sequence[DeliveredDrive], pause_s: float | None = None) -> tuple[Gate, ...]:
    """Check what one device delivers of several cues on one rig, which may be played repeatedly in any order."""
    device, rig = deliveries[0].device, deliveries[0].rig
    if device.driven_by == "set-points":
        stuck = device.interval("set-point range")
        return gate_shown([ways_of(delivery) for delivery in deliveries], rig, stuck_C=stuck, pause_s=pause_s)
    if device.driven_by == "temperatures":
        return gate_controlled(deliveries, pause_s)
    if device.driven_by == "duty":
        return _bridged(deliveries, pause_s)
    assert device.driven_by in ("volts", "amperes"), f"no gate for a device driven by {device.driven_by}"
    drives = [(delivery.delivered, float(delivery.delivered.current_A[0])) for delivery in deliveries]
    return gate_set(drives, rig, pause_s=pause_s)


def _bridged(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """A bridge: by its means, which heat as what switches does, unless it is so slow that the plate ripples."""
    device, rig = deliveries[0].device, deliveries[0].rig
    peak, averaged = device.bridge_A, device.most("carrier frequency") >= RIPPLES_BELOW_HZ
    drives = []
    for delivery in deliveries:
        samples = samples_of(delivery)
        means = Drive(samples.time_s, samples.command * peak, held=True)
        drives.append((means if averaged else delivery.delivered, float(samples.command[0]) * peak))
    return gate_set(drives, rig, bridge_A=peak, pause_s=pause_s, averaged=averaged)


def ways_of(delivery: DeliveredDrive) -> tuple[DisplayCourse, ...]:
    """The display of a thermode in each way in which it may follow its set-points, at its own tick."""
    played, device = delivery.played, delivery.device
    assert isinstance(played, Setpoints)
    ways = [DisplayCourse(AT_ONCE, *display_of(played, device, lagged=False))]
    if lag_of(device) > 0:
        settling = SETTLED_LAGS * lag_of(device)
        step, display = display_of(played, device, lagged=True, end_s=float(played.time_s[-1]) + settling)
        display = np.append(display[:-1], played.level_C[-1])
        ways.append(DisplayCourse(LAGGED, step, display, step * (len(display) - 1) - float(played.time_s[-1])))
    return tuple(ways)
