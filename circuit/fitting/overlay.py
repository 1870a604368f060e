"""A measured log laid beside a simulated trace, on the trace's clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..solver.trace import Trace
from .log import Log, LogError

SHIFTED_BY = ("display_C", "skin_C", "voltage_V", "current_A", "hot_plate_C")
"""Columns that a shift is found from, the best first."""


STEP_S, MOST_STEPS = 0.05, 4000
"""Raster of the search; a parabola through the best three shifts finds the rest."""

LEAST_SHARE = 0.5
"""Share of the shorter recording that must overlap."""


@dataclass(frozen=True, slots=True, eq=False)
class Beside:
    """One column beside a simulation: `time_s` on its clock, `measured` and `simulated` (rows,)."""

    column: str
    time_s: Array
    measured: Array
    simulated: Array

    @property
    def difference(self) -> Array:
        """Measured minus simulated (rows,)."""
        return self.measured - self.simulated

    @property
    def rms(self) -> float:
        """Root mean square of the differences."""
        return float(np.sqrt(np.mean(self.difference**2)))

    @property
    def largest(self) -> float:
        """The difference of largest size, with its sign."""
        return float(self.difference[int(np.argmax(np.abs(self.difference)))])

    @property
    def largest_s(self) -> float:
        """Time in s of the largest difference."""
        return float(self.time_s[int(np.argmax(np.abs(self.difference)))])


@dataclass(frozen=True, slots=True, eq=False)
class Overlay:
    """A log beside a trace.

    Attributes
    ----------
    name
        Name of the log.
    shift_s
        What was added to its times, in s.
    columns
        Every column that both have.
    """

    name: str
    shift_s: float
    columns: tuple[Beside, ...]

    def __repr__(self) -> str:
        parts = [f"{item.column} rms {item.rms:.2g}, largest {item.largest:+.2g}" for item in self.columns]
        return f"Overlay({self.name!r}, shifted by {self.shift_s:.3f} s: {'; '.join(parts)})"


def overlay(trace: Trace, log: Log, *, shift_s: float | None = None) -> Overlay:
    """Lay a log beside a trace."""
    simulated = {name: getattr(trace, name) for name in SHIFTED_BY} | {f"probe_{n}_C": v for n, v in trace.probes}
    common = [name for name, _ in log.columns if name in simulated and np.isfinite(simulated[name]).any()]
    if not common:
        raise LogError(
            f"{log.name}: no column in common with the trace of {trace.icon or 'the drive'}; the log has "
            f"{', '.join(dict(log.columns))}"
        )
    if shift_s is None:
        lead = min(common, key=lambda name: SHIFTED_BY.index(name) if name in SHIFTED_BY else len(SHIFTED_BY))
        shift_s = best_shift_s(trace.time_s, simulated[lead], log.time_s, log.column(lead))[0]
    time = log.time_s + shift_s
    inside = (time >= trace.time_s[0] - 1e-9) & (time <= trace.time_s[-1] + 1e-9)
    columns = []
    for name in common:
        rows = inside & np.isfinite(log.column(name))
        if rows.sum() > 1:
            expected = np.interp(time[rows], trace.time_s, simulated[name])
            columns.append(Beside(name, time[rows], log.column(name)[rows], expected))
    if not columns:
        raise LogError(
            f"{log.name}: no row at a time of the trace, {trace.time_s[0]:g} to {trace.time_s[-1]:g} s, with a shift "
            f"of {shift_s:g} s; check time_s"
        )
    return Overlay(log.name, float(shift_s), tuple(columns))


def best_shift_s(
    reference_s: Array, reference: Array, time_s: Array, values: Array, most_s: float = np.inf
) -> tuple[float, float]:
    """Return what to add to `time_s` so that `values` fit a reference best, and the correlation there.

    `most_s` limits the shift. NaN are left out. Where either has no number or no change, shift and correlation are 0.
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
