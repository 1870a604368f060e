"""The drive between the rows of a log."""

import numpy as np

from thermicon.base.numbers.arrays import Array

MOST_UPDATES, WHOLE, FINE = 1.5, 0.02, 0.25
"""Rows farther apart than 1.5 updates of the driver miss some of them; closer ones meet every update where so many
make a whole one, within this share, and where they are so close that it does not matter."""

STEEP, REPEATS = 0.05, 10
"""Rows that repeat count between steps of at least this share of the largest; so many are no chance."""

MANY_SIZES, CHANCE_ROOTS = 20, 6.0
"""Steps of more sizes are noise. Rounding lets some of them repeat: half as many as differ by the rounding, give or
take so many times the square root of how many repeat."""

SMOOTH_S = 0.2
"""Over so long a display's noise is averaged where its rate is asked."""

QUARTILE_SD = 0.3186
"""Within so many standard deviations lies a quarter of normal noise: rows that move do not count as noise."""

MAD_TO_SD = 1.4826
"""Standard deviation of normal noise over its median absolute deviation: 1/Φ⁻¹(3/4)."""


def tells_all(time_s: Array, drive: Array, update_Hz: float) -> bool:
    """Whether rows (rows,) tell every update of a driver; rows that repeat in steep stretches show another rate.

    >>> [tells_all(np.arange(9) / rate, np.arange(9.0), 80.0) for rate in (10, 40, 80, 100, 160, 1000)]
    [False, False, True, False, True, True]
    """
    share, steps = float(np.median(np.diff(time_s))) * update_Hz, np.abs(np.diff(drive))
    if share < FINE:
        return True
    steep = steps > STEEP * steps.max(initial=0.0)
    sizes, counts = np.unique(np.round(steps[1:-1][steep[:-2] & steep[2:]], 9), return_counts=True)
    repeats = int(counts[0]) if sizes.size and sizes[0] == 0.0 else 0
    by_chance = 0.5 * counts[1] if len(sizes) > MANY_SIZES else 0.0
    if repeats - by_chance >= max(REPEATS, CHANCE_ROOTS * np.sqrt(repeats)):
        return False
    if share >= 1.0 - WHOLE:
        return share <= MOST_UPDATES
    return abs(1.0 / share - round(1.0 / share)) < WHOLE / share


def off_chords(time_s: Array, values: Array) -> Array:
    """How far values are off the chord of both neighbours (rows − 2,), over what noise of SD 1 is off it, as SD."""
    share = (time_s[1:-1] - time_s[:-2]) / (time_s[2:] - time_s[:-2])
    off = values[1:-1] - (1.0 - share) * values[:-2] - share * values[2:]
    return np.asarray(off / np.sqrt(1.0 + share**2 + (1.0 - share) ** 2))


def noise_sd(time_s: Array, values: Array, resolution: float) -> float:
    """SD of what changes from row to row: off the chords, which leaves slow changes out, in the quietest rows."""
    off = np.abs(off_chords(time_s, values))
    own = float(np.quantile(off, 0.25)) / QUARTILE_SD if off.size else 0.0
    return float(max(own, resolution / np.sqrt(12.0)))


def unknown_display(time_s: Array, display_C: Array) -> Array:
    """SD (rows − 1,) of the mean of a display between two rows: the noise of both readings, and what bends there."""
    rows = np.concatenate([[2.0 * time_s[0] - time_s[1]], time_s, [2.0 * time_s[-1] - time_s[-2]]])
    bends = np.sqrt(6.0) * np.abs(off_chords(rows, np.pad(display_C, 1, mode="edge")))
    noise = noise_sd(time_s, display_C, 0.0) / np.sqrt(2.0)
    return np.asarray(np.hypot(noise, 0.125 * (bends[:-1] + bends[1:])))


def one_phase(time_s: Array, current: Array, display_C: Array) -> Array:
    """Error (rows,) of a current, as one SD, if a loop was always read at one phase of its steps.

    A step's course is as large as the step: the display's rate, against half of the greatest jump of readings.
    """
    there, step_s = np.isfinite(display_C), float(np.median(np.diff(time_s)))
    even_s = np.arange(time_s[0], time_s[-1] + step_s, step_s)
    width = max(1, round(SMOOTH_S / step_s))
    padded = np.pad(
        np.interp(even_s, time_s[there], display_C[there]), (width // 2, width - 1 - width // 2), mode="edge"
    )
    rate = np.append(np.diff(np.convolve(padded, np.full(width, 1.0), mode="valid")), 0.0)
    rate /= max(float(np.abs(rate).max()), 1e-12)
    return np.asarray(0.5 * np.abs(np.diff(current)).max() * np.interp(time_s, even_s, rate))


def means(time_s: Array, drive: Array, span_s: float) -> tuple[Array, Array]:
    """A held drive as its means over such a span or more: times and drive (fewer rows,), the last as it is.

    A row that lasts longer by itself keeps its drive.
    """
    steps = np.diff(time_s)
    begins = np.diff(np.floor((time_s[:-1] - time_s[0]) / span_s + 1e-6), prepend=-1.0) > 0
    long = steps > (1.0 + 1e-6) * span_s
    at = np.flatnonzero(np.append(begins | long, True))
    total = np.append(0.0, np.cumsum(drive[:-1] * steps))[at]
    return time_s[at], np.append(np.diff(total) / np.diff(time_s[at]), drive[-1])
