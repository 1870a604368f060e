"""The gate of safety for what a device delivers: how each kind of device meets the corners of a rig's uncertainty.

Volts and amperes are played open loop, so the gain of the current source counts. A bridge switches its full current,
so its rest and its last value are means. A thermode shows its own set-points at its own tick: they are judged as they
stand, with its lag and without, and neither module nor driver nor heat sink of the rig take part.
"""

from __future__ import annotations

from collections.abc import Sequence

from thermicon.circuit.delivery.device import Device
from thermicon.circuit.delivery.realise import Realised
from thermicon.circuit.delivery.samples import Samples
from thermicon.circuit.delivery.setpoints import Setpoints
from thermicon.circuit.safety.gate import Gate, gate_set
from thermicon.circuit.safety.thermode import Shown
from thermicon.circuit.safety.thermode_gate import gate_shown
from thermicon.circuit.solver.prescribed import shown

AT_ONCE, LAGGED = "followed at once", "followed with its lag"


def worst_case(realised: Realised, pause_s: float | None = None) -> Gate:
    """Check what a device delivers against every rule of safety, once and again and again with a pause.

    See `gate`. Raises PauseError for a pause that cannot be.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.circuit.delivery.realise import realise
    >>> from thermicon.icons import load_library
    >>> icon, rig = load_library("six-icons")["cooling-step"], Rig.load("thenar")
    >>> worst_case(realise(icon, rig, Device.load("dac-12")))
    Gate(green: 22 rules in 195 scenarios on thenar)
    >>> worst_case(realise(icon, rig, Device.load("qst-tcs2")))
    Gate(green: 21 rules in 20 scenarios on thenar)
    """
    return worst_cases([realised], pause_s)[0]


def worst_cases(realised: Sequence[Realised], pause_s: float | None = None) -> tuple[Gate, ...]:
    """Check what one device delivers of several cues on one rig, which may be played again and again in any order."""
    device, rig = realised[0].device, realised[0].rig
    if device.driven_by == "set-points":
        low, high = device.interval("set-point range")
        return gate_shown([ways_of(one) for one in realised], rig, stuck_C=(low, high), pause_s=pause_s)
    if device.driven_by != "duty":
        drives = [(one.delivered, float(one.delivered.current_A[0])) for one in realised]
        return gate_set(drives, rig, pause_s=pause_s)
    low, high = device.interval("output range")
    peak = min(-low, high)
    bridged = [(one.delivered, float(_samples(one).command[0]) * peak) for one in realised]
    return gate_set(bridged, rig, bridge_A=peak, pause_s=pause_s)


def ways_of(realised: Realised) -> tuple[Shown, ...]:
    """The display of a thermode in each way in which it may follow its set-points, at its own tick."""
    played, device = realised.played, realised.device
    assert isinstance(played, Setpoints)
    step = played.tick_s
    levels, fastest = played.sampled(), device.most("ramp rate")
    found = [Shown(AT_ONCE, step, shown(levels, step, 0.0, fastest))]
    if lag := _lag_s(device):
        found.append(Shown(LAGGED, step, shown(levels, step, lag, fastest)))
    return tuple(found)


def _lag_s(device: Device) -> float:
    record = device.record("lag")
    return 0.0 if record is None else record.central


def _samples(realised: Realised) -> Samples:
    assert isinstance(realised.played, Samples)
    return realised.played
