"""The shift between two clocks, from the correlation of what both recorded."""

from __future__ import annotations

import numpy as np

from ..arrays import Array

STEP_S, MOST_STEPS = 0.05, 4000
"""Raster of the search; a parabola through the best three shifts finds the rest."""

LEAST_SHARE = 0.5
"""Share of the shorter recording that must overlap."""


def best_shift_s(
    reference_s: Array, reference: Array, time_s: Array, values: Array, most_s: float = np.inf
) -> tuple[float, float]:
    """Return what to add to `time_s` so that `values` fit a reference best, and the correlation there.

    `most_s` limits the shift. NaN are left out. Where either has no number or no change, shift and correlation are 0.

    >>> time = np.arange(0.0, 30.0, 0.1)
    >>> shift, alike = best_shift_s(time, np.sin(time / 3), time, np.sin((time + 1.3) / 3), 5.0)
    >>> round(shift, 2), round(alike, 3)
    (1.3, 1.0)
    """
    there, other = np.isfinite(reference), np.isfinite(values)
    if not (there.any() and other.any()):
        return 0.0, 0.0
    reference_s, reference, time_s, values = reference_s[there], reference[there], time_s[other], values[other]
    spans = reference_s[-1] - reference_s[0], time_s[-1] - time_s[0]
    step = max(STEP_S, max(spans) / MOST_STEPS)
    a = np.interp(np.arange(reference_s[0], reference_s[-1], step), reference_s, reference)
    b = np.interp(np.arange(time_s[0], time_s[-1], step), time_s, values)
    if len(a) < 3 or len(b) < 3 or np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0, 0.0
    origin = float(reference_s[0] - time_s[0])
    fewest = int(LEAST_SHARE * min(len(a), len(b)))
    lags = np.arange(-(len(b) - fewest), len(a) - fewest + 1)
    lags = lags[np.abs(lags * step + origin) <= most_s]
    if not len(lags):
        return 0.0, 0.0
    alike = np.array([_alike(a, b, int(lag)) for lag in lags])
    best = int(np.argmax(alike))
    beyond = 0.0
    if 0 < best < len(lags) - 1:
        before, here, after = alike[best - 1 : best + 2]
        bend = before - 2 * here + after
        beyond = 0.0 if bend == 0 else float(0.5 * (before - after) / bend)
    return float((lags[best] + beyond) * step + origin), float(alike[best])


def _alike(a: Array, b: Array, lag: int) -> float:
    """Correlation of b, moved later by `lag` steps, with a, over what overlaps."""
    first, last = max(0, lag), min(len(a), len(b) + lag)
    x, y = a[first:last], b[first - lag : last - lag]
    if last - first < 3:
        return -1.0
    x, y = x - x.mean(), y - y.mean()
    size = float(np.sqrt((x @ x) * (y @ y)))
    return float(x @ y) / size if size > 0 else 0.0
