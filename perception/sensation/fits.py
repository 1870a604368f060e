"""Constants that follow from others by playing a stimulus: neutral heat flow."""

from __future__ import annotations

from thermicon.circuit import Rig
from thermicon.circuit.records import Record, Table
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import steady_state

from ..observer.channels import Channel
from ..observer.variants import receptor_column

RIG = "thenar"
SITE = "thenar"


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
