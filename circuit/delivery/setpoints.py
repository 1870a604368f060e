"""Set-points for a thermode: the designed display as straight segments.

The rig is not involved: a thermode measures its own surface and corrects it.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..solver.displayed import part_of
from ..solver.modes import shown
from .device import Device
from .devicefile import DeviceError

MOST_SEGMENTS = 1_000_000
"""Segments computed at most, before the device's own limit is applied."""

CLOSING_K_PER_S = 1.0
"""Rate at which a display returns to its baseline after a cue: a tenth of the limit on the rate of skin, so that a cue
is never refused for it."""


@dataclass(frozen=True, slots=True)
class Setpoints:
    """Segments after a baseline: ticks, and the level at their end in steps; the last `closing` lead back to it."""

    tick_s: float
    step_K: float
    baseline: int
    segments: tuple[tuple[int, int], ...]
    closing: int = 0

    @property
    def time_s(self) -> Array:
        """Corners' times in s, from 0."""
        return np.concatenate([[0], np.cumsum([ticks for ticks, _ in self.segments])]) * self.tick_s

    @property
    def cue_s(self) -> float:
        """Time in s at which the cue ends and the return to the baseline begins."""
        return float(self.time_s[len(self.segments) - self.closing])

    @property
    def level_C(self) -> Array:
        """Corners' temperatures in °C, the baseline first."""
        return np.array([self.baseline, *(level for _, level in self.segments)]) * self.step_K

    def at(self, time_s: Array) -> Array:
        """Set-point in °C at times in s; before and after, the ends."""
        return np.asarray(np.interp(time_s, self.time_s, self.level_C), dtype=np.float64)


def closed(device: Device, setpoints: Setpoints) -> Setpoints:
    """Set-points with a ramp back to the baseline, where the next play begins; DeviceError for too many segments."""
    last = setpoints.segments[-1][1]
    away_K = abs(last - setpoints.baseline) * setpoints.step_K
    ticks = math.ceil(away_K / min(CLOSING_K_PER_S, device.most("ramp rate")) / setpoints.tick_s - 1e-9)
    count = -(-ticks // int(device.most("segment length")))
    ends = [ticks * (k + 1) // count for k in range(count)]
    levels = [round(last + (setpoints.baseline - last) * end / ticks) for end in ends]
    added = tuple((end - begin, level) for (begin, end), level in zip(pairwise([0, *ends]), levels, strict=True))
    most = int(device.most("segments"))
    if added and len(setpoints.segments) + count > most:
        raise DeviceError(
            f"{device.name}: {len(setpoints.segments) + count} segments are needed with the return to baseline; "
            f"it takes {most}; shorten the icon, or let it return by itself"
        )
    return replace(setpoints, segments=(*setpoints.segments, *added), closing=len(added))


def setpoints_of(device: Device, time_s: Array, level_C: Array, curve: bool) -> Setpoints:
    """Segments of a line through corners; a `curve` is simplified to within half a step, or as coarsely as is needed.

    Raises DeviceError where baseline, level or number of segments is beyond the device.
    """
    step, tick = device.most("set-point step"), device.most("tick")
    check_level("baseline", float(level_C[0]), device.interval("baseline range"), device)
    for level in (float(level_C.min()), float(level_C.max())):
        check_level("set-point", level, device.interval("set-point range"), device)
    most, tolerance = int(device.most("segments")), 0.5 * step
    while True:
        ends, room = [0, len(time_s) - 1], np.ones(len(time_s))
        rows = _cuts(time_s, level_C, room, ends, tolerance) if curve else range(len(time_s))
        segments = _segments(device, [float(time_s[k]) for k in rows], [float(level_C[k]) for k in rows])
        if len(segments) <= most:
            return Setpoints(tick, step, round(float(level_C[0]) / step), segments)
        if not curve:
            raise DeviceError(
                f"{device.name}: {len(segments)} segments are needed, it takes {most}; shorten the icon, or use fewer "
                f"repeats or a coarser wave"
            )
        tolerance *= 2


def _cuts(time: Array, value: Array, room: Array, ends: list[int], limit: float) -> list[int]:
    """Places between whose chords no value is more than `limit` of its room off, from `ends` (Douglas & Peucker 1973).

    Time goes with values times cuts at the worst.
    """
    cuts, pieces = set(ends), list(pairwise(ends))
    while pieces:
        first, last = pieces.pop()
        inner, both = slice(first + 1, last), [first, last]
        off = np.abs(value[inner] - np.interp(time[inner], time[both], value[both])) / room[inner]
        if off.size and off.max() > limit:
            cut = first + 1 + int(off.argmax())
            cuts.add(cut)
            pieces += [(first, cut), (cut, last)]
    return sorted(cuts)


def lag_of(device: Device) -> float:
    """Return the lag in s by which a thermode's surface follows its set-points; 0 where it states none."""
    record = device.record("lag")
    return 0.0 if record is None else record.central


def display_of(
    setpoints: Setpoints, device: Device, *, lagged: bool, end_s: float | None = None
) -> tuple[float, Array]:
    """A step in s, a whole part of the tick, and the display (rows,) in °C at every step until `end_s`.

    The ramp rate limits it; without `lagged` it is as fast as the device can make it, which is worse for the skin.
    """
    step = part_of(setpoints.tick_s)
    end = float(setpoints.time_s[-1]) if end_s is None else end_s
    times: Array = np.arange(math.ceil(end / step - 1e-9) + 1, dtype=np.float64) * step
    lag = lag_of(device) if lagged else 0.0
    return step, shown(setpoints.at(times), step, lag, device.most("ramp rate"))


def _segments(device: Device, times: list[float], levels: list[float]) -> tuple[tuple[int, int], ...]:
    step, tick = device.most("set-point step"), device.most("tick")
    fastest, longest = device.most("ramp rate"), int(device.most("segment length"))
    begin, before = 0, round(levels[0] / step)
    segments: list[tuple[int, int]] = []
    for time, level in zip(times[1:], levels[1:], strict=True):
        goal = round(level / step)
        least = max(1, math.ceil(abs(goal - before) * step / fastest / tick - 1e-9))
        until = max(round(time / tick), begin + least)  # what a ramp is late, the next segment makes up for
        count = -(-(until - begin) // longest)
        if len(segments) + count > MOST_SEGMENTS:
            raise DeviceError(
                f"{device.name}: more than {MOST_SEGMENTS:,} segments of at most {longest} ticks of {tick:g} s are "
                f"needed; shorten the icon, or use another device"
            )
        ends = [begin + (until - begin) * (k + 1) // count for k in range(count)]
        for end in ends:
            share = (end - begin) / (until - begin)
            segments.append((end, round(before + (goal - before) * share)))
        begin, before = until, goal
    ticks = [end - start for start, end in pairwise([0, *(end for end, _ in segments)])]
    return tuple((length, level) for length, (_, level) in zip(ticks, segments, strict=True))


def check_level(what: str, level: float, limits: tuple[float, float], device: Device) -> None:
    """Raise DeviceError for a level in °C beyond limits of a device."""
    if not limits[0] - 1e-9 <= level <= limits[1] + 1e-9:
        raise DeviceError(
            f"{device.name}: a {what} of {level:.4g} °C is beyond {limits[0]:g} … {limits[1]:g} °C; change the icon, "
            f"or use another device"
        )
