"""Whether the numbers of a column can be in the unit of its name, and readings that no sensor could have taken.

The whole range of a column decides, and every unit that its numbers fit is named; nothing is converted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..number_text import number

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

MOST_SIZE = 1e12
"""Times by the clock of a computer have ten digits; what reads a wire that is off has fewer."""
COLDEST_C, HOTTEST_C = -40.0, 150.0
"""Outside, a sensor of a display on skin is unplugged or its wire broken."""
ON_SKIN_C, HOT_PLATE_C, MEDIAN_C = (5.0, 55.0), (5.0, 100.0), 15.0
"""Ranges of what touches skin and of other parts, in which a column of another unit must lie, and its least median."""
BURNING_C = 65.0
"""Medians of display or skin from here on would burn; 18 to 54 °C have these numbers in °F."""
POSSIBLE_C, JUMP_K = (-10.0, 60.0), 20.0
"""What touches skin is within; a reading beyond that jumps by more, from and to its neighbours, is an error."""
MOST_LEFT_OUT = 0.2
"""Larger shares of impossible readings are no single errors of a sensor."""
MOST_A, MOST_V = 50.0, 200.0
"""Far above what any display on skin takes, and far below what it takes in milliamperes and millivolts."""
SLOWEST_S, SHORTEST_RUN_S, LONGEST_RUN_S = 2.0, 1.0, 3600.0
"""Rows farther apart show nothing of a display; and how long what is recorded of one lasts."""
FASTEST_S, LONG_S, ROUNDING = 1e-4, 600.0, 1e-6
DAYS = (30_000.0, 60_000.0)
"""Days from 1900 on to dates of today, in which spreadsheets count times."""

TEMPERATURES = {
    "kelvin": (1.0, -273.15, "subtract 273.15"),
    "°F": (1 / 1.8, -32 / 1.8, "subtract 32 and divide by 1.8"),
    "tenths of °C": (0.1, 0.0, "divide by 10"),
    "hundredths of °C": (0.01, 0.0, "divide by 100"),
    "thousandths of °C": (0.001, 0.0, "divide by 1000"),
    "tenths of °F": (0.1 / 1.8, -32 / 1.8, "divide by 10, subtract 32 and divide by 1.8"),
    "tenths of kelvin": (0.1, -273.15, "divide by 10 and subtract 273.15"),
    "hundredths of kelvin": (0.01, -273.15, "divide by 100 and subtract 273.15"),
    "thousandths of kelvin": (0.001, -273.15, "divide by 1000 and subtract 273.15"),
}
TIMES = (
    (1e-3, "milliseconds", "divide the column by 1000"),
    (1e-6, "microseconds", "divide the column by 1,000,000"),
    (1e-9, "nanoseconds", "divide the column by 1,000,000,000"),
)


def _errors(values: Array, low: float, high: float, widest: tuple[float, float]) -> NDArray[np.bool_]:
    """Readings that no sensor took: beyond the widest range, or beyond low and high by a jump there and back."""
    import numpy as np

    beyond = (values < widest[0]) | (values > widest[1])
    doubtful = (values < low) | (values > high)
    sound = np.flatnonzero(~doubtful & np.isfinite(values))
    if not sound.size or not doubtful.any():
        return beyond
    at = np.flatnonzero(doubtful & ~beyond)
    after = np.searchsorted(sound, at)
    neighbours = sound[np.maximum(after - 1, 0)], sound[np.minimum(after, sound.size - 1)]
    beyond[at] = np.min([np.abs(values[at] - values[near]) for near in neighbours], axis=0) > JUMP_K
    return beyond


def impossible(name: str, values: Array) -> NDArray[np.bool_]:
    """Where a column of temperatures has error values of its sensor, such as −127, 85 or 999 among others; few of them.

    >>> import numpy as np
    >>> impossible("display_C", np.array([32.0, 31.9, 85.0, 31.9, 32.0, 32.1, 32.0])).sum()
    1
    """
    import numpy as np

    if not name.endswith("_C"):
        return np.zeros(len(values), dtype=bool)
    low, high = (COLDEST_C, HOTTEST_C) if name.startswith("hot_plate") else POSSIBLE_C
    wrong = _errors(values, low, high, (COLDEST_C, HOTTEST_C))
    return wrong if wrong.sum() <= MOST_LEFT_OUT * np.isfinite(values).sum() else np.zeros(len(values), dtype=bool)


def unit_fault(name: str, values: Array) -> tuple[str, str] | None:
    """What of a column's numbers cannot be in the unit of its name, and the cure; None where they may be."""
    import numpy as np

    there = values[np.isfinite(values)]
    if not there.size or name == "time_s":
        return None
    most = float(np.abs(there).max())
    if name.endswith("_C"):
        found = _temperature_fault(name, there)
    else:
        limit, unit = (MOST_A, "A") if name.endswith("_A") else (MOST_V, "V")
        if most <= limit or not name.endswith(("_A", "_V")):
            return None
        words = {"A": ("milliamperes", "microamperes"), "V": ("millivolts", "microvolts")}[unit]
        fitting = [(word, f"divide it by {by:.0f}") for word, by in zip(words, (1e3, 1e6), strict=True)
                   if 1e-3 * limit < most / by <= limit]  # fmt: skip
        if not fitting and most <= MOST_SIZE:
            return f"{name} reaches {most:g} {unit}, above {limit:g} {unit}", "no display on skin takes it: correct it"
        like, how = (" or ".join(each) for each in zip(*fitting, strict=True)) if fitting else ("", "")
        found = (f"{name} reaches {most:g} {unit}, above {limit:g} {unit}: it looks like {like}",
                 f"{how}, so that it is in {unit}") if fitting else None  # fmt: skip
    if most > MOST_SIZE and not found:
        return f"{name} reaches {most:g}, beyond the {MOST_SIZE:g} that any instrument gives", "leave that row out"
    return found


def _temperature_fault(name: str, there: Array) -> tuple[str, str] | None:
    import numpy as np

    middle, on_skin = float(np.median(there)), not name.startswith(("hot_plate", "probe_"))
    if COLDEST_C <= middle <= (BURNING_C if on_skin else HOTTEST_C):
        outside = (there < COLDEST_C) | (there > HOTTEST_C)
        if outside.mean() <= MOST_LEFT_OUT:
            return None
    else:
        low, high = ON_SKIN_C if on_skin else HOT_PLATE_C
        fitting = list[tuple[str, str]]()
        for unit, (factor, plus, how) in TEMPERATURES.items():
            scaled = there * factor + plus
            wrong = _errors(scaled, low, high, (low - JUMP_K, high + JUMP_K))
            kept = scaled[~wrong]
            if (
                wrong.mean() <= MOST_LEFT_OUT
                and low <= kept.min()
                and kept.max() <= high
                and np.median(kept) > MEDIAN_C
            ):
                fitting.append((f"{unit} ({number(float(kept.min()))} to {number(float(kept.max()))} °C)", how))
        if fitting:
            like, how = (" or ".join(each) for each in zip(*fitting, strict=True))
            which = ", whichever they are," if len(fitting) > 1 else ""
            return f"{name} has a median of {middle:g}: these look like {like}", f"{how}{which} to have °C"
        outside = (there < COLDEST_C) | (there > HOTTEST_C)
    if outside.any():
        first, share = float(there[np.argmax(outside)]), 100 * outside.mean()
        what = f"{name} reads {first:g} °C in {share:.0f} % of its rows: a sensor that is unplugged or shorted"
        return what, "connect it, or remove the column"
    return None


def like_units_of_time(time: Array, whole: bool = True) -> tuple[str, str] | None:
    """Units that times fit better than s, in words, and what makes s of them; None where s is likelier.

    With ``whole``, which is for times that may be s after all, they are whole numbers.

    >>> import numpy as np
    >>> like_units_of_time(np.arange(0.0, 6000.0, 100.0))
    ('milliseconds', 'divide the column by 1000')
    """
    import numpy as np

    if len(time) < 3:
        return None
    length, step = float(time[-1] - time[0]), float(np.median(np.diff(time)))
    if DAYS[0] < time[0] < DAYS[1] and 0 < length < 0.5:
        return "days, as spreadsheets count", "multiply by 86,400"
    if whole and (np.abs(time - np.round(time)) > ROUNDING).any():
        return None
    if step <= SLOWEST_S and length <= LONG_S:
        return None
    fits = [
        said
        for factor, *said in TIMES
        if FASTEST_S <= step * factor <= SLOWEST_S and SHORTEST_RUN_S <= length * factor <= LONGEST_RUN_S
    ]
    return (" or ".join(unit for unit, _ in fits), " or ".join(how for _, how in fits)) if fits else None
