"""Samples: a designed drive as the codes of a device at its update rate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from thermicon.base.numbers.arrays import Array
from thermicon.base.words.number_text import signed

from ..rig.rig import Rig
from ..solver.drive import Drive
from ..solver.inverse import Design
from .commands import Scale
from .device import Device
from .devicefile import DeviceError

DENSEST_HZ = 10_000.0
"""From this rate on, a drive has one row per change instead of one per sample; the charge is the same."""

MOST_SAMPLES = 10_000_000
"""Samples, or switching cycles of a bridge, of one drive: with their traces they fill half a gigabyte."""

Codes = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Samples:
    """Codes (n + 1,) at `k / rate_Hz` seconds; the first is the rest, the last marks the end and is the rest again."""

    rate_Hz: float
    codes: Codes
    scale: Scale

    @property
    def time_s(self) -> Array:
        """Times in s of the samples."""
        return np.arange(len(self.codes)) / self.rate_Hz

    @property
    def command(self) -> Array:
        """Commands (n + 1,) in the unit of the scale: V, A, °C, or duty (signed, −1 … 1)."""
        return self.scale.offset + self.scale.step * self.codes.astype(np.float64)

    def rows(self) -> npt.NDArray[np.intp]:
        """Indices of the samples that get a row in a drive: all, or at a dense rate those that change and the last."""
        if self.rate_Hz <= DENSEST_HZ:
            return np.arange(len(self.codes))
        changes = np.append(True, np.diff(self.codes) != 0)
        changes[-1] = True
        return np.flatnonzero(changes)

    def until(self, end_s: float) -> Samples:
        """A copy with the last code held until a time in s."""
        more = max(0, math.ceil(end_s * self.rate_Hz - 1e-9) + 1 - len(self.codes))
        return replace(self, codes=np.append(self.codes, np.repeat(self.codes[-1], more)))


def rate_of(device: Device, requested_Hz: float, length_s: float) -> float:
    """The rate in Hz nearest to the requested one that a device plays: every k-th update, each repeated, or cycles.

    A shorter buffer means fewer samples; DeviceError where that falls below the slowest rate.
    """
    carrier = 0.0
    if device.kind.switches:
        carrier = device.most("carrier frequency")
        rate, low = carrier / math.ceil(carrier / requested_Hz - 1e-9), 0.0
    else:
        low, high = device.interval("update rate")
        rate = requested_Hz
        if low == high:
            rate = high
        elif requested_Hz > high:
            rate = requested_Hz / math.ceil(requested_Hz / high - 1e-9)
        elif requested_Hz < low:
            rate = requested_Hz * math.ceil(low / requested_Hz - 1e-9)
    most = math.inf if device.streams else device.most("buffer length")
    needed = math.ceil(length_s * rate) + 2
    if needed > most:
        rate /= math.ceil(needed / most)
    if rate < low * (1 - 1e-9) or (most < math.inf and rate * length_s < 4):
        raise DeviceError(
            f"{device.name}: {length_s:g} s at {requested_Hz:g} Hz are {needed} samples, it holds {most:g} and plays "
            f"{low:g} Hz at the slowest; shorten the icon or use another device"
        )
    _check_count(device, f"{length_s:g} s at {max(rate, carrier):g} Hz", math.ceil(length_s * max(rate, carrier)))
    return rate


def _check_count(device: Device, what: str, count: int) -> None:
    if count > MOST_SAMPLES:
        raise DeviceError(
            f"{device.name}: {what} are {count:,} samples, at most {MOST_SAMPLES:,} are computed; shorten the icon or "
            f"use a slower device"
        )


def sample(
    device: Device, rig: Rig, designed: Drive, rate_Hz: float, plates: tuple[Array, Array, Array]
) -> tuple[Samples, tuple[str, ...]]:
    """Codes of a designed drive, by its mean over each period within a device's limits, and what these hold back.

    `plates`, for a bridge: times in s, designed display in °C, and how many K hotter than designed the hot plate is.
    """
    buffer = device.record("buffer length")
    least = 0 if buffer is None or buffer.low is None else round(buffer.low) - 1
    _check_count(device, "the minimum that it plays", least)
    count = max(math.ceil(float(designed.time_s[-1]) * rate_Hz - 1e-9), least)
    edges = np.arange(count + 1) / rate_Hz
    current = np.append(_means(designed, edges), designed.current_A[0])
    cold_C, hotter_K = (np.interp(edges, plates[0], column) for column in plates[1:])
    command = device.kind.commands(device, rig, current, cold_C, hotter_K)
    warnings = []
    limit = device.most("slew rate")
    limited = _slewed(command, limit / rate_Hz)
    if np.abs(limited - command).max() > 1e-12:
        warnings.append(f"{device.name}: its slew rate of {limit:g} {device.unit}/s limits the command")
    scale = device.scale(float(np.abs(limited).max()))
    codes = np.rint((limited - scale.offset) / scale.step).astype(np.int64)
    clipped = np.clip(codes, scale.lowest, scale.highest)
    beyond = int(np.argmax(np.abs(codes - clipped)))
    if abs(codes[beyond] - clipped[beyond]) > 1:
        low, high = (signed(scale.offset + scale.step * code, ".4g") for code in (scale.lowest, scale.highest))
        warnings.append(
            f"{device.name}: {signed(limited[beyond], '.4g')} {device.unit} are needed at {edges[beyond]:.2f} s, it "
            f"gives {low} … {high}; "
            f"the command is clipped"
        )
    return Samples(rate_Hz, clipped, scale), tuple(warnings)


def within(device: Device, rig: Rig) -> Rig:
    """Return the rig with its driver limited to the currents in A of a device, unless the device has more."""
    low, high = (end * device.kind.unit_A(device, rig) for end in device.kind.ends(device))
    low, high = max(low, rig.driver.current_min_A), min(high, rig.driver.current_max_A)
    if (low, high) == (rig.driver.current_min_A, rig.driver.current_max_A):
        return rig
    return rig.with_(**{"driver.current_min_A": low, "driver.current_limit_A": high})


def led(plan: Design, end_s: float, rate_Hz: float) -> Drive:
    """The design preceded by one update of rest and followed by rest."""
    lead, drive = 1.0 / rate_Hz, plan.drive
    if drive.held:
        before_end = drive.time_s[:-1] < end_s - 1e-9
        times, currents = drive.time_s[:-1][before_end], drive.current_A[:-1][before_end]
        return Drive([0.0, *(times + lead), end_s + lead], [plan.rest_A, *currents, plan.rest_A], held=True)
    times, currents = drive.time_s + lead, drive.current_A
    return Drive([0.0, *times], [plan.rest_A, *currents])


def _means(drive: Drive, edges: Array) -> Array:
    """Mean current in A between neighbouring edges in s; exact for held and linear drives."""
    if drive.held and len(edges) == len(drive.time_s) and np.abs(edges - drive.time_s).max() < 1e-9:
        return drive.current_A[:-1].copy()
    times = np.union1d(edges, drive.time_s)
    widths = np.diff(times)
    begins = drive.at(times[:-1])
    ends = begins if drive.held else drive.at(times[1:])
    charge = np.concatenate([[0.0], np.cumsum(0.5 * (begins + ends) * widths)])
    means: Array = np.diff(np.interp(edges, times, charge)) / np.diff(edges)
    return means


def _slewed(command: Array, most: float) -> Array:
    if np.abs(np.diff(command)).max() <= most:
        return command
    reached = command.tolist()
    for k in range(1, len(reached)):
        reached[k] = min(max(reached[k], reached[k - 1] - most), reached[k - 1] + most)
    return np.array(reached)
