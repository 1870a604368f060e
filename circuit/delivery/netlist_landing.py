"""The drive of a netlist, and a hand that lands: the clock begins at the landing, and the cue follows by the lead.

The operating point is a display in air over bare skin at rest; a switch of 1 µs then closes the contact and takes away
the air at the display and the heat that keeps the skin's face at `skin.rest_C`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import Array
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..solver.drive import Drive
from ..solver.landing import lead_of

EDGE_S = 1e-6
"""Width of the flank that replaces a jump of a held current; less where rows are closer than four of these."""


def lead_s(rig: Rig) -> float:
    """Time in s from the landing to the beginning of a cue, in whole updates of the driver; 0 for a hand that rests.

    >>> lead_s(Rig.load("thenar").with_(**{"contact.lands_s": -0.5}))
    0.5
    """
    return lead_of(rig) / rig.driver.update_Hz


def check_landing(rig: Rig) -> None:
    """Raise RigError where a hand lands on a rig whose heat sink begins a cue at a temperature of its own.

    In a run, such a sink is set to its starting temperature when the cue begins; nothing in a circuit can do that.
    """
    passive = rig.heat_sink.passive
    if rig.contact.lands_s is not None and passive is not None and not passive.steady:
        raise RigError(
            f"rig {rig.name}: contact.lands_s = {rig.contact.lands_s:g} s: in a netlist, a passive heat sink cannot be "
            "set to heat_sink.temperature_C when the cue begins; remove heat_sink.temperature_C (a sink in balance) or "
            "contact.lands_s"
        )


def lead_currents(rig: Rig, drive: Drive, rest_A: float | None, lead_A: Array | None) -> Array:
    """Currents in A until the hand lands and for each update since: those of a design, or one that is held.

    Raises ValueError for another number of them.
    """
    count = lead_of(rig) + 1
    if lead_A is None:
        return np.full(count, float(drive.current_A[0]) if rest_A is None else rest_A)
    if len(lead_A) != count:
        raise ValueError(f"a lead of {lead_s(rig):g} s has {count} currents, one before it, not {len(lead_A)}")
    return np.asarray(lead_A, dtype=float)


def led_points(rig: Rig, drive: Drive, lead_A: Array) -> list[tuple[float, float]]:
    """Corners of the current from the landing on: the lead, then the drive, a flank of 1 µs for each jump."""
    count, after = len(lead_A) - 1, lead_s(rig)
    if not count:
        return points(drive, float(lead_A[0]))
    held = Drive(np.arange(count + 1) / rig.driver.update_Hz, np.append(lead_A[1:], lead_A[-1]), held=True)
    # The last corner of the lead is the first of the drive.
    cue = points(drive, float(lead_A[-1]))
    return [*points(held, float(lead_A[0]))[:-1], *((after + time, current) for time, current in cue)]


def contact_lines(rig: Rig, resistance_K_per_W: float, first: str) -> Iterator[str]:
    """The contact that closes when the hand lands, and what display and skin have before; `first` is a skin lump."""
    film_W_per_K = rig.ambient.film_W_per_m2K * rig.contact.area_m2
    rest_W = rig.resting_flux_W_per_m2 * rig.contact.area_m2
    yield "* V(landed) is 0 in the operating point and 1 from the landing on"
    yield f"Vlanded landed 0 PWL(0 0 {EDGE_S!r} 1)"
    yield f"Bcontact cold skin I=V(landed)*(V(cold)-V(skin))/{resistance_K_per_W!r}"
    yield "* until then: the display in air, and the heat that bare skin at rest takes up at its face"
    yield f"Bair cold 0 I=(1-V(landed))*{film_W_per_K!r}*(V(cold)-{rig.ambient.temperature_C!r})"
    yield f"Brest 0 {first} I=(1-V(landed))*{rest_W!r}"


def points(drive: Drive, rest_A: float | None) -> list[tuple[float, float]]:
    """Corners of a drive's current: (time s, A), a flank of 1 µs for each jump."""
    times, currents = drive.time_s.tolist(), drive.current_A.tolist()
    start: list[tuple[float, float]] = [(0.0, currents[0])]
    if rest_A is not None and rest_A != currents[0]:
        edge = min(EDGE_S, times[1] / 4)
        slope = 0.0 if drive.held else (currents[1] - currents[0]) / times[1]
        start = [(0.0, float(rest_A)), (edge, currents[0] + slope * edge)]
    if not drive.held:
        return [*start, *zip(times[1:], currents[1:], strict=True)]
    points, before = start, currents[0]
    for k in range(1, len(times) - 1):
        if currents[k] != before:
            half = min(EDGE_S / 2, (times[k] - times[k - 1]) / 4, (times[k + 1] - times[k]) / 4)
            points += [(times[k] - half, before), (times[k] + half, currents[k])]
            before = currents[k]
    return [*points, (times[-1], before)]
