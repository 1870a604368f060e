"""The gate of safety for what a device delivers: how each kind of device meets the corners of a rig's uncertainty.

Volts and amperes are played open loop, so the gain of the current source counts. A bridge switches its full current,
so its rest and its last value are means. A thermode that is given set-points measures its plate and corrects itself:
the gain of the rig's current source is none of its own, and in each corner the gate plays the current by which the
display follows the set-points *there*. A better contact brings such a skin nearer to the set-point than the current of
the nominal rig would. The limits of the rig's driver are not those of the thermode either, and are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from thermicon.circuit.delivery.realise import Realised, followed
from thermicon.circuit.delivery.setpoints import Setpoints
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.safety.checks import Check
from thermicon.circuit.safety.corners import corners_of
from thermicon.circuit.safety.gate import Gate, gate

REACHED = "every set-point reached"

_NO_LIMITS = {"driver.current_min_A": -20.0, "driver.current_limit_A": 20.0, "driver.voltage_limit_V": 200.0}
_NO_GAIN = "the device measures its plate and corrects itself: the gain of the rig's current source is none of its own"
_CORNER = "one corner of a rig's uncertainty, which the gate varies itself"
_SURE = {"contact_resistance_relative": 0.0, "ambient_K": 0.0, "gain_relative": 0.0, "reason": _CORNER}


def worst_case(realised: Realised) -> Gate:
    """Hold what a device delivers against every rule of safety, in all corners of the rig's uncertainty and 60 s after.

    >>> from thermicon.circuit.delivery.device import Device
    >>> from thermicon.circuit.delivery.realise import realise
    >>> from thermicon.icons import load_library
    >>> icon, rig = load_library("six-icons")["cooling-step"], Rig.load("thenar")
    >>> worst_case(realise(icon, rig, Device.load("dac-12")))
    Gate(green: 22 rules in 27 scenarios on thenar)
    >>> worst_case(realise(icon, rig, Device.load("qst-tcs2")))
    Gate(green: 22 rules in 15 scenarios on thenar)
    """
    played, device = realised.played, realised.device
    if isinstance(played, Setpoints):
        return _regulated(realised, played)
    if device.driven_by != "duty":
        return gate(realised.delivered, realised.rig)
    low, high = device.interval("output range")
    peak = min(-low, high)
    return gate(realised.delivered, realised.rig, rest_A=float(played.command[0]) * peak, bridge_A=peak)


def regulated_corners(rig: Rig) -> tuple[tuple[str, Rig], ...]:
    """Corners of contact and ambient, in words and as rigs that are sure, with a driver as strong as need be."""
    calm = rig.with_(**{"uncertainty.gain_relative": 0.0, "uncertainty.reason": _NO_GAIN})
    sure = {f"uncertainty.{key}": value for key, value in _SURE.items()}
    return tuple((str(corner), corner.rig.with_(**sure, **_NO_LIMITS)) for corner in corners_of(calm))


def _regulated(realised: Realised, setpoints: Setpoints) -> Gate:
    rig, found = realised.rig, []
    for words, there in regulated_corners(rig):
        try:
            drive = followed(there, setpoints, realised.lead_s, realised.end_s)
        except RigError:  # where the module cannot hold the baseline, it does what it does on the rig as given
            drive = realised.delivered
        one = gate(drive, there, limits=rig.limits)
        checks = [
            replace(check, scenario=f"{words}, then {check.scenario.rpartition(', then ')[2]}") for check in one.checks
        ]
        found.append(replace(one, checks=tuple(checks)))
    worst = [
        _reached(max(same, key=_beyond), setpoints, realised.lead_s)
        for same in zip(*(one.checks for one in found), strict=True)
    ]
    return replace(
        found[0],
        uncertainty=replace(rig.uncertainty, gain_relative=0.0, reason=_both(rig.uncertainty.reason, _NO_GAIN)),
        scenarios=sum(one.scenarios for one in found),
        checks=tuple(worst),
    )


def _both(given: str, own: str) -> str:
    return f"{given}; {own}" if given else own


def _beyond(check: Check) -> float:
    return check.value - check.limit if check.upper else check.limit - check.value


def _reached(check: Check, setpoints: Setpoints, lead_s: float) -> Check:
    """A check of the display with the set-points themselves, where the rig's module falls short of them."""
    if check.quantity != "display":
        return check
    levels: Sequence[float] = setpoints.level_C.tolist()
    value = max(levels) if check.upper else min(levels)
    time = lead_s + float(setpoints.time_s[levels.index(value)])
    own = replace(check, value=value, time_s=time, since_s=None, scenario=REACHED)
    if _beyond(own) <= _beyond(check) + 1e-6:
        return check
    return replace(own, since_s=time) if _beyond(own) > 0 else own
