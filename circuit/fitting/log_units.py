"""Units that a log is often in by mistake, recognised and named: kelvin, °F, milliseconds, milliamperes."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..inputs import LIKE_MILLISECONDS
from ..rig.module import ZERO_C_IN_K

COLDEST_C, HOTTEST_C = -40.0, 150.0
"""Outside, a sensor of a display on skin is unplugged or its wire broken."""

KELVIN = (ZERO_C_IN_K + COLDEST_C, ZERO_C_IN_K + HOTTEST_C)
FAHRENHEIT_FROM, FAHRENHEIT_TO = 65.0, 130.0
"""Medians of display or skin from here on would burn; 18 to 54 °C have these numbers in °F."""

SLOWEST_S, MILLI = 2.0, 1000.0
"""A log with rows farther apart than 2 s shows nothing of a display; as a rule its times are milliseconds."""

MOST_A, MOST_V = 50.0, 200.0
"""Far above what any display on skin takes, and far below what it takes in milliamperes and millivolts."""


def unit_fault(column: str, values: Array) -> str | None:
    """Return why a column is not in the unit of its name, with the cure; None where it may be.

    >>> unit_fault("display_C", np.full(30, 305.2))[:40]
    'display_C has a median of 305.2: these l'
    """
    there = values[np.isfinite(values)]
    if not there.size:
        return None
    if column == "time_s":
        return _time_fault(there)
    if column.endswith("_C"):
        return _temperature_fault(column, there)
    limit, unit, small = (MOST_A, "A", "milliamperes") if column.endswith("_A") else (MOST_V, "V", "millivolts")
    most = float(np.abs(there).max())
    if most > limit:
        return (
            f"{column} reaches {most:g} {unit}, above {limit:g} {unit}: it looks like {small}; divide it by 1000, so "
            f"that it is in {unit}"
        )
    return None


def _time_fault(time: Array) -> str | None:
    step = float(np.median(np.diff(time)))
    if step <= SLOWEST_S:
        return None
    if step * 1e-3 >= 1e-4 and float(time[-1] - time[0]) > 60.0 and step <= SLOWEST_S * MILLI:
        return f"time_s goes in steps of {step:g} over {time[-1] - time[0]:g}: {LIKE_MILLISECONDS}"
    return f"time_s goes in steps of {step:g} s; a fit needs rows at most {SLOWEST_S:g} s apart: log faster"


def _temperature_fault(column: str, there: Array) -> str | None:
    middle = float(np.median(there))
    if KELVIN[0] < middle < KELVIN[1] and middle > HOTTEST_C:
        return f"{column} has a median of {middle:g}: these look like kelvin; subtract {ZERO_C_IN_K:g} to have °C"
    if column in ("display_C", "skin_C") and FAHRENHEIT_FROM < middle < FAHRENHEIT_TO:
        return f"{column} has a median of {middle:g}: these look like °F; convert the column to °C"
    outside = (there < COLDEST_C) | (there > HOTTEST_C)
    if outside.mean() > 0.01:
        first = float(there[np.argmax(outside)])
        return (
            f"{column} reads {first:g} °C in {100 * outside.mean():.0f} % of its rows: a sensor that is unplugged or "
            f"shorted; connect it, or remove the column"
        )
    return None
