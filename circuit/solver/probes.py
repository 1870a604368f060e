"""Probes: what a thermistor reads while a cue plays. A probe is recorded in addition to the trace's own columns.

`display`: the cold plate, under an insulating layer. `interface`: halfway through the contact resistance. `skin`: the
tissue at a depth, linear in thermal resistance between lumps.
"""

import math

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from ..rig.rig import Rig
from ..rig.rigfile import RigError
from .modes import SkinModes
from .network import COLD, places_of, stacked, temperature_weights

SLOWEST_ROWS_S = 0.01
"""A probe with a lag is stepped at least this finely, whatever the rows."""

MOST_VALUES = 200_000_000
"""Values of all probes at most: 1.6 GB while they are computed."""


def between(rows_s: Array, rig: Rig) -> int:
    """Number of parts into which the rows of a run are divided, so that no probe with a lag steps over 10 ms."""
    if not any(probe.lag_s for probe in rig.probes):
        return 1
    parts = max(1, math.ceil(float(np.diff(rows_s).max(initial=0.0)) / SLOWEST_ROWS_S - 1e-9))
    values = len(rows_s) * parts * len(rig.probes)
    if values > MOST_VALUES:
        raise RigError(
            f"rig {rig.name}: its probes need {values:.2g} values over {rows_s[-1]:g} s; the limit is "
            f"{MOST_VALUES:.2g}: shorten the run, lower the rate or remove probes"
        )
    return parts


def divided(rows_s: Array, parts: int) -> Array:
    """Times in s with every gap between rows in equal parts; every `parts`-th is a row."""
    if parts == 1:
        return rows_s
    inside = rows_s[:-1, np.newaxis] + np.diff(rows_s)[:, np.newaxis] * (np.arange(parts) / parts)
    return np.append(inside.ravel(), rows_s[-1])


def readings_of(rig: Rig) -> tuple[Index, Array] | None:
    """Return the readings that a run must record for a rig's probes, one each; None where it has none."""
    if not rig.probes:
        return None
    place, contact = places_of(rig), rig.contact.resistance_m2K_per_W
    rows = []
    for probe in rig.probes:
        if probe.place == "interface":
            rows.append(temperature_weights(0.5 * contact, place))
        elif probe.place == "skin":
            rows.append(temperature_weights(contact + rig.skin.resistance_to_m2K_per_W(probe.depth_m), place))
        else:
            rows.append((COLD, (1.0, 0.0, 0.0)))
    return stacked(rows)


def sensed(rig: Rig, time_s: Array, recorded: Array, parts: int) -> tuple[tuple[str, Array], ...]:
    """Return (name, °C) of every probe at every `parts`-th time, from the readings (k, times) of `readings_of`."""
    readings = []
    for probe, read in zip(rig.probes, recorded, strict=True):
        value = np.ascontiguousarray(read)
        if probe.lag_s:
            rate = np.array([1.0 / probe.lag_s])
            value = reading_of(0.0, rate, rate, 0.0).at(time_s, value)
        readings.append((probe.name, value[::parts].copy()))
    return tuple(readings)


def reading_of(deep_C: float, rate_per_s: Array, drive_per_s: Array, direct: float) -> SkinModes:
    """Modes whose sum is a reading, with `direct` · u of the display u in K above `deep_C`."""
    ones, none = np.ones((1, len(rate_per_s))), np.empty((0, 0))
    return SkinModes(deep_C, rate_per_s, drive_per_s, ones, np.array([direct]), np.array([deep_C]), none, none)
