"""Constants that follow from others by playing a stimulus: neutral heat flow, threshold drives of drawn observers."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from thermicon.circuit import Rig, steady_state
from thermicon.circuit.records import Record, Table
from thermicon.circuit.solver.network import network_of

from ..observer.channels import CHANNELS, Channel
from ..observer.observer import Observer, load_thresholds
from ..observer.variants import receptor_column
from .bench import Bench, Stimulus, ramp
from .receptors import receptor_drive

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


def anchored(observer: Observer, shipped: Observer) -> Observer:
    """The observer whose threshold drives leave the published thresholds at as many multiples as the shipped one's.

    What adaptation and integration do to a threshold-size fast step changes with their constants; thresholds do not.
    """
    cold, warm = (
        replace(
            observer.receptor(channel),
            threshold_drive=shipped.receptor(channel).threshold_drive
            * peak_drive(channel, observer)
            / peak_drive(channel, shipped),
        )
        for channel in CHANNELS
    )
    return replace(observer, cold=cold, warm=warm)


@lru_cache(maxsize=16)
def peak_drive(channel: Channel, observer: Observer) -> float:
    """Peak receptor drive of a fast step as large as the forced-choice threshold of the thenar."""
    played = _threshold_step(channel)
    return float(receptor_drive(played.received(observer.variable, channel)[0], played.dt_s, channel, observer).max())


@lru_cache(maxsize=2)
def _threshold_step(channel: Channel) -> Stimulus:
    known = load_thresholds()
    size = known.one("detection threshold", channel=channel, site=SITE).central
    rate, held = known.one("rate of the threshold step").central, known.one("duration of the threshold step").central
    end = round(size / rate + held, 2)
    return Bench(Rig.load(RIG)).play([ramp(channel, size, rate)], end)
