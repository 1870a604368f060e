"""Probes: what a thermistor reads while a cue plays. A probe is recorded in addition to the trace's own columns.

`display`: the cold plate, under an insulating layer. `interface`: halfway through the contact resistance. `skin`: the
tissue at a depth, linear in thermal resistance between lumps. `insulated skin`: see `insulated`.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array, Index
from ..rig.parts import Probe
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from .insulated import insulated_C
from .network import COLD, places_of, stacked, temperature_weights

SLOWEST_ROWS_S = 0.01
"""A probe with memory (a lag, or skin of its own) is stepped at least this finely, whatever the rows."""

MOST_VALUES = 200_000_000
"""Values of all probes at most: 1.6 GB while they are computed."""

INSULATED_VALUES = 48
"""A probe on insulated skin takes about as long as this many others: it has some 200 modes."""


def between(rows_s: Array, rig: Rig) -> int:
    """Number of parts into which the rows of a run are divided, so that no probe with memory steps over 10 ms.

    >>> between(np.array([0.0, 0.025]), Rig.load("thenar").with_(probe=[{"name": "a", "place": "skin", "lag_s": 1.0}]))
    3
    """
    if not any(probe.lag_s or probe.place == "insulated skin" for probe in rig.probes):
        return 1
    parts = max(1, math.ceil(float(np.diff(rows_s).max(initial=0.0)) / SLOWEST_ROWS_S - 1e-9))
    insulated = sum(probe.place == "insulated skin" for probe in rig.probes)
    values = len(rows_s) * parts * (len(rig.probes) + INSULATED_VALUES * insulated)
    if values > MOST_VALUES:
        raise RigError(
            f"rig {rig.name}: its probes need {values:.2g} values over {rows_s[-1]:g} s; the limit is "
            f"{MOST_VALUES:.2g}: shorten the run, lower the rate or remove probes"
        )
    return parts


def divided(rows_s: Array, parts: int) -> Array:
    """Times in s with every gap between rows in equal parts; every `parts`-th is a row.

    >>> divided(np.array([0.0, 1.0, 3.0]), 2)
    array([0. , 0.5, 1. , 2. , 3. ])
    """
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
        if probe.place == "insulated skin":
            value = insulated_C(rig, probe, time_s, value)
        readings.append((probe.name, _lagged(probe, time_s, value)[::parts].copy()))
    return tuple(readings)


def _lagged(probe: Probe, time_s: Array, value: Array) -> Array:
    if not probe.lag_s:
        return value
    from . import kernel_modes

    out = np.empty_like(value)
    kernel_modes.lagged(time_s, value, probe.lag_s, out)
    return out
