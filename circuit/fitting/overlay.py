"""A measured log on the clock of a simulated trace."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..solver.trace import Trace
from .forward import Prediction, predict, started
from .keys import FitError
from .log import Log, LogError
from .problem import FitProblem
from .runs import Channel, Run

SHIFTED_BY = ("display_C", "skin_C", "voltage_V", "current_A", "hot_plate_C")
"""Columns that a shift is found from, the best first."""


STEPS = 4000
"""Raster of the search, in the longer recording; a parabola through the best three shifts finds the rest."""

LEAST_SHARE, NOTHING = 0.5, 1e-12
"""Share of the shorter recording that must overlap; products of changes that are none."""


@dataclass(frozen=True, slots=True, eq=False)
class OverlaidColumn:
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
        return float(self.difference[self._worst])

    @property
    def largest_s(self) -> float:
        """Time in s of the largest difference."""
        return float(self.time_s[self._worst])

    @property
    def _worst(self) -> int:
        return int(np.argmax(np.abs(self.difference)))


@dataclass(frozen=True, slots=True, eq=False)
class Overlay:
    """A log beside a trace: what was added to its times in s, and every column that both have."""

    name: str
    shift_s: float
    columns: tuple[OverlaidColumn, ...]

    def __repr__(self) -> str:
        parts = [f"{item.column} rms {item.rms:.2g}, largest {item.largest:+.2g}" for item in self.columns]
        return f"Overlay({self.name!r}, shifted by {self.shift_s:.3f} s: {'; '.join(parts)})"


def overlay(trace: Trace, log: Log, *, shift_s: float | None = None) -> Overlay:
    """Lay a log beside a trace, shifted by `shift_s` or to be most alike; LogError where nothing is in common."""
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
    # Seconds since 1970 are off by 0.2 µs: such a log must not lose its first or last row.
    rounding = max(1e-9, 2.0 * float(np.spacing(np.abs(log.time_s).max() + abs(shift_s))))
    inside = (time >= trace.time_s[0] - rounding) & (time <= trace.time_s[-1] + rounding)
    columns = []
    for name in common:
        rows = inside & np.isfinite(log.column(name))
        if rows.sum() > 1:
            expected = np.interp(time[rows], trace.time_s, simulated[name])
            columns.append(OverlaidColumn(name, time[rows], log.column(name)[rows], expected))
    if not columns:
        raise LogError(
            f"{log.name}: no row at a time of the trace, {trace.time_s[0]:g} to {trace.time_s[-1]:g} s, with a shift "
            f"of {shift_s:g} s; check time_s"
        )
    return Overlay(log.name, float(shift_s), tuple(columns))


def best_shift_s(reference_s: Array, reference: Array, time_s: Array, values: Array) -> tuple[float, float]:
    """Time to add to `time_s` for the best fit to a reference, with the correlation; 0 where nothing changes."""
    there, other = np.isfinite(reference), np.isfinite(values)
    if not (there.any() and other.any()):
        return 0.0, 0.0
    reference_s, reference, time_s, values = reference_s[there], reference[there], time_s[other], values[other]
    step = max(reference_s[-1] - reference_s[0], time_s[-1] - time_s[0]) / STEPS
    a = np.interp(np.arange(reference_s[0], reference_s[-1], step), reference_s, reference)
    b = np.interp(np.arange(time_s[0], time_s[-1], step), time_s, values)
    if len(a) < 3 or len(b) < 3 or np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0, 0.0
    origin = float(reference_s[0] - time_s[0])
    fewest = int(LEAST_SHARE * min(len(a), len(b)))
    lags = np.arange(-(len(b) - fewest), len(a) - fewest + 1)
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
    x, y = x - x.mean(), y - y.mean()
    return float(x @ y) / max(float(np.sqrt((x @ x) * (y @ y))), NOTHING)


STUCK_S, STUCK_STEPS = 3.0, 20.0
"""A sensor that reads one value for 3 s while it should move by 20 of its steps is stuck."""

MOVES = {True: 0.5, False: 0.3}
"""Change in K or V below which nothing can be said about a sensor."""

FLAT_SHARE, REVERSED = 0.05, -0.5
"""A sensor that moves by less than 5 % of what is expected is not on the display; below a correlation of −0.5 a sign is
wrong."""

MOST_DRIFT = 2e-3
"""Clocks of loggers differ by some 100 ppm; 2 ms a second is a wrong sample rate."""

LEAST_OVERLAP = 0.5
"""Share of the rows of a further clock that must lie within the run, once it is shifted."""


def aligned(rig: Rig, runs: Sequence[Run]) -> tuple[Run, ...]:
    """Runs with the shift of every further clock, by correlation; FitError or LogError where that is not possible."""
    out = []
    for each in runs:
        run = started(rig, each)
        try:
            found = predict(rig, run)
        except RigError as fault:
            raise FitError(f"{run.name}: cannot be played on the rig to begin with: {fault}") from None
        out.append(replace(run, shifts=tuple(_shift_s(run, found, clock) for clock in range(1, len(run.clocks) + 1))))
    return tuple(out)


def _shift_s(run: Run, found: Prediction, clock: int) -> float:
    best, inside = (0.0, 0.0), 0.0
    for channel in run.channels:
        if channel.clock == clock:
            time, reference = channel.time_s - run.begin_s, found.at(channel.column, run.time_s)
            best = max(best, best_shift_s(run.time_s, reference, time, channel.values), key=lambda pair: pair[1])
            inside = float(np.mean((time + best[0] >= 0) & (time + best[0] <= run.time_s[-1])))
    if best[1] <= 0 or inside < LEAST_OVERLAP:
        raise LogError(
            f"{run.clocks[clock - 1]}: does not fit in time to {run.name}, which lasts {run.time_s[-1]:g} s: no shift "
            f"makes the two alike; check that both are from the same run"
        )
    return best[0]


def check_sensors(problem: FitProblem) -> None:
    """Raise LogError for every sensor that is stuck, unplugged or of the wrong sign, as the rig to begin with says."""
    found = problem.simulated(problem.first)
    faults = [
        f"{channel.file}: {fault}"
        for r, c, channel in problem.channels()
        if (fault := _sensor_fault(channel, problem.run_time_s(problem.first, r, channel),
                                   problem.modelled(problem.first, r, c, found[r])))
    ]  # fmt: skip
    if faults:
        raise LogError("\n".join(faults))


def _sensor_fault(channel: Channel, time: Array, expected: Array) -> str | None:
    unit = "K" if channel.temperature else "V"
    ends = np.flatnonzero(np.diff(channel.values) != 0.0)
    starts, stops = np.append(0, ends + 1), np.append(ends, len(time) - 1)
    longest = int(np.argmax(time[stops] - time[starts]))
    first, last = int(starts[longest]), int(stops[longest])
    expected_range = float(np.ptp(expected[first : last + 1]))
    if time[last] - time[first] >= STUCK_S and expected_range > max(
        MOVES[channel.temperature], STUCK_STEPS * channel.resolution
    ):
        return (
            f"{channel.column} reads {channel.values[first]:g} from {time[first]:.4g} to {time[last]:.4g} s without "
            f"any change, while the rig changes by {expected_range:.2g} {unit}: the sensor is stuck or unplugged; "
            f"empty these cells, or remove the column"
        )
    span = float(np.ptp(expected))
    if span < MOVES[channel.temperature]:
        return None
    spread = float(np.subtract(*np.percentile(channel.values, [95, 5])))
    expected_spread = float(np.subtract(*np.percentile(expected, [95, 5])))
    if spread < FLAT_SHARE * expected_spread:
        return (
            f"{channel.column} changes by {spread:.2g} {unit} where the rig changes by {expected_spread:.2g} {unit}: "
            f"the sensor is unplugged, or not where the column says"
        )
    if np.corrcoef(channel.values, expected)[0, 1] < REVERSED:
        return (
            f"{channel.column} goes the other way than the rig: positive current cools the display; turn the sign of "
            f"the drive, or of the column"
        )
    return None


def check_clocks(problem: FitProblem, theta: Array) -> None:
    """Raise LogError for a clock that runs at another rate than that of the drive."""
    for r, run in enumerate(problem.runs):
        for clock, name in enumerate(run.clocks, 1):
            drift = problem.nuisance(theta, "drift", r, clock)
            if abs(drift) > MOST_DRIFT:
                word = "slow" if drift > 0 else "fast"
                raise LogError(
                    f"{name}: its clock drifts, {abs(drift) * 100:.2g} % {word} against {run.name}; correct its "
                    f"sample rate, or multiply time_s by {1 + drift:.5f}"
                )
