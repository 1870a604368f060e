"""Plausibility of a column's readings in the unit of its name.

A column's whole range decides. Every unit that fits it is listed; nothing is converted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..words.number_text import number
from .table import LARGEST

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SENSED_C = (-40.0, 150.0)
"""Outside, a sensor of a display on skin is unplugged or its wire broken."""
ON_SKIN_C, HOT_PLATE_C, MEDIAN_C = (5.0, 55.0), (5.0, 100.0), 15.0
"""Ranges of what touches skin and of other parts, in which a column of another unit must lie, and its least median."""
BURNING_C = 65.0
"""Medians of display or skin from here on would burn; 18 to 54 °C have these numbers in °F."""
POSSIBLE_C, JUMP_K = (-10.0, 60.0), 20.0
"""What touches skin is within; a reading beyond that jumps by more, from and to its neighbours, is an error."""
MOST_LEFT_OUT = 0.2
"""Larger shares of impossible readings are no single errors of a sensor."""
MOST_WILD = 0.05
"""Larger shares of readings beyond a limit are no slips, but another unit."""
LIMITS = {"A": (50.0, "milliamperes"), "V": (200.0, "millivolts")}
"""Far above what any display on skin takes, and far below what it takes in milliamperes and millivolts."""
STEPS_S, LENGTHS_S, LONG_S = (1e-4, 2.0), (1.0, 3600.0), 600.0
"""Rows and lengths of what is recorded of a display in s, and the length from which whole seconds are doubted."""
DAYS = ((30_000.0, 60_000.0), (710_000.0, 750_000.0))
"""Days to dates of today, from 1900 on, in which spreadsheets count times, and from the year 0 on, as MATLAB does."""
FASTEST_K_PER_S, FAST_K_PER_S = 500.0, 20.0
"""Beyond what any display does (the fastest contact thermodes reach 300 K/s); and what is doubted of less than 1 s."""
USUAL_A = (-3.0, 3.0)
"""Currents of displays on skin, by which a column without names is proposed."""
RESTING_C, SKIN_C = 42.0, (22.0, 40.0)
"""What touches skin does not begin above the first; medians of what counts or ohms stand for are between the others."""
NTC_OHM, NTC_B_K, FULL_COUNTS = 1e4, 3950.0, {10: 1023.0, 12: 4095.0}
"""The usual thermistor of sketches, 10 kΩ at 25 °C beside 10 kΩ (chosen by this project), and full counts by bits."""
TEMPERATURES = (
    ("kelvin", 1.0, -273.15, "subtract 273.15"),
    ("°F", 1 / 1.8, -32 / 1.8, "subtract 32 and divide by 1.8"),
    *((f"{part} of °C", by, 0.0, f"divide by {1 / by:.0f}")
      for part, by in (("tenths", 0.1), ("hundredths", 0.01), ("thousandths", 0.001))),
)  # fmt: skip


def errors(values: Array, possible: tuple[float, float], widest: tuple[float, float] = SENSED_C) -> NDArray[np.bool_]:
    """Readings that no sensor took, beyond the widest range, or by a jump beyond what is possible; none where many."""
    import numpy as np

    beyond = (values < widest[0]) | (values > widest[1])
    doubtful = (values < possible[0]) | (values > possible[1])
    sound, at = np.flatnonzero(~doubtful & np.isfinite(values)), np.flatnonzero(doubtful & ~beyond)
    if sound.size:
        after = np.searchsorted(sound, at)
        near = sound[np.maximum(after - 1, 0)], sound[np.minimum(after, sound.size - 1)]
        beyond[at] = np.min([np.abs(values[at] - values[place]) for place in near], axis=0) > JUMP_K
    few = bool(beyond.sum() <= MOST_LEFT_OUT * np.isfinite(values).sum())
    return np.asarray(beyond & few)


def unit_fault(name: str, values: Array) -> tuple[str, str] | None:
    """The numbers of a column that cannot be in the unit of its name, with a cure; None where all may be."""
    import numpy as np

    there = values[np.isfinite(values)]
    most, unit = float(np.abs(there).max(initial=0.0)), name.rpartition("_")[2]
    limit, small = LIMITS.get(unit, (np.inf, ""))
    if most > LARGEST:
        return f"{name} reaches {most:g}, beyond the {LARGEST:g} that any instrument gives", "leave that row out"
    if 0 < (beyond := np.abs(there) > limit).sum() <= MOST_WILD * len(there):
        wild = there[np.argmax(np.abs(there))]
        what = f"{name} is {wild:g} {unit} in {beyond.sum()} of {len(there):,} rows"
        return what, f"no display takes more than {limit:g} {unit}: correct these cells, or leave them empty"
    if most > limit:
        what = f"{name} reaches {most:g} {unit}, above {limit:g} {unit}: it looks like {small}"
        return what, f"divide it by 1000, so that it is in {unit}"
    return _temperature_fault(name, there) if unit == "C" and there.size else None


def _temperature_fault(name: str, there: Array) -> tuple[str, str] | None:
    import numpy as np

    if found := _like_a_thermistor(name, there):
        return found
    middle, on_skin = float(np.median(there)), not name.startswith(("hot_plate", "probe_"))
    outside = (there < SENSED_C[0]) | (there > SENSED_C[1])
    low, high = ON_SKIN_C if on_skin else HOT_PLATE_C
    plausible = SENSED_C[0] <= middle <= (BURNING_C if on_skin else SENSED_C[1])
    fits = list[tuple[str, str]]()
    for unit, factor, plus, cure in () if plausible else TEMPERATURES:
        scaled = there * factor + plus
        kept = scaled[~errors(scaled, (low, high), (low - JUMP_K, high + JUMP_K))]
        resting = RESTING_C if on_skin else high
        if low <= kept.min() and kept.max() <= high and np.median(kept) > MEDIAN_C and kept[0] <= resting:
            fits.append((f"{unit} ({number(float(kept.min()))} to {number(float(kept.max()))} °C)", cure))
    if fits:
        like, how = (" or ".join(each) for each in zip(*fits, strict=True))
        cure = f"{how}{', whichever they are,' if len(fits) > 1 else ''} to have °C"
        return f"{name} has a median of {middle:g}: these look like {like}", cure
    if not outside.any() or (plausible and outside.mean() <= MOST_LEFT_OUT):
        return None
    what = f"{name} reads {there[np.argmax(outside)]:g} °C in {100 * outside.mean():.0f} % of its rows"
    return f"{what}: a sensor that is unplugged or shorted", "connect it, or remove the column"


def _like_a_thermistor(name: str, there: Array) -> tuple[str, str] | None:
    """Readings of a column that are counts of a converter or ohms, where a usual thermistor has skin's temperatures."""
    import numpy as np

    whole, fits = bool((there == np.round(there)).all() and there.min() > 0), list[str]()
    resistances = {"ohms of a thermistor of 10 kΩ": there} if there.min() > 2000 else {}
    for bits, full in FULL_COUNTS.items() if whole and there.min() > 100 else ():
        if there.max() < full:
            below = NTC_OHM * there / (full - there)
            resistances[f"counts of a converter ({bits} bit, thermistor of 10 kΩ below 10 kΩ)"] = below
            resistances[f"counts of a converter ({bits} bit, thermistor of 10 kΩ above 10 kΩ)"] = NTC_OHM**2 / below
    for words, ohm in resistances.items():
        level = 1 / (1 / 298.15 + np.log(ohm / NTC_OHM) / NTC_B_K) - 273.15
        if ON_SKIN_C[0] <= level.min() and level.max() <= ON_SKIN_C[1] and SKIN_C[0] <= np.median(level) <= SKIN_C[1]:
            fits.append(
                f"{words}, {number(float(level.min()))} to {number(float(level.max()))} °C with B {NTC_B_K:g} K"
            )
    tenths = [f"{part} of °C" for part, by in (("tenths", 0.1), ("hundredths", 0.01), ("thousandths", 0.001))
              if SKIN_C[0] <= by * np.median(there) <= SKIN_C[1]]  # fmt: skip
    if not fits or tenths:
        return None
    return f"{name} has a median of {np.median(there):g}: these look like {' or '.join(fits)}", "convert them to °C"


def is_days(time: Array) -> bool:
    """Whether times are days, as spreadsheets and MATLAB count them, of less than half a day."""
    length = float(time[-1] - time[0]) if len(time) > 1 else 0.0
    return 0 < length < 0.5 and any(low < time[0] < high for low, high in DAYS)


def too_fast(name: str, time: Array, values: Array, stated: float) -> tuple[bool, str, str] | None:
    """Whether a course is faster than any display, or doubtful, what it shows and what to do; None where it is neither.

    `stated` is the unit of the column of times in s, as its name says.
    """
    import numpy as np

    there = np.isfinite(values)
    time, values = time[there], values[there]
    if len(time) < 3 or time[-1] - time[0] >= LENGTHS_S[0]:
        return None
    apart = abs(float(time[np.argmax(values)] - time[np.argmin(values)]))
    rate = float(np.ptp(values)) / apart if apart else 0.0
    if rate < FAST_K_PER_S:
        return None
    fits = [each for each in (("seconds", 1.0), ("minutes", 60.0), ("hours", 3600.0))
            if each[1] > stated and rate * stated / each[1] < FAST_K_PER_S
            and (time[-1] - time[0]) * each[1] / stated <= LENGTHS_S[1]]  # fmt: skip
    what = f"{name} changes by {rate:,.0f} K/s within {time[-1] - time[0]:.3g} s, by the times as they are read"
    like = (
        f"if these are {fits[0][0]}, call their column time ({fits[0][0]})" if fits else "check the unit of the times"
    )
    return rate > FASTEST_K_PER_S, what, like


def like_units_of_time(time: Array, whole: bool = True) -> tuple[str, str] | None:
    """Units that times fit better than s, and what makes s of them; with ``whole``, of whole numbers alone."""
    import numpy as np

    if len(time) < 2 + whole:
        return None
    length, step = float(time[-1] - time[0]), float(np.median(np.diff(time)))
    if is_days(time):
        return "days, as spreadsheets count", "multiply by 86,400"
    if (whole and (np.abs(time - np.round(time)) > 1e-6).any()) or (step <= STEPS_S[1] and length <= LONG_S):
        return None
    fits = [
        (f"{part}seconds", f"divide the column by {by}")
        for part, by, size in (("milli", "1000", 1e-3), ("micro", "1,000,000", 1e-6), ("nano", "1,000,000,000", 1e-9))
        if STEPS_S[0] <= step * size <= STEPS_S[1] and LENGTHS_S[0] <= length * size <= LENGTHS_S[1]
    ]
    return (" or ".join(like for like, _ in fits), " or ".join(how for _, how in fits)) if fits else None
