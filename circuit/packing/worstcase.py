"""The gate of safety for what a device delivers: how each kind of device meets the corners of a rig's uncertainty.

Volts and amperes are played open loop, so the gain of the current source counts. A bridge switches its full current,
so its rest and its last value are means. A thermode shows its own set-points at its own tick: they are judged as they
stand, with its lag and without, and neither module nor driver nor heat sink of a rig take part. A controller around
the rig's module is judged both ways: the display exactly at its set-points, and the module that follows in each corner.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from thermicon.icons.number_text import signed

from ..delivery.delivered_drive import DeliveredDrive
from ..delivery.samples import Samples
from ..delivery.setpoints import Setpoints
from ..delivery.temperatures import follow_samples
from ..delivery.thermode import display_of, lag_of
from ..rig.rigfile import RigError
from ..safety.checks import Check, worst_of
from ..safety.corners import corners_of
from ..safety.demands import Demands, SingleFault
from ..safety.ensemble import Ensemble, LaneDrives
from ..safety.gate import Gate, gate_set
from ..safety.single import checks_of_lanes
from ..safety.single_faults import BEYOND_K, Faulty
from ..safety.tally import WATCHED
from ..safety.thermode import DisplayCourse, Under
from ..safety.thermode_gate import gate_shown
from ..solver.drive import Drive
from ..solver.network import network_of
from ..solver.steady import check_sink, state_under_current

AT_ONCE, LAGGED, HELD = "followed at once", "followed with its lag", "every set-point reached"

RIPPLES_BELOW_HZ = 100.0
"""A carrier below this ripples a plate of a few J/K by more than some tens of millikelvins, and is played as it is."""

SETTLING_S = 10.0
"""How long a module is followed after the last set-point, to which it returns at its own rate."""

RATE = "rate of skin temperature"

LONGEST_BETWEEN_S = 15.0
"""Pause before the second play of a module at most: by then its display is at the baseline, and only skin is not."""

SETTLED_LAGS = 12.0
"""After this many lags a display is within 1e-5 of its last step."""


def worst_case(delivery: DeliveredDrive, pause_s: float | None = None) -> Gate:
    """Check what a device delivers against every rule of safety, for one play and for repeated plays with a pause.

    See `gate`. Raises PauseError for an impossible pause.

    >>> from thermicon.circuit import Device, Rig, deliver
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
        return _controlled(deliveries, pause_s)
    if device.driven_by == "duty":
        return _bridged(deliveries, pause_s)
    assert device.driven_by in ("volts", "amperes"), f"no gate for a device driven by {device.driven_by}"
    drives = [(delivery.delivered, float(delivery.delivered.current_A[0])) for delivery in deliveries]
    return gate_set(drives, rig, pause_s=pause_s)


def _bridged(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """A bridge: by its means, which heat as what switches does, unless it is so slow that the plate ripples."""
    device, rig = deliveries[0].device, deliveries[0].rig
    low, high = device.interval("output range")
    peak, averaged = min(-low, high), device.most("carrier frequency") >= RIPPLES_BELOW_HZ
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


def samples_of(delivery: DeliveredDrive) -> Samples:
    """The samples of a drive whose device plays samples."""
    assert isinstance(delivery.played, Samples)
    return delivery.played


def _controlled(deliveries: Sequence[DeliveredDrive], pause_s: float | None) -> tuple[Gate, ...]:
    """A controller around the rig's module: the display at its set-points, and the module that follows in each corner.

    No module jumps as a set-point does, so rates are those of the module; a display that is exactly at its set-points
    bounds the temperatures of repetition.
    """
    rig, shows = deliveries[0].rig, [(_held(delivery),) for delivery in deliveries]
    stuck = (_stuck_C(deliveries[0], False), _stuck_C(deliveries[0], True))
    verdicts = gate_shown(shows, rig, stuck_C=stuck, pause_s=pause_s, rates=False, module=True)
    judged, under = [], Under.of(rig)
    for delivery, verdict in zip(deliveries, verdicts, strict=True):
        assert verdict.repeated is not None
        checks, faulty, unpowered_C = _followed(delivery, verdict.repeated.pause_s)
        judged.append(
            replace(
                verdict,
                scenarios=verdict.scenarios + len(corners_of(rig)),
                checks=worst_of([checks, verdict.checks]),
                once=worst_of([checks, verdict.once]),
                demands=_demands(verdict, faulty, unpowered_C, _rest_s(under, delivery, unpowered_C)),
            )
        )
    return tuple(judged)


def _held(delivery: DeliveredDrive) -> DisplayCourse:
    """A display that is exactly at its set-points, from one update to the next."""
    samples = samples_of(delivery)
    return DisplayCourse(HELD, 1.0 / samples.rate_Hz, samples.command)


def _rest_s(under: Under, delivery: DeliveredDrive, unpowered_C: tuple[float, float]) -> float | None:
    """How long the loop must hold the baseline after a start without power until the skin is there, in every corner."""
    base = _held(delivery)
    rest = DisplayCourse(HELD, base.step_s, np.full(2, base.display_C[0]))
    times = [under.recovery_s(rest, under.steady(level)) for level in unpowered_C]
    known = [time for time in times if time is not None]
    return max(known) if len(known) == len(times) else None


def _followed(delivery: DeliveredDrive, between_s: float) -> tuple[tuple[Check, ...], Faulty, tuple[float, float]]:
    """Every rule for the rig's module that follows the set-points, in each corner; its single faults as given; and
    between which temperatures in °C the display stands without power.

    Rates also in a second play `between_s` after the first; temperatures of repeated plays are bounded elsewhere.
    """
    samples, rig = samples_of(delivery), delivery.rig
    corners = tuple(replace(corner, gain_relative=0.0) for corner in corners_of(rig))  # the loop corrects the gain
    ensemble = Ensemble.on(rig, corners, None)
    off = ensemble.at_rest(0.0)
    for nodes in off.nodes_C:
        check_sink(rig, nodes)
    values, _ = ensemble.hold(0.0, off, np.array([0.0, 1.0]))
    unpowered = values[WATCHED.index("display_C"), :, -1]
    drives: dict[int, tuple[Drive, Drive, Drive]] = {}
    settled = _then(samples, SETTLING_S)
    twice = _then(_then(samples, min(between_s, LONGEST_BETWEEN_S), samples), SETTLING_S)
    for lane, corner in enumerate(corners):
        with suppress(RigError):  # a corner whose module cannot hold the baseline shows less than is asked of it
            drive = follow_samples(corner.rig, samples)
            check_sink(rig, state_under_current(network_of(corner.rig), float(drive.current_A[0])))
            drives[lane] = drive, follow_samples(corner.rig, settled), follow_samples(corner.rig, twice)
    drive, lanes = drives[0][0], ensemble.only(list(drives))
    alone, arrived, again = (
        checks_of_lanes(lanes, LaneDrives(each[0].time_s, np.array([one.current_A for one in each])), rig.limits)
        for each in zip(*drives.values(), strict=True)
    )
    again = tuple(new if new.quantity == RATE else old for old, new in zip(alone, again, strict=True))
    second = f"in a second play {min(between_s, LONGEST_BETWEEN_S):.4g} s after the first"
    checks = worst_of([alone, _during(arrived, "after the last set-point"), _during(again, second)])
    nominal, rest_A = ensemble.only([0]), float(drive.current_A[0])
    faulty = Faulty(nominal, drive, rest_A, nominal.at_rest(rest_A), rig.limits)
    return checks, faulty, (float(unpowered.min()), float(unpowered.max()))


def _then(samples: Samples, hold_s: float, after: Samples | None = None) -> Samples:
    """Samples whose last one is held for `hold_s` more, and what comes after."""
    held = np.full(math.ceil(hold_s * samples.rate_Hz), samples.codes[-1])
    return replace(samples, codes=np.concatenate([samples.codes, held, *([] if after is None else [after.codes])]))


def _during(checks: Sequence[Check], when: str) -> tuple[Check, ...]:
    """Checks whose scenarios say in which part of a sequence they are, before how it ends."""
    parts = ((check, *check.scenario.partition(", then ")) for check in checks)
    return tuple(replace(check, scenario=f"{corner}, {when}{then}{ending}") for check, corner, then, ending in parts)


def _demands(verdict: Gate, faulty: Faulty, unpowered_C: tuple[float, float], rest_s: float | None) -> Demands:
    """What set-points demand, and what a loop that loses its sensor or has its poles swapped does to the module.

    The cut-off leaves room for the display without power: a player starts from there, and returns there after a stop.
    """
    cut = verdict.demands.cut_off_display_C
    reach = (min(cut.low + BEYOND_K, unpowered_C[0]), max(cut.high - BEYOND_K, unpowered_C[1]))
    cut_off, stuck = faulty.cut_off(reach)
    duration = "10 min or more" if rest_s is None else f"{rest_s:g} s"
    start = SingleFault(
        "first play on a display that was without power",
        "green",
        f"the display is between {signed(unpowered_C[0], '.1f')} and {signed(unpowered_C[1], '.1f')} °C",
        f"holding the baseline for {duration} before the first play",
    )
    polarity, _ = faulty.polarity()
    lost = replace(stuck, fault="sensor lost or poles swapped: the loop runs to the driver's limit")
    return replace(
        verdict.demands,
        cut_off_display_C=cut_off,
        polarity_check=replace(polarity, needed=True),
        rest_before_first_play_s=rest_s,
        faults=(*verdict.demands.faults[:1], start, lost),
    )


def _stuck_C(delivery: DeliveredDrive, warm: bool) -> float:
    low, high = delivery.device.interval("set-point range")
    return high if warm else low
