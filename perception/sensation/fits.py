"""The parts of the calibration that play stimuli: each sets one constant and says on what.

Skin, receptors and stimuli are those of the bench; the constants of one receptor model are set by
the same steps as those of another. `calibrate` puts the parts in order.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import lru_cache

from thermicon.circuit import Rig, steady_state
from thermicon.circuit.records import Record, Table
from thermicon.circuit.solver.network import network_of

from ..observer.channels import CHANNELS, Channel
from ..observer.observer import Observer, Receptor
from ..observer.variants import drive_unit, receptor_column, source_of
from .bench import Bench, Stimulus, ramp
from .receptors import receptor_drive

RIG = "thenar"
SITE = "thenar"
WRIST_RIG = "forearm"


def neutral_flux(known: Table, channel: Channel) -> Record:
    """Heat flow at receptor depth while the skin rests at the ends of complete adaptation."""
    zone = known.one("complete adaptation")
    rig = Rig.load(RIG)
    network, column = network_of(rig), receptor_column("heat flow", channel)
    low, high = (network.read(steady_state(rig, "skin", level)[1], column) for level in zone.interval)
    return Record(
        quantity="neutral heat flow",
        unit="W/m²",
        source=f"computed from the neutral zone ({zone.source})",
        low=low,
        high=high,
        channel=channel,
        site=SITE,
        method=f"steady heat flow into the skin at receptor depth on the {RIG} rig",
        conditions=f"skin held at {zone.interval[0]:g} and {zone.interval[1]:g} °C",
        confidence="low",
        use="calibrate",
    )


def threshold_drive(known: Table, channel: Channel, observer: Observer) -> Record:
    """Peak receptor drive of a fast step as large as the forced-choice threshold."""
    record = known.one("detection threshold", channel=channel, site=SITE)
    rate, held = known.one("rate of the threshold step"), known.one("duration of the threshold step")
    depth = known.one("receptor depth", channel=channel)

    def drive(rate_K_per_s: float, hold_s: float) -> float:
        return peak_drive(_step(RIG, channel, record.central, rate_K_per_s, hold_s), channel, observer)

    value = drive(rate.central, held.central)
    ends = [drive(r, h) for r, h in itertools.product(rate.interval, held.interval)]
    return Record(
        quantity=f"drive of a threshold step{source_of(observer.variable, observer.model)}",
        unit=drive_unit(observer.variable, observer.model),
        source=f"calibrated on: {record.source}; depth {depth.central:g} mm: {depth.source}",
        value=value,
        low=min(*ends, value),
        high=max(*ends, value),
        channel=channel,
        site=SITE,
        method=f"skin-surface ramp of {record.central:g} K at {rate.central:g} K/s, held, on the {RIG} rig",
        conditions=(
            f"interval: rate of {rate.interval[0]:g} to {rate.interval[1]:g} K/s, "
            f"hold of {held.interval[0]:g} to {held.interval[1]:g} s (assumed)"
        ),
        confidence=record.confidence,
        use="calibrate",
    )


def wrist_factor(known: Table, channel: Channel, observer: Observer) -> Record:
    """How much larger the drive of a threshold step is at the wrist; one area of contact is assumed for both."""
    record = known.one("detection threshold", channel=channel, site="wrist")
    rate, held = known.one("rate of the threshold step").central, known.one("duration of the threshold step").central
    unit = observer.receptor(channel).threshold_drive

    def factor(size_K: float) -> float:
        return peak_drive(_step(WRIST_RIG, channel, size_K, rate, held), channel, observer, fixed=True) / unit

    low, high = (factor(size) for size in record.interval)
    return Record(
        quantity=f"threshold at the wrist{source_of(observer.variable, observer.model)}",
        unit="multiple of the drive at the thenar",
        source=f"calibrated on: {record.source}",
        value=factor(record.central),
        low=low,
        high=high,
        channel=channel,
        site="wrist",
        method=f"skin-surface ramp of {record.central:g} K at {rate:g} K/s, held, on the {WRIST_RIG} rig",
        conditions="mean ± SD over people; the whole forearm is taken to be like the wrist (assumed)",
        confidence="medium",
        use="calibrate",
    )


def with_unit_drives(known: Table, observer: Observer) -> Observer:
    """The observer whose sensation of the threshold step is 1 in both channels."""
    rate, held = known.one("rate of the threshold step").central, known.one("duration of the threshold step").central
    made = []
    for channel in CHANNELS:
        size = known.one("detection threshold", channel=channel, site=SITE).central
        drive = peak_drive(_step(RIG, channel, size, rate, held), channel, observer)
        made.append(replace(observer.receptor(channel), threshold_drive=drive))
    return replace(observer, cold=made[0], warm=made[1])


def peak_drive(played: Stimulus, channel: Channel, observer: Observer, *, fixed: bool = False) -> float:
    """Largest drive of the first stimulus; unless `fixed`, with a threshold drive that is this very drive.

    Gain control starts at a multiple of the threshold drive, so that the two are found together.
    """
    received = played.received(observer.variable, channel)[0]
    receptor = observer.receptor(channel)
    found = 0.0
    for _ in range(1 if fixed or receptor.gain_strength == 0.0 else 60):
        drive = receptor_drive(received, played.dt_s, channel, _with(observer, channel, receptor))
        last, found = found, float(drive.max())
        if abs(found - last) <= 1e-12 * found:
            break
        receptor = replace(receptor, threshold_drive=found)
    return found


def _with(observer: Observer, channel: Channel, receptor: Receptor) -> Observer:
    return replace(observer, cold=receptor) if channel == "cold" else replace(observer, warm=receptor)


@lru_cache(maxsize=64)
def _step(rig: str, channel: Channel, size_K: float, rate_K_per_s: float, hold_s: float) -> Stimulus:
    end = round(size_K / rate_K_per_s + hold_s, 2)
    return Bench(Rig.load(rig)).play([ramp(channel, size_K, rate_K_per_s)], end)
