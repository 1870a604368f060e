"""Remarks of a fit for the reader of its result.

Of several causes of one misfit the first is named: a column that is late and explains it all, a fit that did not come
to rest, a start that was not steady, and only then keys that are held fixed.
"""

import math
from collections.abc import Sequence

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..rig.uncertainty import Uncertainty
from .between import MAD_TO_SD
from .identify import FittedParameter
from .keys import free_keys, possible_keys
from .problem import FitProblem, Unknown
from .rig_fit import LARGEST, channel_fits
from .runs import Channel
from .solve import Solution, covariance_of, huber, parts_of, solve

EARLY_S, EARLY_TIMES, EARLY_NOISE = 2.0, 1.2, 5.0
"""A start that is not steady shows in the first seconds: residuals well above noise, and above those of the rest."""

NO_MATCH = "the rig does not match the logs within their noise"

OFFSET_SDS = 3.0
"""A sensor that is off by more than this many standard deviations of OFFSET_SD_K is named."""


def disagreement(
    problem: FitProblem, solution: Solution, missed: Sequence[str], late: str, unknown: Sequence[FittedParameter]
) -> tuple[tuple[str, ...], str]:
    """Disagreements of rig and logs with a brief reason; `missed` and `late` are sentences on channels."""
    if late:
        return (late,), "the columns of a log are not of one time"
    if not solution.converged:
        return (*missed, "free fewer keys, so that the fit comes to rest"), "the fit did not come to rest"
    if not missed:
        combined = _combined(problem, solution.theta, unknown) if unknown else ()
        return combined, NO_MATCH if combined else ""
    if not beyond_noise(problem, solution.theta):
        return tuple(missed), "the rig leaves something out of the logs"
    if unsteady(problem, solution.theta):
        return tuple(missed), NO_MATCH
    keys = explaining(problem, solution)
    cure = f"free {' or '.join(keys)} as well" if keys else "something that is not a key of the rig may be wrong"
    return (*missed, f"intervals may be too narrow, since what is held fixed is taken as right: {cure}"), NO_MATCH


def _combined(problem: FitProblem, theta: Array, unknown: Sequence[FittedParameter]) -> tuple[str, ...]:
    """A sentence where keys that are not identified matter together, so that the rig that keeps them misses the log."""
    names = {item.key for item in unknown}
    places = [k for k, key in enumerate(problem.keys) if key.key in names]
    kept = theta.copy()
    kept[places] = problem.first[places]
    if problem.predictions(kept) is not None and not beyond_noise(problem, kept):
        return ()
    return (
        "the logs need another combination of the keys that are not identified, and the rig that keeps their values "
        "misses the logs by more than their noise: leave one of them out of the free keys",
    )


def remarks(problem: FitProblem, theta: Array, *, misfit: bool = False) -> tuple[str, ...]:
    """Sentences on drives, starts, sensors and clocks; with a `misfit` an offset is a consequence and no fault."""
    sentences = [
        f"{run.name}: rows are {1e3 * run.step_s:.0f} ms apart, and the rig's driver may change every "
        f"{1e3 / problem.rig.update_Hz:.0f} ms: what it did in between is not in the log, and intervals allow for it; "
        f"log the drive at its own rate, or state that rate where it is slower (driver.update_Hz)"
        for run in problem.runs
        if run.points
    ]
    sentences += unsteady(problem, theta)
    usual = f"more than the {problem.offset_sd_K:g} K (SD) that sensors are assumed to be"
    for channel, offset_K in far_off(problem, theta):
        what, size = f"{channel.file}: {channel.column}", f"{offset_K:+.2f} K".replace("-", "−")
        sentences.append(
            f"{what} is fitted with an offset of {size}, {usual}; since the rig does not match the log, the offset may "
            f"stand for what the rig has wrong: mend that before you doubt the sensor"
            if misfit
            else f"{what} reads {size} off, {usual}; calibrate it"
        )
    for r, run in enumerate(problem.runs):
        for clock, name in enumerate(run.clocks, 1):
            shift = run.shifts[clock - 1] + problem.nuisance(theta, "shift", r, clock)
            drift = problem.nuisance(theta, "drift", r, clock)
            sentences.append(
                f"{name}: its clock was shifted by {shift:.3f} s against {run.name}, and drifts by "
                f"{drift * 1e6:.0f} parts per million".replace("-", "−")
            )
    return tuple(sentences)


def far_off(problem: FitProblem, theta: Array) -> list[tuple[Channel, float]]:
    """Sensors that are off by more than they are assumed to be, with the offset in K."""
    offsets = [(channel, problem.nuisance(theta, "offset", r, c)) for r, c, channel in problem.channels()]
    return [(channel, offset) for channel, offset in offsets if abs(offset) > OFFSET_SDS * problem.offset_sd_K > 0]


def unsteady(problem: FitProblem, theta: Array) -> list[str]:
    """Runs whose first seconds fit much worse than the rest."""
    names = []
    for each, (_, _, channel) in zip(channel_fits(problem, theta), problem.channels(), strict=True):
        residual = np.abs(each.difference)
        early = residual[each.time_s < EARLY_S]
        most = max(EARLY_TIMES * float(np.median(residual)), EARLY_NOISE * channel.noise, 1e-3)
        if channel.temperature and early.size and np.median(early) > most:
            names.append(each.run)
    return [
        f"{name}: the first {EARLY_S:g} s fit much worse than the rest: the rig was not steady at the first row; "
        f"log a few seconds of rest first"
        for name in dict.fromkeys(names)
    ]


def kept(parameters: Sequence[FittedParameter]) -> tuple[str, ...]:
    """Values that the fitted rig keeps from the rig before, since the logs do not determine them."""
    values = ", ".join(f"{item.key} = {item.start:.4g} {item.unit}".rstrip() for item in parameters)
    return (f"not identified, so that the fitted rig keeps what the rig before had: {values}",) if values else ()


def too_narrow(fitted: Uncertainty, before: Uncertainty) -> tuple[str, ...]:
    """A sentence on uncertainties that reached the most a rig file may state."""
    most = [
        f"{key} = {limit:g}" for key, limit in LARGEST.items() if getattr(fitted, key) == limit > getattr(before, key)
    ]
    if not most:
        return ()
    return (f"{', '.join(most)} is the most that a rig file may state, and too narrow here; do not export from it",)


BEYOND = 2.0
"""Residuals that scatter by so many times the noise are more than noise."""
WORTH, MOST_NAMED = 0.3, 2
"""Share of the sum of squares that a freed key must take away to be named; freeing several at once identifies none."""
ALIKE = 3.0
"""From so many alike neighbours on, a note says that the rig leaves something out."""
LATE_EVALUATIONS = 10
LATE_SD_S, MOST_LATE_S, LEAST_LATE_S, LATE_SDS = 1.0, 5.0, 0.01, 5.0
"""How late a column may be against others of its file (standard deviation), at most, and to be named: at least, and in
standard deviations of the delay itself."""


def beyond_noise(problem: FitProblem, theta: Array, inflation: Sequence[float] = ()) -> tuple[str, ...]:
    """A sentence on each channel whose residuals exceed its noise or, by the `inflation`, have a structure."""
    sentences, noises = list[str](), [channel.noise for _, _, channel in problem.channels()]
    sizes = parts_of(problem, problem.residuals(theta, [max(noise, 1e-9) for noise in noises]))
    for place, (each, part) in enumerate(zip(channel_fits(problem, theta), sizes, strict=True)):
        factor = inflation[place] if inflation else 1.0
        structure = "neighbouring residuals are alike, so that the rig leaves something out"
        if each.difference.size and MAD_TO_SD * float(np.median(np.abs(part))) > BEYOND:
            sentences.append(
                f"{each.file}: {each.column}: residuals of {milli(each.rms, each.unit)} rms exceed the log's own noise "
                f"of {milli(noises[place], each.unit)}{f'; {structure}' if factor > ALIKE else ''}"
            )
        elif factor > ALIKE:
            sentences.append(
                f"{each.file}: {each.column}: {structure}; intervals are {math.sqrt(factor):.1f} times as wide "
                f"as its noise alone would make them"
            )
    return tuple(sentences)


def late_column(problem: FitProblem, solution: Solution) -> str:
    """On the column whose delay explains the residuals best, if any; a step of Gauss and Newton tells which to fit."""
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
        known = problem.runs[r].unknown is None  # else columns may share no instant
        least = LEAST_LATE_S if known else problem.runs[r].step_s
        if explained and abs(late) > max(least, LATE_SDS * sd) and left < best:
            best, word = left, "late" if late > 0 else "early"
            sentence = (
                f"{channel.column} of {channel.file} is {abs(late):.2g} s {word} against the other columns, which "
                f"makes values and intervals wrong: save it with time_s as a file of its own; its clock is then fitted"
            )
    return sentence


def explaining(problem: FitProblem, solution: Solution) -> list[str]:
    """Fixed keys that would take away most of the sum of squares in one step of Gauss and Newton, the best first."""
    rig = problem.rig.with_(**problem.values(solution.theta))
    own = [key.key for key in problem.keys]
    others = [key.key for key in possible_keys(rig, problem.alone) if key.key not in own]
    wide = problem.again(rig, free_keys([*own, *others], rig, problem.alone), problem.runs)
    theta = np.concatenate([wide.first[: len(wide.keys)], solution.theta[len(own) :]])
    jacobian = wide.jacobian(theta, solution.sigma)
    clipped = np.clip(wide.residuals(theta, solution.sigma), -10.0, 10.0)
    usual = [*range(len(own)), *range(len(wide.keys), len(theta))]

    def left(columns: list[int]) -> float:
        step = np.linalg.lstsq(jacobian[:, columns], -clipped, rcond=None)[0]
        return float(np.square(clipped + jacobian[:, columns] @ step).sum())

    before = left(usual)
    gains = {key: 1.0 - left([*usual, len(own) + k]) / before for k, key in enumerate(others)}
    return sorted((key for key in others if gains[key] >= WORTH), key=lambda key: -gains[key])[:MOST_NAMED]


def milli(value: float, unit: str) -> str:
    """A difference in K or V in thousandths, from 1 on in the unit itself."""
    text = f"{1e3 * value:.3g} m{unit}" if abs(value) < 0.9995 else f"{value:.3g} {unit}"
    return text.replace("-", "−")
