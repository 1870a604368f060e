"""Residuals beyond the noise of a log: what the fit holds fixed that would explain most of them.

Intervals come from what the free keys leave. Where a key that is held fixed is wrong, the free ones make up for it and
their intervals are too narrow, however small the noise is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from .keys import fittable, free_keys, value_of
from .problem import Problem, Unknown
from .rig_fit import channel_fits
from .runs import MAD_TO_SD, Channel
from .solve import Solution, covariance_of, huber, solve

BEYOND = 2.0
"""Residuals that scatter by so many times the noise are more than noise."""
WORTH = 0.3
"""Share of the sum of squares that a freed key must take away to be named."""
MOST_NAMED = 2
"""Keys that are named at most: freeing several at once identifies none."""
ALIKE = 3.0
"""From so many alike neighbours on, a note says that the rig leaves something out."""
LATE_EVALUATIONS = 10
LATE_SD_S, MOST_LATE_S, LEAST_LATE_S, LATE_SDS = 1.0, 5.0, 0.01, 5.0
"""How late a column may be against others of its file (standard deviation), at most, and to be named: at least, and in
standard deviations of the delay itself."""


def beyond_noise(problem: Problem, theta: Array, inflation: Sequence[float] = ()) -> tuple[str, ...]:
    """A sentence on each channel whose residuals at a point exceed the noise of the log; few wild rows do not count.

    With the `inflation` of a solution, also on those whose residuals are within the noise, but have a structure.
    """
    sentences = []
    for place, (each, (_, _, channel)) in enumerate(zip(channel_fits(problem, theta), problem.channels(), strict=True)):
        noise, factor = noise_of(channel), inflation[place] if inflation else 1.0
        structure = "neighbouring residuals are alike, so that the rig leaves something out"
        if each.residual.size and MAD_TO_SD * float(np.median(np.abs(each.residual))) > BEYOND * noise:
            sentences.append(
                f"{each.file}: {each.column}: residuals of {milli(each.rms, each.unit)} rms exceed the log's own noise "
                f"of {milli(noise, each.unit)}{f'; {structure}' if factor > ALIKE else ''}"
            )
        elif factor > ALIKE:
            sentences.append(
                f"{each.file}: {each.column}: {structure}; intervals are {math.sqrt(factor):.1f} times as wide "
                f"as its noise alone would make them"
            )
    return tuple(sentences)


def late_column(problem: Problem, solution: Solution) -> str:
    """A sentence on the column whose delay against the others of its file explains the residuals best; or nothing.

    Other keys may make up for a delay within the noise: one step of Gauss and Newton tells whether a fit is worth it.
    """
    best, sentence = np.inf, ""
    for r, c, channel in problem.channels():
        if channel.clock or len(problem.runs[r].channels) == 1:
            continue
        wide = problem.with_unknown(Unknown("late", r, c, LATE_SD_S, low=-MOST_LATE_S, high=MOST_LATE_S))
        begin = np.append(solution.theta, 0.0)
        residuals, jacobian = wide.residuals(begin, solution.sigma), wide.jacobian(begin, solution.sigma)
        step = float(np.linalg.lstsq(jacobian, -residuals)[0][-1])
        if abs(step) < LATE_SDS * float(np.sqrt(covariance_of(wide, jacobian, solution.inflation)[-1, -1])):
            continue
        found = solve(wide, begin, LATE_EVALUATIONS)
        late, sd = float(found.theta[-1]), float(np.sqrt(found.covariance[-1, -1]))
        left = huber(wide.residuals(found.theta, solution.sigma))
        explained = not beyond_noise(wide, found.theta, found.inflation)
        if explained and abs(late) > max(LEAST_LATE_S, LATE_SDS * sd) and left < best:
            best, word = left, "late" if late > 0 else "early"
            sentence = (
                f"{channel.column} of {channel.file} is {abs(late):.2g} s {word} against the other columns, which "
                f"makes values and intervals wrong: save it with time_s as a file of its own; its clock is then fitted"
            )
    return sentence


def noise_of(channel: Channel) -> float:
    """SD of what changes from row to row, by second differences, which leave slow changes out."""
    bends = np.diff(channel.values, 2)
    own = MAD_TO_SD * float(np.median(np.abs(bends))) / np.sqrt(6.0) if bends.size else 0.0
    return float(max(own, channel.resolution / np.sqrt(12.0)))


def explaining(problem: Problem, solution: Solution) -> tuple[str, ...]:
    """Keys that are held fixed, and would take away most of the residuals if they were free, the best first."""
    rig = problem.rig.with_(**problem.values(solution.theta))
    own = [key.key for key in problem.keys]
    others = [key for key in fittable(rig) if key not in own and _can_move(value_of(rig, key))]
    keys = free_keys([*own, *others], rig)
    wide = problem.again(rig, keys, problem.runs)
    theta = wide.first.copy()
    theta[len(keys) :] = solution.theta[len(own) :]
    residuals = wide.residuals(theta, solution.sigma)
    if wide.predictions(theta) is None:
        return ()
    jacobian = wide.jacobian(theta, solution.sigma)
    usual = [*range(len(own)), *range(len(keys), len(theta))]
    before = _left(residuals, jacobian[:, usual])
    gains = {key: 1.0 - _left(residuals, jacobian[:, [*usual, len(own) + k]]) / before for k, key in enumerate(others)}
    worth = sorted((key for key in others if gains[key] >= WORTH), key=lambda key: -gains[key])
    return tuple(worth[:MOST_NAMED])


def _left(residuals: Array, jacobian: Array) -> float:
    """Sum of squares after one step of Gauss and Newton, far outliers cut."""
    clipped = np.clip(residuals, -10.0, 10.0)
    step = np.linalg.lstsq(jacobian, -clipped, rcond=None)[0]
    return float(np.square(clipped + jacobian @ step).sum())


def _can_move(value: float | None) -> bool:
    """Whether there is a value to move; a lag of 0 has a bound there."""
    return value is not None and value != 0.0


def milli(value: float, unit: str) -> str:
    """A difference in K or V in thousandths, from 1 on in the unit itself."""
    text = f"{1e3 * value:.3g} m{unit}" if abs(value) < 0.9995 else f"{value:.3g} {unit}"
    return text.replace("-", "−")
