"""The rounding of a log's drive and clock as errors that rows share.

A current that was rounded, or that began a little earlier than its row says, leaves heat in the plates which all later
rows read: far below the noise of one row, and alike in thousands, so that it would pass for another rig. So does a rest
whose drive is only known as the mean of some noisy rows.
"""

from collections.abc import Sequence

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from .between import noise_sd
from .forward import steady_rows
from .problem import FitProblem
from .runs import DISPLAY, Run
from .whiten import responses

UNIFORM_SD = 12.0**-0.5
"""Standard deviation of what was rounded, in steps of the rounding."""

FINEST_S, WHOLE, UNEVEN = 1e-6, 1e-3, 0.1
"""Steps of a clock are told to a µs. Even rows have steps of whole multiples of the least, to within this share of it,
and few of them differ from the step before: some rows may be missing, and the rate may change."""

FEWEST_LEVELS = 50
"""Fewer different values were set, not rounded: a drive of steps has them as they are."""

FEWEST_OF_REST = 10
"""The noise of a rest of fewer rows is that of the whole drive."""

CELL_S = 0.01
"""Rows and their errors are taken as lying in the middle of cells so long, as responses do."""


def clock_step_s(time_s: Array) -> float:
    """Return what times (rows,) in s were rounded to, 0 where rows are even.

    >>> [round(clock_step_s(np.array(times)), 6) for times in ([0, 0.01, 0.02], [0, 0.01, 0.021], [0, 0.02, 0.05])]
    [0.0, 0.001, 0.01]
    """
    steps_s = np.maximum(np.round(np.diff(time_s) / FINEST_S), 1.0) * FINEST_S
    sizes_s = np.unique(steps_s)
    multiples = sizes_s / sizes_s[0]
    whole = np.abs(multiples - np.round(multiples)).max() < WHOLE
    if whole and np.mean(np.diff(steps_s) != 0.0) < UNEVEN:
        return 0.0
    return float(np.diff(sizes_s).min())


def level_step(drive: Array) -> float:
    """Return what a drive (rows,) was rounded to, 0 where it has few values, which were set."""
    levels = np.unique(np.round(drive, 9))
    return float(np.diff(levels).min()) if len(levels) >= FEWEST_LEVELS else 0.0


def rounding(problem: FitProblem, theta: Array, jacobian: Array, sigma: Sequence[float]) -> Array:
    """What rounding adds to the products (unknowns, unknowns) of residuals' derivatives, where the drive is known."""
    total = np.zeros((len(theta), len(theta)))
    ends = np.cumsum([len(channel.values) for _, _, channel in problem.channels()])
    derivatives = np.split(jacobian, ends)[:-1]
    place = 0
    for number, run in enumerate(problem.runs):
        mine = slice(place, place + len(run.channels))
        place += len(run.channels)
        if run.driven_by == DISPLAY or run.unknown is not None:
            continue
        times = [problem.run_time_s(theta, number, channel) for channel in run.channels]
        after_step = responses(problem.rig, run)[1]
        scaled = [rows / sd for rows, sd in zip(derivatives[mine], sigma[mine], strict=True)]
        errors = common_errors(run, times, scaled, after_step)
        total += errors.T @ errors
    return total


def common_errors(run: Run, times: Sequence[Array], derivatives: Sequence[Array], after_step: Sequence[Array]) -> Array:
    """Products (errors, unknowns) of residuals' derivatives and of what one SD of each error does to the residuals.

    `times` and `derivatives` are those of each channel's rows; `after_step` is what a step of one in the drive does to
    it, in cells of time.
    """
    count, cells = steady_rows(run.drive), _cells(run.time_s)
    of_charge = np.zeros((cells[-1] + 1, derivatives[0].shape[1]))
    of_rest = np.zeros(of_charge.shape[1])
    for time_s, rows, response in zip(times, derivatives, after_step, strict=True):
        at = np.clip(_cells(time_s), 0, cells[-1])
        summed = np.zeros_like(of_charge)
        np.add.at(summed, at, rows)
        of_charge += _later(summed, np.diff(response) / CELL_S)
        of_rest += (response[-1] - response[np.minimum(at, len(response) - 1)]) @ rows
    lasts_s = np.diff(run.time_s, append=run.time_s[-1] + run.step_s)[:, np.newaxis]
    jumps = np.abs(np.diff(run.drive, prepend=run.drive[0]))[:, np.newaxis]
    begins = np.flatnonzero(np.append(1.0, np.diff(run.drive)))  # while it stays, a drive is wrong by the same
    level = np.add.reduceat(lasts_s * of_charge[cells], begins)
    level[0] += of_rest * (run.start_C is None)
    noise = np.std(run.drive[:count]) if count >= FEWEST_OF_REST else noise_sd(run.time_s, run.drive, 0.0)
    rest = of_rest * (run.start_C is None) * noise / np.sqrt(count)
    clock = jumps * of_charge[cells] * UNIFORM_SD * clock_step_s(run.time_s)
    return np.concatenate([clock, level * UNIFORM_SD * level_step(run.drive), rest[np.newaxis]])


def _cells(time_s: Array) -> Index:
    return np.asarray(np.round(time_s / CELL_S), dtype=np.int64)


def _later(rows: Array, impulse: Array) -> Array:
    """What an impulse in each cell does to all later rows (cells, unknowns)."""
    from scipy.signal import fftconvolve

    return np.asarray(fftconvolve(rows[::-1], impulse[:, np.newaxis], axes=0)[: len(rows)][::-1])
