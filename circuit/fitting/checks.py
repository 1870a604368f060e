"""Logs checked against the simulation before and after a fit: stuck and unplugged sensors, signs, clocks that drift."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from .alignment import best_shift_s
from .log import LogError
from .problem import FREE_START, STEADY_BEFORE, Problem
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

MOST_UPDATES = 1.5
"""Rows farther apart than 1.5 updates of the driver miss some of them."""

EARLY_S, EARLY_TIMES, EARLY_NOISE = 2.0, 1.2, 5.0
"""A start that is not steady shows in the first seconds: residuals well above noise, and above those of the rest."""

OFFSET_SDS = 3.0
"""A sensor that is off by more than this many standard deviations of OFFSET_SD_K is named."""

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
    first, low, high = problem.first.copy(), problem.low.copy(), problem.high.copy()
    for place, item in enumerate(problem.nuisances, len(problem.keys)):
        if item.kind != "shift":
            continue
        run = problem.runs[item.run]
        channels = [channel for channel in run.channels if channel.clock == item.place]
        best = (0.0, -1.0)
        for channel in channels:
            reference = found[item.run].at(channel.column, run.time_s)
            shift, alike = best_shift_s(run.time_s, reference, channel.time_s - run.begin_s, channel.values)
            best = max(best, (shift, alike), key=lambda pair: pair[1])
        first[place] = best[0]
        low[place], high[place] = best[0] - SHIFT_ROOM_S, best[0] + SHIFT_ROOM_S
        name = run.clocks[item.place - 1]
        time = channels[0].time_s - run.begin_s + best[0] if channels else np.zeros(0)
        inside = (time >= 0) & (time <= run.time_s[-1])
        if not channels or best[1] <= 0 or inside.mean() < LEAST_OVERLAP:
            raise LogError(
                f"{name}: does not fit in time to {run.name}, which lasts {run.time_s[-1]:g} s: no shift makes the two "
                f"alike; check that both are from the same run"
            )
    return replace(problem, first=first, low=low, high=high)


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


def remarks(problem: Problem, theta: Array, *, misfit: bool = False) -> tuple[str, ...]:
    """Sentences on slow drives, starts that were not steady, sensors that are off, and shifted clocks.

    With a `misfit`, an offset is a consequence of what is wrong elsewhere rather than a fault of the sensor.
    """
    sentences = [*_slow_drives(problem), *unsteady(problem, theta)]
    sentences += [_offset(channel, offset, problem.offset_sd_K, misfit) for channel, offset in far_off(problem, theta)]
    for r, run in enumerate(problem.runs):
        if problem.start_count == STEADY_BEFORE and (change := problem.nuisance(theta, "start", r, 0)):
            sentences.append(
                f"{run.name}: the first row's drive has just begun; the start is taken as steady under "
                f"{abs(change):.2f} A {'less' if change < 0 else 'more'}"
            )
        for clock, name in enumerate(run.clocks, 1):
            shift = problem.nuisance(theta, "shift", r, clock)
            drift = problem.nuisance(theta, "drift", r, clock)
            sentences.append(
                f"{name}: its clock was shifted by {shift:.3f} s against {run.name}, and drifts by "
                f"{drift * 1e6:.0f} parts per million".replace("-", "−")
            )
    return tuple(sentences)


def far_off(problem: Problem, theta: Array) -> list[tuple[Channel, float]]:
    """Sensors that are off by more than they are assumed to be, with the offset in K."""
    offsets = [(channel, problem.nuisance(theta, "offset", r, c)) for r, c, channel in problem.channels()]
    return [(channel, offset) for channel, offset in offsets if abs(offset) > OFFSET_SDS * problem.offset_sd_K > 0]


def _offset(channel: Channel, offset_K: float, usual_K: float, misfit: bool) -> str:
    size = f"{offset_K:+.2f} K".replace("-", "−")
    usual = f"more than the {usual_K:g} K (SD) that sensors are assumed to be"
    if not misfit:
        return f"{channel.file}: {channel.column} reads {size} off, {usual}; calibrate it"
    return (
        f"{channel.file}: {channel.column} is fitted with an offset of {size}, {usual}; since the rig does not match "
        f"the log, the offset may stand for what the rig has wrong: mend that before you doubt the sensor"
    )


def _slow_drives(problem: Problem) -> list[str]:
    """Logs slower than the driver: what it did between the rows is not known."""
    sentences = []
    for run in problem.runs:
        step, update = float(np.median(np.diff(run.time_s))), 1.0 / problem.rig.update_Hz
        if run.driven_by != "display_C" and step > MOST_UPDATES * update:
            sentences.append(
                f"{run.name}: rows are {1e3 * step:.0f} ms apart, and the rig's driver may change every "
                f"{1e3 * update:.0f} ms: what it did in between is not in the log; log the drive at its own rate"
            )
    return sentences


def unsteady(problem: Problem, theta: Array) -> list[str]:
    """Runs whose first seconds fit much worse than the rest."""
    found = problem.predictions(theta)
    if found is None or problem.start_count == FREE_START:
        return []
    names = []
    for r, c, channel in problem.channels():
        residual = np.abs(problem.modelled(theta, r, c, found[r]) - channel.values)
        time = problem.run_time_s(theta, r, channel)
        early = residual[(time >= 0) & (time < EARLY_S)]
        noise = float(np.median(np.abs(np.diff(channel.values)))) + channel.resolution
        most = max(EARLY_TIMES * float(np.median(residual)), EARLY_NOISE * noise, 1e-3)
        if channel.temperature and early.size and np.median(early) > most:
            names.append(problem.runs[r].name)
    return [
        f"{name}: the first {EARLY_S:g} s fit much worse than the rest: the rig was not steady at the first row; use "
        f"--fit-start (fit_start=True), or log a few seconds of rest first"
        for name in dict.fromkeys(names)
    ]
