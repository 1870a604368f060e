"""Logs checked against the simulation: stuck and unplugged sensors, signs, clocks that do not fit or drift."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from .log import LogError
from .overlay import best_shift_s
from .problem import Problem
from .runs import Channel

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

SHIFT_ROOM_S = 5.0
"""How far a clock may still move from where the correlation puts it."""


def aligned(problem: Problem) -> Problem:
    """Return the problem with a first guess of the shift of every further clock, by correlation with the simulation.

    Raises LogError for a file whose rows hardly overlap with its run.
    """
    found = problem.predictions(problem.first)
    if found is None:
        return problem
    unknowns = list(problem.unknowns)
    for place, item in enumerate(unknowns):
        if item.kind != "shift":
            continue
        run = problem.runs[item.run]
        channels = [channel for channel in run.channels if channel.clock == item.place]
        best = (0.0, -1.0)
        for channel in channels:
            reference = found[item.run].at(channel.column, run.time_s)
            shift, alike = best_shift_s(run.time_s, reference, channel.time_s - run.begin_s, channel.values)
            best = max(best, (shift, alike), key=lambda pair: pair[1])
        unknowns[place] = replace(item, first=best[0], low=best[0] - SHIFT_ROOM_S, high=best[0] + SHIFT_ROOM_S)
        name = run.clocks[item.place - 1]
        time = channels[0].time_s - run.begin_s + best[0] if channels else np.zeros(0)
        inside = (time >= 0) & (time <= run.time_s[-1])
        if not channels or best[1] <= 0 or inside.mean() < LEAST_OVERLAP:
            raise LogError(
                f"{name}: does not fit in time to {run.name}, which lasts {run.time_s[-1]:g} s: no shift makes the two "
                f"alike; check that both are from the same run"
            )
    return replace(problem, unknowns=tuple(unknowns))


def check_sensors(problem: Problem) -> None:
    """Raise LogError for every sensor that is stuck, unplugged or of the wrong sign, as the rig to begin with says."""
    found = problem.predictions(problem.first)
    if found is None:
        return
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


def check_clocks(problem: Problem, theta: Array) -> None:
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
