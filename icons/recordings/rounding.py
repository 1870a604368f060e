"""Corner times and levels in as few decimals as a recording allows: rounding may cost as much as its noise does."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .settle import Path, settle

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .tube import Tube

    Array = NDArray[np.float64]

Corners = tuple[tuple[float, ...], tuple[float, ...]]
# Decimals of seconds, from short to exact; 0 stands for the time of the nearest reading.
_TIMES = (1, 2, 0, 3, 4, 5, 6, 9)
_READING = _TIMES.index(0)
_BESIDE = 0.02
_MOST_ROUNDS = 12


def rounded(path: Path, tube: Tube, given: bool) -> Corners:
    """Return times (s) and values of the corners of a path, rounded as far as it then stays in the tube.

    With `given`, the first value is prescribed.
    """
    cost = min(max(tube.deviation(path) / 2, tube.tolerance / 100), tube.tolerance / 5)
    path = _levels(path, tube, cost, given)
    times = _times(path, tube, cost)
    same = np.diff(path.value) == 0
    kept = np.concatenate(([True], ~(same[1:] & same[:-1]), [True]))
    return tuple(times[kept].tolist()), tuple((path.value[kept] + 0.0).tolist())


def _levels(path: Path, tube: Tube, cost: float, given: bool) -> Path:
    """Return the path with rounded levels and times that fit these."""
    finer = np.zeros(len(path.level), dtype=int)
    first = max(0, -math.floor(math.log10(tube.tolerance / 2)))
    for _ in range(_MOST_ROUNDS):
        level = [
            _level(value, first, extra, cost) for value, extra in zip(path.level.tolist(), finer.tolist(), strict=True)
        ]
        if given:
            level[path.which[0]] = float(path.value[0])
        trial = replace(path, level=np.array(level))
        settled = settle(trial, tube, levels=False)
        for made in (settled, trial):
            if tube.holds(made):
                return made
        finer[path.which[tube.at_fault(settled)]] += 1
    return path


def _level(value: float, first: int, extra: int, cost: float) -> float:
    decimals = next((n for n in range(first, first + 8) if abs(round(value, n) - value) <= cost), first + 8)
    return round(value, decimals + extra)


def _times(path: Path, tube: Tube, cost: float) -> Array:
    """Return rounded times, without the instants that steps take in the tube."""
    true, time = np.interp(path.time, tube.time, tube.recorded), tube.recorded[tube.own]
    shift = path.time - true
    slope = np.abs(np.diff(path.value) / np.diff(path.time))
    steepest = np.maximum(np.append(slope, 0), np.append(0, slope))
    after = np.clip(np.searchsorted(time, true), 1, len(time) - 1)
    gap = time[after] - time[after - 1]
    nearest = np.where(true - time[after - 1] < gap / 2, time[after - 1], time[after])
    ladder = np.stack([_decimals(true, n) if n else nearest for n in _TIMES] + [true])
    cheap = np.abs(ladder - true) * steepest <= cost
    # Beside a reading a corner is meant to be at it, however steep the piece: so a jump between two readings stays one.
    cheap[_READING] |= np.abs(nearest - true) <= _BESIDE * gap
    # How long an icon lasts is not rounded away, whatever the slope; a step stays where it was recorded.
    step = np.diff(true) == 0
    exact = np.append(step, True) | np.append(True, step)
    ladder[:, exact] = nearest[exact]
    off = np.abs(ladder - true)
    while True:
        cheap[-1] = True
        rung = cheap.argmax(axis=0)
        times = ladder[rung, np.arange(len(true))]
        made = replace(path, time=times + shift)
        finer = tube.at_fault(made)
        if (rung[finer] == len(ladder) - 1).all():
            return np.asarray(times)
        cheap[:, finer] &= off[:, finer] < off[rung[finer], finer]


def _decimals(values: Array, decimals: int) -> Array:
    return np.array([round(value, decimals) for value in values.tolist()])
