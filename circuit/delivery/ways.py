"""Delivery and judgement of a cue by the kind of device."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from ..safety.gate import Gate, gate_set, gate_shown
from ..solver.drive import Drive
from .controlled import gate_controlled
from .deliver import deliver_open, deliver_setpoints
from .delivered_drive import DeliveredDrive, ModuleDrive
from .temperatures import deliver_temperatures
from .worstcase import ways_of

if TYPE_CHECKING:
    from thermicon.icons import Icon

    from ..rig.rig import Rig
    from .device import Device
    from .devicefile import DrivenBy

RIPPLES_BELOW_HZ = 100.0
"""A carrier below this ripples a plate of a few J/K by more than some tens of millikelvins, and is played as it is."""

Deliveries = Sequence[DeliveredDrive]


class Handling(NamedTuple):
    """How a kind delivers a cue with a time in s after it, and how its deliveries on one rig are judged.

    They may be played repeatedly in any order, with a pause in s or after whatever pause is found.
    """

    deliver: Callable[[Icon, Rig, Device, float], DeliveredDrive]
    judge: Callable[[Deliveries, float | None], tuple[Gate, ...]]


def deliver(icon: Icon, rig: Rig, device: Device, *, tail_s: float = 0.0) -> DeliveredDrive:
    """Return what a device delivers of a cue on a rig."""
    return WAYS[device.driven_by].deliver(icon, rig, device, tail_s)


def worst_cases(deliveries: Deliveries, pause_s: float | None = None) -> tuple[Gate, ...]:
    """Check what one device delivers of several cues on one rig, which may be played repeatedly in any order."""
    return WAYS[deliveries[0].device.driven_by].judge(deliveries, pause_s)


def judge_open(deliveries: Deliveries, pause_s: float | None) -> tuple[Gate, ...]:
    """By the current that flows, which nothing corrects."""
    drives = [one.delivered for one in deliveries if isinstance(one, ModuleDrive)]
    return gate_set([(one, float(one.current_A[0])) for one in drives], deliveries[0].rig, pause_s=pause_s)


def judge_bridge(deliveries: Deliveries, pause_s: float | None) -> tuple[Gate, ...]:
    """By the mean of each update, unless the carrier is so slow that the plate ripples."""
    device, drives = deliveries[0].device, []
    peak, averaged = device.bridge_A, device.most("carrier frequency") >= RIPPLES_BELOW_HZ
    for one in deliveries:
        assert isinstance(one, ModuleDrive)
        means = Drive(one.played.time_s, one.played.command * peak, held=True)
        drives.append((means if averaged else one.delivered, float(one.played.command[0]) * peak))
    return gate_set(drives, deliveries[0].rig, bridge_A=peak, pause_s=pause_s, averaged=averaged)


def judge_thermode(deliveries: Deliveries, pause_s: float | None) -> tuple[Gate, ...]:
    """By its display, which follows at once or with its lag, or is stuck anywhere in its range."""
    rig, stuck_C = deliveries[0].rig, deliveries[0].device.interval("set-point range")
    return gate_shown([ways_of(one) for one in deliveries], rig, stuck_C=stuck_C, pause_s=pause_s)


def judge_loop(deliveries: Deliveries, pause_s: float | None) -> tuple[Gate, ...]:
    """By the display at its set-points, the module that follows, and what any loop around that may do."""
    return gate_controlled(deliveries, pause_s)


WAYS: Mapping[DrivenBy, Handling] = {
    "volts": Handling(deliver_open, judge_open),
    "amperes": Handling(deliver_open, judge_open),
    "duty": Handling(deliver_open, judge_bridge),
    "set-points": Handling(deliver_setpoints, judge_thermode),
    "temperatures": Handling(deliver_temperatures, judge_loop),
}
"""Each by the name of its kind in device files."""
